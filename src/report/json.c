#include <jansson.h>
#include <math.h>

#include "convergence_json.h"
#include "json_parts.h"
#include "rendering.h"
#include "scene_json.h"

static json_t *tally_json(const size_t counts[3])
{
    json_t *object = json_object();
    for (int i = SPHV_AGREES; i <= SPHV_INCONCLUSIVE; i++)
        json_object_set_new(object, sphv_verdict_name((sphv_verdict)i),
                            json_integer((json_int_t)counts[i]));
    return object;
}

static json_t *prediction_json(const sphv_prediction *prediction)
{
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:s}", "smoothing",
                     sphv_json_number(prediction->smoothing.value), "discretisation",
                     sphv_json_number(prediction->discretisation.value), "total",
                     sphv_json_number(prediction->total.value), "l2",
                     sphv_json_number(prediction->l2.value), "bound",
                     sphv_json_number(prediction->total.bound), "rigour",
                     sphv_rigour_name(prediction->rigour));
}

/// A cell of the table; `l2`, which is |total|/√2, and `rigour`, the same in all, are not repeated.
static json_t *cell_json(const sphv_agreement_cell *cell)
{
    const sphv_prediction *exact = &cell->exact.analytic, *paper = &cell->paper;
    const sphv_measurement *empirical = &cell->exact.empirical;
    return json_pack(
        "{s:o, s:i, s:{s:o, s:o, s:o, s:o}, s:{s:o, s:o, s:I}, s:o, s:s, s:{s:o, s:o, s:o, s:o}, "
        "s:s}",
        "h", sphv_json_number(cell->h), "n", cell->n, "analytic", "smoothing",
        sphv_json_number(exact->smoothing.value), "discretisation",
        sphv_json_number(exact->discretisation.value), "total",
        sphv_json_number(exact->total.value), "bound", sphv_json_number(exact->total.bound),
        "empirical", "total", sphv_json_number(empirical->total.value), "bound",
        sphv_json_number(empirical->total.bound), "neighbours", (json_int_t)empirical->neighbours,
        "difference", sphv_json_number(cell->exact.difference), "verdict",
        sphv_verdict_name(cell->exact.verdict), "paper", "smoothing",
        sphv_json_number(paper->smoothing.value), "discretisation",
        sphv_json_number(paper->discretisation.value), "total",
        sphv_json_number(paper->total.value), "bound", sphv_json_number(paper->total.bound),
        "paper_verdict", sphv_verdict_name(cell->paper_verdict));
}

static json_t *agreement_json(const sphv_agreement *agreement)
{
    json_t *cells = json_array();
    for (size_t i = 0; i < agreement->h_count * agreement->n_count; i++)
        json_array_append_new(cells, cell_json(&agreement->cells[i]));
    return json_pack("{s:o, s:o, s:o}", "exact", tally_json(agreement->exact), "paper",
                     tally_json(agreement->paper), "cells", cells);
}

static json_t *fourier_json(const sphv_fourier_sign *sign)
{
    return json_pack("{s:b, s:o, s:o, s:o, s:o}", "negative", sign->negative, "first_negative",
                     sign->negative ? sphv_json_number(sign->first_negative) : json_null(),
                     "minimum", sphv_json_number(sign->minimum), "minimum_at",
                     sphv_json_number(sign->minimum_at), "searched",
                     sphv_json_number(sign->searched));
}

static json_t *dimension_json(const sphv_dimension_facts *facts)
{
    json_t *moments = json_array();
    for (int i = 0; i < SPHV_FACT_MOMENTS; i++)
        json_array_append_new(
            moments, json_pack("{s:i, s:o, s:o, s:o}", "order", 2 * i, "value",
                               sphv_json_number(facts->profile->moment[2 * i].value), "bound",
                               sphv_json_number(facts->profile->moment[2 * i].bound), "exact",
                               sphv_json_text_or_null(facts->moment[i])));
    json_t *constant = sphv_json_result(facts->profile->constant);
    json_object_set_new(constant, "exact", sphv_json_text_or_null(facts->constant));
    json_object_set_new(constant, "claim", sphv_json_text_or_null(facts->claim));
    if (facts->claim) {
        json_object_set_new(constant, "claimed", sphv_json_number(facts->claimed));
        json_object_set_new(constant, "verdict",
                            json_string(sphv_verdict_name(facts->claim_verdict)));
    }
    return json_pack("{s:i, s:o, s:o, s:o, s:o}", "dim", facts->profile->dimension, "constant",
                     constant, "integral_minus_one", sphv_json_number(facts->profile->excess),
                     "moments", moments, "fourier", fourier_json(&facts->fourier));
}

static json_t *knots_json(const sphv_profile *profile)
{
    json_t *knots = json_array();
    for (int i = 0; i < profile->knot_count; i++) {
        const sphv_knot *knot = &profile->knots[i];
        json_array_append_new(
            knots,
            json_pack("{s:o, s:i, s:o}", "position", sphv_json_number(knot->position.value),
                      "order", knot->order, "jump",
                      sphv_json_number(knot->jump[knot->order] * tgamma(knot->order + 1.0))));
    }
    return knots;
}

static json_t *order_json(const sphv_kernel_facts *facts)
{
    const sphv_profile *profile = facts->dimension[0].profile;
    if (!profile) return json_null();
    return json_pack("{s:i, s:o, s:i, s:o, s:i}", "special_spacing", facts->special_order,
                     "special_knot",
                     sphv_json_number(profile->knots[facts->special_knot].position.value),
                     "any_spacing", facts->general_order, "any_knot",
                     sphv_json_number(profile->knots[facts->general_knot].position.value),
                     "edge_alone", facts->edge_order);
}

static json_t *checks_json(const sphv_check_report *check)
{
    if (!check) return json_null();
    json_t *checks = json_array();
    for (size_t i = 0; i < check->count; i++)
        json_array_append_new(checks, sphv_check_result_json(&check->results[i]));
    return checks;
}

static json_t *kernel_json(const sphv_kernel_facts *facts)
{
    json_t *dimensions = json_array(), *refused = json_object();
    for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
        char name[2] = {(char)('0' + d), '\0'};
        if (facts->dimension[d - 1].profile)
            json_array_append_new(dimensions, dimension_json(&facts->dimension[d - 1]));
        else
            json_object_set_new(refused, name, json_string(sphv_kernel_refusal(facts->kernel, d)));
    }
    json_t *object = json_pack(
        "{s:s, s:s, s:s, s:s, s:o, s:{s:i, s:o}, s:o, s:o, s:o, s:o}", "kernel",
        sphv_kernel_name(facts->kernel), "title", sphv_kernel_title(facts->kernel), "source",
        sphv_kernel_source(facts->kernel), "verdict", sphv_verdict_name(facts->verdict), "support",
        sphv_json_number(facts->profile->support), "beta", "found",
        facts->profile->boundary_smoothness, "claimed",
        facts->claimed_smoothness ? json_integer(*facts->claimed_smoothness) : json_null(),
        "dimensions", dimensions, "refused", refused, "knots", knots_json(facts->profile),
        "discretisation_order", order_json(facts));
    json_object_set_new(object, "checks", checks_json(facts->check));
    json_object_set_new(object, "agreement",
                        facts->agreement ? agreement_json(facts->agreement) : json_null());
    return object;
}

static json_t *sample_json(const sphv_scene *scene, const sphv_sample *sample)
{
    const sphv_point *point = &sample->point;
    if (scene->abscissa == SPHV_OVER_Q)
        return json_pack("{s:o, s:o, s:o, s:s}", "q", sphv_json_number(sample->x), "analytic",
                         sphv_json_result(point->analytic.total), "empirical",
                         sphv_json_result(point->empirical.total), "verdict",
                         sphv_verdict_name(point->verdict));
    json_t *analytic = prediction_json(&point->analytic);
    json_object_set_new(analytic, "l2_bound", sphv_json_number(point->analytic.l2.bound));
    json_t *empirical =
        json_pack("{s:o, s:o, s:o, s:o}", "total", sphv_json_number(point->empirical.total.value),
                  "l2", sphv_json_number(point->empirical.l2.value), "bound",
                  sphv_json_number(point->empirical.total.bound), "l2_bound",
                  sphv_json_number(point->empirical.l2.bound));
    json_t *object =
        json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:s}", "h", sphv_json_number(sample->h),
                  "spacing", sphv_json_number(sample->spacing.value), "n",
                  sample->n >= 0 ? json_integer(sample->n) : json_null(), "analytic", analytic,
                  "empirical", empirical, "difference", sphv_json_number(point->difference),
                  "verdict", sphv_verdict_name(point->verdict));
    if (point->statistical) {
        const sphv_disorder_measurement *found = &point->disorder;
        sphv_fault_counts faults = {.estimates = found->particles,
                                    .singular = found->singular,
                                    .ill_conditioned = found->ill_conditioned,
                                    .not_finite = found->not_finite,
                                    .worst_condition = found->worst_condition};
        json_object_set_new(object, "realisations", json_integer(found->realisations));
        json_object_set_new(object, "faults", sphv_faults_json(true, &faults));
    }
    if (sample->n >= 0) {
        json_object_set_new(object, "paper", prediction_json(&sample->paper));
        json_object_set_new(object, "paper_verdict",
                            json_string(sphv_verdict_name(sample->paper_verdict)));
    }
    return object;
}

static json_t *scene_with_curves(const sphv_scene_result *result)
{
    const sphv_scene *scene = result->scene;
    json_t *object = sphv_scene_json(result), *curves = json_object_get(object, "curves");
    for (size_t c = 0; c < scene->curve_count; c++) {
        json_t *samples = json_array();
        for (size_t i = 0; i < result->sample_count[c]; i++)
            json_array_append_new(samples, sample_json(scene, &result->samples[c][i]));
        json_object_set_new(json_array_get(curves, c), "samples", samples);
    }
    return object;
}

static json_t *rules_json(const sphv_rule_comparison *rules)
{
    json_t *rows = json_array(), *holding = json_object();
    for (size_t i = 0; i < rules->count; i++) {
        const sphv_rule_row *row = &rules->rows[i];
        json_t *object = json_pack(
            "{s:o, s:o, s:o, s:o}", "scene", sphv_json_text(row->scene->name), "claim",
            sphv_json_text(row->claim->id), "expected", sphv_json_number(row->claim->expected),
            "tolerance", sphv_json_number(row->claim->tolerance));
        for (int rule = 0; rule < SPHV_RULES; rule++)
            json_object_set_new(object, sphv_volumes[sphv_rule_volume[rule]].name,
                                json_pack("{s:o, s:o, s:s}", "analytic",
                                          sphv_json_number(row->found[rule].analytic), "empirical",
                                          sphv_json_number(row->found[rule].empirical), "verdict",
                                          sphv_verdict_name(row->found[rule].verdict)));
        json_array_append_new(rows, object);
    }
    for (int rule = 0; rule < SPHV_RULES; rule++)
        json_object_set_new(holding, sphv_volumes[sphv_rule_volume[rule]].name,
                            json_integer((json_int_t)rules->holding[rule]));
    return json_pack("{s:o, s:o, s:s, s:o}", "holding", holding, "reproducing",
                     rules->reproducing < 0
                         ? json_null()
                         : json_string(sphv_volumes[sphv_rule_volume[rules->reproducing]].name),
                     "conclusion", rules->conclusion, "claims", rows);
}

static json_t *methods_json(const sphv_rendering *rendering)
{
    json_t *rows = json_array();
    for (size_t i = 0; i < rendering->method_count; i++) {
        const sphv_method_facts *of = &rendering->methods[i];
        json_t *row = sphv_faults_json(true, &of->faults);
        json_object_set_new(row, "method", json_string(of->name));
        json_object_set_new(row, "worst_scene", sphv_json_text_or_null(of->faults.worst_scene));
        json_object_set_new(row, "worst_h", sphv_json_number(of->faults.worst_h));
        json_object_set_new(row, "worst_spacing", sphv_json_number(of->faults.worst_spacing));
        json_array_append_new(rows, row);
    }
    return rows;
}

static json_t *sign_slips_json(const sphv_slips *slips)
{
    json_t *rows = json_array();
    for (int i = 0; slips->sign_kernel && i < SPHV_SIGN_ROWS; i++) {
        const sphv_sign_slip *row = &slips->sign[i];
        json_array_append_new(rows, json_pack("{s:s, s:i, s:o, s:o, s:o, s:s, s:o, s:s, s:o}",
                                              "kernel", sphv_kernel_name(slips->sign_kernel), "n",
                                              row->n, "spacing", sphv_json_number(row->spacing),
                                              "measured", sphv_json_result(row->measured), "mended",
                                              sphv_json_result(row->mended), "mended_verdict",
                                              sphv_verdict_name(row->mended_verdict), "printed",
                                              sphv_json_result(row->printed), "printed_verdict",
                                              sphv_verdict_name(row->printed_verdict), "first_term",
                                              sphv_json_number(row->first_term)));
    }
    return rows;
}

static json_t *knot_slip_json(const sphv_slips *slips)
{
    const sphv_knot_slip *slip = &slips->knot;
    if (!slips->knot_kernel) return json_null();
    json_t *terms = json_array();
    for (int k = 0; k < slip->knot_count; k++)
        for (int i = 0; i < SPHV_KNOT_TERMS; i++)
            json_array_append_new(terms, json_pack("{s:o, s:i, s:o}", "knot",
                                                   sphv_json_number(slip->position[k]), "p",
                                                   slip->first_order + i, "value",
                                                   sphv_json_number(slip->term[k][i])));
    return json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:s, s:o, s:s, s:i, s:i, s:o}", "kernel",
                     sphv_kernel_name(slips->knot_kernel), "h", sphv_json_number(slip->h),
                     "spacing", sphv_json_number(slip->spacing), "terms", terms, "measured",
                     sphv_json_result(slip->measured), "exact", sphv_json_result(slip->exact),
                     "exact_verdict", sphv_verdict_name(slip->exact_verdict), "paper",
                     sphv_json_result(slip->paper), "paper_verdict",
                     sphv_verdict_name(slip->paper_verdict), "predicted_order",
                     slip->predicted_order, "paper_order", slip->paper_order, "fitted_order",
                     sphv_json_result(slip->fitted_order));
}

bool sphv_render_json(FILE *stream, const sphv_rendering *rendering)
{
    const sphv_report *report = rendering->report;
    json_t *kernels = json_array(), *scenes = json_array(), *rates = json_array();
    for (size_t i = 0; i < report->kernel_count; i++)
        json_array_append_new(kernels, kernel_json(&rendering->facts[i]));
    for (size_t i = 0; i < report->scene_count; i++)
        json_array_append_new(scenes, scene_with_curves(report->scenes[i]));
    for (size_t i = 0; i < report->convergence_count; i++)
        json_array_append_new(rates, sphv_convergence_json(report->convergences[i]));
    json_t *root = json_pack("{s:s, s:o, s:{s:o, s:o}, s:{s:o, s:o}, s:o, s:o, s:o}", "verdict",
                             sphv_verdict_name(sphv_rendering_verdict(rendering)), "seconds",
                             sphv_json_number(report->seconds), "slips", "sign",
                             sign_slips_json(&rendering->slips), "interior_knots",
                             knot_slip_json(&rendering->slips), "disorder", "volume_rules",
                             rules_json(&rendering->rules), "methods", methods_json(rendering),
                             "kernels", kernels, "scenes", scenes, "convergence", rates);
    // A failure to write shows in the stream; only memory is reported here.
    if (root) (void)json_dumpf(root, stream, JSON_COMPACT | JSON_REAL_PRECISION(17));
    fputc('\n', stream);
    bool whole = root != NULL;
    json_decref(root);
    return whole;
}
