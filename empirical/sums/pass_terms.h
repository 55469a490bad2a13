/// \file pass_terms.h
/// What the passes are made of: the radial functions in vectors, monomials by degree, and the
/// shapes of kernel that get loops of their own. Like vector.h, compiled once for each instruction
/// set.
#ifndef SPHVERIFY_EMPIRICAL_PASS_TERMS_H
#define SPHVERIFY_EMPIRICAL_PASS_TERMS_H

#include "pass.h"
#include "vector.h"

// A name of this instruction set's own.
#define PASS_JOIN_(name, set) name##_##set
#define PASS_JOIN(name, set) PASS_JOIN_(name, set)
#define PASS_NAME(name) PASS_JOIN(name, SPHV_PASS_SET)

#define UNROLL _Pragma("GCC unroll 64")

enum { DEGREE_TERMS = 21 }; ///< monomials of degree 5 in three dimensions

static const sphv_sum_set sets[SPHV_SUM_LEVELS] = SPHV_SUM_SETS;

/// A polynomial form known when this file is compiled, p_0 = Σ_i t_i^low (c_i0 + c_i1 t_i + …), so
/// that its powers unroll; no knots: whatever the radial functions say.
typedef struct shape {
    sphv_radial_form form;
    int knots, low, terms;
} shape;

SPHV_INLINE vec v_power(vec t, const int n)
{
    vec square = v_mul(t, t), result = v_set(1);
    if (n == 1) return t;
    if (n >= 2) result = square;
    UNROLL for (int i = 2; i < n / 2 + 1; i++) result = v_mul(result, square);
    return n > 1 && n % 2 ? v_mul(result, t) : result;
}

/// Σ_j term[j] t^j.
SPHV_INLINE vec v_horner(const double *term, const int terms, vec t)
{
    vec sum = v_set(term[terms - 1]);
    UNROLL for (int j = terms - 2; j >= 0; j--) sum = v_fma(sum, t, v_set(term[j]));
    return sum;
}

SPHV_INLINE vec v_powered(const double *term, int low, int terms, vec t)
{
    vec sum = v_set(term[terms - 1]);
    for (int j = terms - 2; j >= 0; j--) sum = v_fma(sum, t, v_set(term[j]));
    for (int j = 0; j < low; j++) sum = v_mul(sum, t);
    return sum;
}

/// v p_0, v p_1 (and v p_2) at a distance r in each lane. \param inverse 1/r, or 0
SPHV_INLINE void radial_functions(const sphv_radial *radial, const shape known,
                                  const sphv_radial_form form, const int functions, vec r,
                                  vec inverse, vec v, vec w[3])
{
    const vec zero = v_set(0), minus_inverse_h = v_set(-radial->inverse_h);
    if (known.knots == 1 && known.form == SPHV_RADIAL_QUOTIENT) {
        // Beyond the edge v is 0, and t^low at most 1e200 (cells.c keeps r below 1e15 h).
        vec t = v_fma(r, minus_inverse_h, v_set(radial->knot[0]));
        vec common = v_mul(v, v_power(t, known.low - 1));
        w[0] = v_mul(v_mul(common, t), v_horner(radial->term[0][0], known.terms, t));
        w[1] = v_mul(common, v_horner(radial->term[1][0], known.terms - 1, t));
        return;
    }
    UNROLL for (int k = 0; k < functions; k++) w[k] = zero;
    const int knots = known.knots > 0 ? known.knots : radial->knots;
    UNROLL for (int i = 0; i < knots; i++)
    {
        vec t = v_fma(r, minus_inverse_h, v_set(radial->knot[i]));
        if (known.knots == 0 || i > 0) t = v_max(t, zero); // the first is the edge, as above
        if (known.knots > 0) {
            vec common = v_power(t, known.low - 1);
            vec value = v_horner(radial->term[0][i], known.terms, t);
            w[0] = v_fma(v_mul(common, t), value, w[0]);
            w[1] = v_fma(common, v_horner(radial->term[1][i], known.terms, t), w[1]);
        } else {
            UNROLL for (int k = 0; k < functions; k++) w[k] =
                v_add(w[k], v_powered(radial->term[k][i], radial->low[k], radial->terms[k], t));
        }
    }
    UNROLL for (int k = 0; k < functions; k++) w[k] = v_mul(w[k], v);
    if (form == SPHV_RADIAL_SLOPE) w[1] = v_mul(w[1], inverse);
    if (functions > 2) w[2] = v_mul(w[2], inverse);
}

/// Number of monomials of one degree.
SPHV_INLINE int of_degree(const int dimension, const int degree)
{
    return dimension == 1 ? 1 : dimension == 2 ? degree + 1 : (degree + 1) * (degree + 2) / 2;
}

/// Number of monomials of degree < n.
SPHV_INLINE int below_degree(const int dimension, const int n)
{
    return dimension == 1 ? n : dimension == 2 ? n * (n + 1) / 2 : n * (n + 1) * (n + 2) / 6;
}

SPHV_INLINE int of_degrees(const int dimension, const sphv_degrees degrees)
{
    if (degrees.from > degrees.to) return 0;
    return below_degree(dimension, degrees.to + 1) - below_degree(dimension, degrees.from);
}

/// Monomials of degree n in the order of the table come from those of degree n − 1: all of them
/// times x, those without x times y, and the last times z. The j-th is its parent times this axis.
SPHV_INLINE int last_axis(const int dimension, const int n, const int j)
{
    const int earlier = of_degree(dimension, n - 1);
    return j < earlier ? 0 : dimension == 3 && j == of_degree(dimension, n) - 1 ? 2 : 1;
}
SPHV_INLINE int parent_of(const int dimension, const int n, const int j)
{
    const int axis = last_axis(dimension, n, j);
    return axis == 0 ? j : axis == 1 && dimension == 3 ? j - n : of_degree(dimension, n - 1) - 1;
}

/// What a pass knows when it is compiled.
typedef struct plan {
    int dimension, fields, functions, moments, per_field, count;
    sphv_sum_set set;
    shape known;
} plan;

SPHV_INLINE plan plan_make(const int dimension, const sphv_sum_level level, const int fields,
                           const shape known)
{
    plan of = {.dimension = dimension, .fields = fields, .set = sets[level], .known = known};
    of.functions = of.set.moment[2].from <= of.set.moment[2].to ? 3 : 2;
    UNROLL for (int k = 0; k < of.functions; k++)
    {
        of.moments += of_degrees(dimension, of.set.moment[k]);
        of.per_field += of_degrees(dimension, of.set.field[k]);
    }
    of.count = of.moments + 3 + fields * of.per_field;
    return of;
}

// The shapes that are worth a loop of their own: Wendland's C2, C4 and C6, the cubic spline.
#define SHAPE_ANY SPHV_RADIAL_PROFILE, 0, 0, 0
#define SHAPE_C2 SPHV_RADIAL_QUOTIENT, 1, 4, 2
#define SHAPE_C4 SPHV_RADIAL_QUOTIENT, 1, 6, 3
#define SHAPE_C6 SPHV_RADIAL_QUOTIENT, 1, 8, 4
#define SHAPE_CUBIC SPHV_RADIAL_SLOPE, 2, 3, 1

// Every level of low degree; special shapes come first, since the first row that fits is taken.
#define BOTH_FIELDS(X, d, level, name) X(d, level, 1, name) X(d, level, 2, name)
#define LOW(X, d, name) BOTH_FIELDS(X, d, STANDARD, name) BOTH_FIELDS(X, d, FIRST, name)
#if defined(__x86_64__) && !defined(__AVX2__)
#define SPECIAL(X, d) // few processors of this kind are left without AVX2
#else
#define SPECIAL(X, d) LOW(X, d, C2) LOW(X, d, C4) LOW(X, d, C6) LOW(X, d, CUBIC)
#endif

static bool fits(const shape *known, const sphv_radial *radial)
{
    if (known->knots == 0) return true;
    return known->form == radial->form && known->knots == radial->knots &&
           known->low == radial->low[0] && known->terms == radial->terms[0] &&
           radial->low[1] == known->low - 1 &&
           radial->terms[1] == known->terms - (known->form == SPHV_RADIAL_QUOTIENT);
}

/// What a table of passes needs to know of each.
typedef struct pass_row {
    int dimension;
    sphv_sum_level level;
    int fields;
    shape known;
} pass_row;

SPHV_INLINE bool suits(const pass_row *row, int dimension, sphv_sum_level level, int fields,
                       const sphv_radial *radial)
{
    return row->dimension == dimension && row->level == level && row->fields >= fields &&
           fits(&row->known, radial);
}

/// The half pass of this instruction set (half_pass.c).
sphv_half_pass_function *PASS_NAME(sphv_choose_half)(int dimension, int fields,
                                                     const sphv_radial *radial, size_t *tile);

#endif
