#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "convergence_reader.h"
#include "core/constant_text.h"

const sphv_name_row sphv_metrics[] = {
    {"rmse", "root mean square error, √(Σe²/N)"},
    {"mae", "mean absolute error, Σ|e|/N"},
    {"maximum", "largest |e|"},
    {"mean-square", "Σe²/N"},
    {"standard-deviation", "of the error about its mean"},
    {"failed", "part of the particles whose estimate carries a fault"},
    {"neighbours", "n_nb, particles nearer than κh to the middle of the box"},
    {"h", "smoothing length"},
    {NULL, NULL},
};

const sphv_name_row sphv_axes[] = {
    {"particles", "N, number of particles"},
    {"neighbours", "n_nb, particles nearer than κh to the middle of the box"},
    {"h", "smoothing length"},
    {"ratio", "h/Δx"},
    {NULL, NULL},
};

const sphv_name_row sphv_rate_measures[] = {
    {"slope", "least-squares slope of the logarithms"},
    {"factor", "factor of the fitted power law"},
    {"value", "value at one level"},
    {NULL, NULL},
};

sphv_status sphv_rates_number(const struct sphv_rates_reader *of, const char *place,
                              const char *text, double otherwise, double *out)
{
    sphv_error reason;
    sphv_number number = {otherwise, 0};
    if (text && sphv_number_parse(text, &number, &reason) != SPHV_OK)
        return SPHV_RATES_FAIL(of, place, "%s", reason.message);
    *out = number.value;
    return SPHV_OK;
}

sphv_status sphv_rates_constant(const struct sphv_rates_reader *of, const char *place,
                                const char *text, double otherwise, double *out)
{
    sphv_error reason;
    long double value = otherwise;
    if (text && sphv_constant_parse(text, &value, &reason) != SPHV_OK)
        return SPHV_RATES_FAIL(of, place, "%s", reason.message);
    if (!isfinite((double)value))
        return SPHV_RATES_FAIL(of, place, "'%s' is out of the range of a double", text);
    *out = (double)value;
    return SPHV_OK;
}

sphv_status sphv_rates_name(const struct sphv_rates_reader *of, const char *place, const char *text,
                            const sphv_name_row *rows, int otherwise, int *out)
{
    char allowed[300] = "";
    size_t used = 0;
    *out = otherwise;
    if (!text) return SPHV_OK;
    for (int i = 0; rows[i].name; i++) {
        if (strcmp(rows[i].name, text) == 0) {
            *out = i;
            return SPHV_OK;
        }
        if (used < sizeof allowed)
            used += (size_t)snprintf(allowed + used, sizeof allowed - used, "%s%s", i ? ", " : "",
                                     rows[i].name);
    }
    return SPHV_RATES_FAIL(of, place, "unknown name '%s'; allowed: %s", text, allowed);
}

sphv_status sphv_rates_find_scheme(const struct sphv_rates_reader *of, const char *place,
                                   const char *id, size_t *out)
{
    for (size_t i = 0; i < of->scene->scheme_count; i++)
        if (strcmp(of->scene->schemes[i].id, id) == 0) {
            *out = i;
            return SPHV_OK;
        }
    return SPHV_RATES_FAIL(of, place, "no scheme '%s'; allowed: the ids of this scene's schemes",
                           id);
}

sphv_status sphv_rates_find_target(const struct sphv_rates_reader *of, const char *place,
                                   const char *name, size_t *out)
{
    for (size_t i = 0; i < of->scene->target_count; i++)
        if (!of->scene->targets[i].altered && strcmp(of->scene->targets[i].name, name) == 0) {
            *out = i;
            return SPHV_OK;
        }
    return SPHV_RATES_FAIL(of, place,
                           "no quantity '%s'; allowed: a field's id, with '_' and one or two "
                           "coordinates for a derivative",
                           name);
}

sphv_status sphv_rates_levels(const struct sphv_rates_reader *of, const char *place,
                              const unsigned *first, const unsigned *last, sphv_series *series)
{
    size_t count = of->scene->level_count, from = first ? *first : 1, to = last ? *last : count;
    if (from < 1 || from > to || to > count)
        return SPHV_RATES_FAIL(of, place, "levels %zu to %zu; allowed: 1 to %zu, ascending", from,
                               to, count);
    series->first = from - 1;
    series->count = to - from + 1;
    return SPHV_OK;
}

sphv_status sphv_rates_read_measures(const struct sphv_rates_reader *of)
{
    sphv_convergence *scene = of->scene;
    scene->measures = calloc(of->file->measures_count + 1, sizeof *scene->measures);
    if (!scene->measures) return sphv_fail(of->error, SPHV_RESOURCE_FAILURE, "out of memory");
    sphv_status status = SPHV_OK;
    for (unsigned i = 0; status == SPHV_OK && i < of->file->measures_count; i++) {
        const struct sphv_rates_measure *file = &of->file->measures[i];
        char place[64];
        int measure = 0;
        snprintf(place, sizeof place, "consistency.%u", i);
        status = sphv_rates_find_target(of, place, file->quantity, &scene->measures[i].target);
        if (status == SPHV_OK)
            status =
                sphv_rates_name(of, place, file->measure, sphv_consistency_measures, 0, &measure);
        scene->measures[i].measure = (sphv_consistency_measure)measure;
        scene->measure_count = i + 1;
    }
    return status;
}

static bool needs_target(sphv_metric metric)
{
    return metric <= SPHV_METRIC_STANDARD_DEVIATION;
}

sphv_status sphv_rates_series(const struct sphv_rates_reader *of, const char *place,
                              const struct sphv_rates_series *file, bool plot, sphv_series *series)
{
    int metric = 0, axis = 0;
    *series = (sphv_series){0};
    sphv_status status =
        sphv_rates_name(of, place, file->metric, sphv_metrics, SPHV_METRIC_RMSE, &metric);
    if (status == SPHV_OK)
        status =
            sphv_rates_name(of, place, file->against, sphv_axes,
                            of->scene->over_ratio ? SPHV_AXIS_RATIO : SPHV_AXIS_PARTICLES, &axis);
    if (status != SPHV_OK) return status;
    series->metric = (sphv_metric)metric;
    series->axis = (sphv_axis)axis;
    series->per_neighbour = file->per_neighbour && *file->per_neighbour;
    series->interior = file->interior && *file->interior;
    if (!file->scheme && !plot)
        return SPHV_RATES_FAIL(of, place, "'scheme' is missing; allowed: the id of a scheme");
    if (file->scheme) status = sphv_rates_find_scheme(of, place, file->scheme, &series->scheme);
    if (status == SPHV_OK && needs_target(series->metric) != (file->quantity != NULL))
        return SPHV_RATES_FAIL(of, place, "metric '%s' %s a 'quantity'", sphv_metrics[metric].name,
                               file->quantity ? "takes no" : "needs");
    if (status == SPHV_OK && file->quantity)
        status = sphv_rates_find_target(of, place, file->quantity, &series->target);
    if (status == SPHV_OK && file->quantity && file->alone && *file->alone)
        status = sphv_rates_add_alone(of, series->target, &series->target);
    if (status == SPHV_OK) status = sphv_rates_levels(of, place, file->first, file->last, series);
    return status;
}
