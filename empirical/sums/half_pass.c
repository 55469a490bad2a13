#include "pass_terms.h"

enum { TOGETHER = 4 }; ///< vectors of sources whose roots are taken before they are used

/// A vector of sources, their distances from the target known.
typedef struct prepared {
    vec square, r, inverse, d[SPHV_DIMENSIONS];
} prepared;

/// A target in every lane.
typedef struct target {
    vec x[SPHV_DIMENSIONS], v, field[SPHV_PASS_FIELDS];
} target;

/// Lanes are compared unless all are neighbours beyond doubt. \param by_hand the root comes from
/// multiplications, not from the processor's square root
SPHV_INLINE void prepare(const plan of, const sphv_half_pass *pass, const target *to, size_t b,
                         const sphv_radial_form form, const bool by_hand, prepared *out)
{
    vec square = v_set(0);
    UNROLL for (int i = 0; i < of.dimension; i++)
    {
        vec d = v_sub(v_load(pass->sources.x[i] + b), to->x[i]);
        out->d[i] = d;
        square = i ? v_add(square, v_mul(d, d)) : v_mul(d, d);
    }
    out->square = square;
    out->inverse = square;
    if (form == SPHV_RADIAL_SLOPE || by_hand)
        out->r = v_root(square, &out->inverse);
    else
        out->r = v_sqrt(square);
}

/// Where the sums are, and their weights.
typedef struct sums {
    vec *target;   ///< lane by lane
    double *row;   ///< the source's
    size_t room;   ///< from one sum of the sources to the next
    vec of_source; ///< v
    vec of_target;
    vec source_field[SPHV_PASS_FIELDS]; ///< δA, or v A at the level PLAIN
    vec target_field[SPHV_PASS_FIELDS]; ///< v A at the level PLAIN
} sums;

/// Adds a product to sum k of the target, weighted by the source, and to the sources' sums the
/// other way round.
SPHV_INLINE void add_both(const sums *to, const int k, vec product, const bool odd, vec of_source,
                          vec of_target)
{
    double *row = to->row + (size_t)k * to->room;
    vec before = v_load(row);
    to->target[k] = v_fma(product, of_source, to->target[k]);
    v_store(row, odd ? v_fnma(product, of_target, before) : v_fma(product, of_target, before));
}

/// Adds monomials of degree n times a radial function, made from those of degree n − 1: d changes
/// its sign when a pair is seen from its other end, and so does δA.
SPHV_INLINE void add_degree(const plan of, const int n, const sphv_degrees moments,
                            const sphv_degrees fields, const bool plain, const int moment_at,
                            const int field_at, const vec *before, vec *now, const vec *d,
                            const sums *to)
{
    const int d_count = of_degree(of.dimension, n), made = n > 0 ? d_count : 0;
    const int first_moment =
        moment_at + of_degrees(of.dimension, (sphv_degrees){moments.from, n - 1});
    const int first_field = field_at + of_degrees(of.dimension, (sphv_degrees){fields.from, n - 1});
    UNROLL for (int j = 0; j < made; j++) now[j] =
        v_mul(before[parent_of(of.dimension, n, j)], d[last_axis(of.dimension, n, j)]);
    const int moments_here = n >= moments.from && n <= moments.to ? d_count : 0;
    UNROLL for (int j = 0; j < moments_here; j++)
        add_both(to, first_moment + j, now[j], n % 2, to->of_source, to->of_target);
    const int fields_here = n >= fields.from && n <= fields.to ? of.fields : 0;
    UNROLL for (int f = 0; f < fields_here; f++) UNROLL for (int j = 0; j < d_count; j++)
    {
        const int k = first_field + f * of.per_field + j;
        if (plain)
            add_both(to, k, now[j], n % 2, to->source_field[f], to->target_field[f]);
        else
            add_both(to, k, v_mul(now[j], to->source_field[f]), n % 2 == 0, to->of_source,
                     to->of_target);
    }
}

/// What the loops of a known shape read.
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

/// Adds a vector of sources to all sums.
SPHV_INLINE void add_sources(const plan of, const sphv_half_pass *pass, const sphv_radial *radial,
                             const target *at, size_t b, const sphv_radial_form form,
                             const bool plain, const bool sure, mask near, const prepared *from,
                             vec *sum)
{
    vec w[3];
    sums to = {.target = sum,
               .row = pass->row + (b - pass->first),
               .room = pass->room,
               .of_source = v_set(0),
               .of_target = at->v};
    radial_functions(radial, of.known, form, 2, from->r, from->inverse, v_set(1), w);
    if (!plain) to.of_source = v_load(pass->sources.v + b);
    UNROLL for (int f = 0; f < of.fields; f++)
    {
        to.source_field[f] = v_load(pass->sources.field[f] + b);
        to.target_field[f] = at->field[f];
        if (!plain) to.source_field[f] = v_sub(to.source_field[f], at->field[f]);
    }
    int moment_at = 0, field_at = of.moments;
    UNROLL for (int k = 0; k < 2; k++)
    {
        const sphv_degrees moments = of.set.moment[k], fields = of.set.field[k];
        vec even[DEGREE_TERMS] = {sure ? w[k] : v_where(near, w[k])}, odd[DEGREE_TERMS];
        add_degree(of, 0, moments, fields, plain, moment_at, field_at, odd, even, from->d, &to);
        if (moments.to >= 1 || fields.to >= 1)
            add_degree(of, 1, moments, fields, plain, moment_at, field_at, even, odd, from->d, &to);
        if (moments.to >= 2 || fields.to >= 2)
            add_degree(of, 2, moments, fields, plain, moment_at, field_at, odd, even, from->d, &to);
        moment_at += of_degrees(of.dimension, moments);
        field_at += of_degrees(of.dimension, fields);
    }
}

/// A few vectors of sources: where they begin, and how many sources.
typedef struct batch {
    size_t at, count;
    bool sure; ///< all are neighbours beyond doubt
} batch;

SPHV_INLINE batch batch_at(const sphv_range *range, size_t b)
{
    enum { STEP = TOGETHER * LANES };
    size_t left = b < range->to ? range->to - b : 0;
    return (batch){b, left < STEP ? left : STEP, b >= range->sure && b + STEP <= range->sure_to};
}

/// Distances of a batch. Every other root comes from multiplications, for which the square root's
/// unit would keep the others waiting.
SPHV_INLINE void prepare_batch(const plan of, const sphv_half_pass *pass, const target *to,
                               const batch *next, const sphv_radial_form form, prepared *out)
{
    for (size_t n = 0; n < next->count; n += 2 * LANES, out += 2) {
        prepare(of, pass, to, next->at + n, form, false, &out[0]);
        if (n + LANES < next->count)
            prepare(of, pass, to, next->at + n + LANES, form, true, &out[1]);
    }
}

/// Adds a batch to all sums. \param neighbours counts those of the lanes that are compared
SPHV_INLINE void add_batch(const plan of, sphv_half_pass *pass, const sphv_radial *radial,
                           const target *to, size_t begin, const batch *now,
                           const sphv_radial_form form, const bool plain, const prepared *from,
                           vec *neighbours, vec *sum)
{
    if (now->sure) {
        pass->sure[now->at - pass->first] += 1;
        pass->sure[now->at - pass->first + now->count] -= 1;
        for (int u = 0; u < TOGETHER; u++)
            add_sources(of, pass, radial, to, now->at + (size_t)u * LANES, form, plain, true,
                        v_first(LANES), &from[u], sum);
        return;
    }
    for (size_t n = 0; n < now->count; n += LANES, from++) {
        double *met = pass->met + (now->at + n - pass->first);
        mask near = v_both(v_less(from->square, v_set(radial->limit)), v_first(now->count - n));
        if (now->at + n < begin) near = v_without(near, v_first(begin - now->at - n));
        *neighbours = v_count(*neighbours, near);
        v_store(met, v_count(v_load(met), near));
        add_sources(of, pass, radial, to, now->at + n, form, plain, false, near, from, sum);
    }
}

/// The pass for one dimension, level, number of fields and shape, all known to the compiler. Roots
/// take long, and the many operations that wait for one would fill the processor's scheduler: those
/// of the next batch are taken before a batch is used.
SPHV_INLINE void run(sphv_half_pass *pass, const int dimension, const sphv_sum_level level,
                     const int fields, const shape known)
{
    const plan of = plan_make(dimension, level, fields, known);
    const int count = of.moments + fields * of.per_field;
    const bool plain = level == SPHV_SUMS_PLAIN;
    const sphv_radial_form form = known.knots > 0 ? known.form : pass->radial->form;
    sphv_radial copy; // of what is needed: stores to sums cannot change it
    copy_known(&copy, pass->radial, known);
    const sphv_radial *radial = known.knots > 0 ? &copy : pass->radial;
    for (size_t t = 0; t < pass->count; t++) {
        const size_t a = pass->target[t].at;
        const sphv_range range = pass->target[t].range;
        prepared ahead[2][TOGETHER];
        target to = {.v = v_set(plain ? 0 : pass->sources.v[a])};
        vec sum[SPHV_PASS_SUMS], neighbours = v_set(0);
        UNROLL for (int i = 0; i < dimension; i++) to.x[i] = v_set(pass->sources.x[i][a]);
        UNROLL for (int f = 0; f < fields; f++) to.field[f] = v_set(pass->sources.field[f][a]);
        UNROLL for (int k = 0; k < count; k++) sum[k] = v_set(0);
        double sure = 0;
        batch now = batch_at(&range, range.from / LANES * LANES);
        prepare_batch(of, pass, &to, &now, form, ahead[0]);
        for (int n = 0; now.count > 0; n = !n) {
            batch next = batch_at(&range, now.at + now.count);
            prepare_batch(of, pass, &to, &next, form, ahead[!n]);
            add_batch(of, pass, radial, &to, range.from, &now, form, plain, ahead[n], &neighbours,
                      sum);
            if (now.sure) sure += (double)now.count;
            now = next;
        }
        UNROLL for (int k = 0; k < count; k++) pass->total[(size_t)k * pass->stride + a] +=
            v_total(sum[k]);
        pass->neighbours[t] = v_total(neighbours) + sure;
    }
}

#define PASS(d, level, fields, name)                                                               \
    static void pass_##d##_##level##_##fields##_##name(sphv_half_pass *pass)                       \
    {                                                                                              \
        run(pass, d, SPHV_SUMS_##level, fields, (shape){SHAPE_##name});                            \
    }
#define ROW(d, level, fields, name)                                                                \
    {{d, SPHV_SUMS_##level, fields, {SHAPE_##name}}, pass_##d##_##level##_##fields##_##name},

#define EVERY(X) LOW(X, 2, C4) LOW(X, 2, ANY)

EVERY(PASS)

static const struct {
    pass_row row;
    sphv_half_pass_function *pass;
} passes[] = {EVERY(ROW)};

sphv_half_pass_function *PASS_NAME(sphv_choose_half)(int dimension, sphv_sum_level level,
                                                     int fields, const sphv_radial *radial)
{
    if (radial->form == SPHV_RADIAL_PROFILE) return NULL;
    for (size_t i = 0; i < sizeof passes / sizeof *passes; i++)
        if (suits(&passes[i].row, dimension, level, fields, radial)) return passes[i].pass;
    return NULL;
}
