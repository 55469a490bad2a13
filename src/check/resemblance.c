/// Known kernels that a faulty one resembles.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "slips.h"

/// How far a polynomial kernel is from a known one of the same structure.
static int differing_coefficients(const sphv_kernel *kernel, const sphv_kernel *known, int *piece,
                                  int *power)
{
    const sphv_exact_pieces *a = &kernel->pieces, *b = &known->pieces;
    int different = 0;
    if (!known->polynomial || known->fourth_order != kernel->fourth_order || a->count != b->count)
        return -1;
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
/// Are the pieces the first ones of a known kernel that goes on further out?
static bool cut_from(const sphv_kernel *kernel, const sphv_kernel *known)
{
    const sphv_exact_pieces *a = &kernel->pieces, *b = &known->pieces;
    if (!known->polynomial || known->fourth_order != kernel->fourth_order || a->count > b->count ||
        mpq_cmp(a->outer[a->count - 1], b->outer[b->count - 1]) >= 0)
        return false;
    for (int i = 0; i < a->count; i++) {
        if (i + 1 < a->count && !mpq_equal(a->outer[i], b->outer[i])) return false;
        const sphv_polynomial *p = &a->polynomial[i], *r = &b->polynomial[i];
        for (int k = 0; k <= p->degree || k <= r->degree; k++)
            if (k > p->degree   ? mpq_sgn(r->coefficient[k]) != 0
                : k > r->degree ? mpq_sgn(p->coefficient[k]) != 0
                                : !mpq_equal(p->coefficient[k], r->coefficient[k]))
                return false;
    }
    return mpq_cmp(a->outer[a->count - 1], b->outer[a->count - 1]) <= 0;
}

static bool name_cut(const sphv_kernel *kernel, const sphv_catalogue *reference, char *text,
                     size_t size)
{
    for (size_t i = 0; reference && i < reference->count; i++) {
        const sphv_kernel *known = reference->kernels[i];
        if (!cut_from(kernel, known)) continue;
        snprintf(text, size, "this is %s truncated at q = %.10g, where it ends at q = %.10g",
                 sphv_kernel_name(known), kernel->support.value, known->support.value);
        return true;
    }
    return false;
}

void sphv_name_resemblance(const sphv_kernel *kernel, const sphv_catalogue *reference, char *text,
                           size_t size)
{
    if (name_cut(kernel, reference, text, size)) return;
    int fewest = 1000, piece = 0, power = 0;
    const sphv_kernel *nearest = NULL;
    bool rounded = false, single = false;
    for (size_t i = 0; !rounded && reference && i < reference->count; i++) {
        int at_piece = 0, at_power = 0;
        int different = differing_coefficients(kernel, reference->kernels[i], &at_piece, &at_power);
        rounded = different > 1 && rounded_from(kernel, reference->kernels[i], &single);
        if (!rounded && (different <= 0 || different >= fewest)) continue;
        fewest = different;
        nearest = reference->kernels[i];
        piece = at_piece;
        power = at_power;
    }
    if (rounded) {
        snprintf(text, size,
                 "these are the coefficients of %s, %d of them rounded%s; write them exactly",
                 sphv_kernel_name(nearest), fewest, single ? " to single precision" : "");
        return;
    }
    if (!nearest || 2 * fewest > all_coefficients(&nearest->pieces)) return;
    char known[48] = "0";
    if (power <= nearest->pieces.polynomial[piece].degree)
        sphv_search_number(nearest->pieces.polynomial[piece].coefficient[power], known,
                           sizeof known);
    snprintf(text, size,
             "it differs from %s in %d coefficient%s, first in that of q^%d in piece %d: %s there",
             sphv_kernel_name(nearest), fewest, fewest > 1 ? "s" : "", power, piece + 1, known);
}
