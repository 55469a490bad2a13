#include "lattice_table.h"

#include <stdlib.h>
#include <string.h>

#include "../internal.h"

void sphv_lattice_table_free(sphv_lattice_table *table)
{
    for (int k = 0; k < 3; k++) {
        free(table->p[k]);
        free(table->size[k]);
        free(table->error[k]);
    }
    free(table->inside);
    free(table->tie);
    free(table->class_of);
    free(table->low);
    free(table->high);
    *table = (sphv_lattice_table){0};
}

static size_t power(size_t base, int exponent)
{
    size_t product = 1;
    for (int i = 0; i < exponent; i++) product *= base;
    return product;
}

/// Distance from a lattice of the particles' rounded positions.
static double find_stray(const sphv_particles *particles, size_t side)
{
    double stray = 0;
    for (int i = 0; i < particles->dimension; i++) {
        size_t run = power(side, particles->dimension - 1 - i);
        const double *x = particles->x[i];
        for (size_t n = 0; n < particles->count; n++) {
            long double place = (long double)(n / run % side) * (long double)particles->spacing;
            stray = fmax(stray, (double)fabsl(x[n] - x[0] - place));
        }
    }
    return stray;
}

static sphv_status check(const sphv_particles *particles, double *stray, sphv_error *error)
{
    size_t side = particles->lattice_side;
    if (side == 0 || particles->periodic || power(side, particles->dimension) != particles->count)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "sums by convolution need an unperturbed lattice in a box with sides; "
                         "allowed: the direct route");
    for (size_t n = 1; n < particles->count; n++)
        if (particles->volume[n] != particles->volume[0])
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "sums by convolution need the same volume for all particles; allowed: "
                             "the direct route");
    *stray = find_stray(particles, side);
    if (!(*stray <= 16 * SPHV_U * (1 + fabs(particles->x[0][0]))))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "the particles are up to %g off a lattice; allowed: the direct route",
                         *stray);
    return SPHV_OK;
}

/// Which offsets a place along a side leaves, and how many different such sets there are.
static bool classify(sphv_lattice_table *table)
{
    size_t side = table->side, reach = table->reach;
    bool wide = side < 2 * reach + 1; // every place is a class of its own
    table->classes_a_side = wide ? side : 2 * reach + 1;
    table->classes = power(table->classes_a_side, table->dimension);
    table->class_of = malloc(side * sizeof *table->class_of);
    table->low = malloc(table->classes_a_side * sizeof *table->low);
    table->high = malloc(table->classes_a_side * sizeof *table->high);
    if (!table->class_of || !table->low || !table->high) return false;
    for (size_t j = 0; j < side; j++) {
        size_t above = side - 1 - j;
        size_t c = wide || j < reach ? j : above < reach ? 2 * reach - above : reach;
        table->class_of[j] = c;
        table->low[c] = j < reach ? j : reach;
        table->high[c] = above < reach ? above : reach;
    }
    return true;
}

/// What moving a particle by up to δs in each coordinate, δ in all, does to v p_k s^α, in units of
/// v κ^(|α| − m): to p_k by the slopes of Ŵ, and to s^α with |s^α| <= q^m κ^(|α| − m).
static double moved(const sphv_radial *radial, const sphv_lattice_table *table, int k, double q,
                    const double p[3], double by)
{
    double all = by * sqrt(table->dimension), degree = table->degree[k];
    double first = (radial->slope[2] + fabs(p[1])) * all / q; // of p_1 = Ŵ′/q
    double change = k == 0 ? radial->slope[1] * all
                    : k == 1
                        ? first
                        : (radial->slope[3] * all + first) / (q * q) + 2 * fabs(p[2]) * all / q;
    return (change + fabs(p[k]) * degree * by / q) * pow(q, table->lowest[k]);
}

/// How near a knot rounding decides on which side an offset is.
static double blur(double q, double by)
{
    return 4 * (2 * by + 8 * SPHV_U * q);
}

static bool undecided(double q, double knot, double by)
{
    return fabs(q - knot) <= blur(q, by);
}

struct ingredients {
    const sphv_radial *radial;
    sphv_sum_level level;
    double spacing, stray, rounding;
};

/// Fills in one offset of the octant; false when a radial function that is needed jumps there.
static bool evaluate(const struct ingredients *with, sphv_lattice_table *table, size_t n)
{
    const sphv_profile *profile = with->radial->profile;
    double square = 0, by = 2 * with->stray / with->radial->h;
    size_t rest = n;
    for (int i = 0; i < table->dimension; i++, rest /= table->reach + 1)
        square += (double)(rest % (table->reach + 1)) * (double)(rest % (table->reach + 1));
    double q = sqrt(square) * table->step;
    square *= with->spacing * with->spacing;
    bool tie = undecided(q, profile->support, by), inside = square < with->radial->limit;
    int needed = table->degree[2] >= 0 ? 2 : 1;
    for (int i = 0; i < profile->knot_count; i++)
        if (n > 0 && profile->knots[i].order <= needed &&
            undecided(q, profile->knots[i].position.value, by))
            return false;
    table->inside[n] = inside && !tie;
    if (!inside && !tie) return true;
    double p[3] = {0}, size[3] = {0};
    if (inside) sphv_radial_values(with->radial, with->level, square, p, size);
    if (tie) by = blur(q, by);
    for (int k = 0; k < 3; k++) {
        if (table->degree[k] < 0) continue;
        table->p[k][n] = p[k];
        table->size[k][n] = fabs(p[k]) * pow(q, table->lowest[k]);
        table->error[k][n] = with->rounding * size[k];
        if (n > 0) table->error[k][n] += moved(with->radial, table, k, q, p, by);
    }
    return true;
}

/// Offsets of all octants at which rounding decides whether they are within the support.
static bool list_ties(const struct ingredients *with, sphv_lattice_table *table)
{
    double by = 2 * with->stray / with->radial->h, support = with->radial->profile->support;
    for (int pass = 0; pass < 2; pass++) {
        size_t found = 0;
        for (size_t n = 0; n < table->octant; n++) {
            int offset[SPHV_DIMENSIONS] = {0};
            double square = 0;
            size_t rest = n;
            for (int i = table->dimension - 1; i >= 0; i--, rest /= table->reach + 1) {
                offset[i] = (int)(rest % (table->reach + 1));
                square += (double)offset[i] * offset[i];
            }
            if (!undecided(sqrt(square) * table->step, support, by)) continue;
            for (int signs = 0; signs < 1 << table->dimension; signs++) {
                bool again = false; // −0 is 0
                for (int i = 0; i < table->dimension; i++)
                    again = again || (signs >> i & 1 && offset[i] == 0);
                if (again) continue;
                for (int i = 0; pass && i < SPHV_DIMENSIONS; i++)
                    table->tie[found][i] = signs >> i & 1 ? -offset[i] : offset[i];
                found++;
            }
        }
        if (pass == 0) table->tie = malloc((found + 1) * sizeof *table->tie);
        if (!table->tie) return false;
        table->ties = found;
    }
    return true;
}

static sphv_status fill(const struct ingredients *with, sphv_lattice_table *table,
                        sphv_error *error)
{
    bool enough = (table->inside = calloc(table->octant, 1)) != NULL;
    for (int k = 0; k < 3; k++) {
        if (table->degree[k] < 0) continue;
        table->p[k] = calloc(table->octant, sizeof(double));
        table->size[k] = calloc(table->octant, sizeof(double));
        table->error[k] = calloc(table->octant, sizeof(double));
        enough = enough && table->p[k] && table->size[k] && table->error[k];
    }
    if (!enough || !classify(table) || !list_ties(with, table))
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory for %zu offsets",
                         table->octant);
    bool jumps = false;
#pragma omp parallel for schedule(static) reduction(|| : jumps) if (table->octant > 1000)
    for (size_t n = 0; n < table->octant; n++) jumps = !evaluate(with, table, n) || jumps;
    for (size_t n = 0; n < table->octant; n++)
        for (int k = 0; k < 3; k++)
            if (table->degree[k] >= 0 &&
                !isfinite(table->volume * (table->size[k][n] + table->error[k][n] / SPHV_U)))
                return sphv_fail(error, SPHV_INVALID_INPUT,
                                 "the sums overflow: volumes of %g with h = %g; allowed: the "
                                 "direct route",
                                 table->volume, with->radial->h);
    if (jumps)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "the kernel or a derivative jumps at the distance of a particle, where "
                         "rounding decides; allowed: the direct route");
    return SPHV_OK;
}

sphv_status sphv_lattice_table_make(const sphv_evaluation *evaluation, sphv_lattice_table *table,
                                    sphv_error *error)
{
    const sphv_particles *particles = evaluation->particles;
    const sphv_profile *profile = evaluation->request->profile;
    const sphv_sum_set *set = &sphv_sum_sets[evaluation->layout.level];
    double h = evaluation->request->h, stray = 0;
    *table =
        (sphv_lattice_table){.dimension = particles->dimension, .side = particles->lattice_side};
    sphv_status status = check(particles, &stray, error);
    if (status != SPHV_OK) return status;
    table->step = particles->spacing / h;
    table->volume = particles->volume[0];
    for (int i = 0; i < table->dimension; i++) table->volume /= h;
    double reach = ceil(profile->support / table->step) + 1;
    table->reach = (size_t)fmin(reach, (double)table->side - 1);
    table->width = 2 * table->reach + 1;
    table->cells = power(table->width, table->dimension);
    table->octant = power(table->reach + 1, table->dimension);
    for (int k = 0; k < 3; k++) {
        const sphv_degrees *moment = &set->moment[k], *field = &set->field[k];
        int most = moment->to > field->to ? moment->to : field->to;
        table->degree[k] = moment->from <= moment->to ? most : -1;
        table->lowest[k] = moment->from;
    }
    sphv_radial radial;
    sphv_radial_make(&radial, profile, h, evaluation->layout.level);
    const struct ingredients with = {&radial, evaluation->layout.level, particles->spacing, stray,
                                     sphv_summand_rounding(&evaluation->layout)};
    status = fill(&with, table, error);
    if (status != SPHV_OK) sphv_lattice_table_free(table);
    return status;
}

double sphv_offset_value(const sphv_lattice_table *table, const sphv_offset_function *function,
                         const long offset[SPHV_DIMENSIONS])
{
    size_t n = 0;
    double value = function->factor;
    for (int i = 0; i < table->dimension; i++) n = n * (table->reach + 1) + (size_t)labs(offset[i]);
    value *= function->octant ? function->octant[n] : table->inside[n];
    for (int i = 0; function->monomial && i < table->dimension; i++)
        for (int j = 0; j < function->monomial->power[i]; j++)
            value *= (double)offset[i] * table->step;
    return value;
}

size_t sphv_lattice_class(const sphv_lattice_table *table, size_t n, size_t place[SPHV_DIMENSIONS])
{
    size_t which = 0;
    for (int i = table->dimension - 1; i >= 0; i--, n /= table->side) place[i] = n % table->side;
    for (int i = 0; i < table->dimension; i++)
        which = which * table->classes_a_side + table->class_of[place[i]];
    return which;
}

/// Replaces an axis of `width` offsets by the sums over the offsets of each class.
/// \param before, after numbers of lines that differ in the slower and in the faster coordinates
static void contract(const sphv_lattice_table *table, const long double *from, long double *to,
                     size_t before, size_t after, long double *prefix)
{
    for (size_t outer = 0; outer < before; outer++)
        for (size_t inner = 0; inner < after; inner++) {
            const long double *line = from + outer * table->width * after + inner;
            long double *sums = to + outer * table->classes_a_side * after + inner;
            prefix[0] = 0;
            for (size_t j = 0; j < table->width; j++) prefix[j + 1] = prefix[j] + line[j * after];
            for (size_t c = 0; c < table->classes_a_side; c++)
                sums[c * after] = prefix[table->reach + table->high[c] + 1] -
                                  prefix[table->reach - table->low[c]];
        }
}

sphv_status sphv_cuboid_sums(const sphv_lattice_table *table, const sphv_offset_function *function,
                             double *out)
{
    int d = table->dimension;
    // Classes are never more than offsets along an axis, so no array grows.
    long double *from = malloc(table->cells * sizeof *from);
    long double *to = malloc(table->cells * sizeof *to);
    long double *prefix = malloc((table->width + 1) * sizeof *prefix);
    bool enough = from && to && prefix;
    for (size_t n = 0; enough && n < table->cells; n++) {
        long offset[SPHV_DIMENSIONS] = {0};
        size_t rest = n;
        for (int i = d - 1; i >= 0; i--, rest /= table->width)
            offset[i] = (long)(rest % table->width) - (long)table->reach;
        from[n] = sphv_offset_value(table, function, offset);
    }
    for (int axis = d - 1; enough && axis >= 0; axis--) {
        contract(table, from, to, power(table->width, axis),
                 power(table->classes_a_side, d - 1 - axis), prefix);
        long double *swap = from;
        from = to;
        to = swap;
    }
    for (size_t c = 0; enough && c < table->classes; c++) out[c] = (double)from[c];
    free(from);
    free(to);
    free(prefix);
    return enough ? SPHV_OK : SPHV_RESOURCE_FAILURE;
}

/// Each axis adds up to 2 reach + 1 numbers and takes one difference, each off by ε of a partial
/// sum of moduli; the difference of two prefixes carries the errors of both, so each axis may
/// double what the one before left.
double sphv_cuboid_error(const sphv_lattice_table *table)
{
    double axis = ((double)table->width + 1) * (double)LDBL_EPSILON;
    return 1.01 * table->dimension * (double)(1 << table->dimension) * axis;
}
