#include <math.h>
#include <string.h>

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
    out->statistical = false;
    double scale =
        fmax(fabs(out->analytic.total.value),
             fmax(fabs(out->analytic.smoothing.value), fabs(out->analytic.discretisation.value)));
    out->difference = out->analytic.total.value - out->empirical.total.value;
    out->verdict = sphv_compare(out->analytic.total, out->empirical.total, scale);
    return SPHV_OK;
}

/// Prediction and Monte-Carlo mean agree where their intervals meet.
static sphv_verdict compare_statistics(const sphv_experiment *experiment, sphv_result predicted,
                                       sphv_result measured)
{
    if (!isfinite(predicted.value) || !isfinite(measured.value) || !isfinite(measured.bound))
        return SPHV_INCONCLUSIVE;
    if (fabs(predicted.value - measured.value) > predicted.bound + measured.bound)
        return SPHV_DISAGREES;
    return predicted.bound <= experiment->width * predicted.value &&
                   measured.bound <= experiment->width * measured.value
               ? SPHV_AGREES
               : SPHV_INCONCLUSIVE;
}

sphv_status sphv_evaluate_experiment(const sphv_experiment *experiment, sphv_progress progress,
                                     void *context, sphv_point *out, sphv_error *error)
{
    memset(out, 0, sizeof *out);
    sphv_status status = sphv_experiment_check(experiment, error);
    if (status != SPHV_OK) return status;
    if (experiment->method == SPHV_SPH && experiment->layout == SPHV_LATTICE &&
        experiment->volume == SPHV_VOLUME_LATTICE)
        return sphv_evaluate_point(experiment->profile, experiment->h, experiment->spacing,
                                   SPHV_FORM_EXACT, false, NULL, NULL, out, error);
    status = sphv_check_point(experiment->profile, experiment->h, experiment->spacing, error);
    if (status == SPHV_OK) status = sphv_predict_disorder(experiment, &out->analytic, error);
    if (status == SPHV_NO_CLOSED_FORM) {
        sphv_result none = {NAN, INFINITY};
        out->analytic = (sphv_prediction){none, none, none, none, SPHV_RIGOUR_STATISTICAL, 0, 0};
        status = SPHV_OK;
    }
    if (status == SPHV_OK)
        status = sphv_measure_disorder(experiment, progress, context, &out->disorder, error);
    if (status != SPHV_OK) return status;
    const sphv_disorder_measurement *measured = &out->disorder;
    out->statistical = true;
    out->analytic.total = (sphv_result){NAN, out->analytic.l2.bound};
    out->empirical = (sphv_measurement){
        {NAN, measured->l2.bound}, measured->l2,
        measured->particles,       measured->particles ? measured->pairs / measured->particles : 0,
        measured->pairs,           measured->seconds};
    out->difference = out->analytic.l2.value - measured->l2.value;
    out->verdict = compare_statistics(experiment, out->analytic.l2, measured->l2);
    return SPHV_OK;
}
