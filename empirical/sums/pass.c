#include "pass.h"

#include "vector.h"

#define UNROLL _Pragma("GCC unroll 64")

enum {
    PART = 128,       ///< longest run of sources summed plainly; longer ones are summed in parts
    DEGREE_TERMS = 21 ///< monomials of degree 5 in three dimensions
};

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

/// p_0, p_1 (and p_2) at q in each lane.
SPHV_INLINE void radial_functions(const sphv_radial *radial, const shape known, const int functions,
                                  vec q, vec p[3])
{
    const vec zero = v_set(0);
    UNROLL for (int k = 0; k < functions; k++) p[k] = zero;
    if (known.knots > 0) {
        const int first_terms = known.form == SPHV_RADIAL_QUOTIENT ? known.terms - 1 : known.terms;
        UNROLL for (int i = 0; i < known.knots; i++)
        {
            vec t = v_max(v_sub(v_set(radial->knot[i]), q), zero);
            vec common = v_power(t, known.low - 1);
            vec value = v_horner(radial->term[0][i], known.terms, t);
            p[0] = v_fma(v_mul(common, t), value, p[0]);
            p[1] = v_fma(common, v_horner(radial->term[1][i], first_terms, t), p[1]);
        }
    } else {
        for (int i = 0; i < radial->knots; i++) {
            vec t = v_max(v_sub(v_set(radial->knot[i]), q), zero);
            UNROLL for (int k = 0; k < functions; k++) p[k] =
                v_add(p[k], v_powered(radial->term[k][i], radial->low[k], radial->terms[k], t));
        }
    }
    if (functions > 2 || known.form == SPHV_RADIAL_SLOPE) {
        vec inverse = v_div_where(v_less(zero, q), v_set(1), q);
        if (known.form == SPHV_RADIAL_SLOPE) p[1] = v_mul(p[1], inverse);
        if (functions > 2) p[2] = v_mul(p[2], inverse);
    }
}

/// The same from the profile, lane by lane, with sizes.
SPHV_INLINE void profile_functions(const sphv_pass *pass, vec square, vec p[3], vec size[3])
{
    double squares[LANES], values[3][LANES] = {{0}}, sizes[3][LANES] = {{0}};
    v_store(squares, square);
    for (int l = 0; l < LANES; l++) {
        double at[3], size_at[3];
        if (!(squares[l] < pass->radial->limit)) continue;
        sphv_radial_values(pass->radial, pass->layout->level, squares[l], at, size_at);
        for (int k = 0; k < 3; k++) {
            values[k][l] = at[k];
            sizes[k][l] = size_at[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        p[k] = v_load(values[k]);
        size[k] = v_load(sizes[k]);
    }
}

/// Number of monomials of one degree.
SPHV_INLINE int of_degree(const int dimension, const int degree)
{
    return dimension == 1 ? 1 : dimension == 2 ? degree + 1 : (degree + 1) * (degree + 2) / 2;
}

SPHV_INLINE int of_degrees(const int dimension, const sphv_degrees degrees)
{
    int count = 0;
    UNROLL for (int n = degrees.from; n <= degrees.to; n++) count += of_degree(dimension, n);
    return count;
}

/// Adds w s^α to the moments and w s^α δA to the field sums of one radial function. Monomials of
/// degree n come from those of degree n − 1, in the order of the table: all of them times x, those
/// without x times y, and the last times z.
SPHV_INLINE void add_terms(const int dimension, const sphv_degrees moment, const sphv_degrees field,
                           const int fields, const int per_field, vec w, const vec d[3],
                           const vec da[2], vec *moments, vec *sums)
{
    vec term[2][DEGREE_TERMS] = {{w}};
    const int to = moment.to > field.to ? moment.to : field.to;
    int moment_at = 0, field_at = 0;
    UNROLL for (int n = 0; n <= to; n++)
    {
        const vec *before = term[(n + 1) % 2];
        vec *now = term[n % 2];
        const int count = of_degree(dimension, n), earlier = n ? of_degree(dimension, n - 1) : 0;
        const bool last = n > 0 && n == to && n > field.to; // these products are not needed again
        UNROLL for (int j = 0; j < count && n > 0; j++)
        {
            const int axis = j < earlier ? 0 : dimension == 3 && j == count - 1 ? 2 : 1;
            const int parent = axis == 0        ? j
                               : axis == 2      ? earlier - 1
                               : dimension == 3 ? earlier - n + (j - earlier)
                                                : earlier - 1;
            if (last)
                moments[moment_at + j] = v_fma(before[parent], d[axis], moments[moment_at + j]);
            else
                now[j] = v_mul(before[parent], d[axis]);
        }
        if (n >= moment.from && n <= moment.to) {
            UNROLL for (int j = 0; j < count && !last; j++) moments[moment_at + j] =
                v_add(moments[moment_at + j], now[j]);
            moment_at += count;
        }
        if (n >= field.from && n <= field.to) {
            UNROLL for (int f = 0; f < fields; f++) UNROLL for (int j = 0; j < count; j++)
                sums[f * per_field + field_at + j] =
                    v_fma(now[j], da[f], sums[f * per_field + field_at + j]);
            field_at += count;
        }
    }
}

/// The pass for one dimension, level, number of fields and shape, all known to the compiler.
SPHV_INLINE void run(sphv_pass *pass, size_t range_count, const sphv_range *ranges,
                     const int dimension, const sphv_sum_level level, const int fields,
                     const shape known)
{
    const sphv_sum_set set = sets[level];
    const int functions = set.moment[2].from <= set.moment[2].to ? 3 : 2;
    int moments = 0, per_field = 0;
    UNROLL for (int k = 0; k < functions; k++)
    {
        moments += of_degrees(dimension, set.moment[k]);
        per_field += of_degrees(dimension, set.field[k]);
    }
    const int count = moments + 3 + fields * per_field;
    const sphv_radial *radial = pass->radial;
    const vec limit = v_set(radial->limit), inverse_h = v_set(radial->inverse_h);
    vec x[3], a[2], neighbours = v_set(0);
    UNROLL for (int i = 0; i < dimension; i++) x[i] = v_load(pass->x[i]);
    UNROLL for (int f = 0; f < fields; f++) a[f] = v_load(pass->a[f]);
    for (int k = 0; k < count; k++) v_store(pass->sums + k * SPHV_LANES_MAX, v_set(0));
    for (size_t r = 0; r < range_count; r++) {
        for (size_t from = ranges[r].from; from < ranges[r].to; from += PART) {
            size_t to = ranges[r].to - from < PART ? ranges[r].to : from + PART;
            vec sum[SPHV_PASS_SUMS];
            UNROLL for (int k = 0; k < count; k++) sum[k] = v_set(0);
            for (size_t b = from; b < to; b++) {
                vec d[3], da[2], p[3], size[3], square = v_set(0);
                UNROLL for (int i = 0; i < dimension; i++)
                {
                    d[i] = v_sub(v_set(pass->sources.x[i][b]), x[i]);
                    square = i ? v_add(square, v_mul(d[i], d[i])) : v_mul(d[i], d[i]);
                }
                UNROLL for (int f = 0; f < fields; f++) da[f] =
                    v_sub(v_set(pass->sources.field[f][b]), a[f]);
                mask near = v_less(square, limit);
                vec v = v_where(near, v_set(pass->sources.v[b]));
                neighbours = v_count(neighbours, near);
                if (known.form == SPHV_RADIAL_PROFILE) {
                    profile_functions(pass, square, p, size);
                    UNROLL for (int k = 0; k < 3; k++) sum[moments + k] =
                        v_fma(v_max(v, v_sub(v_set(0), v)), size[k], sum[moments + k]);
                } else {
                    radial_functions(radial, known, functions, v_mul(v_sqrt(square), inverse_h), p);
                }
                int moment_at = 0, field_at = moments + 3;
                UNROLL for (int k = 0; k < functions; k++)
                {
                    add_terms(dimension, set.moment[k], set.field[k], fields, per_field,
                              v_mul(v, p[k]), d, da, sum + moment_at, sum + field_at);
                    moment_at += of_degrees(dimension, set.moment[k]);
                    field_at += of_degrees(dimension, set.field[k]);
                }
            }
            UNROLL for (int k = 0; k < count; k++)
            {
                double *total = pass->sums + k * SPHV_LANES_MAX;
                v_store(total, v_add(v_load(total), sum[k]));
            }
        }
    }
    v_store(pass->neighbours, neighbours);
}

// The shapes that are worth a loop of their own: Wendland's C2, C4 and C6, the cubic spline.
#define SHAPE_PROFILE SPHV_RADIAL_PROFILE, 0, 0, 0
#define SHAPE_QUOTIENT SPHV_RADIAL_QUOTIENT, 0, 0, 0
#define SHAPE_SLOPE SPHV_RADIAL_SLOPE, 0, 0, 0
#define SHAPE_C2 SPHV_RADIAL_QUOTIENT, 1, 4, 2
#define SHAPE_C4 SPHV_RADIAL_QUOTIENT, 1, 6, 3
#define SHAPE_C6 SPHV_RADIAL_QUOTIENT, 1, 8, 4
#define SHAPE_CUBIC SPHV_RADIAL_SLOPE, 2, 3, 1

#define PASS(d, level, fields, name)                                                               \
    static void pass_##d##_##level##_##fields##_##name(sphv_pass *pass, size_t count,              \
                                                       const sphv_range *ranges)                   \
    {                                                                                              \
        run(pass, count, ranges, d, SPHV_SUMS_##level, fields, (shape){SHAPE_##name});             \
    }
#define ROW(d, level, fields, name)                                                                \
    {d, SPHV_SUMS_##level, fields, {SHAPE_##name}, pass_##d##_##level##_##fields##_##name},

// Special shapes first: the first row that fits is taken.
#define BOTH_FIELDS(X, d, level, name) X(d, level, 1, name) X(d, level, 2, name)
#define LOW(X, d, name) BOTH_FIELDS(X, d, STANDARD, name) BOTH_FIELDS(X, d, FIRST, name)
#define ANY(X, d, level)                                                                           \
    BOTH_FIELDS(X, d, level, QUOTIENT)                                                             \
    BOTH_FIELDS(X, d, level, SLOPE)                                                                \
    BOTH_FIELDS(X, d, level, PROFILE)
#define DIMENSION(X, d)                                                                            \
    ANY(X, d, STANDARD)                                                                            \
    ANY(X, d, FIRST)                                                                               \
    ANY(X, d, REPRODUCING)                                                                         \
    BOTH_FIELDS(X, d, SECOND, QUOTIENT)                                                            \
    BOTH_FIELDS(X, d, SECOND, PROFILE)                                                             \
    BOTH_FIELDS(X, d, ALL, QUOTIENT)                                                               \
    BOTH_FIELDS(X, d, ALL, PROFILE)
#define SPECIAL(X, d) LOW(X, d, C2) LOW(X, d, C4) LOW(X, d, C6) LOW(X, d, CUBIC)
#define EVERY(X) SPECIAL(X, 2) SPECIAL(X, 3) DIMENSION(X, 1) DIMENSION(X, 2) DIMENSION(X, 3)

EVERY(PASS)

static const struct {
    int dimension;
    sphv_sum_level level;
    int fields;
    shape known;
    sphv_pass_function *pass;
} passes[] = {EVERY(ROW)};

static bool fits(const shape *known, const sphv_radial *radial)
{
    if (known->form != radial->form) return false;
    return known->knots == 0 ||
           (known->knots == radial->knots && known->low == radial->low[0] &&
            known->terms == radial->terms[0] && radial->low[1] == known->low - 1 &&
            radial->terms[1] == known->terms - (known->form == SPHV_RADIAL_QUOTIENT));
}

static sphv_pass_function *choose(int dimension, sphv_sum_level level, int fields,
                                  const sphv_radial *radial)
{
    for (size_t i = 0; i < sizeof passes / sizeof *passes; i++)
        if (passes[i].dimension == dimension && passes[i].level == level &&
            passes[i].fields == fields && fits(&passes[i].known, radial))
            return passes[i].pass;
    return NULL;
}

/// Distances from the box are sums of rounded products, like those of pairs, and rounding is
/// monotone: no pair within the support is lost.
static size_t gather(const sphv_sources *from, int dimension, int fields,
                     const double low[SPHV_DIMENSIONS], const double high[SPHV_DIMENSIONS],
                     double limit, size_t count, const sphv_range *ranges, double *const *to)
{
    const double *arrays[SPHV_DIMENSIONS + 1 + SPHV_PASS_FIELDS];
    int n = 0;
    size_t kept = 0;
    for (int i = 0; i < dimension; i++) arrays[n++] = from->x[i];
    arrays[n++] = from->v;
    for (int f = 0; f < fields; f++) arrays[n++] = from->field[f];
    for (size_t r = 0; r < count; r++) {
#if defined(__AVX512F__) && defined(__AVX512DQ__) && !defined(SPHV_LANES_PLAIN)
        for (size_t b = ranges[r].from; b < ranges[r].to; b += LANES) {
            size_t left = ranges[r].to - b;
            mask valid = left < LANES ? (mask)((1u << left) - 1) : (mask)0xff;
            vec square = v_set(0);
            for (int i = 0; i < dimension; i++) {
                vec x = _mm512_maskz_loadu_pd(valid, from->x[i] + b);
                vec d = v_max(v_max(v_sub(v_set(low[i]), x), v_sub(x, v_set(high[i]))), v_set(0));
                square = v_add(square, v_mul(d, d));
            }
            mask near = v_less(square, v_set(limit)) & valid;
            for (int k = 0; k < n; k++)
                _mm512_mask_compressstoreu_pd(to[k] + kept, near,
                                              _mm512_maskz_loadu_pd(valid, arrays[k] + b));
            kept += (size_t)__builtin_popcount(near);
        }
#else
        for (size_t b = ranges[r].from; b < ranges[r].to; b++) {
            double square = 0;
            for (int i = 0; i < dimension; i++) {
                double x = from->x[i][b], d = fmax(fmax(low[i] - x, x - high[i]), 0);
                square += d * d;
            }
            for (int k = 0; k < n; k++) to[k][kept] = arrays[k][b];
            kept += square < limit;
        }
#endif
    }
    return kept;
}

const sphv_pass_set SPHV_PASS_SET = {SPHV_PASS_SET_NAME, LANES, choose, gather};
