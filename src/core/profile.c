#include "profile.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double unit_roundoff = DBL_EPSILON / 2;

void sphv_profile_free(sphv_profile *profile)
{
    for (int i = 0; i < profile->piece_count; i++) {
        free((double *)profile->pieces[i].about_inner);
        free((double *)profile->pieces[i].about_outer);
        free(profile->pieces[i].derivative_bound);
    }
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

static sphv_result polynomial_derivative(const sphv_piece *piece, int derivative, double q)
{
    int from_inner = q - piece->inner < piece->outer - q;
    const double *c = from_inner ? piece->about_inner : piece->about_outer;
    double t = q - (from_inner ? piece->inner : piece->outer);
    double sum = 0, magnitude = 0;
    for (int i = piece->degree; i >= derivative; i--) {
        double factor = c[i] * falling_factorial(i, derivative);
        sum = sum * t + factor;
        magnitude = magnitude * fabs(t) + fabs(factor);
    }
    // Horner's error is below 2(degree + 1)u Σ|c_i||t|^i; coefficients and t carry one u each.
    return (sphv_result){sum, (3 * piece->degree + 6) * unit_roundoff * magnitude};
}

sphv_result sphv_profile_derivative(const sphv_profile *profile, int derivative, double q)
{
    if (!(q < profile->support)) return (sphv_result){0, 0};
    const sphv_piece *piece = &profile->pieces[piece_of(profile, q)];
    if (piece->degree >= 0) return polynomial_derivative(piece, derivative, q);
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
        jet[n] = polynomial_derivative(piece, n, q).value / factorial;
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
    mpq_set_si(part, 2, (unsigned long)(2 * n + 1));
    mpq_canonicalize(part);
    mpq_mul(spacing, spacing, part);
    sphv_number number = sphv_rational_number(spacing);
    mpq_clears(spacing, part, NULL);
    return number;
}

/// sup |Ŵ^(n)|/n! of a polynomial piece: the smaller of two Taylor majorants.
static void bound_polynomial(sphv_piece *piece)
{
    double length = piece->outer - piece->inner;
    for (int n = 0; n <= SPHV_JET_MAX; n++) {
        double inner = 0, outer = 0, power = 1, binomial = 1;
        for (int i = n; i <= piece->degree; i++) {
            inner += binomial * power * fabs(piece->about_inner[i]);
            outer += binomial * power * fabs(piece->about_outer[i]);
            power *= length;
            binomial *= (i + 1.0) / (i + 1 - n);
        }
        piece->derivative_bound[n] = fmin(inner, outer) * (1 + 1e-12);
    }
}

static sphv_status allocate(sphv_profile *profile, int pieces, int knots, sphv_error *error)
{
    profile->pieces = calloc((size_t)pieces, sizeof *profile->pieces);
    profile->knots = calloc((size_t)knots, sizeof *profile->knots);
    if (!profile->pieces || !profile->knots)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    return SPHV_OK;
}

/// Rounds a polynomial's coefficients, divided by `divisor`.
static double *round_polynomial(const sphv_polynomial *p, double divisor)
{
    double *c = malloc((size_t)(p->degree + 1) * sizeof *c);
    if (!c) return NULL;
    for (int i = 0; i <= p->degree; i++) c[i] = sphv_rational_round(p->coefficient[i]) / divisor;
    return c;
}

static sphv_status compile_piece(sphv_profile *profile, int index, const sphv_exact_pieces *exact,
                                 sphv_polynomial *inner, sphv_polynomial *outer, double pi,
                                 sphv_error *error)
{
    sphv_piece *piece = &profile->pieces[index];
    piece->degree = exact->polynomial[index].degree;
    piece->inner = index ? sphv_rational_round(exact->outer[index - 1]) : 0;
    piece->outer = sphv_rational_round(exact->outer[index]);
    piece->about_inner = round_polynomial(inner, pi);
    piece->about_outer = round_polynomial(outer, pi);
    piece->derivative_bound = calloc(SPHV_JET_MAX + 1, sizeof *piece->derivative_bound);
    if (!piece->about_inner || !piece->about_outer || !piece->derivative_bound)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    bound_polynomial(piece);
    return SPHV_OK;
}

/// Adds the knot whose jump is before − after (either may be NULL), unless nothing jumps there.
static sphv_status add_knot(sphv_profile *profile, const mpq_t position,
                            const sphv_polynomial *before, const sphv_polynomial *after, double pi,
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
        if (mpq_sgn(jump.coefficient[i]) != 0) order = i;
    }
    if (order >= 0) {
        sphv_knot *knot = &profile->knots[profile->knot_count];
        knot->jump = round_polynomial(&jump, pi);
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
static sphv_status add_origin(sphv_profile *profile, const sphv_polynomial *first, double pi,
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
    status = add_knot(profile, zero, &odd, NULL, pi, error);
    mpq_clear(zero);
    sphv_polynomial_free(&odd);
    return status;
}

/// Expands every piece about both its ends and collects the knots.
static sphv_status compile_pieces(sphv_profile *profile, const sphv_exact_pieces *exact, double pi,
                                  sphv_error *error)
{
    sphv_exact_pieces inner = {0}, outer = {0};
    sphv_status status = sphv_exact_pieces_copy(&inner, exact, 0, error);
    if (status == SPHV_OK) status = sphv_exact_pieces_copy(&outer, exact, 0, error);
    for (int i = 0; status == SPHV_OK && i < exact->count; i++) {
        if (i) sphv_polynomial_shift(&inner.polynomial[i], exact->outer[i - 1]);
        sphv_polynomial_shift(&outer.polynomial[i], exact->outer[i]);
        profile->piece_count = i + 1;
        status = compile_piece(profile, i, exact, &inner.polynomial[i], &outer.polynomial[i], pi,
                               error);
    }
    if (status == SPHV_OK) status = add_origin(profile, &exact->polynomial[0], pi, error);
    for (int i = 0; status == SPHV_OK && i < exact->count; i++)
        status = add_knot(profile, exact->outer[i], &outer.polynomial[i],
                          i + 1 < exact->count ? &inner.polynomial[i + 1] : NULL, pi, error);
    sphv_exact_pieces_free(&inner);
    sphv_exact_pieces_free(&outer);
    return status;
}

/// Exact moments, rounded once: the sphere's surface cancels the π of the constant.
static void exact_moments(sphv_profile *profile, const sphv_exact_pieces *pieces)
{
    int d = profile->dimension;
    mpq_t moment, factor, one;
    mpq_inits(moment, factor, one, NULL);
    mpq_set_ui(one, 1, 1);
    for (int j = 0; j <= SPHV_MOMENT_MAX; j++) {
        sphv_exact_pieces_moment(moment, pieces, 0, j + d - 1);
        mpq_set_si(factor, sphv_sphere_factor(d), 1);
        mpq_mul(moment, moment, factor);
        profile->moment[j].value = sphv_rational_round(moment);
        profile->moment[j].bound = unit_roundoff * fabs(profile->moment[j].value);
        if (j == 0) {
            mpq_sub(moment, moment, one);
            profile->excess = sphv_rational_round(moment);
        }
        sphv_exact_pieces_moment(moment, pieces, 1, j + d);
        mpq_set_si(factor, -sphv_sphere_factor(d), (unsigned long)(j + d));
        mpq_canonicalize(factor);
        mpq_mul(moment, moment, factor);
        profile->slope_moment[j].value = sphv_rational_round(moment);
        profile->slope_moment[j].bound = unit_roundoff * fabs(profile->slope_moment[j].value);
        if (j == 0) {
            mpq_sub(moment, moment, one);
            profile->slope_excess = sphv_rational_round(moment);
        }
    }
    mpq_clears(moment, factor, one, NULL);
}

static void find_boundary_smoothness(sphv_profile *profile)
{
    const sphv_knot *edge = &profile->knots[profile->knot_count - 1];
    profile->boundary_smoothness =
        profile->knot_count && edge->position.value == profile->support ? edge->order - 1 : -1;
}

sphv_status sphv_profile_from_pieces(sphv_profile *out, int dimension,
                                     const sphv_exact_pieces *pieces, const mpq_t constant,
                                     sphv_error *error)
{
    memset(out, 0, sizeof *out);
    out->dimension = dimension;
    out->support_exact = sphv_rational_number(pieces->outer[pieces->count - 1]);
    out->support = out->support_exact.value;
    double pi = sphv_sphere_pi(dimension);
    out->constant.value = sphv_rational_round(constant) / pi;
    out->constant.bound = 3 * unit_roundoff * fabs(out->constant.value);
    sphv_status status = allocate(out, pieces->count, pieces->count + 1, error);
    if (status == SPHV_OK) status = compile_pieces(out, pieces, pi, error);
    if (status == SPHV_OK) {
        exact_moments(out, pieces);
        find_boundary_smoothness(out);
    } else {
        sphv_profile_free(out);
    }
    return status;
}
