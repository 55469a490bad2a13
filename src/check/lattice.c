/// Truncation error on the lattice: theory of the exact kernel against a measurement that uses the
/// file's own constant and gradient, and the order in Δx/h.
#include <float.h>
#include <math.h>

#include "check_internal.h"

static const double pi = 3.14159265358979323846;

/// −2Δs Σ g(q_j) sin(K q_j)/K − 1 with the file's gradient g, as a code would evaluate it.
static sphv_result measure_gradient(const sphv_profile *gradient, double h, sphv_number spacing)
{
    double K = 2 * pi * h, sum = 0, lost = 0, bound = 0;
    long inside = sphv_number_place(gradient->support_exact, spacing).inside;
    for (long j = inside; j >= 1; j--) {
        double q = fma((double)j, spacing.value, (double)j * spacing.residual);
        if (!(q < gradient->support)) q = nextafter(gradient->support, 0);
        sphv_result slope = sphv_profile_derivative(gradient, 0, q);
        double bend = sphv_profile_derivative(gradient, 1, q).value;
        double field = 2 * spacing.value * sin(K * q) / K, term = -slope.value * field;
        double next = sum + term;
        lost += fabs(sum) >= fabs(term) ? (sum - next) + term : (term - next) + sum;
        sum = next;
        bound += fabs(field) * (slope.bound + fabs(bend) * q * DBL_EPSILON) +
                 4 * DBL_EPSILON * fabs(term) +
                 2 * spacing.value * fabs(slope.value) * 2 * DBL_EPSILON * q;
    }
    double value = (sum - 1) + lost;
    return (sphv_result){value, bound + 2 * DBL_EPSILON * (1 + fabs(value))};
}

/// Measures E at one point with what the file gives.
static sphv_status measure(const sphv_examination *of, double h, sphv_number spacing,
                           sphv_point *point, sphv_error *error)
{
    const sphv_profile *profile = sphv_kernel_profile(of->kernel, 1);
    const sphv_profile *gradient =
        of->kernel->fourth_order ? NULL : sphv_kernel_gradient(of->kernel, 1);
    sphv_status status =
        sphv_evaluate_point(profile, h, spacing, SPHV_FORM_EXACT, false, NULL, NULL, point, error);
    if (status != SPHV_OK) return status;
    sphv_result *measured = &point->empirical.total;
    if (gradient) *measured = measure_gradient(gradient, h, spacing);
    double ratio = of->claimed_ratio[0];
    // A claimed constant is accepted to 1e-14, so the estimate may be off by that.
    measured->value = ratio == 1 ? measured->value : (measured->value + 1) * ratio - 1;
    measured->bound =
        fabs(ratio) * measured->bound + (of->kernel->claims.constant[0]
                                             ? 1.01 * of->tolerance[0] * (1 + fabs(measured->value))
                                             : 0);
    point->difference = point->analytic.total.value - measured->value;
    double scale =
        fmax(fabs(point->analytic.total.value), fmax(fabs(point->analytic.smoothing.value),
                                                     fabs(point->analytic.discretisation.value)));
    point->verdict = sphv_compare(point->analytic.total, *measured, scale);
    return SPHV_OK;
}

/// Where E itself is next to nothing, rounding hides 1 % of it and the point tells nothing either
/// way.
static bool telling(const sphv_point *point)
{
    return point->verdict != SPHV_INCONCLUSIVE ||
           fabs(point->analytic.smoothing.value) + fabs(point->analytic.discretisation.value) >
               1e-9;
}

/// Keeps the point whose verdict is worst, then whose difference is largest against its bound.
static void keep_worst(sphv_point *worst, const sphv_point *point, double *excess, double *h,
                       double *spacing, double here_h, double here_spacing)
{
    double bound = point->analytic.total.bound + point->empirical.total.bound;
    double here = fabs(point->difference) / bound + (point->verdict == SPHV_DISAGREES ? 1e9
                                                     : point->verdict == SPHV_AGREES  ? 0
                                                                                      : 1e6);
    if (!(here <= *excess)) {
        *excess = here;
        *worst = *point;
        *h = here_h;
        *spacing = here_spacing;
    }
}

static sphv_status truncation(sphv_examination *of, bool special, sphv_error *error)
{
    static const double hs[] = {0.0018, 0.02, 0.2};
    static const int ns[] = {2, 3, 5, 8, 13, 21, 40};
    static const char *const fractions[] = {"0.61", "3/7",    "0.2718", "1/5",
                                            "0.1",  "0.0577", "1/40"};
    enum { POINTS = sizeof ns / sizeof *ns };
    const sphv_profile *profile = sphv_kernel_profile(of->kernel, 1);
    sphv_point worst = {.verdict = SPHV_INCONCLUSIVE};
    int points = 0;
    // A wide kernel is looked at over the same part of a wavelength as one of support 2.
    double excess = -1, h = 0, at = 0, narrow = fmin(1, 2 / profile->support);
    for (size_t i = 0; i < POINTS; i++)
        for (size_t k = 0; k < sizeof hs / sizeof *hs; k++) {
            sphv_number spacing;
            sphv_point point;
            if (special) {
                spacing = sphv_profile_special_spacing(profile, ns[i]);
            } else {
                sphv_status read = sphv_number_parse(fractions[i], &spacing, error);
                if (read != SPHV_OK) return read;
                spacing = sphv_number_from_double(spacing.value * profile->support);
            }
            double here = hs[k] * narrow;
            sphv_status status = measure(of, here, spacing, &point, error);
            if (status != SPHV_OK) return status;
            if (!telling(&point)) continue;
            points++;
            keep_worst(&worst, &point, &excess, &h, &at, here, spacing.value);
        }
    sphv_check_result *result = sphv_check_add(of, "truncation-error", 1, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    sphv_check_numbers(result, worst.analytic.total.value, worst.empirical.total.value,
                       worst.analytic.total.bound + worst.empirical.total.bound);
    result->verdict = sphv_verdict_worse(result->verdict, worst.verdict);
    sphv_check_claim(result,
                     "error E of the gradient at %d points with Δx/h %s, h/λ %.3g to %.3g; "
                     "the worst at Δx/h = %.6g, h/λ = %.3g",
                     points, special ? "= 2κ/(2n+1)" : "arbitrary", 0.0018 * narrow, 0.2 * narrow,
                     at, h);
    if (worst.verdict == SPHV_AGREES) return SPHV_OK;
    double ratio = (1 + worst.empirical.total.value) / (1 + worst.analytic.total.value);
    if (worst.verdict == SPHV_INCONCLUSIVE)
        sphv_check_cause(result, "the bounds would hide an error of 1 %%");
    else if (fabs(ratio + 1) < 1e-9)
        sphv_check_cause(result, "the estimate has the wrong sign: the gradient's sign is flipped");
    else
        sphv_check_cause(result,
                         "the estimate is %.10g times what theory says; see normalisation "
                         "and derivative",
                         ratio);
    return SPHV_OK;
}

sphv_status sphv_check_truncation(sphv_examination *of, int dimension, sphv_error *error)
{
    if (dimension != 1) return sphv_check_truncation_nd(of, dimension, error);
    sphv_status status = truncation(of, true, error);
    return status == SPHV_OK ? truncation(of, false, error) : status;
}

/// The fewest steps in n after which every knot stands at the same fraction of a cell, so that the
/// leading term is a pure power; 0 when there is none up to 60.
static int period(const sphv_profile *profile)
{
    for (int step = 1; step <= 60; step++) {
        bool same = true;
        for (int i = 0; i < profile->knot_count; i++) {
            double turns = step * profile->knots[i].position.value / profile->support;
            same = same && fabs(turns - nearbyint(turns)) < 1e-9;
        }
        if (same) return step;
    }
    return 0;
}

/// Fitted slopes over four spacings with equal fractions, as fine as rounding allows.
struct fit {
    sphv_result measured; ///< with the error that the bounds of the points allow
    double predicted;     ///< the exact theory fitted in the same way
    int coarsest, finest; ///< n
};

static sphv_status fit_order(const sphv_examination *of, int step, int first, struct fit *fit,
                             bool *found, sphv_error *error)
{
    enum { POINTS = 3 };
    const sphv_profile *profile = sphv_kernel_profile(of->kernel, 1);
    const double h = 0.01 * fmin(1, 2 / profile->support);
    double spacing[POINTS], measured[POINTS], predicted[POINTS], noise = 0;
    for (int i = 0; i < POINTS; i++) {
        sphv_number at = sphv_profile_special_spacing(profile, first + i * step);
        sphv_point point;
        // The kernel itself: a wrong constant would add to the error that is fitted.
        sphv_status status =
            sphv_evaluate_point(profile, h, at, SPHV_FORM_EXACT, false, NULL, NULL, &point, error);
        if (status != SPHV_OK) return status;
        spacing[i] = at.value;
        predicted[i] = point.analytic.discretisation.value;
        measured[i] = point.empirical.total.value - point.analytic.smoothing.value;
        double bound = point.analytic.total.bound + point.empirical.total.bound +
                       (of->tolerance[0] - SPHV_CONSTANT_TOLERANCE);
        noise = fmax(noise, bound / fabs(predicted[i]));
    }
    double range = log(spacing[0] / spacing[POINTS - 1]);
    // A relative error ε of the ends turns a line over the range by 2ε/range.
    noise *= 2.5 / range;
    if (!(noise < 0.05)) return SPHV_OK;
    fit->measured = sphv_fit_slope(spacing, measured, POINTS);
    fit->measured.bound = noise;
    fit->predicted = sphv_fit_slope(spacing, predicted, POINTS).value;
    fit->coarsest = first;
    fit->finest = first + (POINTS - 1) * step;
    *found = true;
    return SPHV_OK;
}

sphv_status sphv_check_order(sphv_examination *of, int dimension, sphv_error *error)
{
    if (dimension != 1) return SPHV_OK;
    const sphv_profile *profile = sphv_kernel_profile(of->kernel, 1);
    int deciding = 0, step = period(profile);
    int order = sphv_predicted_order(profile, true, &deciding);
    sphv_check_result *result = sphv_check_add(of, "discretisation-order", 1, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    struct fit best = {{NAN, INFINITY}, NAN, 0, 0}, fit;
    bool any = false;
    for (int first = 2; step && first <= 200; first += first < 8 ? 1 : first / 3) {
        bool found = false;
        if (2 * profile->support / (2 * (first + 2 * step) + 1) < SPHV_SPACING_MIN) break;
        sphv_status status = fit_order(of, step, first, &fit, &found, error);
        if (status != SPHV_OK) return status;
        if (!found) continue;
        if (!any || fabs(fit.predicted - order) + fit.measured.bound <
                        fabs(best.predicted - order) + best.measured.bound)
            best = fit;
        any = true;
    }
    double bias = fabs(best.predicted - order) * (1 + 1e-9);
    sphv_check_claim(result,
                     "order in Δx/h at 2κ/(2n+1), decided by the knot at q = %.6g, fitted "
                     "over n = %d to %d",
                     profile->knot_count ? profile->knots[deciding].position.value : 0,
                     best.coarsest, best.finest);
    if (any && bias < 0.5) {
        sphv_check_numbers(result, order, best.measured.value, bias + best.measured.bound);
        return SPHV_OK;
    }
    if (any && !(fabs(best.predicted - best.measured.value) <= best.measured.bound)) {
        // Too coarse for the order, but even there the exact series must fit as the sums do.
        sphv_check_numbers(result, best.predicted, best.measured.value, best.measured.bound);
        return SPHV_OK;
    }
    sphv_check_cause(result, "not measured: %s",
                     any    ? "rounding ends the fit before the leading term rules"
                     : step ? "the discretisation error is below rounding at every spacing"
                            : "no spacings put all knots at equal fractions of a cell");
    result->analytic = order;
    result->informative = true;
    return SPHV_OK;
}
