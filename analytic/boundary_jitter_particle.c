#include <gsl/gsl_math.h>
#include <string.h>

#include "boundary_jitter.h"

// The error at a particle is a function of its own place and of its neighbours'. Its mean is the
// lattice's error and the means of its main effects, those of one coordinate of one particle alone;
// its variance is that of the main effects, averaged over the other coordinates, and that of the
// interactions of two coordinates. What the last two add is the next order in the amplitude, and
// its size the bound.

enum { N = SPHV_QUANTITIES_MAX, NODES = SPHV_JITTER_NODES };

/// Largest variance of B⁻¹δB that is small: beyond, the series of (B + δB)⁻¹ is of no use.
static const double matrix_variance_max = 0.1;

static double field_at(const sphv_jitter_sums *of, const double *x)
{
    return sphv_field_derivative(of->cloud->field, (int[SPHV_DIMENSIONS]){0}, x);
}

static void take_parts(const sphv_jitter_sums *of, const sphv_shape *shape, sphv_jitter_parts *out)
{
    out->count = 0;
    for (int k = 0; k < SPHV_RADIALS; k++)
        for (size_t m = 0; m < of->terms; m++) {
            bool some = false;
            for (size_t q = 0; q < of->quantities; q++) {
                out->weight[out->count][q] = shape->weight[q][k][m];
                some = some || shape->weight[q][k][m] != 0;
            }
            out->radial[out->count] = k;
            out->monomial[out->count] = m;
            if (some) out->count++;
        }
}

static void shape_functions(const sphv_jitter_sums *of, const sphv_jitter_parts *parts,
                            const sphv_jitter_slot *at, double *out)
{
    for (size_t q = 0; q < of->quantities; q++) out[q] = 0;
    for (int i = 0; i < parts->count; i++) {
        double radial = at->p[parts->radial[i]], monomial = at->monomial[parts->monomial[i]];
        for (size_t q = 0; q < of->quantities; q++)
            out[q] += parts->weight[i][q] * radial * monomial;
    }
}

/// Shape functions and estimates of the particle displaced by `at` Δx along a coordinate while its
/// neighbours stay. False without a regular moment matrix.
static bool evaluate(const sphv_jitter_sums *of, int coordinate, double at, sphv_shape *shape,
                     sphv_jitter_parts *parts, double *estimate, double *own)
{
    enum { MOMENTS = 56 }; // of degree 5 in three dimensions
    double moment[SPHV_RADIALS][MOMENTS] = {{0}}, chi[N];
    const double *const moments[SPHV_RADIALS] = {moment[0], moment[1], moment[2]};
    const sphv_jitter_cloud *cloud = of->cloud;
    const sphv_jitter_neighbour *b, *last = cloud->neighbour + cloud->count;
    const sphv_jitter_move by = {.coordinate = coordinate, .along = -at};
    sphv_jitter_slot self, scratch;
    const sphv_jitter_slot *slot;
    size_t count = sphv_monomial_count(cloud->d, 2 * of->degree);
    int radials = of->method == SPHV_MSPH ? SPHV_RADIALS : SPHV_RADIALS - 1;
    double x[SPHV_DIMENSIONS] = {cloud->x[0], cloud->x[1], cloud->x[2]};
    x[coordinate] += at * cloud->dx;
    *own = field_at(of, x);
    sphv_jitter_self(cloud, &self);
    for (b = cloud->neighbour; b <= last; b++) { // the particle itself comes last
        slot = b < last ? sphv_jitter_look(cloud, b, by, false, &scratch) : &self;
        if (!slot->inside) continue;
        double v = b < last ? cloud->v * b->weight : cloud->v;
        for (int k = 0; k < radials; k++)
            for (size_t m = 0; m < count; m++) moment[k][m] += v * slot->p[k] * slot->monomial[m];
    }
    sphv_shape_make(of->method, cloud->d, moments, shape);
    if (!(shape->condition <= 1 / sqrt(DBL_EPSILON))) return false;
    take_parts(of, shape, parts);
    for (size_t q = 0; q < of->quantities; q++) estimate[q] = -shape->self[q] * *own;
    for (b = cloud->neighbour; b <= last; b++) {
        slot = b < last ? sphv_jitter_look(cloud, b, by, false, &scratch) : &self;
        if (!slot->inside) continue;
        double value = b < last ? cloud->v * b->weight * b->value : cloud->v * *own;
        shape_functions(of, parts, slot, chi);
        for (size_t q = 0; q < of->quantities; q++) estimate[q] += value * chi[q];
    }
    return true;
}

/// First and last unknown of the system that a quantity is solved from; none where last < first.
static void unknowns_of(const sphv_jitter_sums *of, size_t quantity, size_t *first, size_t *last)
{
    *first = 0;
    *last = of->quantities;
    switch (of->method) {
    case SPHV_FPM:
    case SPHV_MSPH:
        return;
    case SPHV_CSPM:
        if (quantity > 0) *first = 1;
        if (quantity == 0) *last = 1;
        return;
    case SPHV_SHEPARD:
    case SPHV_RKPM_0:
        *last = quantity == 0 ? 1 : 0;
        return;
    default:
        *last = 0;
    }
}

/// With u = B⁻¹F the solution, δu = B⁻¹(δF − δB u): v times the shape function times what the
/// fitted polynomial leaves of the field. \param matrix receives δB's part, [quantity][unknown]
static bool response(const sphv_jitter_sums *of, const sphv_jitter_neighbour *b,
                     sphv_jitter_move by, double *out, double matrix[N][N])
{
    double chi[N];
    sphv_jitter_slot scratch;
    const sphv_jitter_slot *slot = sphv_jitter_look(of->cloud, b, by, true, &scratch);
    const sphv_monomial *table = sphv_monomials(of->cloud->d);
    const double *monomial = slot->monomial;
    for (size_t q = 0; q < of->quantities; q++) {
        out[q] = 0;
        memset(matrix[q], 0, of->quantities * sizeof *matrix[q]);
    }
    if (!slot->inside) return false;
    shape_functions(of, &of->parts, slot, chi);
    bool quotient = of->method == SPHV_SHEPARD || of->method == SPHV_RKPM_0;
    bool differences = of->method == SPHV_CSPM || of->method == SPHV_SPH_DIFFERENCE;
    for (size_t q = 0; q < of->quantities; q++) {
        size_t first, last;
        double left = slot->value;
        unknowns_of(of, q, &first, &last);
        for (size_t g = first; g < last; g++) {
            matrix[q][g] = of->cloud->v * chi[q] * monomial[g] / table[g].factorial;
            left -= of->estimate[g] * monomial[g] / table[g].factorial;
        }
        if (differences && q > 0) left -= of->own;
        // The derivative of a quotient: both of its sums change.
        if (quotient && q > 0) left -= of->estimate[0];
        out[q] = of->cloud->v * chi[q] * left;
        if (quotient && q > 0) out[q] -= of->cloud->v * chi[0] * of->estimate[q];
    }
    return true;
}

/// Adds one main effect, given at the nodes of its displacement.
static void add_effect(const sphv_displacement *moved, size_t q, double effect[NODES][N],
                       sphv_jitter_effect *to)
{
    double mean = 0;
    for (int m = 0; m < NODES; m++) mean += moved->weight[m] * effect[m][q];
    to->mean[q] += mean;
    for (int m = 0; m < NODES; m++)
        to->variance[q] += moved->weight[m] * gsl_pow_2(effect[m][q] - mean);
}

/// The main effects of a neighbour's coordinate at the nodes of its displacement.
static void find_main(const sphv_jitter_sums *of, const sphv_jitter_neighbour *b, int i,
                      const double *base, double base_matrix[N][N], double effect[NODES][N],
                      sphv_jitter_effect *to)
{
    double matrix[N][N];
    const sphv_displacement *moved = b->moved[i];
    for (int m = 0; m < NODES; m++) {
        double change[N];
        memset(effect[m], 0, sizeof effect[m]);
        if (moved->at[m] == 0) continue;
        response(of, b, (sphv_jitter_move){i, moved->at[m], 0, 0}, effect[m], matrix);
        for (size_t q = 0; q < of->quantities; q++) change[q] = effect[m][q] - base[q];
        for (size_t q = 0; q < of->quantities; q++) {
            effect[m][q] = change[q];
            // (B + δB)⁻¹ to the next order: the same particle moves both.
            for (size_t g = 0; g < of->quantities; g++) {
                double part = matrix[q][g] - base_matrix[q][g];
                effect[m][q] -= part * change[g];
                to->matrix[q][g] += moved->weight[m] * part * part;
                // Twice: the particle looked at moves as much.
                if (g == q) to->drift[q] += 2 * moved->weight[m] * part;
            }
        }
    }
}

/// Averages a main effect over the coordinate's counterpart in the particle looked at, which moves
/// the support the other way, and adds their interaction.
static void add_along(const sphv_jitter_sums *of, const sphv_jitter_neighbour *b, int i,
                      double variance, const double effect[NODES][N], double third[N],
                      sphv_jitter_effect *to)
{
    double far[2][N], matrix[N][N], q = of->cloud->free.at[2];
    for (int m = 0; m < 2; m++)
        response(of, b, (sphv_jitter_move){i, m ? 2 * q : -2 * q, 0, 0}, far[m], matrix);
    for (size_t n = 0; n < of->quantities; n++) {
        double curvature = (effect[0][n] + effect[2][n]) / (q * q);
        double interaction = gsl_pow_2(variance * curvature);
        third[n] += (far[1][n] - far[0][n] - 2 * (effect[2][n] - effect[0][n])) / (2 * q * q * q);
        to->variance[n] += interaction;
        to->next[n] += interaction;
    }
}

/// The same with another coordinate, of both particles.
static void add_across(const sphv_jitter_sums *of, const sphv_jitter_neighbour *b, int i, int j,
                       double variance, double effect[SPHV_DIMENSIONS][NODES][N],
                       double third[SPHV_DIMENSIONS][N], const double *base, sphv_jitter_effect *to)
{
    double corner[2][2][N], matrix[N][N], q = of->cloud->free.at[2], cube = q * q * q;
    for (int m = 0; m < 2; m++)
        for (int n = 0; n < 2; n++)
            response(of, b, (sphv_jitter_move){i, m ? q : -q, j, n ? q : -q}, corner[m][n], matrix);
    for (size_t k = 0; k < of->quantities; k++) {
        double low = corner[0][0][k] - base[k], up = corner[0][1][k] - base[k];
        double right = corner[1][0][k] - base[k], both = corner[1][1][k] - base[k];
        double mixed = (both - right - up + low) / (4 * q * q);
        // Either coordinate of either particle with the other's other, and the neighbour's own two.
        double interaction = 3 * gsl_pow_2(variance * mixed);
        to->variance[k] += interaction;
        to->next[k] += interaction;
        // ∂_i∂_j² and ∂_j∂_i², averaged over both particles.
        third[i][k] += (both + right - up - low - 2 * (effect[i][2][k] - effect[i][0][k])) / cube;
        third[j][k] += (both + up - right - low - 2 * (effect[j][2][k] - effect[j][0][k])) / cube;
    }
}

/// All effects of one neighbour.
static void find_neighbour(const sphv_jitter_sums *of, const sphv_jitter_neighbour *b,
                           sphv_jitter_effect *to)
{
    double base[N], base_matrix[N][N], effect[SPHV_DIMENSIONS][NODES][N];
    double third[SPHV_DIMENSIONS][N] = {{0}};
    double variance = 2 * of->cloud->free.weight[2] * gsl_pow_2(of->cloud->free.at[2]);
    // Where the next order is not found, or not worth it, its size follows from curvatures.
    bool rough = of->cloud->wide;
    response(of, b, (sphv_jitter_move){0, 0, 0, 0}, base, base_matrix);
    for (int i = 0; i < of->cloud->d; i++) {
        find_main(of, b, i, base, base_matrix, effect[i], to);
        rough = rough || b->moved[i] != &of->cloud->free;
    }
    for (int i = 0; i < of->cloud->d && !rough; i++) {
        add_along(of, b, i, variance, (const double(*)[N])effect[i], third[i], to);
        for (int j = 0; j < i; j++) add_across(of, b, i, j, variance, effect, third, base, to);
    }
    for (int i = 0; i < of->cloud->d; i++)
        for (size_t q = 0; q < of->quantities; q++) {
            double before = to->variance[q], mean = to->mean[q];
            add_effect(b->moved[i], q, effect[i], to);
            if (rough) {
                double even = to->mean[q] - mean - effect[i][1][q];
                to->next[q] += 4 * (1 + 1.5 * (of->cloud->d - 1)) * even * even;
                continue;
            }
            double plain = to->variance[q] - before;
            for (int m = 0; m < NODES; m++)
                effect[i][m][q] += b->moved[i]->at[m] * 0.5 * variance * third[i][q];
            to->mean[q] = mean;
            to->variance[q] = before;
            add_effect(b->moved[i], q, effect[i], to);
            to->next[q] += fabs(to->variance[q] - before - plain);
        }
}

/// Adds the effects of a neighbour, or of those that it stands for.
static void add_neighbour(const sphv_jitter_sums *of, const sphv_jitter_neighbour *b,
                          sphv_jitter_effect *to)
{
    sphv_jitter_effect one = {0};
    find_neighbour(of, b, &one);
    for (size_t q = 0; q < of->quantities; q++) {
        to->mean[q] += b->weight * one.mean[q];
        to->variance[q] += b->weight * one.variance[q];
        to->next[q] += b->weight * one.next[q];
        to->drift[q] += b->weight * one.drift[q];
        for (size_t g = 0; g < of->quantities; g++)
            to->matrix[q][g] += b->weight * one.matrix[q][g];
    }
}

/// Rounding of the moments, of the solve and of sums of effects: each of the values summed is in
/// error by a few tens of roundings times the condition number, and all may add up.
static void find_rounding(const sphv_jitter_sums *of, const double *scale, sphv_jitter_effect *to)
{
    double chi[N];
    sphv_jitter_slot self, scratch;
    double relative =
        32 * DBL_EPSILON * ((double)of->cloud->count + 1) * fmax(1, of->shape.condition);
    const sphv_monomial *table = sphv_monomials(of->cloud->d);
    for (size_t q = 0; q < of->quantities; q++)
        to->rounding[q] =
            fabs(of->shape.self[q] * of->own) +
            scale[q] * fabs(sphv_field_derivative(of->cloud->field, table[q].power, of->cloud->x));
    sphv_jitter_self(of->cloud, &self);
    for (size_t n = 0; n <= of->cloud->count; n++) { // the particle itself comes last
        const sphv_jitter_neighbour *b = &of->cloud->neighbour[n];
        bool other = n < of->cloud->count;
        const sphv_jitter_slot *slot =
            other ? sphv_jitter_look(of->cloud, b, (sphv_jitter_move){0, 0, 0, 0}, false, &scratch)
                  : &self;
        if (!slot->inside) continue;
        double value = other ? b->value : of->own;
        double v = other ? of->cloud->v * fabs(b->weight) : of->cloud->v;
        shape_functions(of, &of->parts, slot, chi);
        for (size_t q = 0; q < of->quantities; q++)
            to->rounding[q] += v * fabs(chi[q]) * fmax(fabs(value), fabs(of->own));
    }
    for (size_t q = 0; q < of->quantities; q++) to->rounding[q] *= relative;
}

bool sphv_jitter_error(sphv_jitter_sums *of, double *out)
{
    const sphv_monomial *table = sphv_monomials(of->cloud->d);
    if (!evaluate(of, 0, 0, &of->shape, &of->parts, of->estimate, &of->own)) return false;
    for (size_t q = 0; q < of->quantities; q++)
        out[q] = of->estimate[q] -
                 gsl_pow_int(of->cloud->h, table[q].degree) *
                     sphv_field_derivative(of->cloud->field, table[q].power, of->cloud->x);
    return true;
}

bool sphv_jitter_effects(sphv_jitter_sums *of, sphv_jitter_effect *to)
{
    double at_lattice[N], scale[N], own, effect[NODES][N];
    const sphv_monomial *table = sphv_monomials(of->cloud->d);
    *to = (sphv_jitter_effect){0};
    if (!sphv_jitter_error(of, at_lattice)) return false;
    for (size_t q = 0; q < of->quantities; q++) {
        scale[q] = gsl_pow_int(of->cloud->h, table[q].degree);
        to->mean[q] = at_lattice[q];
    }
    find_rounding(of, scale, to);
    for (int i = 0; i < of->cloud->d; i++) {
        const sphv_displacement *moved = of->cloud->moved[i];
        for (int m = 0; m < NODES; m++) {
            sphv_shape shape;
            sphv_jitter_parts parts;
            double x[SPHV_DIMENSIONS] = {of->cloud->x[0], of->cloud->x[1], of->cloud->x[2]};
            memset(effect[m], 0, sizeof effect[m]);
            if (moved->at[m] == 0) continue;
            if (!evaluate(of, i, moved->at[m], &shape, &parts, effect[m], &own)) return false;
            x[i] += moved->at[m] * of->cloud->dx;
            for (size_t q = 0; q < of->quantities; q++)
                effect[m][q] -=
                    scale[q] * sphv_field_derivative(of->cloud->field, table[q].power, x) +
                    at_lattice[q];
        }
        for (size_t q = 0; q < of->quantities; q++) add_effect(moved, q, effect, to);
    }
    memcpy(to->own, to->variance, sizeof to->own);
    for (size_t b = 0; b < of->cloud->count; b++) add_neighbour(of, &of->cloud->neighbour[b], to);
    // B⁻¹δB upon the noise: its mean, and that of one particle upon the noise of another.
    double noise[N], largest = 0;
    memcpy(noise, to->variance, sizeof noise);
    for (size_t q = 0; q < of->quantities; q++) {
        double change = gsl_pow_2(1 - to->drift[q]) * noise[q] - noise[q];
        to->variance[q] += change;
        to->next[q] += fabs(change);
        for (size_t g = 0; g < of->quantities; g++) {
            to->variance[q] += to->matrix[q][g] * noise[g];
            to->next[q] += to->matrix[q][g] * noise[g];
            largest += to->matrix[q][g] * to->matrix[g][q];
        }
    }
    return sqrt(largest) <= matrix_variance_max;
}
