#include <gsl/gsl_math.h>

#include "internal.h"

const char *sphv_form_name(sphv_form_of_theory form)
{
    return form == SPHV_FORM_PAPER ? "paper" : "exact";
}

const char *sphv_rigour_name(sphv_rigour rigour)
{
    static const char *const names[] = {"exact", "asymptotic", "statistical"};
    return names[rigour];
}

sphv_status sphv_predict_lattice(const sphv_profile *profile, double h, sphv_number spacing,
                                 sphv_form_of_theory form, sphv_prediction *out, sphv_error *error)
{
    if (profile->dimension != 1)
        return sphv_fail(error, SPHV_NO_CLOSED_FORM,
                         "no lattice theory in %d dimensions; allowed: 1", profile->dimension);
    if (!(h > 0 && isfinite(h) && spacing.value > 0 && isfinite(spacing.value)))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "h %g and spacing %g; allowed: positive numbers", h, spacing.value);
    if (form == SPHV_FORM_PAPER) {
        sphv_status status = sphv_predict_paper(profile, h, spacing, out, error);
        if (status != SPHV_OK) return status;
    } else {
        out->smoothing = sphv_smoothing_error(profile, h);
        out->discretisation =
            sphv_discretisation_error(profile, h, spacing, &out->terms, &out->modes);
        out->rigour = SPHV_RIGOUR_EXACT;
    }
    out->total.value = out->smoothing.value + out->discretisation.value;
    out->total.bound =
        out->smoothing.bound + out->discretisation.bound + 2 * SPHV_U * fabs(out->total.value);
    out->l2.value = fabs(out->total.value) / M_SQRT2;
    out->l2.bound = out->total.bound / M_SQRT2 + 2 * SPHV_U * out->l2.value;
    return SPHV_OK;
}
