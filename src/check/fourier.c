/// The Fourier transform's first negative wavenumber: particles pair when they are packed beyond
/// it.
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
    sphv_result measured =
        sphv_radial_integral(profile, false, sphv_weight_wave(d), sign.minimum_at);
    double whole = profile->moment[0].value;
    sphv_check_claim(result,
                     "least value of the Fourier transform up to wavenumber %.4g/h, "
                     "relative to 0: not negative beyond rounding",
                     sign.searched);
    sphv_check_numbers(result, sign.minimum, measured.value / whole,
                       measured.bound / whole + 32e-16 * (8 + sign.minimum_at * profile->support));
    return SPHV_OK;
}
