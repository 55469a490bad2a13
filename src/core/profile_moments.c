/// Moments of polynomial pieces, in floating point wide enough that one rounding is left.
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "profile.h"

enum {
    BITS = 1024,  ///< of the working precision
    TRUSTED = 900 ///< bits below the largest term at which a sum counts as zero
};

/// Everything that the sums run over.
struct pieces {
    int count, degree, powers;
    mpf_t *power;       ///< [i * powers + e]: e-th power of the i-th end, 0 at the origin
    mpf_t *volume;      ///< [i * powers + e]: S ∫ q^(e − 1) dq over the i-th piece, e >= 1
    mpf_t scale;        ///< common denominator of the coefficients
    mpf_t *coefficient; ///< [i * (degree + 1) + k], times the scale: short, being whole numbers
    mpf_t *jump;        ///< [i]: w(q_i−) − w(q_i+), times the scale
    bool continuous;
};

static mpf_t *numbers(size_t count)
{
    mpf_t *made = malloc(count * sizeof *made);
    for (size_t i = 0; made && i < count; i++) mpf_init2(made[i], BITS);
    return made;
}

static void release(mpf_t *made, size_t count)
{
    for (size_t i = 0; made && i < count; i++) mpf_clear(made[i]);
    free(made);
}

static size_t power_count(const struct pieces *of)
{
    return (size_t)(of->count + 1) * (size_t)of->powers;
}

static size_t volume_count(const struct pieces *of)
{
    return (size_t)of->count * (size_t)of->powers;
}

static size_t coefficient_count(const struct pieces *of)
{
    return (size_t)of->count * (size_t)(of->degree + 1);
}

static void pieces_free(struct pieces *of)
{
    release(of->power, power_count(of));
    release(of->volume, volume_count(of));
    release(of->coefficient, coefficient_count(of));
    release(of->jump, (size_t)of->count);
    mpf_clear(of->scale);
}

static void find_jumps(struct pieces *of, const sphv_exact_pieces *exact)
{
    mpq_t jump, after;
    mpq_inits(jump, after, NULL);
    of->continuous = true;
    for (int i = 0; i < of->count; i++) {
        sphv_polynomial_value(jump, &exact->polynomial[i], exact->outer[i]);
        if (i + 1 < of->count) {
            sphv_polynomial_value(after, &exact->polynomial[i + 1], exact->outer[i]);
            mpq_sub(jump, jump, after);
        }
        mpf_set_q(of->jump[i], jump);
        mpf_mul(of->jump[i], of->jump[i], of->scale);
        of->continuous = of->continuous && mpq_sgn(jump) == 0;
    }
    mpq_clears(jump, after, NULL);
}

static void find_coefficients(struct pieces *of, const sphv_exact_pieces *exact)
{
    mpz_t scale, whole;
    mpz_init_set_ui(scale, 1);
    mpz_init(whole);
    for (int i = 0; i < of->count; i++)
        for (int k = 0; k <= exact->polynomial[i].degree; k++)
            mpz_lcm(scale, scale, mpq_denref(exact->polynomial[i].coefficient[k]));
    mpf_set_z(of->scale, scale);
    for (int i = 0; i < of->count; i++)
        for (int k = 0; k <= exact->polynomial[i].degree; k++) {
            mpq_t *coefficient = &exact->polynomial[i].coefficient[k];
            mpz_divexact(whole, scale, mpq_denref(*coefficient));
            mpz_mul(whole, whole, mpq_numref(*coefficient));
            mpf_set_z(of->coefficient[i * (of->degree + 1) + k], whole);
        }
    mpz_clears(scale, whole, NULL);
}

/// S (q_i^e − q_{i−1}^e)/e
static void find_volumes(struct pieces *of, int dimension)
{
    unsigned long surface = (unsigned long)sphv_sphere_factor(dimension);
    for (int i = 0; i < of->count; i++) {
        mpf_t *volume = of->volume + (size_t)i * (size_t)of->powers;
        const mpf_t *inner = (const mpf_t *)of->power + (size_t)i * (size_t)of->powers;
        const mpf_t *outer = inner + of->powers;
        for (int e = 1; e < of->powers; e++) {
            mpf_sub(volume[e], outer[e], inner[e]);
            mpf_mul_ui(volume[e], volume[e], surface);
            mpf_div_ui(volume[e], volume[e], (unsigned long)e);
        }
    }
}

static bool pieces_make(struct pieces *of, const sphv_exact_pieces *exact, int dimension)
{
    *of = (struct pieces){.count = exact->count};
    mpf_init2(of->scale, BITS);
    for (int i = 0; i < exact->count; i++)
        if (exact->polynomial[i].degree > of->degree) of->degree = exact->polynomial[i].degree;
    of->powers = SPHV_MOMENT_MAX + dimension + of->degree + 1;
    of->power = numbers(power_count(of));
    of->volume = numbers(volume_count(of));
    of->coefficient = numbers(coefficient_count(of));
    of->jump = numbers((size_t)of->count);
    if (!of->power || !of->volume || !of->coefficient || !of->jump) return false;
    for (int i = 0; i <= of->count; i++) {
        mpf_t *power = of->power + (size_t)i * (size_t)of->powers;
        mpf_set_ui(power[0], 1);
        if (i > 0) mpf_set_q(power[1], exact->outer[i - 1]);
        for (int e = 2; i > 0 && e < of->powers; e++) mpf_mul(power[e], power[e - 1], power[1]);
    }
    find_volumes(of, dimension);
    find_coefficients(of, exact);
    find_jumps(of, exact);
    return true;
}

/// A sum and the sum of its terms' moduli.
struct total {
    mpf_t sum, size, part;
};

static void add_part(struct total *total)
{
    mpf_add(total->sum, total->sum, total->part);
    mpf_abs(total->part, total->part);
    mpf_add(total->size, total->size, total->part);
}

/// The double nearest to the sum, 0 where it is nothing but rounding.
static sphv_result conclude(struct total *total)
{
    mpf_div_2exp(total->part, total->size, TRUSTED);
    mpf_abs(total->size, total->sum);
    if (mpf_cmp(total->size, total->part) <= 0) return (sphv_result){0, mpf_get_d(total->part)};
    double high = mpf_get_d(total->sum), low = 0;
    if (isfinite(high)) {
        mpf_set_d(total->part, high);
        mpf_sub(total->part, total->sum, total->part);
        low = mpf_get_d(total->part);
    }
    double value = high + low;
    return (sphv_result){value, DBL_EPSILON / 2 * (1 + 0x1p-40) * fabs(value)};
}

/// Σ_pieces Σ_k c_k S (q_i^e − q_{i−1}^e)/e, e = k + j + d, less, for the slope moment,
/// S Σ jumps of w · q^(j+d)/(j+d): by parts, −∫q^(j+d) w′ dq/(j+d).
static sphv_result moment(const struct pieces *of, int j, int dimension, bool slope,
                          struct total *total)
{
    unsigned long surface = (unsigned long)sphv_sphere_factor(dimension);
    mpf_set_ui(total->sum, 0);
    mpf_set_ui(total->size, 0);
    for (int i = 0; i < of->count; i++) {
        const mpf_t *volume = (const mpf_t *)of->volume + (size_t)i * (size_t)of->powers;
        const mpf_t *coefficient =
            (const mpf_t *)of->coefficient + (size_t)i * (size_t)(of->degree + 1);
        for (int k = 0; k <= of->degree; k++) {
            if (mpf_sgn(coefficient[k]) == 0) continue;
            mpf_mul(total->part, volume[k + j + dimension], coefficient[k]);
            add_part(total);
        }
        if (!slope) continue;
        const mpf_t *outer = (const mpf_t *)of->power + (size_t)(i + 1) * (size_t)of->powers;
        mpf_mul(total->part, outer[j + dimension], of->jump[i]);
        mpf_mul_ui(total->part, total->part, surface);
        mpf_div_ui(total->part, total->part, (unsigned long)j + (unsigned long)dimension);
        mpf_neg(total->part, total->part);
        add_part(total);
    }
    mpf_div(total->sum, total->sum, of->scale);
    mpf_div(total->size, total->size, of->scale);
    return conclude(total);
}

/// The zeroth moment less 1.
static double excess(const struct pieces *of, int dimension, bool slope, struct total *total)
{
    (void)moment(of, 0, dimension, slope, total);
    mpf_set_ui(total->size, 1);
    mpf_sub(total->sum, total->sum, total->size);
    return conclude(total).value;
}

sphv_status sphv_profile_moments(sphv_profile *profile, const sphv_exact_pieces *exact,
                                 sphv_error *error)
{
    struct pieces pieces;
    if (!pieces_make(&pieces, exact, profile->dimension)) {
        pieces_free(&pieces);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    struct total total;
    mpf_init2(total.sum, BITS);
    mpf_init2(total.size, BITS);
    mpf_init2(total.part, BITS);
    int d = profile->dimension;
    for (int j = 0; j <= SPHV_MOMENT_MAX; j++) {
        profile->moment[j] = moment(&pieces, j, d, false, &total);
        profile->slope_moment[j] =
            pieces.continuous ? profile->moment[j] : moment(&pieces, j, d, true, &total);
    }
    profile->excess = excess(&pieces, d, false, &total);
    profile->slope_excess = excess(&pieces, d, true, &total);
    mpf_clears(total.sum, total.size, total.part, NULL);
    pieces_free(&pieces);
    return SPHV_OK;
}
