#include "pass_terms.h"

enum {
    AT_ONCE = 4,      ///< pairs of a target and a vector of sources whose roots are taken together
    SUMS_AT_ONCE = 16 ///< vectors of sums that stay in registers
};

/// A target, in every lane.
typedef struct target {
    double x[SPHV_DIMENSIONS], field[SPHV_PASS_FIELDS];
    size_t begin; ///< the first source to be met
} target;

/// A vector of sources as a target sees it. `inverse` only where p_1 needs it.
typedef struct prepared {
    vec r, inverse, d[SPHV_DIMENSIONS];
} prepared;

/// What a pass knows when it is compiled.
typedef struct half_plan {
    int dimension, fields;
    int per_field; ///< Σ v A p_0 and Σ v A p_1 d_i
    int tile;      ///< targets that meet a vector of sources together
    shape known;
} half_plan;

/// As many targets at once as there is room for their sums.
SPHV_INLINE half_plan half_plan_make(const int dimension, const int fields, const shape known)
{
    const int count = fields * (1 + dimension);
    return (half_plan){.dimension = dimension,
                       .fields = fields,
                       .per_field = 1 + dimension,
                       .tile = AT_ONCE * count <= SUMS_AT_ONCE ? AT_ONCE : AT_ONCE / 2,
                       .known = known};
}

/// What the loops of a known shape read: a copy, which stores to sums cannot change.
SPHV_INLINE void copy_known(sphv_radial *to, const sphv_radial *from, const shape known)
{
    to->inverse_h = from->inverse_h;
    to->limit = from->limit;
    UNROLL for (int i = 0; i < known.knots; i++)
    {
        to->knot[i] = from->knot[i];
        UNROLL for (int k = 0; k < 2; k++) UNROLL for (int j = 0; j < known.terms; j++)
            to->term[k][i][j] = from->term[k][i][j];
    }
}

/// Distances of sources from the targets of a tile, but for 1e-150 where particles coincide. Every
/// other root comes from multiplications, for which the square root's unit would keep the others
/// waiting.
SPHV_INLINE void prepare(const half_plan of, const sphv_sources *sources, const target *to,
                         size_t b, const sphv_radial_form form, prepared out[AT_ONCE])
{
    UNROLL for (int n = 0; n < AT_ONCE; n++)
    {
        const target *at = &to[n % of.tile];
        vec square = v_set(1e-300), inverse;
        UNROLL for (int i = 0; i < of.dimension; i++)
        {
            vec x = v_load(sources->x[i] + b + (size_t)(n / of.tile) * LANES);
            out[n].d[i] = v_sub(x, v_set(at->x[i]));
            square = v_fma(out[n].d[i], out[n].d[i], square);
        }
        if (form != SPHV_RADIAL_SLOPE) {
            out[n].r = n % 2 ? v_root_of(square, &inverse) : v_sqrt(square);
        } else {
            out[n].r = v_root_of(square, &inverse);
            out[n].inverse = inverse;
        }
    }
}

/// Which lanes are neighbours: by the square that every route takes.
SPHV_INLINE mask neighbours_of(const half_plan of, const sphv_radial *radial, const prepared *from,
                               mask valid)
{
    vec square = v_mul(from->d[0], from->d[0]);
    UNROLL for (int i = 1; i < of.dimension; i++) square =
        v_add(square, v_mul(from->d[i], from->d[i]));
    return v_both(v_less(square, v_set(radial->limit)), valid);
}

/// Adds a product to a sum of the target, weighted by the source, and to the source's the other way
/// round; d changes its sign when a pair is seen from its other end.
SPHV_INLINE void add_both(vec product, const bool odd, vec of_source, vec of_target, vec *to_target,
                          vec *to_source)
{
    *to_target = v_fma(product, of_source, *to_target);
    *to_source =
        odd ? v_fnma(product, of_target, *to_source) : v_fma(product, of_target, *to_source);
}

/// Adds what the targets of a tile and a vector of sources are to each other. Lanes are compared
/// unless all are neighbours beyond doubt.
/// \param valid lanes that may be. \param each targets begin with sources of their own
SPHV_INLINE void add_tile(const half_plan of, sphv_half_pass *pass, const sphv_radial *radial,
                          const target *to, size_t b, const sphv_radial_form form, const bool sure,
                          mask valid, bool each, const prepared *from, vec *neighbours, vec *sums)
{
    const int count = of.fields * of.per_field;
    double *row = pass->row + (b - pass->first), *met = pass->met + (b - pass->first);
    const size_t room = pass->room;
    vec sources[SPHV_HALF_SUMS], field[SPHV_PASS_FIELDS], met_here = sure ? v_set(0) : v_load(met);
    UNROLL for (int k = 0; k < count; k++) sources[k] = v_load(row + (size_t)k * room);
    UNROLL for (int f = 0; f < of.fields; f++) field[f] = v_load(pass->sources.field[f] + b);
    UNROLL for (int t = 0; t < of.tile; t++)
    {
        vec w[3], product[SPHV_DIMENSIONS + 1];
        radial_functions(radial, of.known, form, 2, from[t].r, from[t].inverse, v_set(1), w);
        if (!sure) {
            mask near = neighbours_of(of, radial, &from[t], valid);
            if (each && b < to[t].begin) near = v_without(near, v_first(to[t].begin - b));
            neighbours[t] = v_count(neighbours[t], near);
            met_here = v_count(met_here, near);
            w[0] = v_where(near, w[0]);
            w[1] = v_where(near, w[1]);
        }
        product[0] = w[0];
        UNROLL for (int i = 0; i < of.dimension; i++) product[1 + i] = v_mul(w[1], from[t].d[i]);
        UNROLL for (int f = 0; f < of.fields; f++) UNROLL for (int k = 0; k < of.per_field; k++)
            add_both(product[k], k > 0, field[f], v_set(to[t].field[f]),
                     &sums[t * count + f * of.per_field + k], &sources[f * of.per_field + k]);
    }
    UNROLL for (int k = 0; k < count; k++) v_store(row + (size_t)k * room, sources[k]);
    if (!sure) v_store(met, met_here);
}

/// The targets of a tile. Places that no target is left for meet nobody.
SPHV_INLINE void load_tile(const half_plan of, const sphv_sources *sources,
                           const sphv_half_visit *visit, target *to)
{
    for (size_t t = 0; t < (size_t)of.tile; t++) {
        const bool real = t < visit->tile->count;
        const size_t a = visit->tile->target[real ? t : 0];
        for (int i = 0; i < of.dimension; i++) to[t].x[i] = sources->x[i][a];
        for (int f = 0; f < of.fields; f++) to[t].field[f] = sources->field[f][a];
        to[t].begin = !real ? SIZE_MAX : visit->own ? a + 1 : 0;
    }
}

/// The pass for one dimension, number of fields and shape, all known to the compiler. Roots take
/// long, and the many operations that wait for one would fill the processor's scheduler: those of
/// the next sources are taken before the last are used.
SPHV_INLINE void run(sphv_half_pass *pass, const int dimension, const int fields, const shape known)
{
    const half_plan of = half_plan_make(dimension, fields, known);
    const int count = of.fields * of.per_field;
    const size_t size = (size_t)of.tile, step = AT_ONCE / size * LANES;
    const sphv_radial_form form = known.knots > 0 ? known.form : pass->radial->form;
    const sphv_sources *sources = &pass->sources;
    sphv_radial copy;
    copy_known(&copy, pass->radial, known);
    const sphv_radial *radial = known.knots > 0 ? &copy : pass->radial;
    for (size_t i = 0; i < pass->count; i++) {
        const sphv_half_visit *visit = &pass->visit[i];
        const sphv_half_tile *tile = visit->tile;
        const sphv_range range = visit->range;
        const bool each = visit->own || tile->count < size;
        target to[AT_ONCE];
        prepared ahead[2][AT_ONCE];
        vec sum[AT_ONCE * SPHV_HALF_SUMS], neighbours[AT_ONCE];
        load_tile(of, sources, visit, to);
        UNROLL for (int t = 0; t < of.tile; t++) neighbours[t] = v_set(0);
        UNROLL for (int k = 0; k < of.tile * count; k++) sum[k] = v_set(0);
        size_t b = range.from / LANES * LANES, sure = 0;
        int n = 0;
        prepare(of, sources, to, b, form, ahead[0]);
        for (int part = 0; part < 2; part++) {
            const size_t end = part || range.to < range.sure ? range.to : range.sure;
            for (; b < end; b += step, n = !n) {
                prepare(of, sources, to, b + step, form, ahead[!n]);
                for (size_t m = 0; m < step && b + m < range.to; m += LANES) {
                    mask valid = v_first(range.to - b - m);
                    if (b + m < range.from) valid = v_without(valid, v_first(range.from - b - m));
                    add_tile(of, pass, radial, to, b + m, form, false, valid, each,
                             &ahead[n][m / LANES * size], neighbours, sum);
                }
            }
            if (part || b + step > range.sure_to) continue;
            sure = b;
            for (; b + step <= range.sure_to; b += step, n = !n) {
                prepare(of, sources, to, b + step, form, ahead[!n]);
                UNROLL for (size_t m = 0; m < step; m += LANES)
                    add_tile(of, pass, radial, to, b + m, form, true, v_first(LANES), false,
                             &ahead[n][m / LANES * size], neighbours, sum);
            }
            pass->sure[sure - pass->first] += (double)size;
            pass->sure[b - pass->first] -= (double)size;
            sure = b - sure;
        }
        UNROLL for (int t = 0; t < of.tile; t++)
        {
            if ((size_t)t == tile->count) break;
            const size_t a = tile->target[t];
            UNROLL for (int k = 0; k < count; k++) pass->total[(size_t)k * pass->stride + a] +=
                v_total(sum[t * count + k]);
            pass->neighbours[a - pass->first_target] = v_total(neighbours[t]) + (double)sure;
        }
    }
}

#define PASS(d, fields, name)                                                                      \
    static void pass_##d##_##fields##_##name(sphv_half_pass *pass)                                 \
    {                                                                                              \
        run(pass, d, fields, (shape){SHAPE_##name});                                               \
    }
#define ROW(d, fields, name) {d, fields, {SHAPE_##name}, pass_##d##_##fields##_##name},

#if defined(__x86_64__) && !defined(__AVX2__)
#define SHAPES(X, d, fields) X(d, fields, ANY)
#else
#define SHAPES(X, d, fields)                                                                       \
    X(d, fields, C2) X(d, fields, C4) X(d, fields, C6) X(d, fields, CUBIC) X(d, fields, ANY)
#endif
#define EVERY(X) SHAPES(X, 2, 1) SHAPES(X, 2, 2) SHAPES(X, 3, 1) SHAPES(X, 3, 2)

EVERY(PASS)

static const struct {
    int dimension, fields;
    shape known;
    sphv_half_pass_function *pass;
} passes[] = {EVERY(ROW)};

sphv_half_pass_function *PASS_NAME(sphv_choose_half)(int dimension, int fields,
                                                     const sphv_radial *radial, size_t *tile)
{
    *tile = (size_t)half_plan_make(dimension, fields, (shape){SHAPE_ANY}).tile;
    if (radial->form == SPHV_RADIAL_PROFILE) return NULL;
    for (size_t i = 0; i < sizeof passes / sizeof *passes; i++)
        if (passes[i].dimension == dimension && passes[i].fields == fields &&
            fits(&passes[i].known, radial))
            return passes[i].pass;
    return NULL;
}
