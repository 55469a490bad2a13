#include <math.h>

#include "sphverify/compare.h"

sphv_status sphv_check_point(const sphv_profile *profile, double h, sphv_number spacing,
                             sphv_error *error)
{
    if (!(h >= SPHV_H_MIN && h <= SPHV_H_MAX))
        return sphv_fail(error, SPHV_INVALID_INPUT, "h is %g; allowed: %g to %g wavelengths", h,
                         SPHV_H_MIN, SPHV_H_MAX);
    if (spacing.value >= profile->support)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "spacing %g leaves no neighbour; allowed: %g to below the support %g",
                         spacing.value, SPHV_SPACING_MIN, profile->support);
    if (!(spacing.value >= SPHV_SPACING_MIN))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "spacing is %g; allowed: %g to below the support %g", spacing.value,
                         SPHV_SPACING_MIN, profile->support);
    return SPHV_OK;
}

sphv_status sphv_evaluate_point(const sphv_profile *profile, double h, sphv_number spacing,
                                sphv_form_of_theory form, bool exhaustive, sphv_progress progress,
                                void *context, sphv_point *out, sphv_error *error)
{
    sphv_status status = sphv_check_point(profile, h, spacing, error);
    if (status == SPHV_OK)
        status = sphv_predict_lattice(profile, h, spacing, form, &out->analytic, error);
    if (status == SPHV_OK)
        status = exhaustive ? sphv_measure_lattice_exhaustive(profile, h, spacing, progress,
                                                              context, &out->empirical, error)
                            : sphv_measure_lattice(profile, h, spacing, &out->empirical, error);
    if (status != SPHV_OK) return status;
    double scale =
        fmax(fabs(out->analytic.total.value),
             fmax(fabs(out->analytic.smoothing.value), fabs(out->analytic.discretisation.value)));
    out->difference = out->analytic.total.value - out->empirical.total.value;
    out->verdict = sphv_compare(out->analytic.total, out->empirical.total, scale);
    return SPHV_OK;
}
