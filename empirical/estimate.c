#include "estimate.h"

#include <gsl/gsl_math.h>

#include "internal.h"
#include "sums/sums.h"

enum { LANES = 8, SUMS_MAX = 64 };

/// Ŵ, dŴ/ds and d²Ŵ/ds² at a neighbour.
static void kernel_at(const sphv_profile *profile, const sphv_neighbourhood *around, int b,
                      double p[3])
{
    double s = around->s[b];
    if (around->value) {
        p[0] = around->value[b];
        p[1] = around->slope[b];
        p[2] = around->bend[b];
    } else {
        sphv_result all[3];
        sphv_profile_values(profile, fabs(s), all);
        p[0] = all[0].value;
        p[1] = s < 0 ? -all[1].value : s > 0 ? all[1].value : 0;
        p[2] = all[2].value;
    }
}

/// One neighbour's share of all sums of one radial function, v p_k s^from … s^to; the field's share
/// is that of the moments of the same degree, all of which are there.
static void add(const sphv_sum_layout *layout, int k, double first, double s, int fields,
                const double *difference, double *sums)
{
    const sphv_degrees *moment = &sphv_sum_sets[layout->level].moment[k];
    const sphv_degrees *of_field = &sphv_sum_sets[layout->level].field[k];
    double *moments = sums + layout->moment_at[k] * LANES, term = first;
    double *rows = sums + (layout->moments + 3 + layout->field_at[k]) * LANES;
    for (int n = moment->from; n <= moment->to; n++, term *= s) {
        moments[(n - moment->from) * LANES] += term;
        if (n < of_field->from || n > of_field->to) continue;
        for (int f = 0; f < fields; f++)
            rows[(f * layout->per_field + n - of_field->from) * LANES] += term * difference[f];
    }
    sums[(layout->size_at + k) * LANES] += fabs(first);
}

/// W′/s, and its limit for kernels that have one.
static double slope_over_offset(const sphv_profile *profile, const double p[3], double s)
{
    if (s != 0) return p[1] / s;
    return sphv_profile_derivative(profile, 1, 0).value == 0 ? p[2] : 0;
}

static void sum_up(const sphv_sum_layout *layout, const sphv_profile *profile,
                   const sphv_neighbourhood *around, int fields, const double *const *field,
                   double *sums, double *spread)
{
    // the levels with second derivatives begin the sums of p_1 at degree 0
    bool second = layout->moment_at[2] >= 0;
    for (int b = 0; b < around->count; b++) {
        double p[3], difference[SPHV_FIELDS_TOGETHER] = {0}, s = around->s[b];
        double v = around->volume[b];
        kernel_at(profile, around, b, p);
        for (int f = 0; f < fields; f++) {
            difference[f] = field[f][b] - field[f][around->self];
            spread[f] = fmax(spread[f], fabs(difference[f]));
        }
        add(layout, 0, v * p[0], s, fields, difference, sums);
        add(layout, 1, v * (second ? slope_over_offset(profile, p, s) : p[1]), s, fields,
            difference, sums);
        if (second && s != 0) add(layout, 2, v * (p[2] - p[1] / s), s, fields, difference, sums);
    }
}

sphv_estimate sphv_estimate_gradient(sphv_method method, const sphv_profile *profile,
                                     const sphv_neighbourhood *around, int fields,
                                     const double *const *field)
{
    double sums[SUMS_MAX * LANES] = {0}, spread[SPHV_FIELDS_TOGETHER] = {0}, rounding[LANES];
    double values[SPHV_FIELDS_TOGETHER * LANES] = {0}, found[SPHV_FIELDS_TOGETHER * 3] = {0};
    double *arrays[SPHV_FIELDS_TOGETHER * 3], bounds[SPHV_FIELDS_TOGETHER * 3] = {0};
    unsigned neighbours = (unsigned)around->count;
    unsigned char fault = SPHV_FAULT_NONE;
    size_t particle = 0, quantities = sphv_method_quantities(method, 1);
    sphv_sum_layout layout = sphv_sum_layout_make(1, sphv_method_level(method), fields);
    sphv_estimate out = {.condition = 1};
    sum_up(&layout, profile, around, fields, field, sums, spread);
    // a summand has eight roundings at most, its kernel's among them; then one each addition
    for (int l = 0; l < LANES; l++) rounding[l] = (around->count + 8) * SPHV_U;
    for (int f = 0; f < fields; f++) {
        values[f * LANES] = field[f][around->self];
        for (size_t q = 0; q < quantities; q++)
            arrays[(size_t)f * quantities + q] = &found[(size_t)f * quantities + q];
    }
    sphv_sum_block block = {.layout = &layout,
                            .count = 1,
                            .stride = LANES,
                            .sums = sums,
                            .particle = &particle,
                            .neighbours = &neighbours,
                            .rounding = rounding,
                            .spread = spread};
    sphv_request request = {.profile = profile,
                            .h = 1,
                            .method_count = 1,
                            .methods = &method,
                            .field_count = (size_t)fields};
    sphv_method_estimates estimates = {.method = method,
                                       .quantities = quantities,
                                       .estimate = arrays,
                                       .condition = &out.condition,
                                       .fault = &fault,
                                       .rounding = bounds};
    sphv_solve_block(&block, &request, values, &estimates);
    out.fault = (sphv_fault)fault;
    out.usable = fault == SPHV_FAULT_NONE ||
                 (fault == SPHV_FAULT_ISOLATED && sphv_method_least(method, 1) == 1);
    for (int f = 0; f < fields; f++) out.gradient[f] = found[(size_t)f * quantities + 1];
    return out;
}

sphv_estimate sphv_phase_errors(const sphv_experiment *experiment, const sphv_neighbourhood *around,
                                double *field, double error[2])
{
    double K = 2 * M_PI * experiment->h, *cosine = field + around->count;
    const double *const fields[2] = {field, cosine};
    for (int b = 0; b < around->count; b++) {
        field[b] = sin(K * around->s[b]);
        cosine[b] = cos(K * around->s[b]);
    }
    sphv_estimate estimate =
        sphv_estimate_gradient(experiment->method, experiment->profile, around, 2, fields);
    error[SPHV_PHASE_SINE] = estimate.gradient[SPHV_PHASE_SINE] / K - 1;
    error[SPHV_PHASE_COSINE] = estimate.gradient[SPHV_PHASE_COSINE] / K;
    return estimate;
}
