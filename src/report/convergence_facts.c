#include "convergence_facts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *sphv_h_rule_text(char text[SPHV_RULE_TEXT], const sphv_scheme *scheme)
{
    const char *factor = *scheme->factor_text ? scheme->factor_text : "1";
    bool one = strcmp(factor, "1") == 0;
    if (scheme->rule == SPHV_H_OF_PARTICLES)
        snprintf(text, SPHV_RULE_TEXT, "h = %.100s%sN^(%.6g)", one ? "" : factor, one ? "" : " ",
                 scheme->exponent);
    else
        snprintf(text, SPHV_RULE_TEXT, "h = %.100s%s%sΔx", one ? "" : factor, one ? "" : " ",
                 scheme->rule == SPHV_H_OF_RATIO ? "(h/Δx) " : "");
    return text;
}

const char *sphv_box_text(char text[SPHV_RULE_TEXT], const sphv_box *box)
{
    int used = snprintf(text, SPHV_RULE_TEXT, "%s", sphv_layouts[box->layout].name);
    if (box->layout == SPHV_LATTICE || box->layout == SPHV_PERTURBED)
        used += snprintf(text + used, SPHV_RULE_TEXT - (size_t)used, " (%s)",
                         sphv_placements[box->placement].name);
    if (box->layout == SPHV_PERTURBED)
        used += snprintf(text + used, SPHV_RULE_TEXT - (size_t)used, ", %s %g Δx%s",
                         box->jitter == SPHV_JITTER_UNIFORM ? "uniform ±" : "normal, σ =",
                         box->amplitude, box->reflected ? ", reflected" : "");
    used += snprintf(text + used, SPHV_RULE_TEXT - (size_t)used, ", volumes %s",
                     sphv_volumes[box->volume].name);
    if (box->layout != SPHV_LATTICE)
        snprintf(text + used, SPHV_RULE_TEXT - (size_t)used, ", seed %llu",
                 (unsigned long long)box->seed);
    return text;
}

/// `rmse/n_nb of f1_x, interior only`
static int write_metric(char *text, size_t size, const sphv_convergence *scene,
                        const sphv_series *series)
{
    bool of_target = series->metric <= SPHV_METRIC_STANDARD_DEVIATION;
    return snprintf(text, size, "%s%s%s%.70s%s", sphv_metrics[series->metric].name,
                    series->per_neighbour ? "/n_nb" : "", of_target ? " of " : "",
                    of_target ? scene->targets[series->target].name : "",
                    series->interior ? ", interior only" : "");
}

const char *sphv_claim_series_text(char text[SPHV_SERIES_TEXT], const sphv_convergence *scene,
                                   const sphv_rate_claim *claim)
{
    const sphv_series *series = &claim->series;
    int used = snprintf(text, SPHV_SERIES_TEXT, "%s of ", sphv_rate_measures[claim->measure].name);
    used += write_metric(text + used, SPHV_SERIES_TEXT - (size_t)used, scene, series);
    used += snprintf(text + used, SPHV_SERIES_TEXT - (size_t)used, " by %.60s",
                     scene->schemes[series->scheme].label);
    if (claim->measure == SPHV_RATE_VALUE)
        snprintf(text + used, SPHV_SERIES_TEXT - (size_t)used, ", level %zu", series->first + 1);
    else
        snprintf(text + used, SPHV_SERIES_TEXT - (size_t)used, " against %s, levels %zu to %zu",
                 sphv_axes[series->axis].name, series->first + 1, series->first + series->count);
    return text;
}

const char *sphv_rate_text(char text[SPHV_RATE_TEXT], double rate)
{
    if (!isfinite(rate)) {
        strcpy(text, "–");
        return text;
    }
    char digits[SPHV_RATE_TEXT - 4];
    snprintf(digits, sizeof digits, "%.2f", fmin(fabs(rate), 1e9));
    bool zero = strcmp(digits, "0.00") == 0;
    snprintf(text, SPHV_RATE_TEXT, "%s%s", zero ? "" : rate < 0 ? "−" : "+", digits);
    return text;
}

const char *sphv_cell_verdict_short(sphv_cell_verdict verdict)
{
    static const char *const words[] = {"reproduced", "as RMSE/n", "not"};
    return words[verdict];
}

const char *sphv_cell_verdict_class(sphv_cell_verdict verdict)
{
    static const char *const classes[] = {"agrees", "inconclusive", "disagrees"};
    return classes[verdict];
}

void sphv_cell_counts(const sphv_convergence_result *result, size_t counts[SPHV_CELL_VERDICTS])
{
    const sphv_rate_table *table = result->scene->table;
    memset(counts, 0, SPHV_CELL_VERDICTS * sizeof *counts);
    for (size_t i = 0; table && i < table->row_count * table->column_count; i++)
        if (table->cells[i].there) counts[result->cells[i].verdict]++;
}

double sphv_scheme_largest_difference(const sphv_convergence_result *result, size_t scheme)
{
    double largest = NAN;
    for (size_t l = 0; l < result->scene->level_count; l++)
        for (size_t t = 0; t < result->scene->target_count; t++) {
            const sphv_rate_point *point = sphv_convergence_point(result, l, scheme, t);
            if (!point->predicted[0]) continue;
            double off = fabs(point->prediction[0].value / point->whole.rmse - 1);
            if (isfinite(off) && !(off <= largest)) largest = off;
        }
    return largest;
}

void sphv_scheme_verdicts(const sphv_convergence_result *result, size_t scheme, size_t counts[3])
{
    memset(counts, 0, 3 * sizeof *counts);
    for (size_t l = 0; l < result->scene->level_count; l++)
        for (size_t t = 0; t < result->scene->target_count; t++) {
            const sphv_rate_point *point = sphv_convergence_point(result, l, scheme, t);
            for (int part = 0; part < 2; part++)
                if (point->predicted[part]) counts[point->verdict[part]]++;
        }
}

const char *sphv_plot_axis_text(char text[SPHV_SERIES_TEXT], const sphv_convergence *scene,
                                const sphv_rate_plot *plot)
{
    static const char *const names[] = {"RMSE",
                                        "mean absolute error",
                                        "largest error",
                                        "mean square error",
                                        "standard deviation of the error",
                                        "part of the estimates without result",
                                        "n, neighbours",
                                        "h, smoothing length"};
    const sphv_series *series = &plot->series;
    bool of_target = series->metric <= SPHV_METRIC_STANDARD_DEVIATION;
    bool alone = of_target && scene->targets[series->target].alone;
    snprintf(text, SPHV_SERIES_TEXT, "%s%s%s%.70s%s",
             alone && series->metric == SPHV_METRIC_STANDARD_DEVIATION ? "standard deviation"
                                                                       : names[series->metric],
             series->per_neighbour ? "/n" : "", of_target ? " of " : "",
             of_target ? scene->targets[series->target].name : "",
             series->interior ? ", interior" : "");
    return text;
}
