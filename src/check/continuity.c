/// Interior knots and the edge.
#include <float.h>
#include <math.h>

#include "check_internal.h"

/// The derivatives that a text calls by name.
static const char *const derivative_names[] = {"value", "slope", "curvature", "third derivative"};

/// Measured jump of a derivative at the outer end of a piece: floating-point evaluation on both
/// sides, in units of w.
static sphv_result measured_jump(const sphv_profile *profile, int piece, int order)
{
    double inner[SPHV_JET_MAX + 1], outer[SPHV_JET_MAX + 1], factorial = tgamma(order + 1.0);
    double q = profile->pieces[piece].outer, scale = factorial / profile->constant.value;
    sphv_profile_jet(profile, piece, q, order, inner);
    sphv_profile_jet(profile, piece + 1, q, order, outer);
    double size = fmax(profile->pieces[piece].derivative_bound[order],
                       profile->pieces[piece + 1].derivative_bound[order]);
    double drift = (order + 1) * fmax(profile->pieces[piece].derivative_bound[order + 1],
                                      profile->pieces[piece + 1].derivative_bound[order + 1]);
    return (sphv_result){(inner[order] - outer[order]) * scale,
                         8 * DBL_EPSILON * fabs(scale) * (size + drift * q)};
}

/// The exact jump there.
static double exact_jump(const sphv_profile *profile, int piece, int order)
{
    double q = profile->pieces[piece].outer;
    for (int i = 0; i < profile->knot_count; i++) {
        const sphv_knot *knot = &profile->knots[i];
        if (knot->position.value == q)
            return order < knot->terms
                       ? knot->jump[order] * tgamma(order + 1.0) / profile->constant.value
                       : 0;
    }
    return 0;
}

static int edge_order(const sphv_profile *profile)
{
    return profile->boundary_smoothness + 1;
}

/// Derivatives below this order must be continuous inside: value and slope always; further ones
/// when the file claims β, or, up to the curvature, when the edge itself is smoother.
static int required_order(const sphv_examination *of, const sphv_profile *profile)
{
    const int *claim = of->kernel->claims.boundary_smoothness;
    int order = edge_order(profile) < 3 ? edge_order(profile) : 3;
    if (claim && *claim + 1 > order) order = *claim + 1 < 40 ? *claim + 1 : 40;
    // A file that claims less smoothness than a slope at the edge may have it inside as well.
    int least = claim && *claim < 1 ? (*claim < 0 ? 0 : *claim + 1) : 2;
    return order < least ? least : order;
}

static sphv_status examine(sphv_examination *of, int dimension, int order, int required,
                           sphv_error *error)
{
    const sphv_profile *profile = sphv_check_profile(of, dimension);
    int worst = 0;
    double largest = -1;
    for (int i = 0; i + 1 < profile->piece_count; i++) {
        double jump = fabs(exact_jump(profile, i, order));
        if (jump > largest) {
            largest = jump;
            worst = i;
        }
    }
    sphv_check_result *result =
        sphv_check_add(of, "continuity", sphv_check_shape_dimension(of, dimension), error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    char name[32];
    if (order < 4)
        snprintf(name, sizeof name, "%s", derivative_names[order]);
    else
        snprintf(name, sizeof name, "derivative %d", order);
    sphv_check_claim(result, "the %s of w is continuous at %d interior knot%s", name,
                     profile->piece_count - 1, profile->piece_count > 2 ? "s" : "");
    result->informative = order >= required;
    if (result->informative) sphv_check_claim(result, "largest jump of the %s of w inside", name);
    sphv_result measured = measured_jump(profile, worst, order);
    sphv_check_numbers(result, exact_jump(profile, worst, order), measured.value, measured.bound);
    double at = profile->pieces[worst].outer;
    if (largest > 0 && order < required) {
        sphv_check_fail(result);
        sphv_check_cause(result, "the %s of w jumps by %.6g at q = %.10g", name,
                         -exact_jump(profile, worst, order), at);
        sphv_check_name_shape_cause(of, result);
    } else if (largest > 0) {
        sphv_check_cause(result, "at q = %.10g", at);
    }
    return SPHV_OK;
}

sphv_status sphv_check_continuity(sphv_examination *of, int dimension, sphv_error *error)
{
    const sphv_profile *profile = sphv_check_profile(of, dimension);
    if (profile->piece_count < 2) return SPHV_OK;
    int required = required_order(of, profile);
    sphv_status status = SPHV_OK;
    for (int order = 0; status == SPHV_OK && order < required; order++)
        status = examine(of, dimension, order, required, error);
    if (status == SPHV_OK && required < 3) status = examine(of, dimension, 2, required, error);
    return status;
}

/// Ŵ(κ − δ) from the exact Taylor series at the edge.
static double edge_series(const sphv_knot *edge, double step)
{
    double sum = 0;
    for (int i = edge->terms - 1; i >= edge->order; i--) sum = sum * -step + edge->jump[i];
    return sum * pow(-step, edge->order);
}

/// One-sided scaling: log2 of w(κ − δ)/w(κ − δ/2), which tends to β + 1.
/// \param rounding what long decimals leave of w at κ
static sphv_result measured_scaling(const sphv_profile *profile, double step, double rounding)
{
    sphv_result far = sphv_profile_derivative(profile, 0, profile->support - step);
    sphv_result near = sphv_profile_derivative(profile, 0, profile->support - 0.5 * step);
    // κ − δ is rounded: relative to δ that is κu/δ, and w varies like a power of δ.
    double moved = (profile->boundary_smoothness + 2) * profile->support * DBL_EPSILON / step;
    return (sphv_result){log2(fabs(far.value / near.value)),
                         1.5 * ((far.bound + rounding) / fabs(far.value) +
                                (near.bound + rounding) / fabs(near.value) + 4 * moved +
                                4 * DBL_EPSILON)};
}

/// The same at the largest of several δ that settles the order; the bound holds the bias of a
/// finite δ, which the exact series at the edge gives.
static sphv_result measure_scaling(const sphv_examination *of, const sphv_profile *profile,
                                   const sphv_knot *edge, const sphv_piece *last)
{
    double step = fmin(profile->support / 8, last->outer - last->inner), rounding = 0;
    sphv_result best = {NAN, INFINITY};
    if (of->kernel->polynomial)
        rounding = sphv_exact_pieces_rounding(&of->kernel->exact[profile->dimension - 1],
                                              profile->piece_count - 1, 0, profile->support);
    for (int halving = 0; halving < 20 && !(best.bound < 0.25); halving++, step /= 2) {
        sphv_result measured = measured_scaling(profile, step, rounding);
        double series = log2(fabs(edge_series(edge, step) / edge_series(edge, step / 2)));
        measured.bound += fabs(series - edge->order) * (1 + 1e-9);
        if (measured.bound < best.bound) best = measured;
    }
    return best;
}

sphv_status sphv_check_boundary(sphv_examination *of, int dimension, sphv_error *error)
{
    const sphv_profile *profile = sphv_check_profile(of, dimension);
    sphv_check_result *result =
        sphv_check_add(of, "boundary-smoothness", sphv_check_shape_dimension(of, dimension), error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    const int *claim = of->kernel->claims.boundary_smoothness;
    int found = profile->boundary_smoothness;
    const sphv_knot *edge = sphv_profile_edge(profile);
    const sphv_piece *last = &profile->pieces[profile->piece_count - 1];
    if (claim) {
        sphv_check_claim(result, "β = %d, and w meets zero smoothly at κ", *claim);
        result->claimed = *claim;
    } else {
        sphv_check_claim(result, "w and its slope vanish at κ (β >= 1)");
    }
    bool has_edge = edge != NULL;
    sphv_result measured =
        has_edge ? measure_scaling(of, profile, edge, last) : (sphv_result){NAN, INFINITY};
    result->analytic = found;
    if (has_edge && measured.bound < 0.5)
        sphv_check_numbers(result, found, measured.value - 1, measured.bound);
    else if (has_edge)
        sphv_check_cause(result, "not measured: rounding of the coefficients hides the edge");
    // Without an edge at κ (w is zero there already) the support check speaks.
    if (claim && *claim != found) {
        sphv_check_fail(result);
        sphv_check_cause(result, "the file claims β = %d; found β = %d", *claim, found);
    }
    if (found < 1 && !sphv_check_truncated(of) && !(claim && *claim == found)) {
        sphv_check_fail(result);
        if (found < 0 && has_edge)
            sphv_check_cause(result, "w(κ) = %.6g at q = %.10g is not zero",
                             edge->jump[0] / profile->constant.value, profile->support);
        else if (has_edge)
            sphv_check_cause(result, "the slope of w is %.6g at κ, not zero",
                             edge->jump[1] / profile->constant.value);
    }
    if (result->verdict == SPHV_DISAGREES) sphv_check_name_shape_cause(of, result);
    return SPHV_OK;
}
