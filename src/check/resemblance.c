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
void sphv_name_resemblance(const sphv_kernel *kernel, const sphv_catalogue *reference, char *text,
                           size_t size)
{
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
