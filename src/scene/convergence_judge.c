#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "convergence_internal.h"

const char *sphv_cell_verdict_name(sphv_cell_verdict verdict)
{
    static const char *const names[] = {"reproduced", "reproduced as slope of RMSE/n",
                                        "not reproduced"};
    return names[verdict];
}

const sphv_stage *sphv_convergence_stage(const sphv_convergence_result *result, size_t level,
                                         size_t scheme)
{
    return &result->stages[level * result->scene->scheme_count + scheme];
}

const sphv_rate_point *sphv_convergence_point(const sphv_convergence_result *result, size_t level,
                                              size_t scheme, size_t target)
{
    return &sphv_convergence_stage(result, level, scheme)->points[target];
}

double sphv_stage_place(const sphv_stage *stage, sphv_axis axis)
{
    switch (axis) {
    case SPHV_AXIS_NEIGHBOURS:
        return (double)stage->neighbours;
    case SPHV_AXIS_H:
        return stage->h;
    case SPHV_AXIS_RATIO:
        return stage->h / stage->spacing;
    default:
        return (double)stage->particles;
    }
}

static double norm_of(const sphv_norms *norms, sphv_metric metric)
{
    if (!norms->counted) return NAN;
    switch (metric) {
    case SPHV_METRIC_RMSE:
        return norms->rmse;
    case SPHV_METRIC_MAE:
        return norms->mae;
    case SPHV_METRIC_MAXIMUM:
        return norms->maximum;
    case SPHV_METRIC_MEAN_SQUARE:
        return norms->mean_square;
    default:
        return norms->standard_deviation;
    }
}

static double failed_part(const sphv_stage *stage)
{
    size_t failed = 0;
    for (int fault = SPHV_FAULT_NONE + 1; fault < SPHV_FAULTS; fault++)
        failed += stage->faults[fault];
    return (double)failed / (double)stage->particles;
}

double sphv_series_value(const sphv_convergence_result *result, const sphv_series *series,
                         size_t level, bool theory)
{
    const sphv_stage *stage = sphv_convergence_stage(result, level, series->scheme);
    double value = NAN;
    if (series->metric == SPHV_METRIC_NEIGHBOURS)
        value = theory ? NAN : (double)stage->neighbours;
    else if (series->metric == SPHV_METRIC_H)
        value = theory ? NAN : stage->h;
    else if (series->metric == SPHV_METRIC_FAILED)
        value =
            theory || !result->scene->schemes[series->scheme].has_method ? NAN : failed_part(stage);
    else {
        const sphv_rate_point *point = &stage->points[series->target];
        int part = series->interior;
        if (theory && series->metric == SPHV_METRIC_RMSE && point->predicted[part])
            value = point->prediction[part].value;
        else if (!theory && point->there)
            value = norm_of(part ? &point->interior : &point->whole, series->metric);
    }
    return series->per_neighbour ? value / (double)stage->neighbours : value;
}

/// \param all  levels for which there must be a number, or there is no law
static sphv_power_law fit(const double *x, const double *y, size_t count)
{
    sphv_power_law law = {NAN, NAN, NAN, count};
    if (count < 2) return law;
    sphv_result slope = sphv_fit_slope(x, y, count);
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += log(fabs(y[i])) - slope.value * log(x[i]);
    law.slope = slope.value;
    law.error = slope.bound;
    law.factor = exp(sum / (double)count);
    return law;
}

sphv_power_law sphv_series_fit(const sphv_convergence_result *result, const sphv_series *series,
                               bool theory)
{
    sphv_power_law none = {NAN, NAN, NAN, 0};
    double *x = malloc((2 * series->count + 1) * sizeof *x);
    if (!x) return none;
    double *y = x + series->count;
    size_t used = 0;
    for (size_t i = 0; i < series->count; i++) {
        const sphv_stage *stage = sphv_convergence_stage(result, series->first + i, series->scheme);
        x[used] = sphv_stage_place(stage, series->axis);
        y[used] = sphv_series_value(result, series, series->first + i, theory);
        // A rate over fewer levels than asked for would be another rate.
        if (!(x[used] > 0) || !(fabs(y[used]) > 0) || !isfinite(y[used])) break;
        used++;
    }
    sphv_power_law law = used == series->count ? fit(x, y, used) : none;
    free(x);
    return law;
}

static double slope_of(const sphv_convergence_result *result, sphv_series series, bool theory)
{
    return sphv_series_fit(result, &series, theory).slope;
}

static bool near(double value, double expected, double tolerance)
{
    return isfinite(value) && fabs(value - expected) <= tolerance;
}

static void judge_cell(sphv_convergence_result *result, size_t row, size_t column)
{
    const sphv_rate_table *table = result->scene->table;
    const sphv_cell *cell = &table->cells[row * table->column_count + column];
    sphv_cell_result *found = &result->cells[row * table->column_count + column];
    double tolerance = table->groups[table->group[column]].tolerance;
    sphv_series series = {.scheme = table->columns[column],
                          .target = table->rows[row],
                          .count = result->scene->level_count};
    *found = (sphv_cell_result){.evidence = found->evidence};
    if (!cell->there) return;
    found->slope = slope_of(result, series, false);
    found->theory = slope_of(result, series, true);
    series.interior = true;
    found->interior = slope_of(result, series, false);
    found->theory_interior = slope_of(result, series, true);
    series.interior = false;
    series.axis = SPHV_AXIS_H;
    found->slope_h = slope_of(result, series, false);
    series.axis = SPHV_AXIS_PARTICLES;
    series.per_neighbour = true;
    // Where h follows Δx, n_nb does not grow: it wavers, and with it this slope.
    found->per_neighbour = result->scene->schemes[series.scheme].rule == SPHV_H_OF_PARTICLES
                               ? slope_of(result, series, false)
                               : NAN;
    found->verdict = near(found->slope, cell->printed, tolerance) ? SPHV_CELL_REPRODUCED
                     : near(found->per_neighbour, cell->printed, tolerance)
                         ? SPHV_CELL_PER_NEIGHBOUR
                         : SPHV_CELL_NOT_REPRODUCED;
    found->surprising = found->verdict != cell->expected;
    for (size_t e = 0; e < cell->evidence_count; e++) {
        found->evidence[e] = slope_of(result, cell->evidence[e].series, false);
        if (near(found->evidence[e], cell->printed, tolerance) != cell->evidence[e].matches)
            found->evidence_surprises = true;
    }
}

static void judge_group(sphv_convergence_result *result, size_t index)
{
    const sphv_rate_table *table = result->scene->table;
    sphv_group_result *group = &result->groups[index];
    double squares = 0;
    *group = (sphv_group_result){0};
    for (size_t i = 0; i < table->row_count * table->column_count; i++) {
        const sphv_cell *cell = &table->cells[i];
        const sphv_cell_result *found = &result->cells[i];
        if (!cell->there || table->group[i % table->column_count] != index) continue;
        group->cells++;
        if (found->verdict == SPHV_CELL_NOT_REPRODUCED) continue;
        double off =
            (found->verdict == SPHV_CELL_REPRODUCED ? found->slope : found->per_neighbour) -
            cell->printed;
        group->reproduced++;
        squares += off * off;
    }
    group->rms = group->reproduced ? sqrt(squares / (double)group->reproduced) : NAN;
    group->surprising = isfinite(table->groups[index].rms) &&
                        !(group->rms <= table->groups[index].rms) && group->reproduced > 0;
}

/// A unit of the last printed digit of a number such as 0.110.
static double last_digit(const char *text)
{
    const char *point = strchr(text, '.');
    return point ? pow(10, -(double)strspn(point + 1, "0123456789")) : 1;
}

static void judge_listed(sphv_convergence_result *result)
{
    const sphv_level_list *list = result->scene->listed;
    result->listed_neighbours = result->listed_h = 0;
    for (size_t i = 0; list && i < result->scene->level_count; i++) {
        const sphv_stage *stage = sphv_convergence_stage(result, i, list->scheme);
        result->listed_neighbours += strtod(list->neighbours[i], NULL) == (double)stage->neighbours;
        // Rounded or cut off: within one unit, less rounding of the numbers compared.
        result->listed_h +=
            fabs(strtod(list->h[i], NULL) - stage->h) < last_digit(list->h[i]) * (1 + 1e-9);
    }
}

static sphv_claim_result judge_claim(const sphv_convergence_result *result,
                                     const sphv_rate_claim *claim)
{
    double found[2];
    for (int theory = 0; theory < 2; theory++) {
        sphv_power_law law = sphv_series_fit(result, &claim->series, theory);
        found[theory] = claim->measure == SPHV_RATE_VALUE
                            ? sphv_series_value(result, &claim->series, claim->series.first, theory)
                        : claim->measure == SPHV_RATE_SLOPE ? law.slope
                                                            : law.factor;
    }
    sphv_claim_result judged = {found[1], found[0], SPHV_INCONCLUSIVE, false};
    if (isfinite(found[0]))
        judged.verdict =
            near(found[0], claim->expected, claim->tolerance) ? SPHV_AGREES : SPHV_DISAGREES;
    judged.surprising = judged.verdict != (claim->refuted ? SPHV_DISAGREES : SPHV_AGREES);
    return judged;
}

static void count_points(sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    memset(result->verdicts, 0, sizeof result->verdicts);
    for (size_t i = 0; i < scene->level_count * scene->scheme_count; i++)
        for (size_t t = 0; t < scene->target_count; t++)
            for (int part = 0; part < 2; part++) {
                const sphv_rate_point *point = &result->stages[i].points[t];
                if (point->predicted[part]) result->verdicts[point->verdict[part]]++;
            }
}

void sphv_convergence_judge(sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    const sphv_rate_table *table = scene->table;
    bool surprise = false;
    count_points(result);
    for (size_t i = 0; table && i < table->row_count * table->column_count; i++) {
        judge_cell(result, i / table->column_count, i % table->column_count);
        surprise |= result->cells[i].surprising || result->cells[i].evidence_surprises;
    }
    for (size_t g = 0; table && g < table->group_count; g++) {
        judge_group(result, g);
        surprise |= result->groups[g].surprising;
    }
    judge_listed(result);
    if (scene->listed)
        surprise |=
            result->listed_neighbours < scene->level_count || result->listed_h < scene->level_count;
    for (size_t i = 0; i < scene->claim_count; i++) {
        result->claims[i] = judge_claim(result, &scene->claims[i]);
        surprise |= result->claims[i].surprising;
    }
    result->verdict = surprise || result->verdicts[SPHV_DISAGREES] ? SPHV_DISAGREES
                      : result->verdicts[SPHV_INCONCLUSIVE] > result->verdicts[SPHV_AGREES]
                          ? SPHV_INCONCLUSIVE
                          : SPHV_AGREES;
}
