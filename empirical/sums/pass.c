#include "pass_terms.h"

enum {
    AHEAD = 4, ///< sources whose distances are taken before they are used
    RING = 8,  ///< places for them
};

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

/// What one radial function adds to.
typedef struct addition {
    int dimension, fields, per_field;
    sphv_degrees moment, field;
} addition;

/// Monomials of degree n times w, from those of degree n − 1. Adds them to the moments, and times
/// δA to the field sums.
SPHV_INLINE void add_degree(const addition to, const int n, const vec *before, vec *now,
                            const vec d[3], const vec da[2], vec *moments, vec *sums)
{
    const int count = of_degree(to.dimension, n);
    const bool in_moments = n >= to.moment.from && n <= to.moment.to;
    const bool in_sums = n >= to.field.from && n <= to.field.to;
    const int moment_at = of_degrees(to.dimension, (sphv_degrees){to.moment.from, n - 1});
    const int field_at = of_degrees(to.dimension, (sphv_degrees){to.field.from, n - 1});
    const int fields_here = in_sums ? to.fields : 0;
    const bool last = n >= to.moment.to && n >= to.field.to; // products are not needed again
    const int made = n > 0 ? count : 0;
    UNROLL for (int j = 0; j < made; j++)
    {
        const int axis = last_axis(to.dimension, n, j), parent = parent_of(to.dimension, n, j);
        if (last && !in_sums)
            moments[moment_at + j] = v_fma(before[parent], d[axis], moments[moment_at + j]);
        else
            now[j] = v_mul(before[parent], d[axis]);
    }
    const int moments_here = in_moments && (n == 0 || !last || in_sums) ? count : 0;
    UNROLL for (int j = 0; j < moments_here; j++) moments[moment_at + j] =
        v_add(moments[moment_at + j], now[j]);
    UNROLL for (int f = 0; f < fields_here; f++) UNROLL for (int j = 0; j < count; j++)
        sums[f * to.per_field + field_at + j] =
            v_fma(now[j], da[f], sums[f * to.per_field + field_at + j]);
}

/// Adds w s^α and w s^α δA of one radial function, degree by degree.
SPHV_INLINE void add_terms(const addition to, vec w, const vec d[3], const vec da[2], vec *moments,
                           vec *sums)
{
    vec even[DEGREE_TERMS] = {w}, odd[DEGREE_TERMS] = {w};
    const int degree = to.moment.to > to.field.to ? to.moment.to : to.field.to;
    add_degree(to, 0, odd, even, d, da, moments, sums);
    if (degree >= 1) add_degree(to, 1, even, odd, d, da, moments, sums);
    if (degree >= 2) add_degree(to, 2, odd, even, d, da, moments, sums);
    if (degree >= 3) add_degree(to, 3, even, odd, d, da, moments, sums);
    if (degree >= 4) add_degree(to, 4, odd, even, d, da, moments, sums);
    if (degree >= 5) add_degree(to, 5, even, odd, d, da, moments, sums);
}

/// What is known of a source before its turn.
typedef struct prepared {
    vec r; ///< distance; its square where the profile wants that
    vec inverse, v, d[SPHV_DIMENSIONS];
} prepared;

/// Distance and masked volume of source b; the mask is not needed for sure neighbours. Roots take
/// long, and the many operations that wait for one would fill the processor's scheduler: they are
/// taken AHEAD sources before they are used. Without need for 1/r the root comes from the
/// processor's square root, and once in eight from multiplications, which it would keep waiting:
/// both units are busy. Where nothing is decided by the square it is rounded less.
SPHV_INLINE void prepare(const plan of, const sphv_pass *pass, const vec x[3], size_t b,
                         const sphv_radial_form form, bool sure, vec *neighbours, prepared *out)
{
    UNROLL for (int i = 0; i < of.dimension; i++) out->d[i] =
        v_sub(v_set(pass->sources.x[i][b]), x[i]);
    vec square = v_mul(out->d[0], out->d[0]), inverse;
    out->v = v_set(pass->sources.v[b]);
    if (sure && form != SPHV_RADIAL_PROFILE) {
        UNROLL for (int i = 1; i < of.dimension; i++) square = v_fma(out->d[i], out->d[i], square);
    } else {
        UNROLL for (int i = 1; i < of.dimension; i++) square =
            v_add(square, v_mul(out->d[i], out->d[i]));
    }
    if (!sure) {
        mask near = v_less(square, v_set(pass->radial->limit));
        *neighbours = v_count(*neighbours, near);
        out->v = v_where(near, out->v);
    }
    if (form == SPHV_RADIAL_PROFILE)
        out->r = square;
    else if (of.known.knots == 1)
        out->r = b % 8 ? v_sqrt(square) : v_root(square, &inverse);
    else
        out->r = v_root(square, &out->inverse);
}

/// Adds source b to all sums.
SPHV_INLINE void add_source(const plan of, const sphv_pass *pass, const vec a[2], size_t b,
                            const sphv_radial_form form, const prepared *from, vec *sum)
{
    vec da[2], w[3], size[3];
    UNROLL for (int f = 0; f < of.fields; f++) da[f] =
        v_sub(v_set(pass->sources.field[f][b]), a[f]);
    if (form == SPHV_RADIAL_PROFILE) {
        profile_functions(pass, from->r, w, size);
        UNROLL for (int k = 0; k < 3; k++)
        {
            w[k] = v_mul(w[k], from->v);
            sum[of.moments + k] =
                v_fma(v_max(from->v, v_sub(v_set(0), from->v)), size[k], sum[of.moments + k]);
        }
    } else {
        radial_functions(pass->radial, of.known, form, of.functions, from->r, from->inverse,
                         from->v, w);
    }
    int moment_at = 0, field_at = of.moments + 3;
    UNROLL for (int k = 0; k < of.functions; k++)
    {
        const addition terms = {of.dimension, of.fields, of.per_field, of.set.moment[k],
                                of.set.field[k]};
        add_terms(terms, w[k], from->d, da, sum + moment_at, sum + field_at);
        moment_at += of_degrees(of.dimension, of.set.moment[k]);
        field_at += of_degrees(of.dimension, of.set.field[k]);
    }
}

/// The pass for one dimension, level, number of fields and shape, all known to the compiler.
SPHV_INLINE void run(sphv_pass *pass, size_t range_count, const sphv_range *ranges,
                     const int dimension, const sphv_sum_level level, const int fields,
                     const shape known)
{
    const plan of = plan_make(dimension, level, fields, known);
    const sphv_radial_form form = known.knots > 0 ? known.form : pass->radial->form;
    prepared ahead[RING];
    vec x[3], a[2], neighbours = v_set(0);
    UNROLL for (int i = 0; i < dimension; i++) x[i] = v_load(pass->x[i]);
    UNROLL for (int f = 0; f < fields; f++) a[f] = v_load(pass->a[f]);
    for (int k = 0; k < of.count; k++) v_store(pass->sums + k * SPHV_LANES_MAX, v_set(0));
    // Zeros that the compiler does not know as such: it would write them to memory first.
    const vec nought = v_sub(x[0], x[0]);
    for (size_t r = 0; r < range_count; r++) {
        const size_t sure = ranges[r].sure, sure_count = ranges[r].sure_to - sure;
        neighbours = v_add(neighbours, v_set((double)sure_count));
        for (size_t from = ranges[r].from; from < ranges[r].to; from += SPHV_PASS_PART) {
            size_t b = from, to = from + SPHV_PASS_PART;
            if (ranges[r].to < to) to = ranges[r].to;
            vec sum[SPHV_PASS_SUMS];
            UNROLL for (int k = 0; k < of.count; k++) sum[k] = nought;
            for (; b < to && b < from + AHEAD; b++)
                prepare(of, pass, x, b, form, b - sure < sure_count, &neighbours, &ahead[b % RING]);
            for (b = from; b < to; b++) {
                if (b + AHEAD < to)
                    prepare(of, pass, x, b + AHEAD, form, b + AHEAD - sure < sure_count,
                            &neighbours, &ahead[(b + AHEAD) % RING]);
                add_source(of, pass, a, b, form, &ahead[b % RING], sum);
            }
            UNROLL for (int k = 0; k < of.count; k++)
            {
                double *total = pass->sums + k * SPHV_LANES_MAX;
                v_store(total, v_add(v_load(total), sum[k]));
            }
        }
    }
    v_store(pass->neighbours, neighbours);
}

#define PASS(d, level, fields, name)                                                               \
    static void pass_##d##_##level##_##fields##_##name(sphv_pass *pass, size_t count,              \
                                                       const sphv_range *ranges)                   \
    {                                                                                              \
        run(pass, count, ranges, d, SPHV_SUMS_##level, fields, (shape){SHAPE_##name});             \
    }
#define ROW(d, level, fields, name)                                                                \
    {{d, SPHV_SUMS_##level, fields, {SHAPE_##name}}, pass_##d##_##level##_##fields##_##name},

#define DIMENSION(X, d)                                                                            \
    LOW(X, d, ANY)                                                                                 \
    X(d, REPRODUCING, 2, ANY)                                                                      \
    X(d, SECOND, 2, ANY)                                                                           \
    X(d, ALL, 2, ANY)
#define EVERY(X) SPECIAL(X, 2) SPECIAL(X, 3) DIMENSION(X, 1) DIMENSION(X, 2) DIMENSION(X, 3)

EVERY(PASS)

static const struct {
    pass_row row;
    sphv_pass_function *pass;
} passes[] = {EVERY(ROW)};

static sphv_pass_function *choose(int dimension, sphv_sum_level level, int fields,
                                  const sphv_radial *radial)
{
    for (size_t i = 0; i < sizeof passes / sizeof *passes; i++)
        if (suits(&passes[i].row, dimension, level, fields, radial)) return passes[i].pass;
    return NULL;
}

/// Distances from the box are sums of rounded products, like those of pairs, and rounding is
/// monotone: no pair within the support is lost. Whole vectors are written: `to` has room for one
/// more.
SPHV_INLINE size_t gather_near(const sphv_sources *from, const int dimension, const int fields,
                               const double *low, const double *high, double limit, size_t count,
                               const sphv_range *ranges, double *const *to)
{
    const double *arrays[SPHV_DIMENSIONS + 1 + SPHV_PASS_FIELDS];
    const int n = dimension + 1 + fields;
    size_t kept = 0;
    UNROLL for (int i = 0; i < dimension; i++) arrays[i] = from->x[i];
    arrays[dimension] = from->v;
    UNROLL for (int f = 0; f < fields; f++) arrays[dimension + 1 + f] = from->field[f];
    for (size_t r = 0; r < count; r++) {
#if defined(__AVX512F__) && defined(__AVX512DQ__) && !defined(SPHV_LANES_PLAIN)
        for (size_t b = ranges[r].from; b < ranges[r].to; b += LANES) {
            size_t left = ranges[r].to - b;
            mask valid = left < LANES ? (mask)((1u << left) - 1) : (mask)0xff;
            vec square = v_set(0);
            UNROLL for (int i = 0; i < dimension; i++)
            {
                vec x = _mm512_maskz_loadu_pd(valid, arrays[i] + b);
                vec d = v_max(v_max(v_sub(v_set(low[i]), x), v_sub(x, v_set(high[i]))), v_set(0));
                square = i ? v_add(square, v_mul(d, d)) : v_mul(d, d);
            }
            mask near = v_less(square, v_set(limit)) & valid;
            // compressed in a register: compressing into memory takes several times as long
            UNROLL for (int k = 0; k < n; k++) v_store(
                to[k] + kept,
                _mm512_maskz_compress_pd(near, _mm512_maskz_loadu_pd(valid, arrays[k] + b)));
            kept += (size_t)__builtin_popcount(near);
        }
#else
        for (size_t b = ranges[r].from; b < ranges[r].to; b++) {
            double square = 0;
            UNROLL for (int i = 0; i < dimension; i++)
            {
                double x = arrays[i][b], below = low[i] - x, above = x - high[i];
                double apart = below > above ? below : above, d = apart > 0 ? apart : 0;
                square += d * d;
            }
            UNROLL for (int k = 0; k < n; k++) to[k][kept] = arrays[k][b];
            kept += square < limit;
        }
#endif
    }
    return kept;
}

static size_t gather(const sphv_sources *from, int dimension, int fields,
                     const double low[SPHV_DIMENSIONS], const double high[SPHV_DIMENSIONS],
                     double limit, size_t count, const sphv_range *ranges, double *const *to)
{
#define GATHER(d, f)                                                                               \
    if (dimension == (d) && fields == (f))                                                         \
    return gather_near(from, d, f, low, high, limit, count, ranges, to)
    GATHER(1, 1);
    GATHER(1, 2);
    GATHER(2, 1);
    GATHER(2, 2);
    GATHER(3, 1);
    return gather_near(from, 3, 2, low, high, limit, count, ranges, to);
}

const sphv_pass_set PASS_NAME(sphv_passes) = {SPHV_PASS_SET_NAME, LANES, choose, gather,
                                              PASS_NAME(sphv_choose_half)};
