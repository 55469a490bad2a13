#include <math.h>
#include <stdlib.h>

#include "internal.h"

/// What a curve shows at a sample: the signed error or Ŵ, in statistical scenes the L2 norm.
static double value_of(const sphv_scene_result *result, const sphv_sample *sample, bool empirical)
{
    const sphv_point *point = &sample->point;
    if (result->scene->statistical)
        return empirical ? point->empirical.l2.value : point->analytic.l2.value;
    return empirical ? point->empirical.total.value : point->analytic.total.value;
}

/// Whether a claim looks at a sample. The range is widened by rounding so that its ends count.
static bool counts(const sphv_claim *claim, const sphv_sample *sample)
{
    return sample->x >= claim->from * (1 - 1e-12) && sample->x <= claim->to * (1 + 1e-12) &&
           !(claim->special_only && sample->n < 0);
}

/// Least-squares slope of log|E| against the logarithm of the abscissa.
static double slope(const sphv_scene_result *result, const sphv_claim *claim, bool empirical)
{
    size_t count = result->sample_count[claim->curve], used = 0;
    double *x = malloc((2 * count + 1) * sizeof *x);
    if (!x) return NAN;
    for (size_t i = 0; i < count; i++) {
        const sphv_sample *sample = &result->samples[claim->curve][i];
        if (!counts(claim, sample)) continue;
        x[used] = sample->x;
        x[count + used++] = value_of(result, sample, empirical);
    }
    double fitted = used >= 3 ? sphv_fit_slope(x, x + count, used).value : NAN;
    free(x);
    return fitted;
}

/// The slope of the curve less that of the reference curve.
static double slope_difference(const sphv_scene_result *result, const sphv_claim *claim,
                               bool empirical)
{
    sphv_claim other = *claim;
    other.curve = claim->reference;
    return slope(result, claim, empirical) - slope(result, &other, empirical);
}

/// Calls `take` for each abscissa at which both curves of a claim have a sample.
static void for_common(const sphv_scene_result *result, const sphv_claim *claim, bool empirical,
                       void (*take)(double own, double other, double *state), double *state)
{
    size_t j = 0, others = result->sample_count[claim->reference];
    for (size_t i = 0; i < result->sample_count[claim->curve]; i++) {
        const sphv_sample *own = &result->samples[claim->curve][i];
        if (!counts(claim, own)) continue;
        while (j < others && result->samples[claim->reference][j].x < own->x * (1 - 1e-12)) j++;
        if (j == others) break;
        const sphv_sample *other = &result->samples[claim->reference][j];
        if (other->x <= own->x * (1 + 1e-12))
            take(value_of(result, own, empirical), value_of(result, other, empirical), state);
    }
}

static void add_log_ratio(double own, double other, double *state)
{
    state[0] += log(fabs(own / other));
    state[1] += 1;
}

/// Geometric mean of |E| over that of the reference curve.
static double ratio(const sphv_scene_result *result, const sphv_claim *claim, bool empirical)
{
    double state[2] = {0, 0};
    for_common(result, claim, empirical, add_log_ratio, state);
    return state[1] > 0 ? exp(state[0] / state[1]) : NAN;
}

static void keep_largest(double own, double other, double *state)
{
    state[0] = fmax(state[0], fabs(own - other));
    state[1] += 1;
}

/// Largest difference from the reference curve.
static double difference(const sphv_scene_result *result, const sphv_claim *claim, bool empirical)
{
    double state[2] = {0, 0};
    for_common(result, claim, empirical, keep_largest, state);
    return state[1] > 0 ? state[0] : NAN;
}

static double sign_changes(const sphv_scene_result *result, const sphv_claim *claim, bool empirical)
{
    double last = 0, changes = 0;
    for (size_t i = 0; i < result->sample_count[claim->curve]; i++) {
        const sphv_sample *sample = &result->samples[claim->curve][i];
        double value = value_of(result, sample, empirical);
        if (!counts(claim, sample) || value == 0) continue;
        changes += last * value < 0;
        last = value;
    }
    return changes;
}

/// The curve's value at the sample nearest to the start of the range.
static double value(const sphv_scene_result *result, const sphv_claim *claim, bool empirical)
{
    double nearest = INFINITY, found = NAN;
    for (size_t i = 0; i < result->sample_count[claim->curve]; i++) {
        const sphv_sample *sample = &result->samples[claim->curve][i];
        if (fabs(sample->x - claim->from) < nearest) {
            nearest = fabs(sample->x - claim->from);
            found = value_of(result, sample, empirical);
        }
    }
    return found;
}

/// Part of the special points at which the paper's form agrees with measurement: counted, not
/// predicted.
static double paper_agreement(const sphv_scene_result *result, const sphv_claim *claim,
                              bool empirical)
{
    if (!empirical) return NAN;
    double agreeing = 0, all = 0;
    for (size_t i = 0; i < result->sample_count[claim->curve]; i++) {
        const sphv_sample *sample = &result->samples[claim->curve][i];
        if (sample->n < 0 || !counts(claim, sample)) continue;
        all += 1;
        agreeing += sample->paper_verdict == SPHV_AGREES;
    }
    return all > 0 ? agreeing / all : NAN;
}

/// Part of the estimates that had to be left out of the norm: counted, not predicted.
static double failures(const sphv_scene_result *result, const sphv_claim *claim, bool empirical)
{
    if (!empirical) return NAN;
    double left_out = 0, all = 0;
    for (size_t i = 0; i < result->sample_count[claim->curve]; i++) {
        const sphv_sample *sample = &result->samples[claim->curve][i];
        if (!counts(claim, sample) || !sample->point.statistical) continue;
        const sphv_disorder_measurement *measured = &sample->point.disorder;
        all += (double)measured->particles;
        left_out += (double)(measured->singular + measured->ill_conditioned + measured->not_finite);
    }
    return all > 0 ? left_out / all : NAN;
}

const sphv_claim_measure sphv_claim_measures[] = {
    {"slope", "least-squares slope of log|E| against the logarithm of the abscissa", false, false,
     slope},
    {"slope-difference", "slope of the curve less that of the reference curve", true, false,
     slope_difference},
    {"ratio", "geometric mean of |E| over that of the reference curve", true, false, ratio},
    {"difference", "largest difference from the reference curve", true, false, difference},
    {"sign-changes", "number of sign changes of E along the curve", false, true, sign_changes},
    {"value", "value at the start of the range", false, false, value},
    {"paper-agreement", "part of the special points at which the paper's form agrees", false, true,
     paper_agreement},
    {"failures", "part of the estimates left out: singular, ill-conditioned or not finite", false,
     false, failures},
    {NULL, NULL, false, false, NULL},
};

sphv_claim_result sphv_claim_judge(const sphv_scene_result *result, const sphv_claim *claim)
{
    sphv_claim_result judged = {claim->measure->measure(result, claim, false),
                                claim->measure->measure(result, claim, true), SPHV_INCONCLUSIVE,
                                false};
    // Some measures only count; theory then says nothing, which is not a disagreement.
    if (isfinite(judged.empirical)) {
        bool predicted = !isfinite(judged.analytic) ||
                         fabs(judged.analytic - claim->expected) <= claim->tolerance;
        bool measured = fabs(judged.empirical - claim->expected) <= claim->tolerance;
        judged.verdict = predicted && measured ? SPHV_AGREES : SPHV_DISAGREES;
    }
    judged.surprising = judged.verdict != (claim->refuted ? SPHV_DISAGREES : SPHV_AGREES);
    return judged;
}
