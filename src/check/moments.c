/// Moments, and the order in h of the smoothing error that follows from them.
#include <float.h>
#include <math.h>

#include "radial.h"

enum { MOMENTS_SHOWN = 4, ORDERS = 8 };

sphv_status sphv_check_moments(sphv_examination *of, int d, sphv_error *error)
{
    const sphv_profile *profile = sphv_kernel_profile(of->kernel, d);
    for (int j = 2; j <= MOMENTS_SHOWN; j += 2) {
        sphv_check_result *result = sphv_check_add(of, "moments", d, error);
        if (!result) return SPHV_RESOURCE_FAILURE;
        sphv_result measured = sphv_radial_integral(profile, false, sphv_weight_power, j);
        char exact[100];
        sphv_kernel_moment_text(of->kernel, d, j, exact, sizeof exact);
        sphv_check_claim(result, "μ_%d = ∫|s|^%d Ŵ dV%s%s", j, j, *exact ? " = " : "", exact);
        sphv_check_numbers(result, profile->moment[j].value, measured.value,
                           profile->moment[j].bound + measured.bound);
        result->informative = true;
    }
    return SPHV_OK;
}

/// Even moments 0, 2, 4 … of the kernel, of the whole one when it is cut off from an infinite one.
static void even_moments(const sphv_examination *of, const sphv_profile *profile,
                         sphv_result *moment)
{
    for (int j = 0; j <= ORDERS; j++)
        moment[j] = sphv_check_truncated(of)
                        ? sphv_radial_integral(profile, true, sphv_weight_power, 2 * j)
                        : profile->moment[2 * j];
}

/// The smoothing error of a wave, Σ_{j≥1} (−K²/4)^j/(j! (d/2)_j) μ_2j, from the moments.
static double smoothing_series(const sphv_result *moment, int d, double K)
{
    double coefficient = 1, sum = 0;
    for (int j = 1; j <= ORDERS; j++) {
        coefficient *= -0.25 * K * K / (j * (0.5 * d + j - 1));
        sum += coefficient * moment[j].value;
    }
    return sum;
}

/// The first even moment that does not vanish: exactly for pieces, beyond the quadrature's rounding
/// for closed forms, beyond that of their coefficients for pieces in long decimals.
static int smoothing_order(const sphv_examination *of, int d, const sphv_result *moment)
{
    const sphv_kernel *kernel = of->kernel;
    double kappa = sphv_kernel_profile(kernel, d)->support, reach = 1;
    double relative = of->tolerance[d - 1] - SPHV_CONSTANT_TOLERANCE;
    for (int j = 1; j <= ORDERS; j++) {
        reach *= kappa * kappa;
        double zero = kernel->polynomial ? relative * reach : 8 * moment[j].bound;
        if (fabs(moment[j].value) > zero) return 2 * j;
    }
    return 2 * ORDERS;
}

sphv_status sphv_check_smoothing_order(sphv_examination *of, int d, sphv_error *error)
{
    const sphv_profile *profile = sphv_kernel_profile(of->kernel, d);
    sphv_check_result *result = sphv_check_add(of, "smoothing-order", d, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    bool truncated = sphv_check_truncated(of);
    sphv_result moment[ORDERS + 1];
    even_moments(of, profile, moment);
    int order = smoothing_order(of, d, moment);
    for (int j = 1; 2 * j < order; j++) moment[j].value = 0;

    sphv_radial_weight wave = sphv_weight_wave_less_one(d);
    double K = 0.5 / profile->support, slope = NAN, bound = INFINITY;
    for (int halving = 0; halving < 8; halving++, K /= 2) {
        sphv_result far = sphv_radial_integral(profile, truncated, wave, 2 * K);
        sphv_result near = sphv_radial_integral(profile, truncated, wave, K);
        double series =
            log2(fabs(smoothing_series(moment, d, 2 * K) / smoothing_series(moment, d, K)));
        slope = log2(fabs(far.value / near.value));
        bound = fabs(series - order) * 1.01 +
                1.5 * (far.bound / fabs(far.value) + near.bound / fabs(near.value));
        if (bound < 0.05) break;
    }
    sphv_check_numbers(result, order, slope, bound);
    if (!(bound < 0.5)) result->verdict = sphv_verdict_worse(result->verdict, SPHV_INCONCLUSIVE);
    const int *claim = of->kernel->claims.smoothing_order;
    if (!claim) {
        sphv_check_claim(result, "order in h of the smoothing error%s",
                         truncated ? " of the whole kernel" : "");
        result->informative = true;
        // Nothing is claimed, so a slope that no small K settles is a remark and no failure.
        if (result->verdict == SPHV_INCONCLUSIVE) {
            sphv_check_cause(result, "μ_2 = %.6g is too small for the slope to be measured",
                             moment[1].value);
            result->verdict = SPHV_AGREES;
        }
        return SPHV_OK;
    }
    result->claimed = *claim;
    sphv_check_claim(result, "the smoothing error%s is of order h^%d",
                     truncated ? " of the whole kernel" : "", *claim);
    if (*claim != order) {
        sphv_check_fail(result);
        sphv_check_cause(result, "the file claims order %d; found %d: the moment μ_%d = %.6g %s",
                         *claim, order, order, moment[order / 2].value,
                         *claim > order ? "does not vanish" : "is the first that does not vanish");
        if (*claim == 4 && order == 2 && of->kernel->polynomial && !of->kernel->fourth_order)
            sphv_check_cause(result, "'transform: fourth-order' would make it so");
    }
    return SPHV_OK;
}
