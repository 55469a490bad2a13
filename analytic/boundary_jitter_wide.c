#include <gsl/gsl_math.h>
#include <stdlib.h>

#include "boundary_jitter.h"

// Where many neighbours share a support, what perturbations do is small, of the order σΔx/h
// relative to the error, and smooth on the scale of h. So the lattice's own theory, exact, is
// corrected by sums over few particles with few neighbours each: nodes of Gauss's rule for sums,
// each of which stands for many, in panels between the edges, the strips and the interior. What a
// coarser rule makes of it tells how good it is.

enum {
    N = SPHV_QUANTITIES_MAX,
    NODES_MAX = 12,
    PANELS = 5,
    REGIONS = PANELS * PANELS,
    SOURCES = 3,
    LINES_MAX = 2 * NODES_MAX + 2, ///< of neighbours: two sides and what is between
};

/// Nodes of particles in a strip and in the interior, and of neighbours on either side of a
/// particle.
struct orders {
    int strip, interior, neighbours;
    bool on_lines; ///< particles near a side are moved to the nearest line
};
/// By dimension: places and neighbours are products.
static const struct orders fine[] = {{10, 12, 12, false}, {4, 6, 6, false}};
static const struct orders coarse[] = {{7, 9, 8, true}, {2, 4, 4, true}};

/// Some of the lines of one coordinate, by index, and how many each stands for.
struct nodes {
    int count;
    double index[LINES_MAX], weight[LINES_MAX];
};

/// A place of particles in one coordinate, and the lines of their neighbours.
struct place {
    double index, weight;
    int panel;
    bool inside;
    struct nodes near;
};

struct places {
    int count;
    struct place at[PANELS * NODES_MAX];
};

/// Mean changes of squares of h^|β| times the error, over all particles and over the interior.
struct changes {
    double count[2], next[2][N], rounding[2][N];
    /// What is added to squares by the mean, by own displacements and by those of neighbours;
    /// region by region, so that the faults of rules cannot cancel.
    double square[REGIONS][SOURCES][2][N];
    /// (Mean error)² times variance, and variance², of own displacements and of neighbours'.
    double own[2][2][N], shared[2][2][N];
    bool singular[2];
};

/// Adds nodes for the lines from … to − 1.
static bool add_nodes(struct nodes *nodes, double from, double to, int order)
{
    order = (int)fmin(order, to - from);
    if (order < 1) return true;
    double *index = nodes->index + nodes->count;
    if (!sphv_sum_rule(order, to - from, index, nodes->weight + nodes->count)) return false;
    for (int i = 0; i < order; i++) index[i] += from;
    nodes->count += order;
    return true;
}

static double reach_of(const sphv_jitter_cloud *of)
{
    return of->profile->support / of->ds + 4 * of->box->amplitude;
}

/// Whether all lines within reach of an index are alike.
static bool is_deep(const sphv_jitter_cloud *of, double index)
{
    double whole = floor(reach_of(of)), last = (double)of->box->side - 1;
    return of->box->periodic || (index - whole > 1 && index + whole < last - 1);
}

/// The lines within reach of an index: the sides, which perturbations treat in another way, alone.
static bool find_near(const sphv_jitter_cloud *of, double index, int order, struct nodes *out)
{
    double reach = reach_of(of), last = (double)of->box->side - 1;
    double from = ceil(index - reach), to = floor(index + reach) + 1;
    out->count = 0;
    // Lines of the particle's own lattice: nodes need not be whole numbers, and few neighbours
    // notice where theirs are.
    double whole = floor(reach);
    if (is_deep(of, index)) return add_nodes(out, index - whole, index + whole + 1, 2 * order);
    double lines = fmin(to, last) - fmax(from, 1);
    int nodes = (int)fmin(2 * order, ceil(order * lines / reach));
    return (from > 0 || add_nodes(out, 0, 1, 1)) &&
           add_nodes(out, fmax(from, 1), fmin(to, last), nodes) &&
           (to <= last || add_nodes(out, last, last + 1, 1));
}

/// Particles of one coordinate: of the sides, the strips and the interior.
static bool find_places(const sphv_jitter_cloud *of, struct orders orders, struct places *out)
{
    double side = (double)of->box->side;
    double margin = ceil(of->profile->support / of->ds - (of->box->placement ? 0.5 : 0));
    double low = fmax(1, fmin(margin, side - margin)), high = side - low;
    double breaks[PANELS + 1] = {0, 1, low, high, side - 1, side};
    out->count = 0;
    for (int panel = 0; panel < PANELS; panel++) {
        struct nodes nodes = {0};
        bool whole = of->box->periodic;
        if (whole && panel > 0) break;
        int order = whole || panel == 2 ? orders.interior : orders.strip;
        if (!add_nodes(&nodes, breaks[panel], whole ? side : breaks[panel + 1], order))
            return false;
        for (int i = 0; i < nodes.count; i++) {
            struct place *place = &out->at[out->count++];
            place->index = nodes.index[i];
            // Near a side lines are not the particle's own lattice: what that makes of the rule is
            // the difference from particles that are on the lines.
            if (orders.on_lines && !is_deep(of, place->index)) place->index = rint(place->index);
            place->weight = nodes.weight[i];
            place->panel = panel;
            place->inside = whole || (panel == 2 && margin < side - margin);
            if (!find_near(of, place->index, orders.neighbours, &place->near)) return false;
        }
    }
    return true;
}

/// Places a particle and its neighbours on the lattice, or at their mean places.
static void put(sphv_jitter_cloud *of, const struct place *const *at, bool moved)
{
    double dx = of->dx;
    double offset = of->box->placement == SPHV_PLACEMENT_CELL ? 0.5 : 0;
    int node[SPHV_DIMENSIONS] = {0};
    for (int i = 0; i < of->d; i++) {
        double x = (at[i]->index + offset) * dx;
        of->moved[i] = sphv_jitter_at(of, x);
        of->x[i] = x + (moved ? of->moved[i]->mean * dx : 0);
    }
    of->count = 0;
    for (bool more = true; more;) {
        sphv_jitter_neighbour *b = sphv_jitter_next(of, 1);
        double square = 0, reach = of->profile->support + 4 * of->box->amplitude * of->ds;
        for (int i = 0; i < of->d; i++) {
            double x = (at[i]->near.index[node[i]] + offset) * dx;
            b->moved[i] = sphv_jitter_at(of, x);
            b->x[i] = x + (moved ? b->moved[i]->mean * dx : 0);
            b->s[i] = (b->x[i] - of->x[i]) / of->h;
            b->weight *= at[i]->near.weight[node[i]];
            square += b->s[i] * b->s[i];
        }
        if (square < reach * reach) {
            b->value = sphv_field_derivative(of->field, (int[SPHV_DIMENSIONS]){0}, b->x);
            of->count++;
        }
        int i = of->d - 1;
        while (i >= 0 && ++node[i] == at[i]->near.count) node[i--] = 0;
        more = i >= 0;
    }
    // The particle's own line is among those that the nodes stand for; it is no neighbour.
    sphv_jitter_neighbour *own = sphv_jitter_next(of, -1);
    for (int i = 0; i < of->d; i++) {
        own->x[i] = of->x[i];
        own->moved[i] = of->moved[i];
    }
    own->value = sphv_field_derivative(of->field, (int[SPHV_DIMENSIONS]){0}, own->x);
    of->count++;
}

/// \param lattice  h^|β| times the errors without perturbations
static void add_particle(sphv_jitter_sums *of, const struct place *const *at, const double *lattice,
                         struct changes *to)
{
    sphv_jitter_effect effects;
    double weight = 1;
    bool inside = true;
    int region = 0;
    for (int i = 0; i < of->cloud->d; i++) {
        region = region * PANELS + at[i]->panel;
        weight *= at[i]->weight;
        inside = inside && at[i]->inside;
    }
    bool regular = sphv_jitter_effects(of, &effects);
    for (int part = 0; part < (inside ? 2 : 1); part++) {
        if (!regular) to->singular[part] = true;
        if (to->singular[part]) continue;
        to->count[part] += weight;
        for (size_t q = 0; q < of->quantities; q++) {
            double mean = effects.mean[q], own = effects.own[q];
            double shared = fmax(0, effects.variance[q] - own), change = mean - lattice[q];
            to->square[region][0][part][q] += weight * change * (2 * lattice[q] + change);
            to->square[region][1][part][q] += weight * effects.own[q];
            to->square[region][2][part][q] += weight * (effects.variance[q] - effects.own[q]);
            to->next[part][q] += weight * effects.next[q];
            to->rounding[part][q] +=
                weight * effects.rounding[q] * (2 * fabs(lattice[q]) + effects.rounding[q]);
            to->own[0][part][q] += weight * mean * mean * own;
            to->own[1][part][q] += weight * own * own;
            to->shared[0][part][q] += weight * mean * mean * shared;
            to->shared[1][part][q] += weight * shared * shared;
        }
    }
}

static void divide(const sphv_jitter_sums *of, struct changes *to)
{
    for (int part = 0; part < 2; part++)
        for (size_t q = 0; q < of->quantities && to->count[part] > 0; q++) {
            for (int r = 0; r < REGIONS; r++)
                for (int n = 0; n < SOURCES; n++) to->square[r][n][part][q] /= to->count[part];
            to->next[part][q] /= to->count[part];
            to->rounding[part][q] /= to->count[part];
            for (int n = 0; n < 2; n++) {
                to->own[n][part][q] /= to->count[part];
                to->shared[n][part][q] /= to->count[part];
            }
        }
}

/// Means over the box by rules of some orders, for every method.
static sphv_status find_changes(sphv_jitter_group *group, struct orders orders, struct changes *to,
                                sphv_error *error)
{
    struct places places;
    const struct place *at[SPHV_DIMENSIONS] = {0};
    int node[SPHV_DIMENSIONS] = {0};
    sphv_jitter_cloud *cloud = &group->cloud;
    double lattice[SPHV_BOX_METHODS_MAX][N];
    if (!find_places(cloud, orders, &places))
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for a box's theory");
    for (bool more = true; more;) {
        for (int i = 0; i < cloud->d; i++) at[i] = &places.at[node[i]];
        put(cloud, at, false);
        for (size_t m = 0; m < group->count; m++)
            if (!sphv_jitter_error(&group->sums[m], lattice[m]))
                to[m].singular[0] = to[m].singular[1] = true;
        put(cloud, at, true);
        for (size_t m = 0; m < group->count; m++)
            if (!to[m].singular[0] || !to[m].singular[1])
                add_particle(&group->sums[m], at, lattice[m], &to[m]);
        int i = cloud->d - 1;
        while (i >= 0 && ++node[i] == places.count) node[i--] = 0;
        more = i >= 0;
    }
    for (size_t m = 0; m < group->count; m++) divide(&group->sums[m], &to[m]);
    return SPHV_OK;
}

/// Standard deviation of the mean square, or more: own displacements are independent, neighbours'
/// of particles further apart than two supports.
static double deviation_of(const sphv_jitter_cloud *of, const struct changes *from, int part,
                           size_t q)
{
    static const double ball[] = {2, M_PI};
    double spacings = of->profile->support / of->ds;
    double related = fmin(1, ball[of->d - 1] * gsl_pow_int(spacings, of->d) / from->count[part]);
    double shared = related * (4 * from->shared[0][part][q] + 2 * from->shared[1][part][q]);
    double own = (4 * from->own[0][part][q] + 2 * from->own[1][part][q]) / from->count[part];
    return sqrt(fmax(own, 0)) + sqrt(fmax(shared, 0));
}

/// The interior's particles are taken for those of the lattice. A line's particles cross the margin
/// by 2a of a spacing or less, and squares there are taken for four times the mean at most: what
/// that does to a mean over the interior, relative to it.
static double astray(const sphv_jitter_cloud *of)
{
    double lines = (double)of->box->side - 2 * ceil(of->profile->support / of->ds);
    if (of->box->periodic) return 0;
    return 8 * of->box->amplitude * of->d / fmax(lines, 1);
}

/// Corrects one norm. \param scatter  what is known of its standard deviation, added to
static void correct(const sphv_jitter_cloud *of, const struct changes *from,
                    const struct changes *rough, int part, size_t q, sphv_result *norm,
                    double *scatter)
{
    // A norm of the lattice over particles that none of the nodes stands for is no better.
    if (from->singular[part] || (!(from->count[part] > 0) && norm->value != 0)) {
        *norm = (sphv_result){NAN, INFINITY};
        *scatter = INFINITY;
        return;
    }
    if (!(from->count[part] > 0)) return;
    double scale = gsl_pow_int(of->h, -2 * sphv_monomials(of->d)[q].degree);
    double square = gsl_pow_2(norm->value), doubt = from->next[part][q];
    for (int r = 0; r < REGIONS; r++)
        for (int n = 0; n < SOURCES; n++) {
            square += scale * from->square[r][n][part][q];
            doubt += 2 * fabs(from->square[r][n][part][q] - rough->square[r][n][part][q]);
        }
    square = fmax(0, square);
    if (part == 1) doubt += astray(of) * square / scale;
    double margin = 2 * norm->value * *scatter, value = sqrt(square);
    double rounding = norm->bound + sqrt(square + scale * from->rounding[part][q]) - value;
    double bound = sqrt(square + scale * doubt) - value;
    *norm = (sphv_result){value, bound + rounding};
    *scatter = hypot(margin, scale * deviation_of(of, from, part, q)) / (2 * value);
    if (!(*scatter >= 0)) *scatter = INFINITY; // no error at all
    if (!(doubt >= 0) || !(bound >= 0 && bound <= SPHV_JITTER_BOUND_MAX * value + rounding))
        *norm = (sphv_result){NAN, INFINITY};
}

sphv_status sphv_widen_jitter(sphv_jitter_group *group, sphv_box_prediction *const *out,
                              sphv_error *error)
{
    sphv_jitter_cloud *cloud = &group->cloud;
    struct orders most = fine[cloud->d - 1];
    struct changes *changes = calloc(2 * group->count, sizeof *changes);
    struct changes *rough = NULL;
    sphv_status status = sphv_jitter_cloud_make(
        cloud, (size_t)gsl_pow_int(2 * most.neighbours + 2, cloud->d) + 2, error);
    if (!changes)
        status = sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for a box's theory");
    if (status == SPHV_OK) status = find_changes(group, most, changes, error);
    if (status == SPHV_OK) {
        rough = changes + group->count;
        status = find_changes(group, coarse[cloud->d - 1], rough, error);
    }
    sphv_jitter_cloud_free(cloud);
    for (size_t m = 0; m < group->count && status == SPHV_OK; m++) {
        sphv_box_prediction *to = out[m];
        to->rigour = SPHV_RIGOUR_STATISTICAL;
        for (size_t q = 0; q < to->quantities; q++) {
            correct(cloud, &changes[m], &rough[m], 0, q, &to->rmse[q], &to->scatter[q]);
            correct(cloud, &changes[m], &rough[m], 1, q, &to->interior[q],
                    &to->interior_scatter[q]);
            to->exists[q] = isfinite(to->rmse[q].value) || isfinite(to->interior[q].value);
        }
    }
    free(changes);
    return status;
}
