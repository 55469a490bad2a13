/// The Fourier transform's first negative wavenumber: particles pair when they are packed beyond
/// it.
#include <float.h>
#include <math.h>

#include "radial.h"

/// The same zero by bisection with another quadrature; NaN when it has no sign change there.
static double bisect(const sphv_profile *profile, double at, double width)
{
    sphv_radial_weight wave = sphv_weight_wave(profile->dimension);
    double low = at - width, high = at + width;
    if (!(sphv_radial_integral(profile, false, wave, low).value > 0) ||
        !(sphv_radial_integral(profile, false, wave, high).value < 0))
        return NAN;
    for (int i = 0; i < 30 && high - low > 1e-9 * at; i++) {
        double middle = 0.5 * (low + high);
        if (sphv_radial_integral(profile, false, wave, middle).value > 0)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

/// The distance from a zero at which the transform is telling: beyond the bounds of both routes.
static double reach(const sphv_profile *profile, double at)
{
    sphv_radial_weight wave = sphv_weight_wave(profile->dimension);
    double width = 1e-10 * at;
    for (; width < 0.1 * at; width *= 2) {
        sphv_result low = sphv_radial_integral(profile, false, wave, at - width);
        sphv_result high = sphv_radial_integral(profile, false, wave, at + width);
        double noise = sphv_fourier_transform(profile, at).bound;
        if (low.value > low.bound + noise && -high.value > high.bound + noise) break;
    }
    return width;
}

sphv_status sphv_check_fourier(sphv_examination *of, int d, sphv_error *error)
{
    sphv_check_result *result = sphv_check_add(of, "fourier", d, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    const sphv_profile *profile = sphv_kernel_profile(of->kernel, d);
    sphv_fourier_sign sign = sphv_fourier_find_sign(profile);
    result->informative = true;
    if (sign.negative) {
        sphv_check_claim(result, "first wavenumber (units 1/h) at which the Fourier transform is "
                                 "negative: pairing");
        // Where the transform crosses zero flatly, rounding moves the crossing far.
        double width = reach(profile, sign.first_negative);
        double bound = 2 * width + 2e-9 * sign.first_negative;
        double measured =
            bisect(profile, sign.first_negative, fmax(width, 1e-3 / profile->support));
        if (isfinite(measured)) {
            sphv_check_numbers(result, sign.first_negative, measured, bound);
        } else {
            result->analytic = sign.first_negative;
            sphv_check_cause(result, "too weak a crossing to be measured again");
        }
        sphv_check_cause(result, "minimum %.3e of the value at 0, at %.6g/h", sign.minimum,
                         sign.minimum_at);
        return SPHV_OK;
    }
    // Where the least value is: at the end of the search when it falls all the way.
    double at = sign.minimum < 0 ? sign.minimum_at : sign.searched;
    double whole = profile->moment[0].value;
    sphv_result theory = sphv_fourier_transform(profile, at);
    sphv_result measured = sphv_radial_integral(profile, false, sphv_weight_wave(d), at);
    sphv_check_claim(result,
                     "not negative beyond rounding up to wavenumber %.4g/h; the Fourier transform "
                     "over that at 0, at %.4g/h",
                     sign.searched, at);
    // The wave's argument is rounded: a phase error of Ωκ u in either route.
    sphv_check_numbers(result, theory.value / whole, measured.value / whole,
                       (theory.bound + measured.bound) / whole +
                           2 * DBL_EPSILON * (8 + at * profile->support));
    return SPHV_OK;
}
