#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/constant_text.h"
#include "defects.h"

static bool copy_text(char **to, const char *from)
{
    *to = from ? strdup(from) : NULL;
    return !from || *to;
}

static const int *copy_claim(const sphv_kernel *from, sphv_kernel *to, const int *claim)
{
    return claim ? to->claimed_value + (claim - from->claimed_value) : NULL;
}

static bool copy_contents(sphv_kernel *to, const sphv_kernel *from)
{
    bool done = copy_text(&to->path, from->path) && copy_text(&to->name, from->name) &&
                copy_text(&to->title, from->title) && copy_text(&to->source, from->source);
    for (int d = 0; done && d < SPHV_DIMENSIONS; d++)
        done = copy_text(&to->claims.constant[d], from->claims.constant[d]);
    if (done && from->pieces.count)
        done = sphv_exact_pieces_copy(&to->pieces, &from->pieces, 0, NULL) == SPHV_OK;
    if (done && from->gradient.count)
        done = sphv_exact_pieces_copy(&to->gradient, &from->gradient, 0, NULL) == SPHV_OK;
    return done;
}

sphv_kernel *sphv_defect_copy(const sphv_kernel *from)
{
    sphv_kernel *to = sphv_kernel_new();
    if (!to) return NULL;
    if (!copy_contents(to, from)) {
        sphv_kernel_free(to);
        return NULL;
    }
    memcpy(to->claimed_value, from->claimed_value, sizeof to->claimed_value);
    memcpy(to->declared, from->declared, sizeof to->declared);
    to->claims.boundary_smoothness = copy_claim(from, to, from->claims.boundary_smoothness);
    to->claims.smoothing_order = copy_claim(from, to, from->claims.smoothing_order);
    to->claims.monotone = copy_claim(from, to, from->claims.monotone);
    to->claims.non_negative = copy_claim(from, to, from->claims.non_negative);
    to->polynomial = from->polynomial;
    to->fourth_order = from->fourth_order;
    to->form = from->form;
    to->support = from->support;
    return to;
}

bool sphv_defect_give_gradient(sphv_kernel *kernel)
{
    if (!kernel->pieces.count || kernel->fourth_order) return false;
    if (kernel->gradient.count) return true;
    if (sphv_exact_pieces_copy(&kernel->gradient, &kernel->pieces, 0, NULL) != SPHV_OK)
        return false;
    mpq_t power;
    mpq_init(power);
    for (int i = 0; i < kernel->gradient.count; i++) {
        sphv_polynomial *p = &kernel->gradient.polynomial[i];
        for (int k = 0; k < p->degree; k++) {
            mpq_set_si(power, k + 1, 1);
            mpq_mul(p->coefficient[k], p->coefficient[k + 1], power);
        }
        mpq_set_ui(p->coefficient[p->degree], 0, 1);
    }
    mpq_clear(power);
    return true;
}

/// The value of pieces at q, zero beyond them.
static void value_at(mpq_t out, const sphv_exact_pieces *pieces, const mpq_t q)
{
    int i = 0;
    while (i < pieces->count && mpq_cmp(q, pieces->outer[i]) >= 0) i++;
    if (i < pieces->count)
        sphv_polynomial_value(out, &pieces->polynomial[i], q);
    else
        mpq_set_ui(out, 0, 1);
}

/// Compares at many places, exactly.
static bool pieces_differ(const sphv_exact_pieces *a, const sphv_exact_pieces *b)
{
    enum { STEPS = 96 };
    if (!a->count || !b->count) return a->count != b->count;
    mpq_t q, step, one, two;
    mpq_inits(q, step, one, two, NULL);
    mpq_set_ui(step, 2, 2 * STEPS + 1);
    mpq_canonicalize(step);
    const sphv_exact_pieces *longer =
        mpq_cmp(a->outer[a->count - 1], b->outer[b->count - 1]) > 0 ? a : b;
    mpq_mul(step, step, longer->outer[longer->count - 1]);
    double largest = 0, difference = 0;
    for (int i = 0; i <= STEPS; i++) {
        value_at(one, a, q);
        value_at(two, b, q);
        largest = fmax(largest, fabs(mpq_get_d(one)));
        mpq_sub(one, one, two);
        difference = fmax(difference, fabs(mpq_get_d(one)));
        mpq_add(q, q, step);
    }
    mpq_clears(q, step, one, two, NULL);
    return difference > 1e-14 * largest;
}

static bool constants_differ(const char *a, const char *b)
{
    long double one = 0, two = 0;
    sphv_error unused;
    if (!a || !b) return a != b;
    if (sphv_constant_parse(a, &one, &unused) != SPHV_OK) return true;
    if (sphv_constant_parse(b, &two, &unused) != SPHV_OK) return true;
    return fabsl(one - two) > 1e-14L * fabsl(one);
}

static bool claims_differ(const int *a, const int *b)
{
    return (a == NULL) != (b == NULL) || (a && *a != *b);
}

/// A kernel without a gradient of its own stands for one with the right gradient.
static bool gradient_differs(const sphv_kernel *a, const sphv_kernel *b)
{
    if (!b->gradient.count) return false;
    sphv_kernel *with = sphv_defect_copy(a);
    bool differs =
        with && sphv_defect_give_gradient(with) && pieces_differ(&with->gradient, &b->gradient);
    sphv_kernel_free(with);
    return differs;
}

bool sphv_defect_changes(const sphv_kernel *a, const sphv_kernel *b)
{
    for (int d = 0; d < SPHV_DIMENSIONS; d++)
        if (a->declared[d] != b->declared[d] ||
            constants_differ(a->claims.constant[d], b->claims.constant[d]))
            return true;
    return claims_differ(a->claims.boundary_smoothness, b->claims.boundary_smoothness) ||
           claims_differ(a->claims.smoothing_order, b->claims.smoothing_order) ||
           claims_differ(a->claims.monotone, b->claims.monotone) ||
           claims_differ(a->claims.non_negative, b->claims.non_negative) ||
           a->fourth_order != b->fourth_order || a->form.exponent != b->form.exponent ||
           a->support.value != b->support.value || pieces_differ(&a->pieces, &b->pieces) ||
           gradient_differs(a, b);
}

void sphv_defect_round(mpq_t value, int digits)
{
    char text[64];
    sphv_error unused;
    snprintf(text, sizeof text, "%.*e", digits - 1, sphv_rational_round(value));
    (void)!sphv_rational_parse(text, value, &unused);
}

void sphv_defect_round_all(sphv_exact_pieces *pieces, int digits)
{
    for (int i = 0; i < pieces->count; i++)
        for (int k = 0; k <= pieces->polynomial[i].degree; k++) {
            mpq_t *c = &pieces->polynomial[i].coefficient[k];
            if (mpq_sgn(*c) == 0) continue;
            if (digits)
                sphv_defect_round(*c, digits);
            else
                mpq_set_d(*c, (double)(float)sphv_rational_round(*c));
        }
}

mpq_t *sphv_defect_coefficient(sphv_exact_pieces *pieces, int index)
{
    for (int i = 0; i < pieces->count; i++)
        for (int k = 0; k <= pieces->polynomial[i].degree; k++) {
            mpq_t *c = &pieces->polynomial[i].coefficient[k];
            if (mpq_sgn(*c) != 0 && index-- == 0) return c;
        }
    return NULL;
}

static void set_fraction(mpq_t out, long numerator, unsigned long denominator)
{
    mpq_set_si(out, numerator, denominator);
    mpq_canonicalize(out);
}

void sphv_defect_scale(mpq_t value, long numerator, unsigned long denominator)
{
    mpq_t factor;
    mpq_init(factor);
    set_fraction(factor, numerator, denominator);
    mpq_mul(value, value, factor);
    mpq_clear(factor);
}

void sphv_defect_scale_all(sphv_exact_pieces *pieces, long numerator, unsigned long denominator)
{
    mpq_t factor;
    mpq_init(factor);
    set_fraction(factor, numerator, denominator);
    sphv_exact_pieces_scale(pieces, factor);
    mpq_clear(factor);
}
