#include <gsl/gsl_math.h>

#include "internal.h"

/// E_s = (slope_moment_0 − 1) + Σ_{j≥1} (−1)^j K^(2j)/(2j)! slope_moment_2j: eq. 9 summed, in the
/// moments of Ŵ′ so that it holds for kernels with Ŵ(κ) ≠ 0 too.
static sphv_result series(const sphv_profile *profile, double K)
{
    double sum = 0, bound = 4 * SPHV_U * fabs(profile->slope_excess), coefficient = 1;
    int j = 0;
    for (; 2 * (j + 1) <= SPHV_MOMENT_MAX; j++) {
        int order = 2 * (j + 1);
        coefficient *= -K * K / (order * (order - 1.0));
        sphv_result moment = profile->slope_moment[order];
        double term = coefficient * moment.value;
        sum += term;
        bound += (6 * order + 4) * SPHV_U * fabs(term) + fabs(coefficient) * moment.bound;
        if (fabs(coefficient) * gsl_pow_int(profile->support, order) < 1e-22) break;
    }
    // Taylor remainder of the sine: ∫ (Ks)^(2J+3)/(2J+3)!/K |Ŵ′| ds, |s| ≤ κ, J the last j above.
    int next = 2 * (j + 1) + 3;
    double variation = 0;
    for (int i = 0; i < profile->piece_count; i++)
        variation += 2 * (profile->pieces[i].outer - profile->pieces[i].inner) *
                     profile->pieces[i].derivative_bound[1];
    double x = K * profile->support;
    double remainder =
        exp((next - 1) * log(x) + log(profile->support) - lgamma(next + 1.0)) * variation;
    sum += profile->slope_excess;
    return (sphv_result){sum, bound + 2 * SPHV_U * fabs(sum) + remainder};
}

sphv_result sphv_smoothing_error(const sphv_profile *profile, double h)
{
    double K = 2 * M_PI * h;
    sphv_result by_series = series(profile, K);
    if (by_series.bound <= 64 * SPHV_U * fmax(fabs(by_series.value), 0.01)) return by_series;
    sphv_result whole = sphv_gradient_mode(profile, K, 0);
    sphv_result by_quadrature = {whole.value - 1, whole.bound + SPHV_U};
    return by_quadrature.bound < by_series.bound ? by_quadrature : by_series;
}
