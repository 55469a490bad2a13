/// A user's compiled kernel against its kernel file.
#include "implementation_check.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static sphv_status report_run(sphv_examination *of, const sphv_implementation_data *data,
                              sphv_error *error)
{
    const sphv_implementation_run *run = &data->run;
    sphv_check_result *result = sphv_check_add(of, "implementation", 0, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    sphv_check_claim(result, "the library answers every call, alike when asked again");
    sphv_check_numbers(result, (double)data->count, (double)run->answered, 0);
    if (run->outcome != SPHV_OUTCOME_ANSWERED) {
        sphv_check_fail(result);
        sphv_check_cause(result, "%s: %s", sphv_outcome_name(run->outcome), run->message);
        return SPHV_OK;
    }
    if (!run->repeatable) {
        const sphv_kernel_call *call = &data->probes[run->differing].call;
        sphv_check_fail(result);
        sphv_check_cause(result,
                         "another answer when called again, at r = %.10g, h = %.10g in %dD: it "
                         "depends on something else than its arguments",
                         call->r, call->h, call->dimension);
    }
    if (run->rounding_changed) {
        sphv_check_fail(result);
        sphv_check_cause(result, "it leaves another rounding mode behind");
    }
    if (run->printed)
        sphv_check_cause(result, "it prints (%zu bytes and perhaps more)", run->printed);
    if (data->single)
        sphv_check_cause(result, "single precision: judged by a unit roundoff of 6e-8");
    return SPHV_OK;
}

static sphv_status check_finite(sphv_examination *of, const sphv_implementation_data *data, int d,
                                sphv_error *error)
{
    sphv_check_result *result = sphv_check_add(of, "implementation-finite", d, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    size_t bad = 0, elsewhere = 0;
    for (size_t i = 0; i < data->count; i++) {
        const sphv_probe *probe = &data->probes[i];
        bool value = isfinite(probe->answer.value);
        if (probe->call.dimension != d || (value && isfinite(probe->answer.derivative))) continue;
        elsewhere += probe->call.r > 0;
        if (bad++ == 0)
            sphv_check_cause(
                result, "the %s is %s at r = %.10g, h = %.10g", value ? "derivative" : "value",
                isnan(value ? probe->answer.derivative : probe->answer.value) ? "NaN" : "infinite",
                probe->call.r, probe->call.h);
    }
    if (bad && !elsewhere) sphv_check_cause(result, "only at r = 0: a division by r");
    sphv_check_claim(result, "the library's results that are not finite");
    sphv_check_numbers(result, 0, (double)bad, 0);
    return SPHV_OK;
}

/// What the reference is where more than one answer is right: at the edge of a truncated kernel
/// either side, at the tip of a cone the slope or none.
static double difference(const sphv_probe *probe, int which)
{
    double found = sphv_implementation_answer(probe, which);
    double apart = fabs(found - probe->reference[which].value);
    return which && probe->call.r == 0 ? fmin(apart, fabs(found)) : apart;
}

static sphv_status check_shape(sphv_examination *of, const sphv_implementation_data *data, int d,
                               int which, sphv_error *error)
{
    sphv_check_result *result =
        sphv_check_add(of, which ? "implementation-derivative" : "implementation-value", d, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    double worst = -1;
    size_t places = 0;
    const sphv_probe *at = NULL;
    for (size_t i = 0; i < data->count; i++) {
        const sphv_probe *probe = &data->probes[i];
        if (probe->kind != SPHV_PROBE_SHAPE || probe->call.dimension != d) continue;
        double excess =
            difference(probe, which) / sphv_implementation_tolerance(data, probe, which);
        places++;
        if (!(excess > worst)) continue;
        worst = excess;
        at = probe;
    }
    if (at)
        sphv_check_claim(
            result,
            "%s of the library, at h = 1, is the file's at %zu places; the worst at q = %.10g",
            which ? "dW/dr" : "W", places, at->q);
    else
        sphv_check_claim(result, "%s of the library, at h = 1, is the file's at %zu places",
                         which ? "dW/dr" : "W", places);
    if (!at) {
        result->verdict = SPHV_INCONCLUSIVE; // nothing finite to compare
        return SPHV_OK;
    }
    sphv_check_numbers(result, at->reference[which].value, sphv_implementation_answer(at, which),
                       sphv_implementation_tolerance(data, at, which));
    if (worst <= 1) result->verdict = SPHV_AGREES;
    if (result->verdict == SPHV_DISAGREES)
        sphv_implementation_name_cause(of, data, d, which, result);
    return SPHV_OK;
}

static sphv_status check_support(sphv_examination *of, const sphv_implementation_data *data, int d,
                                 sphv_error *error)
{
    sphv_check_result *result = sphv_check_add(of, "implementation-support", d, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    const sphv_profile *profile = sphv_kernel_profile(data->kernel, d);
    sphv_result edge[3];
    sphv_profile_values(profile, nextafter(profile->support, 0), edge);
    const sphv_probe *worst = NULL; // the first place at which it is not zero
    double first = 0;
    for (size_t i = 0; i < data->count; i++) {
        const sphv_probe *probe = &data->probes[i];
        if (probe->kind != SPHV_PROBE_OUTSIDE || probe->call.dimension != d) continue;
        for (int which = 0; which < 2; which++) {
            double tolerance = sphv_implementation_tolerance(data, probe, which);
            double found = fabs(sphv_implementation_answer(probe, which));
            // On the edge itself the value inside is as good an answer as zero.
            if (probe->q == profile->support &&
                fabs(fabs(found) - fabs(edge[which].value)) <= 2 * tolerance)
                continue;
            // Beyond it nothing is computed, so nothing is rounded.
            if (probe->q == profile->support && found <= tolerance) continue;
            if (found == 0 || worst) continue;
            first = found;
            worst = probe;
        }
    }
    sphv_check_claim(result, "W and dW/dr vanish at and beyond r = κh (κ = %.10g)%s",
                     profile->support, worst ? "; the first that does not" : "");
    sphv_check_numbers(result, 0, first, 0);
    if (!worst || !isfinite(first)) return SPHV_OK;
    sphv_result whole[3] = {{0, 0}};
    if (sphv_check_truncated(of)) sphv_form_values(profile->form, worst->q, whole);
    if (whole[0].value != 0 &&
        fabs(sphv_implementation_answer(worst, 0) - whole[0].value) <= 1e-6 * fabs(whole[0].value))
        sphv_check_cause(result, "the library does not cut the kernel off at κ");
    else
        sphv_check_cause(result,
                         "not zero at q = %.10g: the support is larger than the file's, or "
                         "the cut-off is missing",
                         worst->q);
    return SPHV_OK;
}

static sphv_status check_scaling(sphv_examination *of, const sphv_implementation_data *data, int d,
                                 sphv_error *error)
{
    sphv_check_result *result = sphv_check_add(of, "implementation-scaling", d, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    double worst = -1;
    for (size_t i = 0; i < data->count; i++) {
        const sphv_probe *probe = &data->probes[i], *own = &data->probes[probe->unscaled];
        if (probe->kind != SPHV_PROBE_SCALED || probe->call.dimension != d) continue;
        for (int which = 0; which < 2; which++) {
            double expected = sphv_implementation_answer(own, which);
            double found = sphv_implementation_answer(probe, which);
            // Both sides are rounded, and a wrong kernel may be larger than the right one.
            double tolerance = 2 * sphv_implementation_tolerance(data, probe, which) +
                               32 * data->roundoff * fabs(expected);
            double excess = fabs(found - expected) / tolerance;
            if (!(excess > worst)) continue;
            worst = excess;
            result->verdict = SPHV_AGREES;
            sphv_check_numbers(result, expected, found, tolerance);
            sphv_check_claim(result,
                             "h^%d W(qh, h) of the library does not depend on h (0.0017 to 41.3), "
                             "nor does h^%d dW/dr; the worst: %s at q = %.6g, h = %g",
                             d, d + 1, which ? "dW/dr" : "W", probe->q, probe->call.h);
        }
    }
    if (worst < 0) result->verdict = SPHV_INCONCLUSIVE; // nothing finite to compare
    if (result->verdict == SPHV_DISAGREES) sphv_implementation_name_scaling(data, d, result);
    return SPHV_OK;
}

/// E at one point from the library's own W′, and what its rounding may have added.
static sphv_result measure(const sphv_implementation_data *data, const sphv_lattice_probe *point)
{
    double sum = -1, bound = 0;
    for (size_t j = point->count; j-- > 0;) {
        const sphv_probe *probe = &data->probes[point->first + j];
        double unit = probe->weight / (point->h * point->h);
        sum -= probe->weight * probe->answer.derivative;
        bound += fabs(unit) * sphv_implementation_tolerance(data, probe, 1) +
                 4 * DBL_EPSILON * (fabs(sum) + fabs(unit * probe->reference[1].value));
    }
    return (sphv_result){sum, bound};
}

static sphv_status check_truncation(sphv_examination *of, const sphv_implementation_data *data,
                                    sphv_error *error)
{
    const sphv_profile *profile = sphv_kernel_profile(data->kernel, 1);
    sphv_check_result *result = sphv_check_add(of, "implementation-truncation", 1, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    double worst = -1;
    for (size_t i = 0; i < data->lattice_count; i++) {
        const sphv_lattice_probe *point = &data->lattice[i];
        sphv_prediction theory;
        sphv_status status = sphv_predict_lattice(profile, point->h, point->spacing,
                                                  SPHV_FORM_EXACT, &theory, error);
        if (status != SPHV_OK) return status;
        sphv_result measured = measure(data, point);
        double bound = theory.total.bound + measured.bound;
        if (!isfinite(bound)) bound = INFINITY;
        double excess = fabs(measured.value - theory.total.value) / bound;
        if (!isnan(excess) && !(excess > worst)) continue;
        worst = isnan(excess) ? INFINITY : excess;
        result->verdict = SPHV_AGREES;
        sphv_check_numbers(result, theory.total.value, measured.value, bound);
        sphv_check_claim(
            result,
            "error E of the gradient with the library's dW/dr at %zu lattices, special "
            "and arbitrary; the worst at Δx/h = %.6g, h/λ = %g",
            data->lattice_count, point->spacing.value, point->h);
    }
    if (result->verdict == SPHV_DISAGREES)
        sphv_check_cause(result, "the estimate is %.10g times what theory says",
                         (1 + result->empirical) / (1 + result->analytic));
    return SPHV_OK;
}

static sphv_status judge(sphv_examination *of, sphv_implementation_data *data, sphv_error *error)
{
    sphv_status status = report_run(of, data, error);
    if (data->run.outcome != SPHV_OUTCOME_ANSWERED) return status;
    for (int d = 1; status == SPHV_OK && d <= SPHV_DIMENSIONS; d++) {
        bool wanted = !of->options->dimension || of->options->dimension == d;
        if (!wanted || !sphv_kernel_profile(of->kernel, d)) continue;
        status = check_finite(of, data, d, error);
        for (int which = 0; status == SPHV_OK && which < 2; which++)
            status = check_shape(of, data, d, which, error);
        if (status == SPHV_OK) status = check_support(of, data, d, error);
        if (status == SPHV_OK) status = check_scaling(of, data, d, error);
        if (status == SPHV_OK && d == 1) status = check_truncation(of, data, error);
    }
    return status;
}

static sphv_status sample(const sphv_examination *of, sphv_implementation_data *data,
                          sphv_error *error)
{
    sphv_kernel_call *calls = malloc(data->count * sizeof *calls);
    sphv_kernel_answer *answers = malloc(data->count * sizeof *answers);
    sphv_status status = SPHV_OK;
    if (!calls || !answers) status = sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    for (size_t i = 0; status == SPHV_OK && i < data->count; i++) calls[i] = data->probes[i].call;
    if (status == SPHV_OK)
        status = sphv_implementation_sample(of->options->implementation, of->options->time_limit,
                                            calls, data->count, answers, &data->run, error);
    for (size_t i = 0; status == SPHV_OK && i < data->count; i++)
        data->probes[i].answer = answers[i];
    free(calls);
    free(answers);
    return status;
}

sphv_status sphv_check_implementation(sphv_examination *of, int unused, sphv_error *error)
{
    (void)unused;
    if (!of->options->implementation) return SPHV_OK;
    sphv_implementation_data data = {.kernel = of->kernel};
    sphv_status status = sphv_implementation_plan(of, &data)
                             ? sample(of, &data, error)
                             : sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    if (status == SPHV_OK) {
        sphv_implementation_refer(&data);
        status = judge(of, &data, error);
    }
    free(data.probes);
    return status;
}
