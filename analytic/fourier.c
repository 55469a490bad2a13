#include <gsl/gsl_math.h>

#include "core/quadrature.h"
#include "internal.h"

double sphv_sine_over(double K, double s)
{
    return sin(K * s) / K;
}

struct oscillation {
    const sphv_profile *profile;
    double K, wavenumber;
    sphv_radial_function radial;
};

static double gradient_integrand(double s, void *context)
{
    const struct oscillation *of = context;
    return -2 * sphv_sine_over(of->K, s) * sphv_profile_derivative(of->profile, 1, s).value *
           cos(of->wavenumber * s);
}

static double gradient_modulus(double s, void *context)
{
    const struct oscillation *of = context;
    return 2 * fabs(sphv_sine_over(of->K, s) * sphv_profile_derivative(of->profile, 1, s).value);
}

/// Integrates over every piece, with panels short enough for both kernel and oscillation.
static sphv_result over_pieces(double (*f)(double, void *), struct oscillation *of, double rate)
{
    sphv_result sum = {0, 0};
    for (int i = 0; i < of->profile->piece_count; i++) {
        const sphv_piece *piece = &of->profile->pieces[i];
        double panel = fmin(piece->degree < 0 ? 0.5 : 4, 16 / (rate + 1e-3));
        sphv_result part = sphv_quadrature(f, of, piece->inner, piece->outer, panel);
        sum.value += part.value;
        sum.bound += part.bound;
    }
    sum.bound += (8 + of->profile->support * rate) * SPHV_U * fabs(sum.value);
    return sum;
}

sphv_result sphv_gradient_mode(const sphv_profile *profile, double K, double wavenumber)
{
    struct oscillation of = {profile, K, wavenumber, NULL};
    sphv_result mode = over_pieces(gradient_integrand, &of, K + wavenumber);
    // The phase is known to (Ω + K)κ u, the kernel's slope to a few u: errors of f's size each. The
    // modulus has kinks, so its quadrature is good to some 1e-3 only; a quarter is added.
    double size = 1.25 * over_pieces(gradient_modulus, &of, K).value;
    mode.bound += (8 + (wavenumber + K) * profile->support) * SPHV_U * size;
    return mode;
}

/// The spherical average of e^{−iΩ·s} times the sphere's surface, by dimension.
static double transform_integrand(double q, void *context)
{
    const struct oscillation *of = context;
    double w = of->radial(of->profile, q), x = of->wavenumber * q;
    switch (of->profile->dimension) {
    case 1:
        return 2 * w * cos(x);
    case 2:
        return 2 * M_PI * q * w * j0(x);
    default:
        return 4 * M_PI * q * q * w * (x < 1e-4 ? 1 - x * x / 6 : sin(x) / x);
    }
}

sphv_result sphv_radial_transform(const sphv_profile *profile, sphv_radial_function radial,
                                  double wavenumber)
{
    struct oscillation of = {profile, 0, wavenumber, radial};
    sphv_result transform = over_pieces(transform_integrand, &of, wavenumber);
    transform.bound += (8 + wavenumber * profile->support) * 4 * SPHV_U;
    return transform;
}

static double kernel_value(const sphv_profile *profile, double q)
{
    return sphv_profile_derivative(profile, 0, q).value;
}

sphv_result sphv_fourier_transform(const sphv_profile *profile, double wavenumber)
{
    return sphv_radial_transform(profile, kernel_value, wavenumber);
}

sphv_fourier_sign sphv_fourier_find_sign(const sphv_profile *profile)
{
    // Ŵ_F decays like Ω^−(β+2+…); beyond 40/κ it is below rounding for every smooth kernel.
    sphv_fourier_sign sign = {.searched = 80 / profile->support};
    double whole = sphv_fourier_transform(profile, 0).value;
    double step = 0.1 / profile->support, last = 0;
    for (double at = 0; at <= sign.searched; at += step) {
        sphv_result transform = sphv_fourier_transform(profile, at);
        double relative = transform.value / whole;
        if (relative < sign.minimum) {
            sign.minimum = relative;
            sign.minimum_at = at;
        }
        if (!sign.negative && transform.value < -transform.bound) {
            double low = last, high = at;
            for (int i = 0; i < 60 && high - low > 1e-12 * high; i++) {
                double middle = 0.5 * (low + high);
                if (sphv_fourier_transform(profile, middle).value < 0)
                    high = middle;
                else
                    low = middle;
            }
            sign.negative = true;
            sign.first_negative = high;
        }
        last = at;
    }
    return sign;
}
