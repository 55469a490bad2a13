/// Support, peak and evenness of w.
#include <math.h>

#include "check_internal.h"

/// w(q) of the file, from one piece, with its bound.
static sphv_result value_at(const sphv_profile *profile, double q)
{
    sphv_result value = sphv_profile_derivative(profile, 0, q);
    double constant = profile->constant.value;
    return (sphv_result){value.value / constant, value.bound / fabs(constant)};
}

static bool piece_is_zero(const sphv_polynomial *p)
{
    for (int k = 0; k <= p->degree; k++)
        if (mpq_sgn(p->coefficient[k]) != 0) return false;
    return true;
}

/// Was a negative tail replaced by zero? Then the kernel arrives at zero with a slope.
static bool clamped_at(const sphv_exact_pieces *pieces, int piece)
{
    if (piece < 1) return false;
    const sphv_polynomial *before = &pieces->polynomial[piece - 1];
    sphv_polynomial shifted;
    if (sphv_polynomial_make(&shifted, before->degree, NULL) != SPHV_OK) return false;
    for (int k = 0; k <= before->degree; k++)
        mpq_set(shifted.coefficient[k], before->coefficient[k]);
    sphv_polynomial_shift(&shifted, pieces->outer[piece - 1]);
    bool clamped = shifted.degree > 0 && mpq_sgn(shifted.coefficient[0]) == 0 &&
                   mpq_sgn(shifted.coefficient[1]) < 0;
    sphv_polynomial_free(&shifted);
    return clamped;
}

/// Where w ends really: the outer end of the last piece that is not zero.
static double exact_end(const sphv_examination *of, const sphv_profile *profile, int *zero_piece)
{
    *zero_piece = -1;
    if (!of->kernel->polynomial) return profile->support;
    const sphv_exact_pieces *pieces = &of->kernel->pieces;
    int last = pieces->count;
    while (last > 0 && piece_is_zero(&pieces->polynomial[last - 1])) last--;
    if (last < pieces->count) *zero_piece = last;
    return last ? sphv_rational_round(pieces->outer[last - 1]) : 0;
}

static bool zero_inside(const sphv_exact_pieces *pieces, int below)
{
    for (int i = 0; i < below; i++)
        if (piece_is_zero(&pieces->polynomial[i])) return true;
    return false;
}

/// The largest q, on a fine grid, at which w is not zero.
static double measured_end(const sphv_profile *profile)
{
    enum { STEPS = 4096 };
    for (int i = STEPS - 1; i >= 0; i--) {
        double q = profile->support * (i + 0.5) / STEPS;
        if (sphv_profile_derivative(profile, 0, q).value != 0)
            return profile->support * (i + 1.0) / STEPS;
    }
    return 0;
}

sphv_status sphv_check_support(sphv_examination *of, int dimension, sphv_error *error)
{
    enum { STEPS = 4096 };
    sphv_check_result *result =
        sphv_check_add(of, "support", sphv_check_shape_dimension(of, dimension), error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    const sphv_profile *profile = sphv_check_profile(of, dimension);
    int zero_piece;
    double end = exact_end(of, profile, &zero_piece);
    sphv_check_claim(result, "w ends at q = %.10g, not before and not beyond", profile->support);
    result->claimed = profile->support;
    sphv_check_numbers(result, end, measured_end(profile), profile->support / STEPS);
    double beyond = value_at(profile, profile->support).value;
    if (beyond != 0) {
        sphv_check_fail(result);
        sphv_check_cause(result, "w(κ) evaluates to %g", beyond);
    }
    if (zero_piece >= 0) {
        sphv_check_fail(result);
        if (clamped_at(&of->kernel->pieces, zero_piece))
            sphv_check_cause(result,
                             "negative part clamped: w is set to zero from q = %.10g on, "
                             "where it crosses zero with a slope",
                             end);
        else
            sphv_check_cause(result,
                             "the support is overstated: w is identically zero from "
                             "q = %.10g on",
                             end);
        sphv_check_name_shape_cause(of, result);
    } else if (of->kernel->polynomial &&
               zero_inside(&of->kernel->pieces, of->kernel->pieces.count)) {
        sphv_check_fail(result);
        sphv_check_cause(result, "a piece before the end is identically zero");
        sphv_check_name_shape_cause(of, result);
    }
    return SPHV_OK;
}

sphv_status sphv_check_peak(sphv_examination *of, int dimension, sphv_error *error)
{
    enum { STEPS = 2048 };
    sphv_check_result *result =
        sphv_check_add(of, "peak", sphv_check_shape_dimension(of, dimension), error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    const sphv_profile *profile = sphv_check_profile(of, dimension);
    const int *monotone = of->kernel->claims.monotone;
    sphv_result origin = value_at(profile, 0);
    double highest = origin.value, at = 0, bound = origin.bound;
    for (int i = 1; i <= STEPS; i++) {
        double q = profile->support * (i - 0.5) / STEPS;
        sphv_result value = value_at(profile, q);
        if (value.value > highest + value.bound + origin.bound) {
            highest = value.value;
            at = q;
            bound = value.bound + origin.bound;
        }
    }
    sphv_check_claim(result, "w(0) is positive and the largest value");
    double exact;
    if (sphv_kernel_exact_value(of->kernel, profile->dimension, 0, 0, &exact))
        exact /= profile->constant.value;
    else
        exact = origin.value;
    // A kernel that says of itself that it does not decrease may have its largest value elsewhere.
    result->informative = monotone && !*monotone;
    if (result->informative) {
        sphv_check_claim(result, "w(0), and the largest value");
        highest = fmin(highest, exact);
    }
    sphv_check_numbers(result, exact, highest, bound + 8e-16 * fabs(exact));
    if (!(origin.value > origin.bound)) {
        sphv_check_fail(result);
        sphv_check_cause(result, "w(0) = %.6g is not positive", origin.value);
    } else if (result->verdict == SPHV_DISAGREES) {
        sphv_check_cause(result,
                         "w rises to %.10g at q = %.6g; a kernel for which this is meant "
                         "claims 'monotone: false'",
                         highest, at);
    }
    if (result->verdict == SPHV_DISAGREES) sphv_check_name_shape_cause(of, result);
    return SPHV_OK;
}

/// One-sided slope at the origin: four-point forward difference of the value,
/// (−11 w_0 + 18 w_1 − 9 w_2 + 2 w_3)/6δ, with error δ³ |w⁗|/4.
static sphv_result measured_slope(const sphv_profile *profile)
{
    static const double weight[] = {-11, 18, -9, 2};
    const sphv_piece *piece = &profile->pieces[0];
    double constant = fabs(profile->constant.value);
    double bend = 24 * piece->derivative_bound[4] / constant;
    double step = fmin(1e-3, piece->outer / 8);
    sphv_result slope = {0, bend * step * step * step / 4};
    for (int i = 0; i < 4; i++) {
        sphv_result value = value_at(profile, i * step);
        slope.value += weight[i] * value.value / (6 * step);
        slope.bound += fabs(weight[i]) * (value.bound + 4e-16 * fabs(value.value)) / (6 * step);
    }
    return slope;
}

sphv_status sphv_check_evenness(sphv_examination *of, int dimension, sphv_error *error)
{
    sphv_check_result *result =
        sphv_check_add(of, "evenness", sphv_check_shape_dimension(of, dimension), error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    const sphv_profile *profile = sphv_check_profile(of, dimension);
    double slope = 0, jet[2];
    sphv_profile_jet(profile, 0, 0, 1, jet);
    slope = jet[1] / profile->constant.value;
    sphv_result measured = measured_slope(profile);
    double height = value_at(profile, 0).value;
    double steepness = fabs(slope) * profile->support / fabs(height);
    sphv_check_numbers(result, slope, measured.value, measured.bound + 4e-16 * fabs(slope));
    sphv_check_claim(result, "the slope of w at the origin");
    result->informative = true;
    const sphv_knot *first = profile->knot_count ? &profile->knots[0] : NULL;
    if (first && first->position.value > 0) first = NULL;
    if (steepness == 0 || (!of->kernel->polynomial && steepness < 1e-12)) {
        if (first)
            sphv_check_cause(result, "even up to order %d: derivative %d jumps at the origin",
                             first->order - 1, first->order);
    } else if (steepness < 1e-2) {
        // A cone that is meant has a slope of the size of w(0)/κ.
        result->informative = false;
        sphv_check_fail(result);
        sphv_check_cause(result,
                         "w'(0) = %.6g is neither zero nor the cone of a kernel such as "
                         "spiky: an odd part was added or a coefficient is mistyped",
                         slope);
        sphv_check_name_shape_cause(of, result);
    } else {
        sphv_check_cause(result, "a cone: w'(0) = %.6g, so the gradient jumps at the origin",
                         slope);
    }
    return SPHV_OK;
}
