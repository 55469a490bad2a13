/// Slips in single coefficients and in their list.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "slips.h"

/// Names a coefficient: `q^2` of a one-piece kernel, `q^2 in piece 1` otherwise.
static void place_text(const struct sphv_search *search, int piece, int k, char *text, size_t size)
{
    if (search->trial.count > 1)
        snprintf(text, size, "q^%d in piece %d", k, piece + 1);
    else
        snprintf(text, size, "q^%d", k);
}

bool sphv_try_swaps(struct sphv_search *search)
{
    for (int i = 0; i < search->trial.count; i++)
        for (int k = 0; k < sphv_search_terms(search, i); k++)
            for (int m = k + 1; m < sphv_search_terms(search, i); m++) {
                mpq_t *a = sphv_search_coefficient(search, i, k),
                      *b = sphv_search_coefficient(search, i, m);
                if (mpq_equal(*a, *b)) continue;
                mpq_swap(*a, *b);
                if (sphv_search_fits(search)) {
                    snprintf(search->text, search->size,
                             "two coefficients are swapped: those of q^%d and q^%d%s%.0d", k, m,
                             search->trial.count > 1 ? " in piece " : "",
                             search->trial.count > 1 ? i + 1 : 0);
                    return true;
                }
                mpq_swap(*a, *b);
            }
    return false;
}

bool sphv_try_signs(struct sphv_search *search)
{
    char place[40];
    for (int i = 0; i < search->trial.count; i++)
        for (int k = 0; k < sphv_search_terms(search, i); k++) {
            mpq_t *c = sphv_search_coefficient(search, i, k);
            if (mpq_sgn(*c) == 0) continue;
            mpq_neg(*c, *c);
            if (sphv_search_fits(search)) {
                place_text(search, i, k, place, sizeof place);
                snprintf(search->text, search->size, "the sign of the coefficient of %s is flipped",
                         place);
                return true;
            }
            mpq_neg(*c, *c);
        }
    return false;
}

/// One coefficient wrong: continuity of the value at either end of its piece says what it must be.
static bool try_coefficient(struct sphv_search *search, int i, int k)
{
    mpq_t jump, power, was;
    mpq_inits(jump, power, was, NULL);
    mpq_t *c = sphv_search_coefficient(search, i, k);
    bool found = false;
    mpq_set(was, *c);
    for (int end = i > 0 && k >= 0 ? 0 : 1; !found && end < 2; end++) {
        int knot = end ? i : i - 1;
        sphv_candidate_jump(jump, &search->trial, knot, 0);
        if (mpq_sgn(jump) == 0) continue;
        sphv_rational_power(power, search->trial.outer[knot], k);
        mpq_div(jump, jump, power);
        if (end)
            mpq_sub(*c, was, jump);
        else
            mpq_add(*c, was, jump);
        found = sphv_search_fits(search);
        if (found) {
            char place[40], given[48], needed[48];
            place_text(search, i, k, place, sizeof place);
            sphv_search_number(was, given, sizeof given);
            sphv_search_number(*c, needed, sizeof needed);
            snprintf(search->text, search->size,
                     "the coefficient of %s is wrong: %s in the file, %s would fit", place, given,
                     needed);
        } else {
            mpq_set(*c, was);
        }
    }
    mpq_clears(jump, power, was, NULL);
    return found;
}

bool sphv_try_coefficients(struct sphv_search *search)
{
    for (int i = 0; i < search->trial.count; i++)
        for (int k = 0; k < sphv_search_terms(search, i); k++)
            if (try_coefficient(search, i, k)) return true;
    return false;
}

/// A zero left out or one too many: the powers from there on are off by one.
bool sphv_try_shifts(struct sphv_search *search)
{
    for (int i = 0; i < search->trial.count; i++) {
        sphv_polynomial *p = &search->trial.polynomial[i], given = *p;
        if (given.degree + 1 > SPHV_DEGREE_MAX) continue;
        for (int gap = 0; gap <= given.degree; gap++)
            for (int insert = 1; insert >= 0; insert--) {
                if (!insert && (given.degree == 0 || mpq_sgn(given.coefficient[gap]) != 0))
                    continue;
                sphv_polynomial shifted;
                int degree = given.degree + (insert ? 1 : -1);
                if (sphv_polynomial_make(&shifted, degree, NULL) != SPHV_OK) return false;
                for (int k = 0; k <= degree; k++) {
                    int from = insert ? (k < gap ? k : k - 1) : (k < gap ? k : k + 1);
                    if (insert && k == gap) continue;
                    mpq_set(shifted.coefficient[k], given.coefficient[from]);
                }
                *p = shifted;
                bool found = sphv_search_fits(search);
                *p = given;
                sphv_polynomial_free(&shifted);
                if (!found) continue;
                if (insert)
                    snprintf(search->text, search->size,
                             "piece %d: the coefficient of q^%d is left out, so that all further "
                             "ones stand one power too low",
                             i + 1, gap);
                else
                    snprintf(search->text, search->size,
                             "piece %d: one zero too many at q^%d, so that all further ones stand "
                             "one power too high",
                             i + 1, gap);
                return true;
            }
    }
    return false;
}

/// The rational of least denominator within a relative tolerance (continued fraction).
static void simplest(mpq_t out, const mpq_t value, double tolerance)
{
    mpz_t p0, q0, p1, q1, a, rest;
    mpq_t x, difference;
    mpz_inits(p0, q0, p1, q1, a, rest, NULL);
    mpq_inits(x, difference, NULL);
    mpz_set_ui(p1, 1);
    mpz_set_ui(q0, 1);
    mpq_set(x, value);
    for (int round = 0; round < 40; round++) {
        mpz_fdiv_qr(a, rest, mpq_numref(x), mpq_denref(x));
        mpz_addmul(p0, a, p1);
        mpz_swap(p0, p1);
        mpz_addmul(q0, a, q1);
        mpz_swap(q0, q1);
        mpz_set(mpq_numref(out), p1);
        mpz_set(mpq_denref(out), q1);
        mpq_sub(difference, out, value);
        if (mpz_sgn(rest) == 0 || fabs(mpq_get_d(difference)) <= tolerance * fabs(mpq_get_d(value)))
            break;
        mpz_set(mpq_numref(difference), rest);
        mpz_set(mpq_denref(difference), mpq_denref(x));
        mpq_inv(x, difference);
    }
    mpz_clears(p0, q0, p1, q1, a, rest, NULL);
    mpq_clears(x, difference, NULL);
}

static bool is_float(const mpq_t value)
{
    double x = sphv_rational_round(value);
    mpq_t back;
    mpq_init(back);
    mpq_set_d(back, x);
    bool exact = mpq_equal(back, value) != 0 && x == (double)(float)x;
    mpq_clear(back);
    return exact;
}

/// Coefficients that were rounded: replace each by the simplest rational near it.
bool sphv_try_rounding(struct sphv_search *search)
{
    static const double tolerances[] = {1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 5e-3};
    const sphv_exact_pieces *given = &search->kernel->pieces;
    for (size_t t = 0; t < sizeof tolerances / sizeof *tolerances; t++) {
        bool changed = false, single = true;
        for (int i = 0; i < given->count; i++)
            for (int k = 0; k < sphv_search_terms(search, i); k++) {
                const mpq_t *from = (const mpq_t *)&given->polynomial[i].coefficient[k];
                mpq_t *to = sphv_search_coefficient(search, i, k);
                simplest(*to, *from, tolerances[t]);
                if (mpq_equal(*to, *from)) continue;
                changed = true;
                single = single && is_float(*from);
            }
        if (changed && sphv_search_fits(search)) {
            snprintf(search->text, search->size, "the coefficients are rounded %s",
                     single && t < 1 ? "to single precision"
                                     : "to a few digits; write them as exact fractions");
            return true;
        }
    }
    sphv_search_reset(search);
    return false;
}
