#include "candidate.h"

#include <math.h>
#include <stdlib.h>

#include "core/constant_text.h"

/// out = p^(order)(q)/order!
static void taylor(mpq_t out, const sphv_polynomial *p, int order, const mpq_t q)
{
    mpq_t term;
    mpz_t binomial;
    mpq_init(term);
    mpz_init(binomial);
    mpq_set_ui(out, 0, 1);
    for (int k = p->degree; k >= order; k--) {
        mpz_bin_uiui(binomial, (unsigned)k, (unsigned)order);
        mpq_set_z(term, binomial);
        mpq_mul(term, term, p->coefficient[k]);
        mpq_mul(out, out, q);
        mpq_add(out, out, term);
    }
    mpz_clear(binomial);
    mpq_clear(term);
}

void sphv_candidate_jump(mpq_t out, const sphv_exact_pieces *pieces, int piece, int order)
{
    mpq_t outside;
    mpq_init(outside);
    taylor(out, &pieces->polynomial[piece], order, pieces->outer[piece]);
    if (piece + 1 < pieces->count)
        taylor(outside, &pieces->polynomial[piece + 1], order, pieces->outer[piece]);
    mpq_sub(out, out, outside);
    mpq_clear(outside);
}

/// Is a jump at the outer end of a piece nothing but the rounding of long decimals?
static bool vanishes(const mpq_t jump, const sphv_exact_pieces *pieces, int piece, int order)
{
    if (mpq_sgn(jump) == 0 || pieces->rounding == 0) return mpq_sgn(jump) == 0;
    double q = mpq_get_d(pieces->outer[piece]);
    double rounding = sphv_exact_pieces_rounding(pieces, piece, order, q);
    if (piece + 1 < pieces->count)
        rounding += sphv_exact_pieces_rounding(pieces, piece + 1, order, q);
    return fabs(mpq_get_d(jump)) <= rounding;
}

static bool smooth_below(const sphv_exact_pieces *pieces, int piece, int order)
{
    mpq_t jump;
    mpq_init(jump);
    bool smooth = true;
    for (int i = 0; smooth && i < order; i++) {
        sphv_candidate_jump(jump, pieces, piece, i);
        smooth = vanishes(jump, pieces, piece, i);
    }
    mpq_clear(jump);
    return smooth;
}

double sphv_candidate_constant_rounding(const sphv_exact_pieces *pieces, int d)
{
    if (pieces->rounding == 0) return 0;
    double parts = 0, inner = 0;
    for (int i = 0; i < pieces->count; i++) {
        double outer = mpq_get_d(pieces->outer[i]);
        for (int k = 0; k <= pieces->polynomial[i].degree; k++)
            parts += fabs(mpq_get_d(pieces->polynomial[i].coefficient[k])) *
                     (pow(outer, k + d) - pow(inner, k + d)) / (k + d);
        // An end that is rounded moves the integral by its own uncertainty.
        parts += fabs(mpq_get_d(pieces->polynomial[0].coefficient[0])) * pow(outer, d);
        inner = outer;
    }
    mpq_t integral;
    mpq_init(integral);
    sphv_exact_pieces_moment(integral, pieces, 0, d - 1);
    double whole = fabs(mpq_get_d(integral));
    mpq_clear(integral);
    return pieces->rounding * parts / whole;
}

static bool constant_fits(const sphv_kernel *kernel, const sphv_exact_pieces *pieces, int d)
{
    sphv_error unused;
    long double claimed;
    if (sphv_constant_parse(kernel->claims.constant[d - 1], &claimed, &unused) != SPHV_OK)
        return false;
    mpq_t integral, a, part;
    mpq_inits(integral, a, part, NULL);
    sphv_exact_pieces_moment(integral, pieces, 0, d - 1);
    if (kernel->fourth_order) {
        // ∫w(1 − a q²) with a = μ_2/μ_4.
        sphv_exact_pieces_moment(a, pieces, 0, d + 1);
        sphv_exact_pieces_moment(part, pieces, 0, d + 3);
        mpq_mul(a, a, a);
        if (mpq_sgn(part) != 0) mpq_div(a, a, part);
        mpq_sub(integral, integral, a);
    }
    double found = 1 / (sphv_rational_round(integral) * sphv_sphere_factor(d) * sphv_sphere_pi(d));
    mpq_clears(integral, a, part, NULL);
    return fabs((double)(claimed / (long double)found - 1)) <
           1e-13 + sphv_candidate_constant_rounding(pieces, d);
}

bool sphv_candidate_fits(const sphv_kernel *kernel, const sphv_exact_pieces *pieces, int *suspect)
{
    const int *beta = kernel->claims.boundary_smoothness;
    int edge = beta && *beta >= 0 && *beta <= SPHV_DEGREE_MAX ? *beta + 1 : 2;
    int inside = edge < 2 ? edge : 2, last = pieces->count - 1, first = *suspect;
    if (first <= last && !smooth_below(pieces, first, first < last ? inside : edge)) return false;
    for (int i = 0; i <= last; i++)
        if (!smooth_below(pieces, i, i < last ? inside : edge)) {
            *suspect = i;
            return false;
        }
    if (beta && smooth_below(pieces, last, edge + 1)) return false;
    for (int d = 1; d <= SPHV_DIMENSIONS; d++)
        if (kernel->claims.constant[d - 1] && kernel->declared[d - 1] &&
            !constant_fits(kernel, pieces, d))
            return false;
    return true;
}
