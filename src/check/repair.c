/// A search for the mistake in a kernel's pieces: undo one likely slip after another until the
/// kernel meets its own claims and what every kernel must meet. Exact arithmetic, so a repair that
/// fits does so to the last digit.
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "candidate.h"

/// The search: the file's pieces, a copy to try on, and the words for what fitted.
struct search {
    const sphv_kernel *kernel;
    sphv_exact_pieces trial;
    char *text;
    size_t size;
    int suspect; ///< the knot at which the last candidate failed, looked at first
    int tries;
};

/// A file of 32 pieces of degree 40 has millions of candidates; so many are tried.
enum { TRIES_MAX = 20000 };

static bool fits(struct search *search)
{
    return ++search->tries <= TRIES_MAX &&
           sphv_candidate_fits(search->kernel, &search->trial, &search->suspect);
}

static int terms(const struct search *search, int piece)
{
    return search->trial.polynomial[piece].degree + 1;
}

static mpq_t *coefficient(struct search *search, int piece, int k)
{
    return &search->trial.polynomial[piece].coefficient[k];
}

/// Names a coefficient: `q^2` of a one-piece kernel, `q^2 in piece 1` otherwise.
static void place_text(const struct search *search, int piece, int k, char *text, size_t size)
{
    if (search->trial.count > 1)
        snprintf(text, size, "q^%d in piece %d", k, piece + 1);
    else
        snprintf(text, size, "q^%d", k);
}

static void number_text(const mpq_t value, char *text, size_t size)
{
    // Short rationals as such, others as decimals.
    if (mpz_sizeinbase(mpq_numref(value), 10) + mpz_sizeinbase(mpq_denref(value), 10) < 24)
        gmp_snprintf(text, size, "%Qd", value);
    else
        snprintf(text, size, "%.15g", sphv_rational_round(value));
}

static bool try_swaps(struct search *search)
{
    for (int i = 0; i < search->trial.count; i++)
        for (int k = 0; k < terms(search, i); k++)
            for (int m = k + 1; m < terms(search, i); m++) {
                mpq_t *a = coefficient(search, i, k), *b = coefficient(search, i, m);
                if (mpq_equal(*a, *b)) continue;
                mpq_swap(*a, *b);
                if (fits(search)) {
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

static bool try_signs(struct search *search)
{
    char place[40];
    for (int i = 0; i < search->trial.count; i++)
        for (int k = 0; k < terms(search, i); k++) {
            mpq_t *c = coefficient(search, i, k);
            if (mpq_sgn(*c) == 0) continue;
            mpq_neg(*c, *c);
            if (fits(search)) {
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
static bool try_coefficient(struct search *search, int i, int k)
{
    mpq_t jump, power, was;
    mpq_inits(jump, power, was, NULL);
    mpq_t *c = coefficient(search, i, k);
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
        found = fits(search);
        if (found) {
            char place[40], given[48], needed[48];
            place_text(search, i, k, place, sizeof place);
            number_text(was, given, sizeof given);
            number_text(*c, needed, sizeof needed);
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

static bool try_coefficients(struct search *search)
{
    for (int i = 0; i < search->trial.count; i++)
        for (int k = 0; k < terms(search, i); k++)
            if (try_coefficient(search, i, k)) return true;
    return false;
}

/// A zero left out or one too many: the powers from there on are off by one.
static bool try_shifts(struct search *search)
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
                bool found = fits(search);
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

static bool try_piece_swaps(struct search *search)
{
    for (int i = 0; i < search->trial.count; i++)
        for (int j = i + 1; j < search->trial.count; j++) {
            sphv_polynomial *a = &search->trial.polynomial[i], *b = &search->trial.polynomial[j];
            sphv_polynomial kept = *a;
            *a = *b;
            *b = kept;
            if (fits(search)) {
                snprintf(search->text, search->size, "pieces %d and %d are swapped", i + 1, j + 1);
                return true;
            }
            *b = *a;
            *a = kept;
        }
    return false;
}

static bool try_knots(struct search *search)
{
    static const int parts[] = {1, 2, 3, 4, 5, 6, 8, 10, 12};
    mpq_t was, knot;
    mpq_inits(was, knot, NULL);
    bool found = false;
    for (int i = 0; !found && i + 1 < search->trial.count; i++) {
        mpq_set(was, search->trial.outer[i]);
        double from = i ? mpq_get_d(search->trial.outer[i - 1]) : 0;
        double to = mpq_get_d(search->trial.outer[i + 1]);
        for (size_t p = 0; !found && p < sizeof parts / sizeof *parts; p++)
            for (int n = 1; !found && n < to * parts[p] && n < 200; n++) {
                if (n <= from * parts[p]) continue;
                mpq_set_si(knot, n, (unsigned)parts[p]);
                mpq_canonicalize(knot);
                if (mpq_equal(knot, was)) continue;
                mpq_set(search->trial.outer[i], knot);
                found = fits(search);
            }
        if (found) {
            char place[48], given[48];
            number_text(knot, place, sizeof place);
            number_text(was, given, sizeof given);
            snprintf(search->text, search->size,
                     "a knot is moved: piece %d ends at %s in the file, at %s it would fit", i + 1,
                     given, place);
        } else {
            mpq_set(search->trial.outer[i], was);
        }
    }
    mpq_clears(was, knot, NULL);
    return found;
}

/// q written for x = q/κ, or the other way round.
static bool try_scaled_argument(struct search *search)
{
    mpq_t factor, power, kappa;
    mpq_inits(factor, power, kappa, NULL);
    mpq_set(kappa, search->trial.outer[search->trial.count - 1]);
    bool found = false;
    for (int variant = 0; !found && variant < 4; variant++) {
        if (variant < 2)
            mpq_set(factor, kappa);
        else
            mpq_set_ui(factor, 2, 1);
        if (variant % 2 == 0) mpq_inv(factor, factor);
        if (mpq_cmp_ui(factor, 1, 1) == 0) continue;
        for (int i = 0; i < search->trial.count; i++)
            for (int k = 0; k < terms(search, i); k++) {
                sphv_rational_power(power, factor, k);
                mpq_mul(*coefficient(search, i, k), *coefficient(search, i, k), power);
            }
        found = fits(search);
        if (found) {
            char text[48];
            mpq_inv(power, factor);
            number_text(power, text, sizeof text);
            snprintf(search->text, search->size,
                     "the argument is scaled: the coefficients belong to powers of %s q, not of q "
                     "(h and the support radius are confused)",
                     text);
        } else {
            mpq_inv(factor, factor);
            for (int i = 0; i < search->trial.count; i++)
                for (int k = 0; k < terms(search, i); k++) {
                    sphv_rational_power(power, factor, k);
                    mpq_mul(*coefficient(search, i, k), *coefficient(search, i, k), power);
                }
        }
    }
    mpq_clears(factor, power, kappa, NULL);
    return found;
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
static bool try_rounding(struct search *search)
{
    static const double tolerances[] = {1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 5e-3};
    const sphv_exact_pieces *given = &search->kernel->pieces;
    for (size_t t = 0; t < sizeof tolerances / sizeof *tolerances; t++) {
        bool changed = false, single = true;
        for (int i = 0; i < given->count; i++)
            for (int k = 0; k < terms(search, i); k++) {
                const mpq_t *from = (const mpq_t *)&given->polynomial[i].coefficient[k];
                mpq_t *to = coefficient(search, i, k);
                simplest(*to, *from, tolerances[t]);
                if (mpq_equal(*to, *from)) continue;
                changed = true;
                single = single && is_float(*from);
            }
        if (changed && fits(search)) {
            snprintf(search->text, search->size, "the coefficients are rounded %s",
                     single && t < 1 ? "to single precision"
                                     : "to a few digits; write them as exact fractions");
            return true;
        }
    }
    for (int i = 0; i < given->count; i++)
        for (int k = 0; k < terms(search, i); k++)
            mpq_set(*coefficient(search, i, k), given->polynomial[i].coefficient[k]);
    return false;
}

/// The last piece goes on to a smooth end further out.
static bool try_truncation(struct search *search)
{
    mpq_t was, end;
    mpq_inits(was, end, NULL);
    mpq_t *outer = &search->trial.outer[search->trial.count - 1];
    mpq_set(was, *outer);
    double kappa = mpq_get_d(was);
    const sphv_polynomial *last = &search->trial.polynomial[search->trial.count - 1];
    bool found = false, zero = true;
    for (int k = 0; k <= last->degree; k++) zero = zero && mpq_sgn(last->coefficient[k]) == 0;
    for (int parts = 1; !found && !zero && parts <= 4; parts++)
        for (int n = 1; !found && n <= 8 * parts; n++) {
            mpq_set_si(end, n, (unsigned)parts);
            mpq_canonicalize(end);
            if (mpq_get_d(end) <= kappa || mpq_get_d(end) > 4 * kappa) continue;
            mpq_set(*outer, end);
            mpq_t jump, slope;
            mpq_inits(jump, slope, NULL);
            sphv_candidate_jump(jump, &search->trial, search->trial.count - 1, 0);
            sphv_candidate_jump(slope, &search->trial, search->trial.count - 1, 1);
            if (mpq_sgn(jump) == 0 && mpq_sgn(slope) == 0) {
                bool whole = fits(search);
                found = true;
                snprintf(search->text, search->size,
                         "the kernel is truncated at q = %.10g; its last piece ends smoothly at "
                         "q = %.10g%s",
                         kappa, mpq_get_d(end),
                         whole ? ", for which the constants are right: it was not renormalised"
                               : "");
            }
            mpq_clears(jump, slope, NULL);
        }
    if (!found) mpq_set(*outer, was);
    mpq_clears(was, end, NULL);
    return found;
}

/// Something of the form ε(q − knot)^m was added from one knot outwards: take it away again.
static bool try_jumps(struct search *search)
{
    static const char *const names[] = {"value", "slope", "curvature"};
    mpq_t jump, part, binomial_power;
    mpz_t binomial;
    mpq_inits(jump, part, binomial_power, NULL);
    mpz_init(binomial);
    bool found = false;
    for (int knot = 0; !found && knot < search->trial.count; knot++)
        for (int m = 0; !found && m < 3; m++)
            for (int side = 0; !found && side < 2; side++) {
                // side 0: in all pieces from the knot outwards; side 1: in the piece before it
                int from = side ? knot : knot + 1;
                int to = side ? knot + 1 : search->trial.count;
                if (from >= to) continue;
                sphv_candidate_jump(jump, &search->trial, knot, m);
                if (mpq_sgn(jump) == 0) continue;
                if (side) mpq_neg(jump, jump);
                bool room = true;
                for (int i = from; i < to; i++) room = room && terms(search, i) > m;
                if (!room) continue;
                for (int pass = 0; pass < 2 && !found; pass++) {
                    for (int i = from; i < to; i++)
                        for (int k = 0; k <= m; k++) {
                            mpz_bin_uiui(binomial, (unsigned)m, (unsigned)k);
                            mpq_neg(part, search->trial.outer[knot]);
                            sphv_rational_power(binomial_power, part, m - k);
                            mpq_set_z(part, binomial);
                            mpq_mul(part, part, binomial_power);
                            mpq_mul(part, part, jump);
                            mpq_add(*coefficient(search, i, k), *coefficient(search, i, k), part);
                        }
                    if (pass == 0) {
                        found = fits(search);
                        mpq_neg(jump, jump);
                    }
                }
                if (found)
                    snprintf(search->text, search->size,
                             "the %s of w was made to jump at q = %.10g", names[m],
                             mpq_get_d(search->trial.outer[knot]));
            }
    mpz_clear(binomial);
    mpq_clears(jump, part, binomial_power, NULL);
    return found;
}

/// An odd part ε q (κ − q)^m was added everywhere: take it away so that w′(0) is 0 again.
static bool try_odd_part(struct search *search)
{
    const sphv_exact_pieces *given = &search->kernel->pieces;
    mpq_t slope, kappa, part, number;
    mpz_t binomial;
    mpq_inits(slope, kappa, part, number, NULL);
    mpz_init(binomial);
    mpq_set(kappa, given->outer[given->count - 1]);
    bool found = false;
    if (terms(search, 0) > 1) mpq_set(slope, given->polynomial[0].coefficient[1]);
    for (int m = 1; !found && mpq_sgn(slope) != 0 && m <= 12; m++) {
        bool room = true;
        for (int i = 0; i < given->count; i++) room = room && terms(search, i) > m + 1;
        if (!room) break;
        for (int i = 0; i < given->count; i++)
            for (int k = 0; k <= given->polynomial[i].degree; k++) {
                mpq_t *c = coefficient(search, i, k);
                mpq_set(*c, given->polynomial[i].coefficient[k]);
                if (k < 1 || k > m + 1) continue;
                // slope/κ^m · q (κ − q)^m: the power j = k − 1 has C(m, j) (−1)^j κ^(−j).
                mpz_bin_uiui(binomial, (unsigned)m, (unsigned)(k - 1));
                mpq_set_z(part, binomial);
                sphv_rational_power(number, kappa, k - 1);
                mpq_div(part, part, number);
                mpq_mul(part, part, slope);
                if ((k - 1) % 2) mpq_neg(part, part);
                mpq_sub(*c, *c, part);
            }
        found = fits(search);
    }
    if (found)
        snprintf(search->text, search->size,
                 "an odd part was added: without %.6g q (1 - q/%.6g)^m "
                 "the kernel meets its claims",
                 mpq_get_d(slope), mpq_get_d(kappa));
    else
        for (int i = 0; i < given->count; i++)
            for (int k = 0; k < terms(search, i); k++)
                mpq_set(*coefficient(search, i, k), given->polynomial[i].coefficient[k]);
    mpz_clear(binomial);
    mpq_clears(slope, kappa, part, number, NULL);
    return found;
}

/// The slips, in the order in which they are tried; the first that fits is named.
static bool (*const slips[])(struct search *) = {
    try_signs,           try_swaps, try_coefficients, try_shifts,   try_piece_swaps, try_knots,
    try_scaled_argument, try_jumps, try_odd_part,     try_rounding, try_truncation,
};

/// How far a polynomial kernel is from a known one of the same structure.
static int differing_coefficients(const sphv_kernel *kernel, const sphv_kernel *known, int *piece,
                                  int *power)
{
    const sphv_exact_pieces *a = &kernel->pieces, *b = &known->pieces;
    int different = 0;
    if (!known->polynomial || a->count != b->count) return -1;
    for (int i = 0; i < a->count; i++) {
        if (!mpq_equal(a->outer[i], b->outer[i])) return -1;
        const sphv_polynomial *p = &a->polynomial[i], *r = &b->polynomial[i];
        for (int k = 0; k <= p->degree || k <= r->degree; k++) {
            bool equal = k <= p->degree && k <= r->degree
                             ? mpq_equal(p->coefficient[k], r->coefficient[k]) != 0
                             : mpq_sgn(k <= p->degree ? p->coefficient[k] : r->coefficient[k]) == 0;
            if (equal) continue;
            if (different++ == 0) {
                *piece = i;
                *power = k;
            }
        }
    }
    return different;
}

/// Are these the coefficients of a known kernel, each to 1 %, but not exact?
/// \param single receives whether single precision explains all of them
static bool rounded_from(const sphv_kernel *kernel, const sphv_kernel *known, bool *single)
{
    *single = true;
    for (int i = 0; i < kernel->pieces.count; i++) {
        const sphv_polynomial *p = &kernel->pieces.polynomial[i];
        const sphv_polynomial *r = &known->pieces.polynomial[i];
        if (p->degree != r->degree) return false;
        for (int k = 0; k <= p->degree; k++) {
            double given = sphv_rational_round(p->coefficient[k]);
            double right = sphv_rational_round(r->coefficient[k]);
            if (fabs(given - right) > 0.01 * fabs(right)) return false;
            *single = *single && given == (double)(float)right;
        }
    }
    return true;
}

static int all_coefficients(const sphv_exact_pieces *pieces)
{
    int count = 0;
    for (int i = 0; i < pieces->count; i++)
        for (int k = 0; k <= pieces->polynomial[i].degree; k++)
            count += mpq_sgn(pieces->polynomial[i].coefficient[k]) != 0;
    return count;
}

/// A known kernel that differs in few coefficients is what the author had in mind.
static void name_resemblance(sphv_examination *of)
{
    const sphv_catalogue *reference = of->options->reference;
    int fewest = 1000, piece = 0, power = 0;
    const sphv_kernel *nearest = NULL;
    bool rounded = false, single = false;
    for (size_t i = 0; !rounded && reference && i < reference->count; i++) {
        int at_piece = 0, at_power = 0;
        int different =
            differing_coefficients(of->kernel, reference->kernels[i], &at_piece, &at_power);
        rounded = different > 1 && rounded_from(of->kernel, reference->kernels[i], &single);
        if (!rounded && (different <= 0 || different >= fewest)) continue;
        fewest = different;
        nearest = reference->kernels[i];
        piece = at_piece;
        power = at_power;
    }
    if (rounded) {
        snprintf(of->repair, sizeof of->repair,
                 "these are the coefficients of %s, %d of them rounded%s; write them exactly",
                 sphv_kernel_name(nearest), fewest, single ? " to single precision" : "");
        return;
    }
    if (!nearest || 2 * fewest > all_coefficients(&nearest->pieces)) return;
    char known[48] = "0";
    if (power <= nearest->pieces.polynomial[piece].degree)
        number_text(nearest->pieces.polynomial[piece].coefficient[power], known, sizeof known);
    snprintf(of->repair, sizeof of->repair,
             "it differs from %s in %d coefficient%s, first in that of q^%d in piece %d: %s there",
             sphv_kernel_name(nearest), fewest, fewest > 1 ? "s" : "", power, piece + 1, known);
}

static void seek(sphv_examination *of)
{
    struct search search = {of->kernel, {0, NULL, NULL}, of->repair, sizeof of->repair, 0, 0};
    if (sphv_exact_pieces_copy(&search.trial, &of->kernel->pieces, 0, NULL) != SPHV_OK) return;
    if (sphv_candidate_decidable(of->kernel) && !fits(&search))
        for (size_t i = 0; !*of->repair && i < sizeof slips / sizeof *slips; i++) slips[i](&search);
    sphv_exact_pieces_free(&search.trial);
    if (!*of->repair) name_resemblance(of);
}

void sphv_check_name_shape_cause(sphv_examination *of, sphv_check_result *result)
{
    if (!of->kernel->polynomial) return;
    if (!of->repair_sought) seek(of);
    of->repair_sought = true;
    if (*of->repair) sphv_check_cause(result, "%s", of->repair);
}
