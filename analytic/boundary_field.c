#include <gsl/gsl_math.h>

#include "boundary_internal.h"

static bool is_whole(double p)
{
    return p == floor(p);
}

/// Coefficients of x^p about x: |p (p−1) … (p−n+1)|/n! x^(p−n).
static double power_coefficient(double p, int n, double x)
{
    double product = 1;
    for (int i = 0; i < n; i++) product *= fabs(p - i) / (i + 1);
    return product == 0 ? 0 : product * pow(x, p - n);
}

/// A bound of |φ^(n)(x)|/n!.
static double coefficient_bound(const sphv_factor *factor, int n, double x)
{
    double product = 1;
    switch (factor->kind) {
    case SPHV_FACTOR_POWER:
        return power_coefficient(factor->parameter, n, x);
    case SPHV_FACTOR_SINE:
        for (int i = 1; i <= n; i++) product *= fabs(factor->parameter) / i;
        return product;
    case SPHV_FACTOR_BELL:
        // Cramér: |He_n(x)| e^(−x²/2) <= 1.0865 √n!, the smaller factor e^(−x²/4) left out
        for (int i = 1; i <= n; i++) product /= sqrt(i) * factor->parameter;
        return 1.0865 * product;
    }
    return INFINITY;
}

sphv_status sphv_field_theory_make(const sphv_field *field, sphv_field_theory *out,
                                   sphv_error *error)
{
    int d = field->dimension;
    *out = (sphv_field_theory){.field = field};
    for (int t = 0; t < field->terms; t++)
        for (int i = 0; i < d; i++) {
            const sphv_factor *factor = &field->term[t].factor[i];
            bool power = factor->kind == SPHV_FACTOR_POWER;
            if (power && !is_whole(factor->parameter)) {
                if (i > 0)
                    return sphv_fail(error, SPHV_NO_CLOSED_FORM,
                                     "field '%s' is singular in coordinate %d; allowed: in the "
                                     "first only",
                                     field->name, i + 1);
                out->singular = true;
            }
            if (factor->kind == SPHV_FACTOR_BELL) out->narrow = true;
            if (i > 0)
                out->rest_degree = power ? (int)fmax(out->rest_degree, factor->parameter)
                                         : SPHV_MONOMIAL_DEGREE_MAX;
        }
    return SPHV_OK;
}

/// Adds c Σ_{|γ| = m} Π_i coefficient_i(γ_i) r^m to out[m], m <= last.
static void add_term(const sphv_field_term *term, int first, int d, const double *x, double r,
                     int last, double *out)
{
    double product[SPHV_TAIL] = {fabs(term->coefficient)}, next[SPHV_TAIL], factor[SPHV_TAIL];
    for (int i = first; i < d; i++) {
        for (int n = 0; n <= last; n++)
            factor[n] = coefficient_bound(&term->factor[i], n, x[i]) * gsl_pow_int(r, n);
        for (int m = 0; m <= last; m++) {
            next[m] = 0;
            for (int n = 0; n <= m; n++) next[m] += product[m - n] * factor[n];
        }
        for (int m = 0; m <= last; m++) product[m] = next[m];
    }
    for (int m = 0; m <= last; m++) out[m] += product[m];
}

void sphv_taylor_tail(const sphv_field *field, bool rest_only, double x, double r, double *tail)
{
    const int last = SPHV_TAIL - 1;
    double terms[SPHV_TAIL] = {0};
    // |x| <= 1: monomials of the other coordinates are largest at 1.
    double at[SPHV_DIMENSIONS] = {x, 1, 1};
    for (int t = 0; t < field->terms; t++)
        add_term(&field->term[t], rest_only ? 1 : 0, field->dimension, at, r, last, terms);
    // Beyond `last` terms at least halve: their rest is no more than the last of them.
    double sum = terms[last];
    for (int m = last; m >= 0; m--) {
        sum += terms[m];
        if (m > 0) tail[m - 1] = sum;
    }
    tail[last] = terms[last];
}
