#include "profile.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "expansion.h"

static const double unit_roundoff = DBL_EPSILON / 2;

/// Expansions per degree over a whole support; more of them lower the bounds and cost memory.
static const double centres_per_degree = 2;

void sphv_profile_free(sphv_profile *profile)
{
    for (int i = 0; i < profile->piece_count; i++) sphv_piece_free(&profile->pieces[i]);
    for (int i = 0; i < profile->knot_count; i++) free((double *)profile->knots[i].jump);
    free(profile->pieces);
    free(profile->knots);
    free((sphv_form *)profile->form);
    memset(profile, 0, sizeof *profile);
}

static int piece_of(const sphv_profile *profile, double q)
{
    int piece = 0;
    while (piece < profile->piece_count - 1 && q >= profile->pieces[piece].outer) piece++;
    return piece;
}

/// i!/(i−derivative)!
static double falling_factorial(int i, int derivative)
{
    double product = 1;
    for (int k = 0; k < derivative; k++) product *= i - k;
    return product;
}

void sphv_profile_values(const sphv_profile *profile, double q, sphv_result out[3])
{
    if (!(q < profile->support)) {
        for (int n = 0; n < 3; n++) out[n] = (sphv_result){0, 0};
        return;
    }
    const sphv_piece *piece = &profile->pieces[piece_of(profile, q)];
    if (piece->degree >= 0)
        sphv_piece_values(piece, q, out);
    else
        sphv_form_values(profile->form, q, out);
}

sphv_result sphv_profile_derivative(const sphv_profile *profile, int derivative, double q)
{
    if (!(q < profile->support)) return (sphv_result){0, 0};
    const sphv_piece *piece = &profile->pieces[piece_of(profile, q)];
    if (piece->degree >= 0) return sphv_piece_derivative(piece, derivative, q);
    if (derivative < 3) {
        sphv_result values[3];
        sphv_form_values(profile->form, q, values);
        return values[derivative];
    }
    double jet[SPHV_JET_MAX + 1];
    sphv_form_jet(profile->form, q, derivative, jet);
    double factorial = falling_factorial(derivative, derivative);
    return (sphv_result){factorial * jet[derivative],
                         16 * unit_roundoff * factorial * piece->derivative_bound[derivative]};
}

void sphv_profile_jet(const sphv_profile *profile, int piece_index, double q, int order,
                      double *jet)
{
    const sphv_piece *piece = &profile->pieces[piece_index];
    if (piece->degree < 0) {
        sphv_form_jet(profile->form, q, order, jet);
        return;
    }
    double factorial = 1;
    for (int n = 0; n <= order; n++) {
        jet[n] = sphv_piece_derivative(piece, n, q).value / factorial;
        factorial *= n + 1;
    }
}

sphv_number sphv_profile_special_spacing(const sphv_profile *profile, int n)
{
    mpq_t spacing, part;
    mpq_inits(spacing, part, NULL);
    mpq_set_d(spacing, profile->support_exact.value);
    mpq_set_d(part, profile->support_exact.residual);
    mpq_add(spacing, spacing, part);
    mpq_set_si(part, 2, 2 * (unsigned long)n + 1);
    mpq_canonicalize(part);
    mpq_mul(spacing, spacing, part);
    sphv_number number = sphv_rational_number(spacing);
    mpq_clears(spacing, part, NULL);
    return number;
}

static sphv_status allocate(sphv_profile *profile, int pieces, int knots, sphv_error *error)
{
    profile->pieces = calloc((size_t)pieces, sizeof *profile->pieces);
    profile->knots = calloc((size_t)knots, sizeof *profile->knots);
    if (!profile->pieces || !profile->knots)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    return SPHV_OK;
}

/// Enough expansions that the terms beyond the first few of each are small over its cell.
static int centres_of(const sphv_profile *profile, int index, int degree)
{
    const sphv_piece *piece = &profile->pieces[index];
    return 2 + (int)ceil(centres_per_degree * degree * (piece->outer - piece->inner) /
                         profile->support);
}

static sphv_status compile_piece(sphv_profile *profile, int index, const sphv_exact_pieces *exact,
                                 const sphv_polynomial *inner, const sphv_polynomial *outer,
                                 bool over_pi, sphv_error *error)
{
    mpq_t zero;
    mpq_init(zero);
    sphv_piece *piece = &profile->pieces[index];
    sphv_exact_piece whole = {index ? exact->outer[index - 1] : zero, exact->outer[index],
                              &exact->polynomial[index], inner, outer};
    piece->inner = sphv_rational_round(whole.inner);
    piece->outer = sphv_rational_round(whole.outer);
    sphv_status status = sphv_piece_expand(
        piece, &whole, over_pi, centres_of(profile, index, whole.polynomial->degree), error);
    mpq_clear(zero);
    return status;
}

/// Adds the knot whose jump is before − after (either may be NULL), unless nothing jumps there.
/// \param exact the pieces whose number `piece` ends at the knot: those of files with coefficients
///              of 17 digits are no less smooth than those with fractions. NULL at the origin
static sphv_status add_knot(sphv_profile *profile, const mpq_t position,
                            const sphv_polynomial *before, const sphv_polynomial *after,
                            const sphv_exact_pieces *exact, int piece, bool over_pi,
                            sphv_error *error)
{
    int degree = before ? before->degree : 0;
    if (after && after->degree > degree) degree = after->degree;
    sphv_polynomial jump;
    sphv_status status = sphv_polynomial_make(&jump, degree, error);
    if (status != SPHV_OK) return status;
    int order = -1;
    for (int i = degree; i >= 0; i--) {
        if (before && i <= before->degree) mpq_set(jump.coefficient[i], before->coefficient[i]);
        if (after && i <= after->degree)
            mpq_sub(jump.coefficient[i], jump.coefficient[i], after->coefficient[i]);
        double rounding = 0;
        for (int side = piece; exact && side < exact->count && side < piece + 2; side++)
            rounding += sphv_exact_pieces_rounding(exact, side, i, mpq_get_d(position));
        if (fabs(mpq_get_d(jump.coefficient[i])) > rounding) order = i;
    }
    for (int i = 0; i < order; i++) mpq_set_ui(jump.coefficient[i], 0, 1);
    if (order >= 0) {
        sphv_knot *knot = &profile->knots[profile->knot_count];
        double *rounded = malloc((size_t)(degree + 1) * sizeof *rounded);
        for (int i = 0; rounded && i <= degree; i++)
            rounded[i] = sphv_rational_over_pi(jump.coefficient[i], over_pi);
        knot->jump = rounded;
        knot->position = sphv_rational_number(position);
        knot->order = order;
        knot->terms = degree + 1;
        if (knot->jump)
            profile->knot_count++;
        else
            status = sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    sphv_polynomial_free(&jump);
    return status;
}

/// At the origin Ŵ(−s) − Ŵ(s) jumps: twice the odd part of the first piece, with a minus.
static sphv_status add_origin(sphv_profile *profile, const sphv_polynomial *first, bool over_pi,
                              sphv_error *error)
{
    sphv_polynomial odd;
    sphv_status status = sphv_polynomial_make(&odd, first->degree, error);
    if (status != SPHV_OK) return status;
    mpq_t zero;
    mpq_init(zero);
    for (int i = 1; i <= first->degree; i += 2) {
        mpq_add(odd.coefficient[i], first->coefficient[i], first->coefficient[i]);
        mpq_neg(odd.coefficient[i], odd.coefficient[i]);
    }
    status = add_knot(profile, zero, &odd, NULL, NULL, 0, over_pi, error);
    mpq_clear(zero);
    sphv_polynomial_free(&odd);
    return status;
}

/// Expands every piece about both its ends and collects the knots.
static sphv_status compile_pieces(sphv_profile *profile, const sphv_exact_pieces *exact,
                                  bool over_pi, sphv_error *error)
{
    sphv_exact_pieces inner = {0}, outer = {0};
    sphv_status status = sphv_exact_pieces_copy(&inner, exact, 0, error);
    if (status == SPHV_OK) status = sphv_exact_pieces_copy(&outer, exact, 0, error);
    for (int i = 0; status == SPHV_OK && i < exact->count; i++) {
        if (i) sphv_polynomial_shift(&inner.polynomial[i], exact->outer[i - 1]);
        sphv_polynomial_shift(&outer.polynomial[i], exact->outer[i]);
        profile->piece_count = i + 1;
        status = compile_piece(profile, i, exact, &inner.polynomial[i], &outer.polynomial[i],
                               over_pi, error);
    }
    if (status == SPHV_OK) status = add_origin(profile, &exact->polynomial[0], over_pi, error);
    for (int i = 0; status == SPHV_OK && i < exact->count; i++)
        status = add_knot(profile, exact->outer[i], &outer.polynomial[i],
                          i + 1 < exact->count ? &inner.polynomial[i + 1] : NULL, exact, i, over_pi,
                          error);
    sphv_exact_pieces_free(&inner);
    sphv_exact_pieces_free(&outer);
    return status;
}

const sphv_knot *sphv_profile_edge(const sphv_profile *profile)
{
    if (profile->knot_count == 0) return NULL;
    const sphv_knot *last = &profile->knots[profile->knot_count - 1];
    return last->position.value == profile->support ? last : NULL;
}

static void find_boundary_smoothness(sphv_profile *profile)
{
    const sphv_knot *edge = sphv_profile_edge(profile);
    profile->boundary_smoothness = edge ? edge->order - 1 : SPHV_JET_MAX;
}

sphv_status sphv_profile_from_pieces(sphv_profile *out, int dimension,
                                     const sphv_exact_pieces *pieces, const mpq_t constant,
                                     sphv_error *error)
{
    memset(out, 0, sizeof *out);
    out->dimension = dimension;
    out->support_exact = sphv_rational_number(pieces->outer[pieces->count - 1]);
    out->support = out->support_exact.value;
    bool over_pi = dimension > 1;
    out->constant.value = sphv_rational_over_pi(constant, over_pi);
    out->constant.bound = 2 * unit_roundoff * fabs(out->constant.value);
    sphv_status status = allocate(out, pieces->count, pieces->count + 1, error);
    if (status == SPHV_OK) status = compile_pieces(out, pieces, over_pi, error);
    if (status == SPHV_OK) status = sphv_profile_moments(out, pieces, error);
    if (status == SPHV_OK)
        find_boundary_smoothness(out);
    else
        sphv_profile_free(out);
    return status;
}
