#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>
#include <stdlib.h>
#include <string.h>

#include "boundary_internal.h"

// A place (I_1, …, I_d) of the table holds the moments of the block of cells 0 … I_i, half of the
// cells at 0. It grows line by line: row by row in the coordinates other than the first, then by
// the first. One Gauss node in a cell is its middle, and the sum the lattice's own; several give
// the integral over the cells, that is over the support cut half a spacing beyond the last line.

enum { NODES_MAX = 8, POWERS = SPHV_MONOMIAL_DEGREE_MAX + 1 };
static const double BYTES_MAX = 4e8;

/// Points of one coordinate: those of line 0 lie in its positive half.
static bool make_nodes(int reach, int order, double spacing, double *place, double *share)
{
    gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc((size_t)order);
    if (!table) return false;
    for (int line = 0; line <= reach; line++)
        for (int i = 0; i < order; i++) {
            double from = line == 0 && order > 1 ? 0 : line - 0.5, x, weight;
            gsl_integration_glfixed_point(from, line + 0.5, (size_t)i, &x, &weight, table);
            // The lattice itself exactly, the line 0 counted half.
            place[line * order + i] = spacing * (order == 1 ? line : x);
            share[line * order + i] = spacing * (order > 1 ? weight : line == 0 ? 0.5 : 1);
        }
    gsl_integration_glfixed_table_free(table);
    return true;
}

/// Adds the points over a place of the other coordinates at one s_1 to its row.
static void add_cell(const sphv_octants *octants, const sphv_profile *profile, int node,
                     const int *line, size_t tail)
{
    int others = octants->dimension - 1, order = octants->nodes_per_line, points = 1;
    const sphv_monomial *rest = others > 0 ? sphv_monomials(others) : NULL;
    for (int i = 0; i < others; i++) points *= order;
    for (int point = 0; point < points; point++) {
        double s[2] = {0, 0}, square = gsl_pow_2(octants->place[node]), weight = 1, p[SPHV_RADIALS];
        double power[2][POWERS] = {{1}, {1}};
        for (int i = 0, left = point; i < others; i++, left /= order) {
            int at = line[i] * order + left % order;
            s[i] = octants->place[at];
            weight *= octants->share[at];
            square += s[i] * s[i];
            for (int n = 1; n <= octants->degree; n++) power[i][n] = power[i][n - 1] * s[i];
        }
        double q = sqrt(square);
        if (q >= profile->support) continue;
        sphv_radial_functions(profile, q, p);
        p[2] = q > 0 ? p[2] / square : 0;
        for (int k = 0; k < SPHV_RADIALS; k++) {
            double *row = octants->row[k] + node * octants->tails * octants->rests + tail;
            for (size_t m = 0; m < octants->rests; m++)
                row[m * octants->tails] += weight * p[k] * (rest ? power[0][rest[m].power[0]] : 1) *
                                           (others > 1 ? power[1][rest[m].power[1]] : 1);
        }
    }
}

/// Turns cells into blocks of cells along one direction. \param stride  distance of neighbours
static void accumulate(double *at, size_t places, size_t lines, size_t stride, size_t width)
{
    for (size_t place = 0; place < places; place++)
        if (place / stride % lines > 0)
            for (size_t m = 0; m < width; m++)
                at[place * width + m] += at[(place - stride) * width + m];
}

static void fill_rows(sphv_octants *octants, const sphv_profile *profile)
{
    size_t lines = (size_t)octants->reach + 1;
    for (int node = 0; node < octants->nodes; node++)
        for (size_t tail = 0; tail < octants->tails; tail++) {
            int line[2] = {(int)(octants->dimension > 2 ? tail / lines : tail),
                           (int)(tail % lines)};
            add_cell(octants, profile, node, line, tail);
        }
    for (int k = 0; k < SPHV_RADIALS; k++)
        for (size_t stride = 1; stride < octants->tails; stride *= lines)
            accumulate(octants->row[k], (size_t)octants->nodes * octants->rests * octants->tails,
                       lines, stride, 1);
}

static void fill_signs(sphv_octants *octants)
{
    const sphv_monomial *table = sphv_monomials(octants->dimension);
    for (int octant = 0; octant < 1 << octants->dimension; octant++)
        for (size_t m = 0; m < octants->monomials; m++) {
            int odd = 0;
            for (int i = 0; i < octants->dimension; i++)
                odd += (octant >> i & 1) * table[m].power[i];
            octants->sign[(size_t)octant * octants->monomials + m] = odd % 2 ? -1 : 1;
        }
}

static bool fill_places(sphv_octants *octants)
{
    int d = octants->dimension;
    const sphv_monomial *table = sphv_monomials(d);
    size_t *rest_of = malloc(octants->monomials * sizeof *rest_of);
    if (!rest_of) return false;
    for (size_t m = 0; m < octants->monomials; m++) {
        int power[SPHV_DIMENSIONS] = {table[m].power[1], table[m].power[2], 0};
        rest_of[m] = d > 1 ? sphv_monomial_index(d - 1, power) : 0;
    }
    for (int node = 0; node < octants->nodes; node++) {
        double power[POWERS] = {octants->share[node]};
        size_t line = (size_t)(node / octants->nodes_per_line);
        for (int n = 1; n <= octants->degree; n++) power[n] = power[n - 1] * octants->place[node];
        for (int k = 0; k < SPHV_RADIALS; k++)
            for (size_t tail = 0; tail < octants->tails; tail++) {
                const double *row = octants->row[k] + node * octants->tails * octants->rests + tail;
                double *to =
                    octants->moment[k] + (line * octants->tails + tail) * octants->monomials;
                for (size_t m = 0; m < octants->monomials; m++)
                    to[m] += power[table[m].power[0]] * row[rest_of[m] * octants->tails];
            }
    }
    free(rest_of);
    for (int k = 0; k < SPHV_RADIALS; k++)
        accumulate(octants->moment[k], octants->places, (size_t)octants->reach + 1, octants->tails,
                   octants->monomials);
    return true;
}

/// Σ v|p_k| q^k over the support, to scale rounding errors by.
static void find_sizes(sphv_octants *octants, const sphv_profile *profile)
{
    double points = gsl_pow_int(octants->nodes, octants->dimension);
    for (double point = 0; point < points; point++) {
        double square = 0, weight = 1 << octants->dimension, p[SPHV_RADIALS];
        size_t left = (size_t)point;
        for (int i = 0; i < octants->dimension; i++, left /= (size_t)octants->nodes) {
            size_t at = left % (size_t)octants->nodes;
            square += gsl_pow_2(octants->place[at]);
            weight *= octants->share[at];
        }
        double q = sqrt(square);
        if (q >= profile->support) continue;
        sphv_radial_functions(profile, q, p);
        octants->size[0] += weight * fabs(p[0]);
        octants->size[1] += weight * fabs(p[1]) * q;
        octants->size[2] += weight * fabs(p[2]);
        octants->flat += weight * fabs(p[1]);
    }
    // Each sum is made line by line: reach additions in each direction beside the terms' own
    // rounding of a few dozen units.
    octants->rounding = (64 + 4 * octants->nodes * octants->dimension) * SPHV_U;
}

sphv_status sphv_octants_make(const sphv_profile *profile, double spacing, int nodes_per_line,
                              int degree, sphv_octants *out, sphv_error *error)
{
    int d = profile->dimension;
    double reach = floor(profile->support / spacing), lines = reach + 1;
    double nodes = lines * nodes_per_line;
    *out = (sphv_octants){
        .dimension = d, .degree = degree, .spacing = spacing, .nodes_per_line = nodes_per_line};
    out->monomials = sphv_monomial_count(d, degree);
    out->rests = d > 1 ? sphv_monomial_count(d - 1, degree) : 1;
    double tails = gsl_pow_int(lines, d - 1);
    double numbers =
        SPHV_RADIALS * tails * (lines * (double)out->monomials + nodes * (double)out->rests) +
        2 * nodes + (1 << d) * (double)out->monomials;
    if (nodes_per_line < 1 || nodes_per_line > NODES_MAX || !(numbers * sizeof(double) < BYTES_MAX))
        return sphv_fail(error, SPHV_NO_CLOSED_FORM,
                         "%.4g lattice lines within the support are too many for its theory in %d "
                         "dimensions",
                         2 * reach + 1, d);
    out->reach = (int)reach;
    out->nodes = (int)nodes;
    out->tails = (size_t)tails;
    out->places = (size_t)(tails * lines);
    double *at = out->memory = calloc((size_t)numbers, sizeof *at);
    if (!at) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for moments");
    for (int k = 0; k < SPHV_RADIALS; k++) {
        out->moment[k] = at;
        at += out->places * out->monomials;
        out->row[k] = at;
        at += (size_t)out->nodes * out->tails * out->rests;
    }
    out->place = at;
    out->share = at + out->nodes;
    out->sign = at + 2 * out->nodes;
    bool done = make_nodes(out->reach, nodes_per_line, spacing, out->place, out->share);
    if (done) fill_rows(out, profile);
    if (!done || !fill_places(out)) {
        sphv_octants_free(out);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for moments");
    }
    fill_signs(out);
    find_sizes(out, profile);
    return SPHV_OK;
}

void sphv_octants_free(sphv_octants *octants)
{
    free(octants->memory);
    *octants = (sphv_octants){0};
}

void sphv_octants_moments(const sphv_octants *octants, const int *below, const int *above,
                          double *const out[SPHV_RADIALS])
{
    int d = octants->dimension;
    size_t count = octants->monomials, place[1 << SPHV_DIMENSIONS] = {0};
    for (int octant = 0; octant < 1 << d; octant++)
        for (int i = 0; i < d; i++)
            place[octant] = place[octant] * ((size_t)octants->reach + 1) +
                            (size_t)(octant >> i & 1 ? below[i] : above[i]);
    for (int k = 0; k < SPHV_RADIALS; k++) {
        if (!out[k]) continue;
        memset(out[k], 0, count * sizeof *out[k]);
        for (int octant = 0; octant < 1 << d; octant++) {
            const double *part = octants->moment[k] + place[octant] * count;
            const double *sign = octants->sign + (size_t)octant * count;
            for (size_t m = 0; m < count; m++) out[k][m] += sign[m] * part[m];
        }
    }
}
