/// Slips in whole pieces: their order, their ends, what was added to them.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "slips.h"

bool sphv_try_piece_swaps(struct sphv_search *search)
{
    for (int i = 0; i < search->trial.count; i++)
        for (int j = i + 1; j < search->trial.count; j++) {
            sphv_polynomial *a = &search->trial.polynomial[i], *b = &search->trial.polynomial[j];
            sphv_polynomial kept = *a;
            *a = *b;
            *b = kept;
            if (sphv_search_fits(search)) {
                snprintf(search->text, search->size, "pieces %d and %d are swapped", i + 1, j + 1);
                return true;
            }
            *b = *a;
            *a = kept;
        }
    return false;
}

bool sphv_try_knots(struct sphv_search *search)
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
                found = sphv_search_fits(search);
            }
        if (found) {
            char place[48], given[48];
            sphv_search_number(knot, place, sizeof place);
            sphv_search_number(was, given, sizeof given);
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
bool sphv_try_scaled_argument(struct sphv_search *search)
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
            for (int k = 0; k < sphv_search_terms(search, i); k++) {
                sphv_rational_power(power, factor, k);
                mpq_mul(*sphv_search_coefficient(search, i, k),
                        *sphv_search_coefficient(search, i, k), power);
            }
        found = sphv_search_fits(search);
        if (found) {
            char text[48];
            mpq_inv(power, factor);
            sphv_search_number(power, text, sizeof text);
            snprintf(search->text, search->size,
                     "the argument is scaled: the coefficients belong to powers of %s q, not of q "
                     "(h and the support radius are confused)",
                     text);
        } else {
            mpq_inv(factor, factor);
            for (int i = 0; i < search->trial.count; i++)
                for (int k = 0; k < sphv_search_terms(search, i); k++) {
                    sphv_rational_power(power, factor, k);
                    mpq_mul(*sphv_search_coefficient(search, i, k),
                            *sphv_search_coefficient(search, i, k), power);
                }
        }
    }
    mpq_clears(factor, power, kappa, NULL);
    return found;
}

/// The last piece goes on to a smooth end further out.
bool sphv_try_truncation(struct sphv_search *search)
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
                bool whole = sphv_search_fits(search);
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
bool sphv_try_jumps(struct sphv_search *search)
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
                for (int i = from; i < to; i++) room = room && sphv_search_terms(search, i) > m;
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
                            mpq_add(*sphv_search_coefficient(search, i, k),
                                    *sphv_search_coefficient(search, i, k), part);
                        }
                    if (pass == 0) {
                        found = sphv_search_fits(search);
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
bool sphv_try_odd_part(struct sphv_search *search)
{
    const sphv_exact_pieces *given = &search->kernel->pieces;
    mpq_t slope, kappa, part, number;
    mpz_t binomial;
    mpq_inits(slope, kappa, part, number, NULL);
    mpz_init(binomial);
    mpq_set(kappa, given->outer[given->count - 1]);
    bool found = false;
    if (sphv_search_terms(search, 0) > 1) mpq_set(slope, given->polynomial[0].coefficient[1]);
    for (int m = 1; !found && mpq_sgn(slope) != 0 && m <= 12; m++) {
        bool room = true;
        for (int i = 0; i < given->count; i++) room = room && sphv_search_terms(search, i) > m + 1;
        if (!room) break;
        for (int i = 0; i < given->count; i++)
            for (int k = 0; k <= given->polynomial[i].degree; k++) {
                mpq_t *c = sphv_search_coefficient(search, i, k);
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
        found = sphv_search_fits(search);
    }
    if (found)
        snprintf(search->text, search->size,
                 "an odd part was added: without %.6g q (1 - q/%.6g)^m "
                 "the kernel meets its claims",
                 mpq_get_d(slope), mpq_get_d(kappa));
    else
        sphv_search_reset(search);
    mpz_clear(binomial);
    mpq_clears(slope, kappa, part, number, NULL);
    return found;
}
