/// Normalisation constants, and why a wrong one is wrong; legality of dimensions.
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/constant_text.h"
#include "radial.h"

sphv_status sphv_check_dimension_legality(sphv_examination *of, int dimension, sphv_error *error)
{
    const sphv_kernel *kernel = of->kernel;
    const sphv_profile *profile = sphv_kernel_profile(kernel, dimension);
    sphv_check_result *result = sphv_check_add(of, "dimension", dimension, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    if (!kernel->declared[dimension - 1]) {
        sphv_check_claim(result, "C_%d = %s", dimension, kernel->claims.constant[dimension - 1]);
        sphv_check_cause(result, "not checked: the file does not declare dimension %d", dimension);
        result->informative = true;
        return SPHV_OK;
    }
    sphv_check_claim(result, "the kernel can be normalised in %dD (1 yes, 0 no)", dimension);
    result->claimed = 1;
    double positive = 0;
    if (profile) positive = sphv_radial_integral(profile, false, sphv_weight_one, 0).value > 0;
    sphv_check_numbers(result, profile != NULL, positive, 0);
    if (!profile) {
        sphv_check_fail(result);
        sphv_check_cause(result, "%s", sphv_kernel_refusal(kernel, dimension));
        sphv_check_name_shape_cause(of, result);
    }
    return SPHV_OK;
}

/// Are two numbers the same beyond what 1e-13 tells apart?
static bool same(double a, double b)
{
    return fabs(a - b) <= 1e-13 * fabs(b);
}

/// A constant that was right before it was rounded.
static bool name_rounding(sphv_check_result *result, double claimed, double found)
{
    if (fabs(claimed / found - 1) > 0.05) return false;
    if (claimed == (double)(float)found) {
        sphv_check_cause(result, "the constant is rounded to single precision");
        return true;
    }
    for (int digits = 1; digits <= 15; digits++) {
        char text[64];
        snprintf(text, sizeof text, "%.*e", digits - 1, found);
        if (same(claimed, strtod(text, NULL))) {
            sphv_check_cause(result,
                             "the constant is rounded to %d digit%s; write %.17g or an "
                             "exact expression",
                             digits, digits > 1 ? "s" : "", found);
            return true;
        }
        // Cut off instead of rounded: one unit of the last digit below, towards zero.
        double unit = pow(10, floor(log10(fabs(found))) - (digits - 1));
        if (digits > 2 && fabs(claimed - trunc(found / unit) * unit) <= 1e-13 * fabs(found)) {
            sphv_check_cause(result,
                             "the constant is cut off after %d digits; write %.17g or an "
                             "exact expression",
                             digits, found);
            return true;
        }
    }
    return false;
}

/// C_d of a kernel's pieces without a transform, whether or not the file declares dimension d; NaN
/// when the integral vanishes.
static double plain_constant(const sphv_kernel *kernel, int d)
{
    mpq_t moment;
    mpq_init(moment);
    sphv_exact_pieces_moment(moment, &kernel->pieces, 0, d - 1);
    double integral = sphv_rational_round(moment) * sphv_sphere_factor(d) * sphv_sphere_pi(d);
    mpq_clear(moment);
    return integral != 0 ? 1 / integral : NAN;
}

static bool name_other_dimension(const sphv_examination *of, sphv_check_result *result, int d,
                                 double claimed)
{
    for (int other = 1; other <= SPHV_DIMENSIONS; other++) {
        const sphv_profile *profile = sphv_kernel_profile(of->kernel, other);
        double constant = profile                  ? profile->constant.value
                          : of->kernel->polynomial ? plain_constant(of->kernel, other)
                                                   : NAN;
        if (other == d || !same(claimed, constant)) continue;
        sphv_check_cause(result, "this is the %dD constant", other);
        return true;
    }
    return false;
}

/// A power of a length, or a factor of the sphere's surface, in the claimed constant.
static bool name_factor(const sphv_examination *of, sphv_check_result *result, int d, double ratio)
{
    double kappa = sphv_kernel_profile(of->kernel, d)->support;
    static const double pi = 3.14159265358979323846;
    if (kappa != 1 && same(ratio, pow(kappa, d))) {
        sphv_check_cause(result,
                         "the constant is %.10g^%d too large: the file's h is the support "
                         "radius%s",
                         kappa, d,
                         d == 1 && kappa == 2 ? ", or W was integrated over one half of the line"
                                              : "");
        return true;
    }
    if (kappa != 1 && same(ratio, pow(kappa, -d))) {
        sphv_check_cause(result,
                         "the constant is %.10g^%d too small: h and the support radius are "
                         "confused",
                         kappa, d);
        return true;
    }
    if (same(ratio, pow(2, d)) || same(ratio, pow(2, -d))) {
        sphv_check_cause(result, "the constant is 2^%d too %s: h is taken for %s", d,
                         ratio > 1 ? "large" : "small", ratio > 1 ? "2h" : "h/2");
        return true;
    }
    static const struct {
        double factor;
        const char *meaning;
    } factors[] = {
        {pi, "pi is missing: the constant is pi times too large"},
        {1 / pi, "one pi too many: the constant is pi times too small"},
        {2 * pi, "2 pi is missing"},
        {1 / (2 * pi), "2 pi too many"},
        {4 * pi, "4 pi, the surface of the unit sphere, is missing"},
        {1 / (4 * pi), "4 pi too many"},
        {-1, "the constant's sign is flipped"},
        {2, "twice too large: as if W were integrated over one half only"},
        {0.5, "half of the right one"},
        {4, "four times too large"},
        {0.25, "a quarter of the right one"},
        {4.0 / 3, "4/3 too large: volume and surface of the sphere are confused"},
    };
    for (size_t i = 0; i < sizeof factors / sizeof *factors; i++)
        if (same(ratio, factors[i].factor)) {
            sphv_check_cause(result, "%s", factors[i].meaning);
            return true;
        }
    return false;
}

/// Other kernels that the claimed constant would be right for.
static bool name_other_kernel(const sphv_examination *of, sphv_check_result *result, int d,
                              double claimed)
{
    const sphv_profile *profile = sphv_kernel_profile(of->kernel, d);
    if (profile->excess != 0 && same(claimed, profile->constant.value / (1 + profile->excess))) {
        sphv_check_cause(result,
                         "the constant is renormalised over the truncated support; a "
                         "truncated family keeps the constant of the whole here, %.17g",
                         profile->constant.value);
        return true;
    }
    if (of->kernel->polynomial && of->kernel->fourth_order) {
        double before = plain_constant(of->kernel, d);
        if (same(claimed, before)) {
            sphv_check_cause(result, "this is the constant before the fourth-order transform");
            return true;
        }
    }
    return false;
}

static bool name_catalogue_constant(const sphv_examination *of, sphv_check_result *result, int d,
                                    double claimed)
{
    const sphv_catalogue *reference = of->options->reference;
    for (size_t i = 0; reference && i < reference->count; i++) {
        const char *name = sphv_kernel_name(reference->kernels[i]);
        const sphv_profile *other = sphv_kernel_profile(reference->kernels[i], d);
        if (!other || strcmp(name, sphv_kernel_name(of->kernel)) == 0) continue;
        if (!same(claimed, other->constant.value)) continue;
        sphv_check_cause(result, "this is the %dD constant of %s", d, name);
        return true;
    }
    return false;
}

/// The same factor in every dimension: not the constants are wrong, but w is scaled.
static bool name_scaled_shape(const sphv_examination *of, sphv_check_result *result)
{
    int claims = 0;
    double first = 0;
    for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
        if (!of->kernel->claims.constant[d - 1] || !sphv_kernel_profile(of->kernel, d)) continue;
        double ratio = of->claimed_ratio[d - 1];
        if (claims++ == 0) first = ratio;
        if (!same(ratio, first)) return false;
    }
    if (claims < 2) return false;
    sphv_check_cause(result,
                     "every constant is %.10g times too large: w and the constants belong "
                     "to different scalings (w is multiplied by %.10g)",
                     first, 1 / first);
    return true;
}

static void name_cause(sphv_examination *of, sphv_check_result *result, int d, double claimed)
{
    double found = sphv_kernel_profile(of->kernel, d)->constant.value;
    bool named = name_rounding(result, claimed, found) ||
                 name_other_dimension(of, result, d, claimed) || name_scaled_shape(of, result) ||
                 name_factor(of, result, d, claimed / found) ||
                 name_other_kernel(of, result, d, claimed);
    if (!named) {
        size_t before = strlen(result->cause);
        sphv_check_name_shape_cause(of, result);
        named = strlen(result->cause) > before || name_catalogue_constant(of, result, d, claimed);
    }
    if (!named)
        sphv_check_cause(result, "the claimed constant is %.10g times the right one",
                         claimed / found);
}

/// ∫W dV with the constant that the file claims.
static sphv_status check_integral(sphv_examination *of, int d, sphv_result whole, sphv_result part,
                                  sphv_error *error)
{
    sphv_check_result *result = sphv_check_add(of, "unit-integral", d, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    const sphv_profile *profile = sphv_kernel_profile(of->kernel, d);
    double ratio = of->claimed_ratio[d - 1];
    result->claimed = 1 + profile->excess;
    sphv_check_numbers(result, 1 + profile->excess, ratio * part.value,
                       fabs(ratio) * part.bound + of->tolerance[d - 1]);
    if (sphv_check_truncated(of)) {
        sphv_check_claim(result, "∫W dV over the support is 1 less the tail cut off at q = %.10g",
                         profile->support);
        sphv_check_cause(result, "the tail beyond κ holds %.6e of the whole",
                         whole.value - part.value);
    } else {
        sphv_check_claim(result, "∫W dV = 1%s",
                         of->kernel->claims.constant[d - 1] ? " with the claimed constant" : "");
    }
    if (result->verdict == SPHV_DISAGREES) sphv_check_cause(result, "see normalisation");
    return SPHV_OK;
}

sphv_status sphv_check_normalisation(sphv_examination *of, int d, sphv_error *error)
{
    sphv_check_result *result = sphv_check_add(of, "normalisation", d, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    const sphv_profile *profile = sphv_kernel_profile(of->kernel, d);
    const char *text = of->kernel->claims.constant[d - 1];
    bool truncated = sphv_check_truncated(of);
    double found = profile->constant.value;
    sphv_result part = sphv_radial_integral(profile, false, sphv_weight_one, 0);
    sphv_result whole = truncated ? sphv_radial_integral(profile, true, sphv_weight_one, 0) : part;
    sphv_check_numbers(result, found, found / whole.value,
                       profile->constant.bound + fabs(found) * whole.bound * 1.001);
    if (text) {
        sphv_error unused;
        long double claimed = 0;
        if (sphv_constant_parse(text, &claimed, &unused) != SPHV_OK) claimed = 0;
        result->claimed = (double)claimed;
        sphv_check_claim(result, "C_%d = %s", d, text);
        long double excess = fabsl(claimed / (long double)found - 1);
        if (!(excess <= (long double)of->tolerance[d - 1])) {
            sphv_check_fail(result);
            name_cause(of, result, d, result->claimed);
        }
    } else {
        char exact[120];
        sphv_kernel_constant_text(of->kernel, d, exact, sizeof exact);
        sphv_check_claim(result, "C_%d is not claimed; found %s", d, *exact ? exact : "as given");
        result->informative = true;
    }
    return check_integral(of, d, whole, part, error);
}
