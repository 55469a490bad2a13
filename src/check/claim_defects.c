/// Mistakes in what the file claims, and in its closed form.
#include <gsl/gsl_sf_gamma.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/constant_text.h"
#include "defects.h"

/// Replaces claimed constant number `variant` (by dimension) by a text.
static sphv_application replace(sphv_kernel *kernel, int d, const char *text)
{
    char *copy = strdup(text);
    if (!copy) return SPHV_NOT_HERE;
    free(kernel->claims.constant[d]);
    kernel->claims.constant[d] = copy;
    return SPHV_APPLIED;
}

static bool claimed(const sphv_kernel *kernel, int d, double *value)
{
    long double read;
    sphv_error unused;
    if (!kernel->claims.constant[d] || !kernel->declared[d] ||
        sphv_constant_parse(kernel->claims.constant[d], &read, &unused) != SPHV_OK)
        return false;
    *value = (double)read;
    return true;
}

/// Prints the claimed constant after a change, with so many digits.
static sphv_application change_constant(sphv_kernel *kernel, int d, double factor, int digits)
{
    double value;
    char text[64];
    if (d >= SPHV_DIMENSIONS) return SPHV_NO_MORE;
    if (!claimed(kernel, d, &value)) return SPHV_NOT_HERE;
    snprintf(text, sizeof text, "%.*g", digits, value * factor);
    return replace(kernel, d, text);
}

static sphv_application constant_float(sphv_kernel *kernel, int d)
{
    double value;
    char text[64];
    if (d >= SPHV_DIMENSIONS) return SPHV_NO_MORE;
    if (!claimed(kernel, d, &value)) return SPHV_NOT_HERE;
    snprintf(text, sizeof text, "%.17g", (double)(float)value);
    return replace(kernel, d, text);
}

static sphv_application constant_6_digits(sphv_kernel *kernel, int d)
{
    return change_constant(kernel, d, 1, 6);
}

static sphv_application constant_3_digits(sphv_kernel *kernel, int d)
{
    return change_constant(kernel, d, 1, 3);
}

static sphv_application constant_12_digits(sphv_kernel *kernel, int d)
{
    return change_constant(kernel, d, 1, 12);
}

static double length_factor(const sphv_kernel *kernel, int d)
{
    double kappa = kernel->support.value;
    return pow(kappa == 1 ? 2 : kappa, d + 1);
}

static sphv_application constant_too_large(sphv_kernel *kernel, int d)
{
    return change_constant(kernel, d, length_factor(kernel, d), 17);
}

static sphv_application constant_too_small(sphv_kernel *kernel, int d)
{
    return change_constant(kernel, d, 1 / length_factor(kernel, d), 17);
}

static sphv_application constant_of_other_dimension(sphv_kernel *kernel, int variant)
{
    if (variant >= SPHV_DIMENSIONS * SPHV_DIMENSIONS) return SPHV_NO_MORE;
    int to = variant / SPHV_DIMENSIONS, from = variant % SPHV_DIMENSIONS;
    double unused;
    if (to == from || !claimed(kernel, to, &unused) || !claimed(kernel, from, &unused))
        return SPHV_NOT_HERE;
    return replace(kernel, to, kernel->claims.constant[from]);
}

static sphv_application constant_without_pi(sphv_kernel *kernel, int d)
{
    return change_constant(kernel, d, 3.14159265358979323846, 17);
}

static sphv_application constant_doubled(sphv_kernel *kernel, int d)
{
    return change_constant(kernel, d, 2, 17);
}

static sphv_application constant_sign(sphv_kernel *kernel, int d)
{
    return change_constant(kernel, d, -1, 17);
}

/// The constant of what is left after truncation, for families that keep that of the whole.
static sphv_application constant_renormalised(sphv_kernel *kernel, int d)
{
    double value;
    if (d >= SPHV_DIMENSIONS || kernel->polynomial || !kernel->form.family->truncated)
        return SPHV_NO_MORE;
    if (!claimed(kernel, d, &value)) return SPHV_NOT_HERE;
    // The part inside κ: P(d/2, κ²) of the Gaussian, and by parts of the super-Gaussian.
    double half = 0.5 * (d + 1), square = kernel->support.value * kernel->support.value;
    double inside = gsl_sf_gamma_inc_P(half, square);
    if (strcmp(kernel->form.family->name, "super-gaussian") == 0)
        inside = (1 + half) * inside - half * gsl_sf_gamma_inc_P(half + 1, square);
    return change_constant(kernel, d, 1 / inside, 17);
}

static sphv_application change_claim(sphv_kernel *kernel, int variant, const int *claim, int value)
{
    if (variant || !claim) return SPHV_NO_MORE;
    kernel->claimed_value[claim - kernel->claimed_value] = value;
    return SPHV_APPLIED;
}

static sphv_application claim_smoother(sphv_kernel *kernel, int variant)
{
    const int *claim = kernel->claims.boundary_smoothness;
    return change_claim(kernel, variant, claim, claim ? *claim + 1 : 0);
}

static sphv_application claim_rougher(sphv_kernel *kernel, int variant)
{
    const int *claim = kernel->claims.boundary_smoothness;
    return change_claim(kernel, variant, claim, claim ? *claim - 1 : 0);
}

static sphv_application claim_order(sphv_kernel *kernel, int variant)
{
    const int *claim = kernel->claims.smoothing_order;
    return change_claim(kernel, variant, claim, claim && *claim == 2 ? 4 : 2);
}

static sphv_application claim_monotone(sphv_kernel *kernel, int variant)
{
    const int *claim = kernel->claims.monotone;
    return change_claim(kernel, variant, claim, claim ? !*claim : 0);
}

static sphv_application claim_sign(sphv_kernel *kernel, int variant)
{
    const int *claim = kernel->claims.non_negative;
    return change_claim(kernel, variant, claim, claim ? !*claim : 0);
}

/// Declares every dimension; some kernels cannot be normalised in one of them.
static sphv_application dimension_illegal(sphv_kernel *kernel, int d)
{
    if (d >= SPHV_DIMENSIONS) return SPHV_NO_MORE;
    if (kernel->declared[d]) return SPHV_NOT_HERE;
    kernel->declared[d] = true;
    return SPHV_APPLIED;
}

static sphv_application transform_toggled(sphv_kernel *kernel, int variant)
{
    // The super-Gaussian is of fourth order already: its transform is itself, almost.
    if (variant || (!kernel->polynomial && kernel->form.family->truncated)) return SPHV_NO_MORE;
    kernel->fourth_order = !kernel->fourth_order;
    return SPHV_APPLIED;
}

static sphv_application exponent_wrong(sphv_kernel *kernel, int variant)
{
    if (variant > 1 || kernel->polynomial || !kernel->form.family->needs_exponent)
        return SPHV_NO_MORE;
    kernel->form.exponent += variant ? 1 : -1;
    return SPHV_APPLIED;
}

static sphv_application family_support(sphv_kernel *kernel, int variant)
{
    if (variant || kernel->polynomial || kernel->form.family->truncated) return SPHV_NO_MORE;
    kernel->support = sphv_number_from_double(1.5 * kernel->support.value);
    kernel->form.support = kernel->support.value;
    return SPHV_APPLIED;
}

const sphv_defect sphv_claim_defects[] = {
    {"constant-float", "constant rounded to single precision", "single precision|digit",
     constant_float},
    {"constant-3-digits", "constant rounded to three digits", "rounded to|cut off",
     constant_3_digits},
    {"constant-6-digits", "constant rounded to six digits", "rounded to|cut off",
     constant_6_digits},
    {"constant-12-digits", "constant rounded to twelve digits", "rounded to|cut off",
     constant_12_digits},
    {"constant-h-is-support", "constant for h = the support radius (2h where that is h)",
     "too large|constant", constant_too_large},
    {"constant-h-is-small", "the same the other way round", "too small|constant",
     constant_too_small},
    {"constant-dimension", "constant of another dimension", "D constant",
     constant_of_other_dimension},
    {"constant-pi", "a factor pi left out", "pi|D constant", constant_without_pi},
    {"constant-half-line", "constant twice too large", "twice|constant", constant_doubled},
    {"constant-sign", "constant with the wrong sign", "sign", constant_sign},
    {"constant-renormalised", "truncated family with the constant of the truncated kernel",
     "renormalised", constant_renormalised},
    {"claim-beta-high", "boundary smoothness claimed one too high", "claims β", claim_smoother},
    {"claim-beta-low", "boundary smoothness claimed one too low", "claims β", claim_rougher},
    {"claim-order", "smoothing order claimed 4 for 2, or 2 for 4", "claims order", claim_order},
    {"claim-monotone", "monotone claimed wrongly", "increases|says it is not", claim_monotone},
    {"claim-sign", "sign claimed wrongly", "negative|says it is not", claim_sign},
    {"dimension-illegal", "declared in a dimension in which it cannot be normalised",
     "not positive", dimension_illegal},
    {"transform-toggled", "fourth-order transform forgotten, or added",
     "transform|claims order|increases|negative|constant", transform_toggled},
    {"exponent-wrong", "another exponent of sinc", "claims β|constant", exponent_wrong},
    {"family-support", "another support of a closed form", "constant", family_support},
    {NULL, NULL, NULL, NULL},
};
