#include <gsl/gsl_math.h>

#include "internal.h"

/// Bounds |Σ_{m>M} 2F(Ω_m)|. With r the lowest derivative of f that jumps anywhere, r + 2
/// integrations by parts leave
///   leading jumps of f^(r):  2 |J| cos(Ω_m κ_i + …)/Ω_m^(r+1), whose sum over m is at most
///                            |J|(Δs/2π(M+1))^(r+1)/|sin(πκ_i/Δs)| (Abel) or, for r ≥ 1, absolute;
///   the rest, absolutely:    [Σ|jump of f^(r+1)| + ∫|f^(r+2)|]/Ω_m^(r+2).
static double tail(const sphv_profile *profile, double K, double spacing, int modes)
{
    int r = SPHV_JET_MAX;
    for (int i = 0; i < profile->knot_count; i++) {
        int order = profile->knots[i].order;
        r = order < 2 ? 0 : order - 1 < r ? order - 1 : r;
    }
    double cut = spacing / (2 * M_PI * (modes + 1)), next_jumps = 0, bound = 0, magnitude;
    for (int i = 0; i < profile->knot_count; i++) {
        const sphv_knot *knot = &profile->knots[i];
        double pair = knot->position.value > 0 ? 2 : 1;
        double jump = fabs(sphv_gradient_jump(knot, K, r, &magnitude));
        double abel = 1 / fabs(sin(M_PI * knot->position.value / spacing));
        if (r > 0) abel = fmin(abel, 1 + (modes + 1.0) / r);
        // At a knot on the lattice Abel's factor is infinite; where nothing jumps it is not needed.
        if (jump > 0) bound += 2 * pair * jump * gsl_pow_int(cut, r + 1) * abel;
        next_jumps += pair * fabs(sphv_gradient_jump(knot, K, r + 1, &magnitude));
    }
    double rest = next_jumps + sphv_gradient_variation(profile, K, r + 2);
    return bound + 2 * rest * gsl_pow_int(cut, r + 2) * (1 + (modes + 1.0) / (r + 1));
}

sphv_result sphv_predict_poisson(const sphv_profile *profile, double h, sphv_number spacing,
                                 int modes)
{
    double K = 2 * M_PI * h;
    sphv_result sum = sphv_gradient_mode(profile, K, 0);
    sum.value -= 1;
    for (int m = 1; m <= modes; m++) {
        sphv_result mode = sphv_gradient_mode(profile, K, 2 * M_PI * m / spacing.value);
        sum.value += 2 * mode.value;
        sum.bound += 2 * mode.bound;
    }
    sum.bound += tail(profile, K, spacing.value, modes);
    return sum;
}
