/// \file dense.h
/// Small dense systems, one in each lane, solved with proof: the bound of the error comes from the
/// residual and an approximate inverse, not from assumptions on pivots.
///
/// With X ≈ A⁻¹ and A, b known to within E, e (entry by entry), the solution x of the true system
/// differs from any y by at most (Rump 1983)
///
///     |x − y| ≤ |X|ρ + δ/(1 − δ) ‖|X|ρ‖_∞,   ρ = |b − Ay| + e + E|y|,   δ = ‖|I − XA| + |X|E‖_∞
///
/// as long as the defect δ is below 1, which also proves that the true matrix is regular. Beyond
/// 1/2 no bound is given; up to there 1/(1 − δ) ≤ 1 + 2δ saves a division.
///
/// Up to SPHV_DENSE_SMALL unknowns n is a constant where these are called from, so that the system
/// stays in registers; more are solved by one loop for all.
#ifndef SPHVERIFY_EMPIRICAL_DENSE_H
#define SPHVERIFY_EMPIRICAL_DENSE_H

#include "lanes.h"

enum { SPHV_UNKNOWNS_MAX = 10, SPHV_DENSE_SMALL = 3 };

#if defined(__GNUC__) && !defined(__clang__)
#define SPHV_UNROLL _Pragma("GCC unroll 3")
#else
#define SPHV_UNROLL
#endif

/// A matrix, row by row, with what is known of its inverse.
typedef struct sphv_dense {
    sphv_bounded a[SPHV_UNKNOWNS_MAX * SPHV_UNKNOWNS_MAX];
    sphv_lanes inverse[SPHV_UNKNOWNS_MAX * SPHV_UNKNOWNS_MAX];
    sphv_lanes condition; ///< ‖A‖₁‖A⁻¹‖₁; not finite when elimination broke down
    sphv_lanes defect;    ///< δ above
} sphv_dense;

SPHV_INLINE void sphv_lanes_swap(sphv_lane_mask mask, sphv_lanes *a, sphv_lanes *b)
{
    sphv_lanes first = *a;
    *a = sphv_lanes_choose(mask, *b, *a);
    *b = sphv_lanes_choose(mask, first, *b);
}

/// X ≈ A⁻¹ by Gauss and Jordan's elimination with partial pivoting: the largest entry of a column
/// rises to the pivot's row by exchanges that each lane makes or leaves.
SPHV_INLINE void sphv_dense_invert(const int n, const sphv_bounded *a, sphv_lanes *x)
{
    sphv_lanes w[SPHV_UNKNOWNS_MAX * SPHV_UNKNOWNS_MAX];
    SPHV_UNROLL
    for (int i = 0; i < n; i++) {
        SPHV_UNROLL
        for (int j = 0; j < n; j++) {
            w[i * n + j] = a[i * n + j].value;
            x[i * n + j] = sphv_lanes_of(i == j);
        }
    }
    SPHV_UNROLL
    for (int k = 0; k < n; k++) {
        SPHV_UNROLL
        for (int i = k + 1; i < n; i++) {
            sphv_lane_mask larger = sphv_lanes_abs(w[i * n + k]) > sphv_lanes_abs(w[k * n + k]);
            SPHV_UNROLL
            for (int j = k; j < n; j++) sphv_lanes_swap(larger, &w[k * n + j], &w[i * n + j]);
            SPHV_UNROLL
            for (int j = 0; j < n; j++) sphv_lanes_swap(larger, &x[k * n + j], &x[i * n + j]);
        }
        sphv_lanes scale = 1.0 / w[k * n + k];
        SPHV_UNROLL
        for (int j = k + 1; j < n; j++) w[k * n + j] *= scale;
        SPHV_UNROLL
        for (int j = 0; j < n; j++) x[k * n + j] *= scale;
        SPHV_UNROLL
        for (int i = 0; i < n; i++) {
            if (i == k) continue;
            sphv_lanes factor = w[i * n + k];
            SPHV_UNROLL
            for (int j = k + 1; j < n; j++) w[i * n + j] -= factor * w[k * n + j];
            SPHV_UNROLL
            for (int j = 0; j < n; j++) x[i * n + j] -= factor * x[k * n + j];
        }
    }
}

/// Raises a norm to the sum of one more column; what is not finite stays.
SPHV_INLINE sphv_lanes sphv_dense_raise(sphv_lanes norm, sphv_lanes column)
{
    return sphv_lanes_choose((norm >= column) | ~sphv_lanes_finite(norm), norm, column);
}

/// ‖A‖₁‖X‖₁.
SPHV_INLINE sphv_lanes sphv_dense_condition(const int n, const sphv_bounded *a, const sphv_lanes *x)
{
    sphv_lanes norm = {0}, inverse_norm = {0};
    SPHV_UNROLL
    for (int j = 0; j < n; j++) {
        sphv_lanes column = {0}, inverse_column = {0};
        SPHV_UNROLL
        for (int i = 0; i < n; i++) {
            column += sphv_lanes_abs(a[i * n + j].value);
            inverse_column += sphv_lanes_abs(x[i * n + j]);
        }
        norm = sphv_dense_raise(norm, column);
        inverse_norm = sphv_dense_raise(inverse_norm, inverse_column);
    }
    return norm * inverse_norm;
}

/// Rounding of a sum of n products, and of the differences around it: γ_{n+2} = (n + 2)u and slack.
SPHV_INLINE double sphv_dense_gamma(int n)
{
    return (n + 3) * SPHV_U;
}

/// Fills in `inverse`, `condition` and `defect`.
SPHV_INLINE void sphv_dense_factor_inline(const int n, sphv_dense *of)
{
    // what is written here first
    // cppcheck-suppress ctuuninitvar
    sphv_lanes *x = of->inverse, row[SPHV_UNKNOWNS_MAX], defect = {0};
    sphv_dense_invert(n, of->a, x);
    of->condition = sphv_dense_condition(n, of->a, x);
    SPHV_UNROLL
    for (int k = 0; k < n; k++) { // what multiplies |X_ik|: row sums of E + γ|A|
        row[k] = (sphv_lanes){0};
        SPHV_UNROLL
        for (int j = 0; j < n; j++)
            row[k] += of->a[k * n + j].error +
                      sphv_dense_gamma(n) * sphv_lanes_abs(of->a[k * n + j].value);
    }
    SPHV_UNROLL
    for (int i = 0; i < n; i++) {
        sphv_lanes sum = {0};
        SPHV_UNROLL
        for (int k = 0; k < n; k++) sum += sphv_lanes_abs(x[i * n + k]) * row[k];
        SPHV_UNROLL
        for (int j = 0; j < n; j++) {
            sphv_lanes rest = sphv_lanes_of(i == j);
            SPHV_UNROLL
            for (int k = 0; k < n; k++) rest -= x[i * n + k] * of->a[k * n + j].value;
            sum += sphv_lanes_abs(rest);
        }
        defect = sphv_dense_raise(defect, sum);
    }
    of->defect = defect * SPHV_BOUND_SLACK + (n + 2) * SPHV_U;
}

/// Solves A x = b with one step of refinement.
SPHV_INLINE void sphv_dense_solve_inline(const int n, const sphv_dense *of, const sphv_bounded *b,
                                         sphv_bounded *out)
{
    const sphv_lanes *x = of->inverse;
    sphv_lanes y[SPHV_UNKNOWNS_MAX], rest[SPHV_UNKNOWNS_MAX], largest = {0};
    SPHV_UNROLL
    for (int i = 0; i < n; i++) {
        y[i] = (sphv_lanes){0};
        SPHV_UNROLL
        for (int j = 0; j < n; j++) y[i] += x[i * n + j] * b[j].value;
    }
    SPHV_UNROLL
    for (int i = 0; i < n; i++) {
        rest[i] = b[i].value;
        SPHV_UNROLL
        for (int j = 0; j < n; j++) rest[i] -= of->a[i * n + j].value * y[j];
    }
    SPHV_UNROLL
    for (int i = 0; i < n; i++) {
        SPHV_UNROLL
        for (int j = 0; j < n; j++) y[i] += x[i * n + j] * rest[j];
    }
    SPHV_UNROLL
    for (int i = 0; i < n; i++) { // ρ, with the rounding of its own evaluation
        sphv_lanes residual = b[i].value, moduli = sphv_lanes_abs(b[i].value), errors = b[i].error;
        SPHV_UNROLL
        for (int j = 0; j < n; j++) {
            sphv_lanes product = of->a[i * n + j].value * y[j];
            residual -= product;
            moduli += sphv_lanes_abs(product);
            errors += of->a[i * n + j].error * sphv_lanes_abs(y[j]);
        }
        rest[i] = sphv_lanes_abs(residual) + sphv_dense_gamma(n) * moduli + errors;
    }
    SPHV_UNROLL
    for (int i = 0; i < n; i++) {
        sphv_lanes sum = {0};
        SPHV_UNROLL
        for (int j = 0; j < n; j++) sum += sphv_lanes_abs(x[i * n + j]) * rest[j];
        out[i] = (sphv_bounded){y[i], sum};
        largest = sphv_lanes_max(sum, largest);
    }
    sphv_lanes share = of->defect * (1.0 + 2.0 * of->defect) * largest;
    sphv_lane_mask proven = of->defect <= 0.5;
    SPHV_UNROLL
    for (int i = 0; i < n; i++)
        out[i].error = sphv_lanes_choose(proven, (out[i].error + share) * SPHV_BOUND_SLACK,
                                         sphv_lanes_of(INFINITY));
}

// One copy in each file, which need not use it.
#define SPHV_APART static __attribute__((noinline, unused))

SPHV_APART void sphv_dense_factor_large(int n, sphv_dense *of)
{
    sphv_dense_factor_inline(n, of);
}

SPHV_APART void sphv_dense_solve_large(int n, const sphv_dense *of, const sphv_bounded *b,
                                       sphv_bounded *out)
{
    sphv_dense_solve_inline(n, of, b, out);
}

SPHV_INLINE void sphv_dense_factor(const int n, sphv_dense *of)
{
    if (n <= SPHV_DENSE_SMALL)
        sphv_dense_factor_inline(n, of);
    else
        sphv_dense_factor_large(n, of);
}

SPHV_INLINE void sphv_dense_solve(const int n, const sphv_dense *of, const sphv_bounded *b,
                                  sphv_bounded *out)
{
    if (n <= SPHV_DENSE_SMALL)
        sphv_dense_solve_inline(n, of, b, out);
    else
        sphv_dense_solve_large(n, of, b, out);
}

#endif
