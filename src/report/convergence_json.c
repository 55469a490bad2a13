#include "convergence_json.h"

#include <math.h>
#include <stdio.h>

#include "convergence_facts.h"
#include "json_parts.h"

static json_t *count_json(size_t count)
{
    return json_integer((json_int_t)count);
}

static json_t *excluded_json(const sphv_norms *norms)
{
    json_t *object = json_object();
    for (int fault = SPHV_FAULT_NONE + 1; fault < SPHV_FAULTS; fault++)
        json_object_set_new(object, sphv_faults[fault].name, count_json(norms->excluded[fault]));
    json_object_set_new(object, "exact_undefined", count_json(norms->exact_undefined));
    return object;
}

static json_t *norms_json(const sphv_rate_point *point, int part)
{
    const sphv_norms *norms = part ? &point->interior : &point->whole;
    if (!norms->counted) return json_null();
    json_t *object =
        json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "rmse", sphv_json_number(norms->rmse),
                  "rmse_bound", sphv_json_number(norms->bound), "mae", sphv_json_number(norms->mae),
                  "maximum", sphv_json_number(norms->maximum), "mean_square",
                  sphv_json_number(norms->mean_square), "standard_deviation",
                  sphv_json_number(norms->standard_deviation), "counted",
                  count_json(norms->counted), "excluded", excluded_json(norms));
    bool predicted = point->predicted[part];
    json_object_set_new(object, "predicted_rmse",
                        predicted ? sphv_json_result(point->prediction[part]) : json_null());
    json_object_set_new(object, "rigour",
                        predicted ? json_string(sphv_rigour_name(point->rigour)) : json_null());
    json_object_set_new(object, "verdict",
                        predicted ? json_string(sphv_verdict_name(point->verdict[part]))
                                  : json_null());
    return object;
}

static json_t *stage_json(const sphv_convergence *scene, const sphv_stage *stage, bool method)
{
    json_t *quantities = json_object(), *faults = json_object();
    for (size_t t = 0; t < scene->target_count; t++)
        if (stage->points[t].there && !scene->targets[t].altered)
            json_object_set_new(quantities, scene->targets[t].name,
                                json_pack("{s:o, s:o}", "whole", norms_json(&stage->points[t], 0),
                                          "interior", norms_json(&stage->points[t], 1)));
    for (int fault = SPHV_FAULT_NONE + 1; method && fault < SPHV_FAULTS; fault++)
        json_object_set_new(faults, sphv_faults[fault].name, count_json(stage->faults[fault]));
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "particles",
                     count_json(stage->particles), "spacing", sphv_json_number(stage->spacing), "h",
                     sphv_json_number(stage->h), "neighbours", count_json(stage->neighbours),
                     "faults", faults, "worst_condition", sphv_json_number(stage->worst_condition),
                     "quantities", quantities);
}

static json_t *box_json(const sphv_box *box)
{
    bool lattice = box->layout == SPHV_LATTICE, perturbed = box->layout == SPHV_PERTURBED;
    return json_pack(
        "{s:s, s:o, s:o, s:o, s:o, s:s, s:o}", "layout", sphv_layouts[box->layout].name,
        "placement",
        lattice || perturbed ? json_string(sphv_placements[box->placement].name) : json_null(),
        "jitter", perturbed ? json_string(sphv_jitters[box->jitter].name) : json_null(),
        "amplitude", perturbed ? sphv_json_number(box->amplitude) : json_null(), "reflected",
        perturbed ? json_boolean(box->reflected) : json_null(), "volume",
        sphv_volumes[box->volume].name, "seed",
        lattice ? json_null() : json_integer((json_int_t)box->seed));
}

static json_t *scheme_json(const sphv_convergence_result *result, size_t s)
{
    const sphv_convergence *scene = result->scene;
    const sphv_scheme *scheme = &scene->schemes[s];
    char h[SPHV_RULE_TEXT];
    json_t *levels = json_array();
    for (size_t l = 0; l < scene->level_count; l++)
        json_array_append_new(
            levels, stage_json(scene, sphv_convergence_stage(result, l, s), scheme->has_method));
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "id", sphv_json_text(scheme->id), "label",
        sphv_json_text(scheme->label), "kernel", sphv_json_text(sphv_kernel_name(scheme->kernel)),
        "method", scheme->has_method ? json_string(sphv_methods[scheme->method].name) : json_null(),
        "h", sphv_json_text(sphv_h_rule_text(h, scheme)), "particles",
        box_json(&scene->boxes[scheme->box].box), "levels", levels);
}

static json_t *evidence_json(const sphv_convergence *scene, const sphv_cell *cell,
                             const sphv_cell_result *found)
{
    json_t *list = json_array();
    for (size_t e = 0; e < cell->evidence_count; e++) {
        const sphv_evidence *evidence = &cell->evidence[e];
        json_array_append_new(list, json_pack("{s:o, s:s, s:s, s:I, s:I, s:o, s:b}", "statement",
                                              sphv_json_text(evidence->statement), "scheme",
                                              scene->schemes[evidence->series.scheme].id, "metric",
                                              sphv_metrics[evidence->series.metric].name,
                                              "first_level", (json_int_t)evidence->series.first + 1,
                                              "levels", (json_int_t)evidence->series.count,
                                              "slope_in_N", sphv_json_number(found->evidence[e]),
                                              "expected_to_match", evidence->matches));
    }
    return list;
}

static json_t *cell_json(const sphv_convergence_result *result, size_t index)
{
    const sphv_convergence *scene = result->scene;
    const sphv_rate_table *table = scene->table;
    const sphv_cell *cell = &table->cells[index];
    const sphv_cell_result *found = &result->cells[index];
    size_t row = index / table->column_count, column = index % table->column_count;
    json_t *object = json_pack(
        "{s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:s, s:b}", "quantity",
        scene->targets[table->rows[row]].name, "scheme", scene->schemes[table->columns[column]].id,
        "printed_text", cell->text, "printed", sphv_json_number(cell->printed), "tolerance",
        sphv_json_number(table->groups[table->group[column]].tolerance), "slope_in_N",
        sphv_json_number(found->slope), "slope_in_h", sphv_json_number(found->slope_h),
        "slope_of_rmse_per_neighbour_in_N", sphv_json_number(found->per_neighbour),
        "theory_slope_in_N", sphv_json_number(found->theory), "asymptotic_slope_in_N",
        sphv_json_number(cell->limit), "interior_slope_in_N", sphv_json_number(found->interior),
        "theory_interior_slope_in_N", sphv_json_number(found->theory_interior), "verdict",
        sphv_cell_verdict_name(found->verdict), "surprising",
        found->surprising || found->evidence_surprises);
    json_object_set_new(object, "expected_verdict",
                        json_string(sphv_cell_verdict_name(cell->expected)));
    json_object_set_new(object, "why", sphv_json_text_or_null(cell->why));
    json_object_set_new(object, "evidence", evidence_json(scene, cell, found));
    return object;
}

static json_t *table_json(const sphv_convergence_result *result)
{
    const sphv_rate_table *table = result->scene->table;
    if (!table) return json_null();
    json_t *cells = json_array(), *groups = json_array();
    for (size_t i = 0; i < table->row_count * table->column_count; i++)
        if (table->cells[i].there) json_array_append_new(cells, cell_json(result, i));
    for (size_t g = 0; g < table->group_count; g++)
        json_array_append_new(groups,
                              json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:b}", "columns",
                                        sphv_json_text(table->groups[g].label), "cells",
                                        count_json(result->groups[g].cells), "reproduced",
                                        count_json(result->groups[g].reproduced), "rms_deviation",
                                        sphv_json_number(result->groups[g].rms), "rms_tolerance",
                                        sphv_json_number(table->groups[g].rms), "cell_tolerance",
                                        sphv_json_number(table->groups[g].tolerance), "reason",
                                        sphv_json_text(table->groups[g].reason), "surprising",
                                        result->groups[g].surprising));
    return json_pack("{s:o, s:o}", "groups", groups, "cells", cells);
}

static json_t *claim_json(const sphv_convergence_result *result, size_t index)
{
    const sphv_rate_claim *claim = &result->scene->claims[index];
    const sphv_claim_result *found = &result->claims[index];
    char measure[SPHV_SERIES_TEXT];
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:s, s:o, s:o, s:b}", "id", sphv_json_text(claim->id),
        "statement", sphv_json_text(claim->statement), "measure",
        sphv_json_text(sphv_claim_series_text(measure, result->scene, claim)), "expected",
        sphv_json_number(claim->expected), "tolerance", sphv_json_number(claim->tolerance),
        "analytic", sphv_json_number(found->analytic), "empirical",
        sphv_json_number(found->empirical), "verdict", sphv_verdict_name(found->verdict), "reason",
        sphv_json_text(claim->reason), "refuted", sphv_json_text_or_null(claim->refuted),
        "surprising", found->surprising);
}

static json_t *listed_json(const sphv_convergence_result *result)
{
    const sphv_level_list *list = result->scene->listed;
    if (!list) return json_null();
    json_t *rows = json_array();
    for (size_t l = 0; l < result->scene->level_count; l++) {
        const sphv_stage *stage = sphv_convergence_stage(result, l, list->scheme);
        json_array_append_new(
            rows, json_pack("{s:o, s:o, s:o, s:o, s:o}", "particles", count_json(stage->particles),
                            "printed_neighbours", sphv_json_text(list->neighbours[l]), "neighbours",
                            count_json(stage->neighbours), "printed_h", sphv_json_text(list->h[l]),
                            "h", sphv_json_number(stage->h)));
    }
    return json_pack("{s:o, s:o, s:o}", "neighbours_met", count_json(result->listed_neighbours),
                     "h_met", count_json(result->listed_h), "levels", rows);
}

json_t *sphv_convergence_json(const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    json_t *schemes = json_array(), *claims = json_array();
    for (size_t s = 0; s < scene->scheme_count; s++)
        json_array_append_new(schemes, scheme_json(result, s));
    for (size_t c = 0; c < scene->claim_count; c++)
        json_array_append_new(claims, claim_json(result, c));
    return json_pack(
        "{s:o, s:s, s:o, s:o, s:o, s:s, s:i, s:{s:o, s:o, s:o}, s:o, s:o, s:o, s:o, s:o, s:o}",
        "scene", sphv_json_text(scene->name), "kind", "convergence", "title",
        sphv_json_text(scene->title), "source", sphv_json_text(scene->source), "notes",
        sphv_json_text(scene->notes), "verdict", sphv_verdict_name(result->verdict), "dimension",
        scene->dimension, "points", sphv_verdict_name(SPHV_AGREES),
        count_json(result->verdicts[SPHV_AGREES]), sphv_verdict_name(SPHV_DISAGREES),
        count_json(result->verdicts[SPHV_DISAGREES]), sphv_verdict_name(SPHV_INCONCLUSIVE),
        count_json(result->verdicts[SPHV_INCONCLUSIVE]), "claims", claims, "table",
        table_json(result), "printed_levels", listed_json(result), "schemes", schemes, "pairs",
        sphv_json_number(result->pairs), "seconds", sphv_json_number(result->seconds));
}

/// The columns that only cells have, in every row.
static void add_cell_columns(json_t *row, const sphv_cell *cell, const sphv_cell_result *found)
{
    const double none = NAN;
    const struct {
        const char *name;
        double value;
    } numbers[] = {
        {"slope_in_N", found ? found->slope : none},
        {"slope_in_h", found ? found->slope_h : none},
        {"slope_of_rmse_per_neighbour_in_N", found ? found->per_neighbour : none},
        {"asymptotic_slope_in_N", cell ? cell->limit : none},
        {"interior_slope_in_N", found ? found->interior : none},
        {"theory_interior_slope_in_N", found ? found->theory_interior : none},
    };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        json_object_set_new(row, numbers[i].name, sphv_json_number(numbers[i].value));
    json_object_set_new(row, "as_expected",
                        found ? json_boolean(!found->surprising && !found->evidence_surprises)
                              : json_null());
    json_object_set_new(row, "remark", sphv_json_text_or_null(cell ? cell->why : NULL));
}

static json_t *cell_row(const sphv_convergence_result *result, size_t index)
{
    const sphv_convergence *scene = result->scene;
    const sphv_rate_table *table = scene->table;
    const sphv_cell *cell = &table->cells[index];
    const sphv_cell_result *found = &result->cells[index];
    const sphv_scheme *scheme = &scene->schemes[table->columns[index % table->column_count]];
    const char *quantity = scene->targets[table->rows[index / table->column_count]].name;
    char id[140], statement[260];
    bool shared = found->verdict == SPHV_CELL_PER_NEIGHBOUR;
    snprintf(id, sizeof id, "%.60s/%.60s", quantity, scheme->id);
    snprintf(statement, sizeof statement, "RMSE of %.60s by %.60s goes as N^(%.20s)", quantity,
             scheme->label, cell->text);
    json_t *row = json_pack(
        "{s:o, s:o, s:o, s:s, s:o, s:o, s:o, s:o, s:s}", "scene", sphv_json_text(scene->name), "id",
        sphv_json_text(id), "statement", sphv_json_text(statement), "measure",
        shared ? "slope of RMSE/n_nb against N" : "slope of RMSE against N", "expected",
        sphv_json_number(cell->printed), "tolerance",
        sphv_json_number(table->groups[table->group[index % table->column_count]].tolerance),
        "analytic", sphv_json_number(shared ? NAN : found->theory), "empirical",
        sphv_json_number(shared ? found->per_neighbour : found->slope), "verdict",
        sphv_cell_verdict_name(found->verdict));
    add_cell_columns(row, cell, found);
    return row;
}

json_t *sphv_convergence_rows(const sphv_convergence_result *result)
{
    const sphv_rate_table *table = result->scene->table;
    json_t *rows = json_array();
    for (size_t i = 0; table && i < table->row_count * table->column_count; i++)
        if (table->cells[i].there) json_array_append_new(rows, cell_row(result, i));
    for (size_t c = 0; c < result->scene->claim_count; c++) {
        static const char *const keys[] = {"id",        "statement", "measure",   "expected",
                                           "tolerance", "analytic",  "empirical", "verdict"};
        json_t *claim = claim_json(result, c), *row = json_object();
        json_object_set_new(row, "scene", sphv_json_text(result->scene->name));
        for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
            json_object_set(row, keys[k], json_object_get(claim, keys[k]));
        add_cell_columns(row, NULL, NULL);
        json_object_set_new(row, "as_expected", json_boolean(!result->claims[c].surprising));
        json_object_set(row, "remark", json_object_get(claim, "refuted"));
        json_array_append_new(rows, row);
        json_decref(claim);
    }
    return rows;
}
