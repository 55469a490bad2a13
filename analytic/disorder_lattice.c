#include <gsl/gsl_math.h>

#include "core/quadrature.h"
#include "internal.h"

/// What the integrands below need.
struct smeared {
    const sphv_profile *profile;
    double K, deviation;
};

/// f(s) times the normal density of the particle's distance from where it would coincide with its
/// neighbour of index 0, that is itself.
static double self_integrand(double s, void *context)
{
    const struct smeared *of = context;
    double x = s / of->deviation;
    return -2 * sphv_sine_over(of->K, s) * sphv_profile_derivative(of->profile, 1, s).value *
           exp(-0.5 * x * x) / (of->deviation * sqrt(2 * M_PI));
}

/// |g′|² of g = e^{iKs} Ŵ′.
static double noise_integrand(double s, void *context)
{
    const struct smeared *of = context;
    double slope = sphv_profile_derivative(of->profile, 1, s).value;
    double bend = sphv_profile_derivative(of->profile, 2, s).value;
    return 2 * (bend * bend + of->K * of->K * slope * slope);
}

/// Σ over pieces of ∫_inner^min(outer, end).
static double over_pieces(double (*f)(double, void *), struct smeared *of, double end, double panel)
{
    double sum = 0;
    for (int i = 0; i < of->profile->piece_count; i++) {
        const sphv_piece *piece = &of->profile->pieces[i];
        if (piece->inner < end)
            sum += sphv_quadrature(f, of, piece->inner, fmin(piece->outer, end), panel).value;
    }
    return sum;
}

sphv_lattice_noise sphv_predict_lattice_noise(const sphv_profile *profile, double h,
                                              sphv_number spacing, double sigma)
{
    double K = 2 * M_PI * h, step = spacing.value;
    struct smeared of = {profile, K, M_SQRT2 * sigma * step};
    sphv_lattice_noise noise = {sphv_smoothing_error(profile, h), 0, 0};
    for (int m = 1; m <= 4096; m++) {
        double smear = exp(-gsl_pow_2(2 * M_PI * m * sigma));
        if (smear < 1e-18) break;
        sphv_result alias = sphv_gradient_mode(profile, K, 2 * M_PI * m / step);
        noise.mean.value += 2 * smear * alias.value;
        noise.mean.bound += 2 * smear * alias.bound;
        // Aliases of a kernel with a jump of order c fall as m^−(c+1); f's absolute integral is 1.
        if (fabs(alias.value) < 1e-17) break;
    }
    if (sigma > 0)
        noise.mean.value -=
            step * over_pieces(self_integrand, &of, 10 * of.deviation, 0.5 * of.deviation);
    double size = over_pieces(noise_integrand, &of, profile->support, 0.5);
    noise.noise_l2 = sigma * pow(step, 1.5) * sqrt(size / 2) / K;
    noise.l2 = sqrt(0.5 * gsl_pow_2(noise.mean.value) + gsl_pow_2(noise.noise_l2));
    return noise;
}
