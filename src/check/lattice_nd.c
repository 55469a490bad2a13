/// The gradient of a sine on a lattice in two and three dimensions: the alias sum of the Fourier
/// transform against a particle sum with the file's own constant and gradient.
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "check_internal.h"

static const double pi = 3.14159265358979323846;

/// What is compared: A = sin(Kx) along a lattice axis, x in units of h.
struct wave {
    const sphv_profile *profile;
    int dimension, modes;
    double K, spacing;
};

/// Ŵ_F decays like Ω^−p: a jump of derivative c at radius q > 0 gives p = c + (d + 1)/2, one at the
/// origin p = c + d.
static double decay(const sphv_profile *profile)
{
    double p = INFINITY;
    int d = profile->dimension;
    for (int i = 0; i < profile->knot_count; i++) {
        const sphv_knot *knot = &profile->knots[i];
        p = fmin(p, knot->position.value > 0 ? knot->order + 0.5 * (d + 1) : knot->order + d);
    }
    return p;
}

static bool jumps(const sphv_profile *profile)
{
    for (int i = 0; i < profile->knot_count; i++)
        if (profile->knots[i].order == 0) return true;
    return false;
}

/// (1 + G₁/K) Ŵ_F(|K e₁ + G|) at one mode, and what it says of the envelope A of Ŵ_F ~ A Ω^−p.
static sphv_result mode(const struct wave *of, int first, int second, int third, double p,
                        double *envelope)
{
    double unit = 2 * pi / of->spacing, along = of->K + unit * first;
    double across = unit * hypot(second, third), wavenumber = hypot(along, across);
    sphv_result transform = sphv_fourier_transform(of->profile, wavenumber);
    int reach = abs(first) > second ? abs(first) : second;
    if (2 * reach >= of->modes)
        *envelope = fmax(*envelope, fabs(transform.value) * pow(wavenumber, p));
    double factor = along / of->K;
    return (sphv_result){factor * transform.value,
                         fabs(factor) *
                             (transform.bound + 4 * DBL_EPSILON * fabs(transform.value))};
}

/// 1 + E = Σ_m (1 + G₁/K) Ŵ_F(|K e₁ + G_m|), modes up to `modes` in each direction, and the rest
/// bounded by the envelope of those evaluated: pairs ±m leave at most A Ω^−p (1 + κΩ) a mode.
static sphv_result predict(const struct wave *of)
{
    int d = of->dimension, M = of->modes;
    double p = decay(of->profile), envelope = 0, sum = 0, bound = 0;
    // A kernel whose value jumps has a gradient that is not the transform's: its shell is missing.
    if (!(p - 1 > d) || jumps(of->profile)) return (sphv_result){NAN, INFINITY};
    for (int first = -M; first <= M; first++)
        for (int second = 0; second <= M; second++)
            for (int third = 0; third <= (d == 3 ? second : 0); third++) {
                // Modes that differ by signs, and by order, of the other components.
                double copies = second == 0                     ? 1
                                : d == 2                        ? 2
                                : third == 0 || third == second ? 4
                                                                : 8;
                sphv_result part = mode(of, first, second, third, p, &envelope);
                sum += copies * part.value;
                bound += copies * part.bound;
            }
    double unit = 2 * pi / of->spacing, area = d == 2 ? 2 * pi : 4 * pi;
    double tail = area * pow(unit, -p) * pow(M, d - p) / (p - d) +
                  area * of->profile->support * pow(unit, 1 - p) * pow(M, d + 1 - p) / (p - 1 - d);
    // The envelope is that of the outer half of the modes: asymptotic, hence the factor.
    return (sphv_result){sum - 1, bound + 1.5 * envelope * tail};
}

/// −Δs^d Σ_j (x_j/q_j) W′(q_j) sin(K x_j)/K − 1 over the lattice.
static sphv_result measure(const struct wave *of, const sphv_profile *gradient, double ratio)
{
    const sphv_profile *slope_of = gradient ? gradient : of->profile;
    int order = gradient ? 0 : 1, reach = (int)(of->profile->support / of->spacing) + 1;
    int deep = of->dimension == 3 ? reach : 0;
    double cell = pow(of->spacing, of->dimension), sum = 0, bound = 0, size = 0;
    for (int i = 1; i <= reach; i++) {
        double x = i * of->spacing, field = 2 * cell * sin(of->K * x) / of->K;
        for (int j = 0; j <= reach; j++)
            for (int k = 0; k <= deep; k++) {
                double q = of->spacing * sqrt((double)(i * i + j * j + k * k));
                if (q >= of->profile->support) break;
                double copies = (j ? 2 : 1) * (k ? 2 : 1);
                sphv_result slope = sphv_profile_derivative(slope_of, order, q);
                double bend = sphv_profile_derivative(slope_of, order + 1, q).value;
                double weight = copies * field * x / q;
                sum -= weight * slope.value;
                size += fabs(weight * slope.value);
                bound += fabs(weight) * (slope.bound + 2 * DBL_EPSILON * q * fabs(bend));
            }
    }
    // Plain summation: n u Σ|terms| at most, and a few u for each term.
    double count = pow(reach, of->dimension);
    bound += (count + 16) * DBL_EPSILON * size;
    return (sphv_result){ratio * sum - 1, fabs(ratio) * bound + DBL_EPSILON};
}

sphv_status sphv_check_truncation_nd(sphv_examination *of, int d, sphv_error *error)
{
    const sphv_profile *profile = sphv_kernel_profile(of->kernel, d);
    sphv_check_result *result = sphv_check_add(of, "truncation-error", d, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    // Arbitrary spacings, so that no knot stands on the lattice; fine enough for the tail.
    struct wave wave = {profile, d, d == 2 ? 10 : 5, 0, 0};
    double h = 0.2 * fmin(1, 2 / profile->support);
    wave.K = 2 * pi * h;
    const sphv_profile *gradient =
        of->kernel->fourth_order ? NULL : sphv_kernel_gradient(of->kernel, d);
    sphv_result theory = {NAN, INFINITY}, measured = {NAN, INFINITY};
    bool telling = false;
    double cells = d == 2 ? 30.37 : 18.37;
    for (int attempt = 0; attempt < 2 && !telling; attempt++, cells *= 2) {
        wave.spacing = profile->support / cells;
        theory = predict(&wave);
        measured = measure(&wave, gradient, of->claimed_ratio[d - 1]);
        measured.bound += 1.01 * of->tolerance[d - 1] * (1 + fabs(measured.value));
        telling = theory.bound + measured.bound <= 0.01 * fabs(theory.value);
        if (!isfinite(theory.bound)) break;
    }
    sphv_check_claim(result,
                     "error E of the gradient along an axis of a lattice, Δx/h = %.6g, h/λ = %.3g; "
                     "the theory sums %d aliases each way and bounds the rest asymptotically",
                     wave.spacing, h, wave.modes);
    bool apart = fabs(theory.value - measured.value) > theory.bound + measured.bound;
    if (!telling && !apart) {
        result->empirical = measured.value;
        result->informative = true;
        sphv_check_cause(result,
                         "measured only: the aliases of so rough a kernel cannot be bounded "
                         "within 1 %%");
        return SPHV_OK;
    }
    sphv_check_numbers(result, theory.value, measured.value, theory.bound + measured.bound);
    if (apart)
        sphv_check_cause(result,
                         "the estimate is %.10g times what theory says; see normalisation "
                         "and derivative",
                         (1 + measured.value) / (1 + theory.value));
    return SPHV_OK;
}
