/// Monotone decrease and sign, decided exactly for polynomials and by sampling in floating point.
#include <math.h>
#include <stdlib.h>

#include "check_internal.h"

/// What an exact examination of a sign found.
struct sign {
    bool positive; ///< somewhere above zero
    double at;     ///< a place where it is
};

enum { DEPTH_MAX = 24, SAMPLES = 4096 };

/// Bernstein coefficients on [0, 1] of a polynomial in powers of t, in place.
static void to_bernstein(mpq_t *c, int degree)
{
    // b_k = Σ_i C(k,i)/C(n,i) a_i: divide by C(n,i), then repeated sums.
    mpq_t binomial;
    mpz_t number;
    mpq_init(binomial);
    mpz_init(number);
    for (int i = 0; i <= degree; i++) {
        mpz_bin_uiui(number, (unsigned)degree, (unsigned)i);
        mpq_set_z(binomial, number);
        mpq_div(c[i], c[i], binomial);
    }
    for (int round = 1; round <= degree; round++)
        for (int k = degree; k >= round; k--) mpq_add(c[k], c[k], c[k - 1]);
    mpz_clear(number);
    mpq_clear(binomial);
}

/// Halves an interval by de Casteljau: `c` keeps the left half, `right` receives the right one.
static void halve(mpq_t *c, mpq_t *right, int degree)
{
    for (int k = 0; k <= degree; k++) mpq_set(right[k], c[k]);
    for (int round = 1; round <= degree; round++) {
        mpq_set(c[round - 1], right[0]);
        for (int k = 0; k <= degree - round; k++) {
            mpq_add(right[k], right[k], right[k + 1]);
            mpq_div_2exp(right[k], right[k], 1);
        }
    }
    mpq_set(c[degree], right[0]);
}

/// Is the polynomial above zero anywhere on the interval? Its ends' values are exact; between
/// them it lies in the hull of the coefficients.
static void search(mpq_t *c, int degree, double from, double to, int depth, struct sign *sign)
{
    bool hull_positive = false;
    for (int k = 0; k <= degree; k++) hull_positive |= mpq_sgn(c[k]) > 0;
    if (!hull_positive || sign->positive) return;
    if (mpq_sgn(c[0]) > 0 || mpq_sgn(c[degree]) > 0) {
        sign->positive = true;
        sign->at = mpq_sgn(c[0]) > 0 ? from : to;
        return;
    }
    if (depth == DEPTH_MAX) return; // a touching zero: above zero nowhere that matters
    mpq_t right[SPHV_DEGREE_MAX + 3];
    for (int k = 0; k <= degree; k++) mpq_init(right[k]);
    halve(c, right, degree);
    double middle = 0.5 * (from + to);
    search(c, degree, from, middle, depth + 1, sign);
    search(right, degree, middle, to, depth + 1, sign);
    for (int k = 0; k <= degree; k++) mpq_clear(right[k]);
}

/// Examines factor · d^order w/dq^order over all pieces.
static struct sign examine_exactly(const sphv_exact_pieces *pieces, int order, int factor)
{
    struct sign sign = {false, 0};
    mpq_t from, length, power, number;
    mpq_inits(from, length, power, number, NULL);
    for (int i = 0; i < pieces->count && !sign.positive; i++) {
        const sphv_polynomial *p = &pieces->polynomial[i];
        mpq_sub(length, pieces->outer[i], from);
        sphv_polynomial shifted;
        if (sphv_polynomial_make(&shifted, p->degree, NULL) != SPHV_OK) break;
        for (int k = 0; k <= p->degree; k++) mpq_set(shifted.coefficient[k], p->coefficient[k]);
        sphv_polynomial_shift(&shifted, from);
        int degree = p->degree - order;
        mpq_set_si(power, factor, 1);
        for (int k = 0; k <= degree; k++) {
            mpq_set_si(number, order ? k + 1 : 1, 1);
            mpq_mul(shifted.coefficient[k], shifted.coefficient[k + order], number);
            mpq_mul(shifted.coefficient[k], shifted.coefficient[k], power);
            mpq_mul(power, power, length);
        }
        if (degree >= 0) {
            // Less than what the rounding of long decimals makes of it is no violation.
            double rounding =
                sphv_exact_pieces_rounding(pieces, i, order, mpq_get_d(pieces->outer[i]));
            mpq_set_d(number, rounding);
            mpq_sub(shifted.coefficient[0], shifted.coefficient[0], number);
            to_bernstein(shifted.coefficient, degree);
            search(shifted.coefficient, degree, mpq_get_d(from), mpq_get_d(pieces->outer[i]), 0,
                   &sign);
        }
        sphv_polynomial_free(&shifted);
        mpq_set(from, pieces->outer[i]);
    }
    mpq_clears(from, length, power, number, NULL);
    return sign;
}

/// The same by evaluation at many places, beyond the rounding bound of each.
static struct sign examine_samples(const sphv_kernel *kernel, const sphv_profile *profile,
                                   int order, int factor)
{
    int piece = 0;
    for (int i = 0; i < SAMPLES; i++) {
        double q = profile->support * (i + 0.5) / SAMPLES, rounding = 0;
        while (piece + 1 < profile->piece_count && q >= profile->pieces[piece].outer) piece++;
        if (kernel->polynomial)
            rounding =
                sphv_exact_pieces_rounding(&kernel->exact[profile->dimension - 1], piece, order, q);
        sphv_result value = sphv_profile_derivative(profile, order, q);
        if (factor * value.value > value.bound + rounding) return (struct sign){true, q};
    }
    return (struct sign){false, 0};
}

/// Closed forms have no exact route; a finite difference of the value stands beside the derivative.
static struct sign examine_differences(const sphv_profile *profile, int order, int factor)
{
    sphv_result last = sphv_profile_derivative(profile, 0, 0);
    for (int i = 1; i < SAMPLES; i++) {
        double q = profile->support * i / SAMPLES;
        sphv_result value = sphv_profile_derivative(profile, 0, q);
        double rise = order ? value.value - last.value : value.value;
        if (factor * rise > value.bound + (order ? last.bound : 0)) return (struct sign){true, q};
        last = value;
    }
    return (struct sign){false, 0};
}

/// `order`th derivative times `factor` must nowhere be positive, if that is what is claimed.
static sphv_status examine(sphv_examination *of, int dimension, const char *id, const int *claim,
                           int order, int factor, const char *property, const char *violation,
                           sphv_error *error)
{
    sphv_check_result *result =
        sphv_check_add(of, id, sphv_check_shape_dimension(of, dimension), error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    const sphv_profile *profile = sphv_check_profile(of, dimension);
    struct sign exact =
        of->kernel->polynomial
            ? examine_exactly(&of->kernel->exact[profile->dimension - 1], order, factor)
            : examine_differences(profile, order, factor);
    struct sign measured = examine_samples(of->kernel, profile, order, factor);
    // A violation narrower than the samples, or below their rounding, is looked at where it is.
    if (exact.positive && !measured.positive) {
        double q = fmin(fmax(exact.at, 0), nextafter(profile->support, 0));
        sphv_result value = sphv_profile_derivative(profile, order, q);
        measured.positive = factor * value.value > -value.bound;
    }
    sphv_check_numbers(result, !exact.positive, !measured.positive, 0);
    result->informative = !claim;
    if (claim) {
        result->claimed = *claim;
        sphv_check_claim(result, "%s: %s (1 yes, 0 no)", property, *claim ? "yes" : "no");
        if (*claim == exact.positive) {
            sphv_check_fail(result);
            if (exact.positive)
                sphv_check_cause(result, "%s at q = %.6g", violation, exact.at);
            else
                sphv_check_cause(result, "the file says it is not, but it is");
            sphv_check_name_shape_cause(of, result);
        }
    } else {
        sphv_check_claim(result, "is it %s? (1 yes, 0 no)", property);
        if (exact.positive) sphv_check_cause(result, "%s at q = %.6g", violation, exact.at);
    }
    return SPHV_OK;
}

sphv_status sphv_check_monotone(sphv_examination *of, int dimension, sphv_error *error)
{
    return examine(of, dimension, "monotone", of->kernel->claims.monotone, 1, 1,
                   "nowhere increasing", "w increases", error);
}

sphv_status sphv_check_sign(sphv_examination *of, int dimension, sphv_error *error)
{
    return examine(of, dimension, "sign", of->kernel->claims.non_negative, 0, -1,
                   "nowhere negative", "w is negative", error);
}
