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

const sphv_displacement *sphv_jitter_at(const sphv_jitter_sums *of, double x)
{
    double near = 1e-6 * sphv_box_spacing(of->box);
    if (!of->box->reflected) return &of->free;
    return fabs(x) < near ? &of->low : fabs(1 - x) < near ? &of->high : &of->free;
}

static double field_at(const sphv_jitter_sums *of, const double *x)
{
    return sphv_field_derivative(of->field, (int[SPHV_DIMENSIONS]){0}, x);
}

/// p_k(|s|) and the monomials of s.
static bool basis(const sphv_jitter_sums *of, const double *s, double p[SPHV_RADIALS],
                  double *monomial, size_t count)
{
    double square = 0, power[SPHV_DIMENSIONS][SPHV_SHAPE_DEGREE + 3];
    for (int i = 0; i < of->d; i++) square += s[i] * s[i];
    double q = sqrt(square);
    if (q >= of->profile->support) return false;
    sphv_radial_functions(of->profile, q, p);
    if (q > 0) p[2] /= square;
    for (int i = 0; i < SPHV_DIMENSIONS; i++) {
        power[i][0] = 1;
        for (int n = 1; n < SPHV_SHAPE_DEGREE + 3; n++)
            power[i][n] = i < of->d ? power[i][n - 1] * s[i] : 0;
    }
    const sphv_monomial *table = sphv_monomials(of->d);
    for (size_t m = 0; m < count; m++)
        monomial[m] =
            power[0][table[m].power[0]] * power[1][table[m].power[1]] * power[2][table[m].power[2]];
    return true;
}

/// The shape functions from what `basis` gave.
static void shape_functions(const sphv_jitter_sums *of, const sphv_shape *shape,
                            const double p[SPHV_RADIALS], const double *monomial, double *out)
{
    for (size_t q = 0; q < of->quantities; q++) {
        out[q] = 0;
        for (int k = 0; k < SPHV_RADIALS; k++)
            for (size_t m = 0; m < of->terms; m++)
                out[q] += shape->weight[q][k][m] * p[k] * monomial[m];
    }
}

/// Shape functions and estimates of the particle displaced by `at` Δx along a coordinate while its
/// neighbours stay. False without a regular moment matrix.
static bool evaluate(const sphv_jitter_sums *of, int coordinate, double at, sphv_shape *shape,
                     double *estimate, double *own)
{
    enum { MOMENTS = 56 }; // of degree 5 in three dimensions
    double moment[SPHV_RADIALS][MOMENTS] = {{0}}, p[SPHV_RADIALS], monomial[MOMENTS], chi[N];
    const double *const moments[SPHV_RADIALS] = {moment[0], moment[1], moment[2]};
    size_t count = sphv_monomial_count(of->d, 2 * of->degree);
    double x[SPHV_DIMENSIONS] = {of->x[0], of->x[1], of->x[2]};
    x[coordinate] += at * sphv_box_spacing(of->box);
    *own = field_at(of, x);
    for (int pass = 0; pass < 2; pass++) {
        for (size_t b = 0; b <= of->count; b++) { // the particle itself comes last
            double s[SPHV_DIMENSIONS] = {0}, v = of->v;
            if (b < of->count) {
                memcpy(s, of->neighbour[b].s, sizeof s);
                s[coordinate] -= at * of->ds;
                v *= of->neighbour[b].weight;
            }
            if (!basis(of, s, p, monomial, pass ? of->terms : count)) continue;
            if (pass) {
                double value = b < of->count ? of->neighbour[b].value : *own;
                shape_functions(of, shape, p, monomial, chi);
                for (size_t q = 0; q < of->quantities; q++) estimate[q] += v * value * chi[q];
            } else {
                for (int k = 0; k < SPHV_RADIALS; k++)
                    for (size_t m = 0; m < count; m++) moment[k][m] += v * p[k] * monomial[m];
            }
        }
        if (pass) break;
        sphv_shape_make(of->method, of->d, moments, shape);
        if (!(shape->condition <= 1 / sqrt(DBL_EPSILON))) return false;
        for (size_t q = 0; q < of->quantities; q++) estimate[q] = -shape->self[q] * *own;
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
static bool response(const sphv_jitter_sums *of, const double *s, double value, double *out,
                     double matrix[N][N])
{
    double p[SPHV_RADIALS], monomial[SPHV_SHAPE_TERMS], chi[N];
    const sphv_monomial *table = sphv_monomials(of->d);
    memset(out, 0, N * sizeof *out);
    memset(matrix, 0, N * sizeof *matrix);
    size_t needed = of->terms > of->quantities ? of->terms : of->quantities;
    if (!basis(of, s, p, monomial, needed)) return false;
    shape_functions(of, &of->shape, p, monomial, chi);
    bool quotient = of->method == SPHV_SHEPARD || of->method == SPHV_RKPM_0;
    bool differences = of->method == SPHV_CSPM || of->method == SPHV_SPH_DIFFERENCE;
    for (size_t q = 0; q < of->quantities; q++) {
        size_t first, last;
        double left = value;
        unknowns_of(of, q, &first, &last);
        for (size_t g = first; g < last; g++) {
            matrix[q][g] = of->v * chi[q] * monomial[g] / table[g].factorial;
            left -= of->estimate[g] * monomial[g] / table[g].factorial;
        }
        if (differences && q > 0) left -= of->own;
        // The derivative of a quotient: both of its sums change.
        if (quotient && q > 0) left -= of->estimate[0];
        out[q] = of->v * chi[q] * left;
        if (quotient && q > 0) out[q] -= of->v * chi[0] * of->estimate[q];
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

/// A neighbour's response displaced in one or two coordinates, in Δx.
static void respond(const sphv_jitter_sums *of, const sphv_jitter_neighbour *b, int i, double along,
                    int j, double across, double *out, double matrix[N][N])
{
    double s[SPHV_DIMENSIONS], x[SPHV_DIMENSIONS], move[SPHV_DIMENSIONS] = {0};
    move[j] = across;
    move[i] = along;
    for (int c = 0; c < SPHV_DIMENSIONS; c++) {
        s[c] = b->s[c] + move[c] * of->ds;
        x[c] = b->x[c] + move[c] * sphv_box_spacing(of->box);
    }
    response(of, s, field_at(of, x), out, matrix);
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
        respond(of, b, i, moved->at[m], i, 0, effect[m], matrix);
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
    double far[2][N], matrix[N][N], q = of->free.at[2];
    for (int m = 0; m < 2; m++) respond(of, b, i, m ? 2 * q : -2 * q, i, 0, far[m], matrix);
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
    double corner[2][2][N], matrix[N][N], q = of->free.at[2], cube = q * q * q;
    for (int m = 0; m < 2; m++)
        for (int n = 0; n < 2; n++)
            respond(of, b, i, m ? q : -q, j, n ? q : -q, corner[m][n], matrix);
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
    double variance = 2 * of->free.weight[2] * gsl_pow_2(of->free.at[2]);
    // Where the next order is not found, or not worth it, its size follows from curvatures.
    bool rough = of->wide;
    response(of, b->s, b->value, base, base_matrix);
    for (int i = 0; i < of->d; i++) {
        find_main(of, b, i, base, base_matrix, effect[i], to);
        rough = rough || b->moved[i] != &of->free;
    }
    for (int i = 0; i < of->d && !rough; i++) {
        add_along(of, b, i, variance, (const double(*)[N])effect[i], third[i], to);
        for (int j = 0; j < i; j++) add_across(of, b, i, j, variance, effect, third, base, to);
    }
    for (int i = 0; i < of->d; i++)
        for (size_t q = 0; q < of->quantities; q++) {
            double before = to->variance[q], mean = to->mean[q];
            add_effect(b->moved[i], q, effect[i], to);
            if (rough) {
                double even = to->mean[q] - mean - effect[i][1][q];
                to->next[q] += 4 * (1 + 1.5 * (of->d - 1)) * even * even;
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
    double p[SPHV_RADIALS], monomial[SPHV_SHAPE_TERMS], chi[N];
    double relative = 32 * DBL_EPSILON * ((double)of->count + 1) * fmax(1, of->shape.condition);
    const sphv_monomial *table = sphv_monomials(of->d);
    for (size_t q = 0; q < of->quantities; q++)
        to->rounding[q] = fabs(of->shape.self[q] * of->own) +
                          scale[q] * fabs(sphv_field_derivative(of->field, table[q].power, of->x));
    for (size_t b = 0; b <= of->count; b++) { // the particle itself comes last
        static const double origin[SPHV_DIMENSIONS] = {0};
        double value = b < of->count ? of->neighbour[b].value : of->own;
        double v = b < of->count ? of->v * fabs(of->neighbour[b].weight) : of->v;
        if (!basis(of, b < of->count ? of->neighbour[b].s : origin, p, monomial, of->terms))
            continue;
        shape_functions(of, &of->shape, p, monomial, chi);
        for (size_t q = 0; q < of->quantities; q++)
            to->rounding[q] += v * fabs(chi[q]) * fmax(fabs(value), fabs(of->own));
    }
    for (size_t q = 0; q < of->quantities; q++) to->rounding[q] *= relative;
}

bool sphv_jitter_error(sphv_jitter_sums *of, double *out)
{
    const sphv_monomial *table = sphv_monomials(of->d);
    if (!evaluate(of, 0, 0, &of->shape, of->estimate, &of->own)) return false;
    for (size_t q = 0; q < of->quantities; q++)
        out[q] = of->estimate[q] - gsl_pow_int(of->h, table[q].degree) *
                                       sphv_field_derivative(of->field, table[q].power, of->x);
    return true;
}

bool sphv_jitter_effects(sphv_jitter_sums *of, sphv_jitter_effect *to)
{
    double at_lattice[N], scale[N], own, effect[NODES][N];
    const sphv_monomial *table = sphv_monomials(of->d);
    *to = (sphv_jitter_effect){0};
    if (!sphv_jitter_error(of, at_lattice)) return false;
    for (size_t q = 0; q < of->quantities; q++) {
        scale[q] = gsl_pow_int(of->h, table[q].degree);
        to->mean[q] = at_lattice[q];
    }
    find_rounding(of, scale, to);
    for (int i = 0; i < of->d; i++) {
        const sphv_displacement *moved = of->moved[i];
        for (int m = 0; m < NODES; m++) {
            sphv_shape shape;
            double x[SPHV_DIMENSIONS] = {of->x[0], of->x[1], of->x[2]};
            memset(effect[m], 0, sizeof effect[m]);
            if (moved->at[m] == 0) continue;
            if (!evaluate(of, i, moved->at[m], &shape, effect[m], &own)) return false;
            x[i] += moved->at[m] * sphv_box_spacing(of->box);
            for (size_t q = 0; q < of->quantities; q++)
                effect[m][q] -=
                    scale[q] * sphv_field_derivative(of->field, table[q].power, x) + at_lattice[q];
        }
        for (size_t q = 0; q < of->quantities; q++) add_effect(moved, q, effect, to);
    }
    memcpy(to->own, to->variance, sizeof to->own);
    for (size_t b = 0; b < of->count; b++) add_neighbour(of, &of->neighbour[b], to);
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

void sphv_jitter_neighbours(sphv_jitter_sums *of, const sphv_line *const *line)
{
    int offset[SPHV_DIMENSIONS] = {0};
    double dx = sphv_box_spacing(of->box);
    // Those that a perturbation may bring into the support belong to it.
    double reach = of->profile->support + 4 * of->box->amplitude * of->ds;
    for (int i = 0; i < of->d; i++) {
        of->moved[i] = sphv_jitter_at(of, line[i]->x);
        of->x[i] = line[i]->x + of->moved[i]->mean * dx;
        offset[i] = -line[i]->below;
    }
    of->count = 0;
    for (;;) {
        sphv_jitter_neighbour *b = &of->neighbour[of->count];
        double square = 0;
        *b = (sphv_jitter_neighbour){.weight = 1};
        for (int i = 0; i < of->d; i++) {
            double x = line[i]->x + offset[i] * dx;
            // Exactly on the side, or a power of x may be that of a negative number.
            if (fabs(x) < 1e-6 * dx) x = 0;
            b->moved[i] = sphv_jitter_at(of, x);
            b->x[i] = x + b->moved[i]->mean * dx;
            b->s[i] = (offset[i] + b->moved[i]->mean - of->moved[i]->mean) * of->ds;
            square += b->s[i] * b->s[i];
        }
        if (square > 0 && square < reach * reach) {
            b->value = field_at(of, b->x);
            of->count++;
        }
        int i = of->d - 1;
        while (i >= 0 && ++offset[i] > line[i]->above) {
            offset[i] = -line[i]->below;
            i--;
        }
        if (i < 0) return;
    }
}
