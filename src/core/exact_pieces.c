#include <math.h>
#include <stdlib.h>

#include "profile.h"

int sphv_sphere_factor(int dimension)
{
    return dimension == 3 ? 4 : 2;
}

double sphv_sphere_pi(int dimension)
{
    return dimension > 1 ? 3.14159265358979323846 : 1;
}

sphv_status sphv_exact_pieces_make(sphv_exact_pieces *pieces, int count, sphv_error *error)
{
    pieces->count = 0;
    pieces->rounding = 0;
    pieces->outer = malloc((size_t)count * sizeof *pieces->outer);
    pieces->polynomial = calloc((size_t)count, sizeof *pieces->polynomial);
    if (!pieces->outer || !pieces->polynomial) {
        free(pieces->outer);
        free(pieces->polynomial);
        pieces->outer = NULL;
        pieces->polynomial = NULL;
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    for (int i = 0; i < count; i++) mpq_init(pieces->outer[i]);
    pieces->count = count;
    return SPHV_OK;
}

sphv_status sphv_exact_pieces_copy(sphv_exact_pieces *to, const sphv_exact_pieces *from,
                                   int extra_degree, sphv_error *error)
{
    sphv_status status = sphv_exact_pieces_make(to, from->count, error);
    to->rounding = from->rounding;
    for (int i = 0; status == SPHV_OK && i < from->count; i++) {
        const sphv_polynomial *p = &from->polynomial[i];
        mpq_set(to->outer[i], from->outer[i]);
        status = sphv_polynomial_make(&to->polynomial[i], p->degree + extra_degree, error);
        for (int k = 0; status == SPHV_OK && k <= p->degree; k++)
            mpq_set(to->polynomial[i].coefficient[k], p->coefficient[k]);
    }
    if (status != SPHV_OK) sphv_exact_pieces_free(to);
    return status;
}

void sphv_exact_pieces_free(sphv_exact_pieces *pieces)
{
    for (int i = 0; i < pieces->count; i++) {
        mpq_clear(pieces->outer[i]);
        sphv_polynomial_free(&pieces->polynomial[i]);
    }
    free(pieces->outer);
    free(pieces->polynomial);
    *pieces = (sphv_exact_pieces){0, NULL, NULL, 0};
}

double sphv_exact_pieces_rounding(const sphv_exact_pieces *pieces, int piece, int order, double q)
{
    if (pieces->rounding == 0) return 0;
    const sphv_polynomial *p = &pieces->polynomial[piece];
    double sum = 0, binomial = 1, power = 1;
    for (int k = order; k <= p->degree; k++) {
        sum += fabs(mpq_get_d(p->coefficient[k])) * binomial * power;
        binomial *= (k + 1.0) / (k + 1 - order);
        power *= q;
    }
    return pieces->rounding * sum;
}

/// Bits of the least common multiple with another denominator.
static size_t grow(mpz_t common, const mpq_t value)
{
    mpz_lcm(common, common, mpq_denref(value));
    return mpz_sizeinbase(common, 2);
}

bool sphv_exact_pieces_manageable(const sphv_exact_pieces *pieces)
{
    enum { BITS = 4000 };
    mpz_t coefficients, ends;
    mpz_init_set_ui(coefficients, 1);
    mpz_init_set_ui(ends, 1);
    size_t bits = 0;
    int degree = 0;
    for (int i = 0; bits <= BITS && i < pieces->count; i++) {
        const sphv_polynomial *p = &pieces->polynomial[i];
        if (p->degree > degree) degree = p->degree;
        bits = grow(ends, pieces->outer[i]) * (size_t)(degree + SPHV_DIMENSIONS + 2);
        for (int k = 0; bits <= BITS && k <= p->degree; k++)
            if (grow(coefficients, p->coefficient[k]) > BITS) bits = BITS + 1;
    }
    bits += mpz_sizeinbase(coefficients, 2);
    mpz_clear(coefficients);
    mpz_clear(ends);
    return bits <= BITS;
}

void sphv_exact_pieces_scale(sphv_exact_pieces *pieces, const mpq_t factor)
{
    for (int i = 0; i < pieces->count; i++)
        for (int k = 0; k <= pieces->polynomial[i].degree; k++)
            mpq_mul(pieces->polynomial[i].coefficient[k], pieces->polynomial[i].coefficient[k],
                    factor);
}

void sphv_exact_pieces_transform(sphv_exact_pieces *pieces, const mpq_t a)
{
    mpq_t product;
    mpq_init(product);
    for (int i = 0; i < pieces->count; i++) {
        sphv_polynomial *p = &pieces->polynomial[i];
        for (int k = p->degree; k >= 2; k--) {
            mpq_mul(product, a, p->coefficient[k - 2]);
            mpq_sub(p->coefficient[k], p->coefficient[k], product);
        }
    }
    mpq_clear(product);
}

void sphv_exact_pieces_moment(mpq_t out, const sphv_exact_pieces *pieces, int order, int power)
{
    mpq_t part, zero;
    mpq_inits(part, zero, NULL);
    mpq_set_ui(out, 0, 1);
    for (int i = 0; i < pieces->count; i++) {
        if (i)
            sphv_polynomial_moment(part, &pieces->polynomial[i], order, power, pieces->outer[i - 1],
                                   pieces->outer[i]);
        else
            sphv_polynomial_moment(part, &pieces->polynomial[i], order, power, zero,
                                   pieces->outer[i]);
        mpq_add(out, out, part);
    }
    mpq_clears(part, zero, NULL);
}
