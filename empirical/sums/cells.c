#include "cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../internal.h"
#include "memory.h"

/// Targets in a group should be close together: a row is as thick as the square or cube that holds
/// SPHV_LANES_MAX particles, and cells are as long as one particle needs.
enum { SPARE = 32 }; ///< places behind the sources that a vector may read

static const double THICKNESS[SPHV_DIMENSIONS] = {0, 2.83, 2};

void sphv_cell_grid_free(sphv_cell_grid *grid)
{
    for (int i = 0; i < SPHV_DIMENSIONS; i++) free(grid->x[i]);
    free(grid->volume);
    free(grid->particle);
    free(grid->target);
    free(grid->start);
    free(grid->row);
    *grid = (sphv_cell_grid){0};
}

/// The cell of a coordinate: monotone in it, rounding included.
static size_t cell_of(const sphv_cell_grid *grid, int axis, double x)
{
    double cell = (x - grid->low[axis]) * grid->per_cell[axis];
    if (!(cell > 0)) return 0;
    return cell < (double)grid->cells[axis] ? (size_t)cell : grid->cells[axis] - 1;
}

/// Which copies of a coordinate there are in a periodic box: 0, and 1 or −1 near its ends.
static int copies_of(double x, bool periodic, double radius, double copy[2])
{
    copy[0] = x;
    double near = radius * (1 + 4 * SPHV_U) + 2 * SPHV_U; // room for the rounding of x ± 1
    if (!periodic || (x > near && x < 1 - near)) return 1;
    copy[1] = x < 0.5 ? x + 1 : x - 1;
    return 2;
}

struct source {
    double x[SPHV_DIMENSIONS];
    size_t particle;
    bool copy;
};

#define SPHV_EACH static inline __attribute__((always_inline))

/// Calls for every source in the order of the particles.
SPHV_EACH void each_source(const sphv_cell_grid *grid, const sphv_particles *particles,
                           double radius,
                           void (*call)(sphv_cell_grid *, const struct source *, void *),
                           sphv_cell_grid *into, void *context)
{
    int d = particles->dimension;
    for (size_t b = 0; b < particles->count && !particles->periodic; b++) {
        struct source source = {{0, 0, 0}, b, false};
        for (int i = 0; i < d; i++) source.x[i] = particles->x[i][b] * grid->unit;
        call(into, &source, context);
    }
    for (size_t b = 0; b < particles->count && particles->periodic; b++) {
        double copy[SPHV_DIMENSIONS][2] = {{0}};
        int copies[SPHV_DIMENSIONS] = {1, 1, 1};
        for (int i = 0; i < d; i++)
            copies[i] = copies_of(particles->x[i][b], particles->periodic, radius, copy[i]);
        for (int k = 0; k < copies[2]; k++)
            for (int j = 0; j < copies[1]; j++)
                for (int i = 0; i < copies[0]; i++) {
                    struct source source = {
                        {copy[0][i] * grid->unit, copy[1][j] * grid->unit, copy[2][k] * grid->unit},
                        b,
                        i || j || k};
                    call(into, &source, context);
                }
    }
}

static size_t row_of(const sphv_cell_grid *grid, const double x[SPHV_DIMENSIONS])
{
    size_t row = 0;
    for (int i = grid->dimension - 1; i > 0; i--)
        row = row * grid->cells[i] + cell_of(grid, i, x[i]);
    return row;
}

static size_t place_of(const sphv_cell_grid *grid, const double x[SPHV_DIMENSIONS])
{
    return row_of(grid, x) * grid->cells[0] + cell_of(grid, 0, x[0]);
}

struct extent {
    double low[SPHV_DIMENSIONS], high[SPHV_DIMENSIONS];
    size_t copies;
};

static void widen(sphv_cell_grid *grid, const struct source *source, void *context)
{
    struct extent *extent = context;
    extent->copies += source->copy;
    for (int i = 0; i < grid->dimension; i++) {
        if (source->x[i] < extent->low[i]) extent->low[i] = source->x[i];
        if (source->x[i] > extent->high[i]) extent->high[i] = source->x[i];
    }
}

static void count_source(sphv_cell_grid *grid, const struct source *source, void *context)
{
    uint32_t **cell = context, at = (uint32_t)place_of(grid, source->x);
    *(*cell)++ = at;
    grid->start[at + 1]++;
}

struct putting {
    const sphv_particles *particles;
    const uint32_t *cell; ///< of the next source
};

/// Puts a source where its cell has come to; start[cell] ends as the start of the next one.
static void put_source(sphv_cell_grid *grid, const struct source *source, void *context)
{
    struct putting *putting = context;
    size_t at = grid->start[*putting->cell++]++;
    for (int i = 0; i < grid->dimension; i++) grid->x[i][at] = source->x[i];
    grid->volume[at] = putting->particles->volume[source->particle];
    grid->particle[at] = (uint32_t)source->particle | (source->copy ? 0x80000000u : 0);
}

/// Cells along each axis for particles spread over these lengths. Axes along which there is hardly
/// more than one row's thickness get one cell and do not count.
static void choose_cells(sphv_cell_grid *grid, const struct extent *extent, double thickness)
{
    int d = grid->dimension, counted = d;
    bool flat[SPHV_DIMENSIONS] = {false, false, false};
    double spacing = 0;
    for (int pass = 0; pass < d; pass++) {
        double logarithm = -log((double)grid->count);
        int axes = 0;
        for (int i = 0; i < d; i++)
            if (!flat[i] && extent->high[i] > extent->low[i]) {
                logarithm += log(extent->high[i] - extent->low[i]);
                axes++;
            }
        counted = axes;
        spacing = axes ? exp(logarithm / axes) : 0;
        for (int i = 0; i < d; i++)
            if (extent->high[i] - extent->low[i] <= spacing) flat[i] = true;
    }
    if (counted <= 1) thickness = 1;
    if (!(thickness > 0)) thickness = THICKNESS[counted - 1];
    double most = fmin(2 * (double)grid->count + 16, 4e9); // places fit 32 bits
    for (int i = d - 1; i >= 0; i--) {
        double length = extent->high[i] - extent->low[i];
        double size = i > 0 ? thickness * spacing : spacing / pow(thickness, counted - 1);
        double cells = size > 0 && length > 0 ? ceil(length / size) : 1;
        if (!(cells >= 1)) cells = 1;
        if (cells > most) cells = most;
        most /= cells;
        grid->cells[i] = (size_t)cells;
        grid->low[i] = extent->low[i];
        grid->per_cell[i] = length > 0 ? cells / length : 0;
        if (!isfinite(grid->per_cell[i])) {
            grid->per_cell[i] = 0;
            grid->cells[i] = 1;
        }
    }
}

static bool allocate_cells(sphv_cell_grid *grid, size_t rows)
{
    bool enough = true;
    for (int i = 0; i < grid->dimension; i++)
        enough = (grid->x[i] = sphv_room(grid->count + SPARE, sizeof(double))) && enough;
    grid->volume = sphv_room(grid->count + SPARE, sizeof(double));
    for (int n = 0; enough && grid->volume && n < SPARE; n++) {
        for (int i = 0; i < grid->dimension; i++) grid->x[i][grid->count + (size_t)n] = 0;
        grid->volume[grid->count + (size_t)n] = 0;
    }
    grid->particle = sphv_room(grid->count, sizeof(uint32_t));
    grid->target = sphv_room(grid->targets, sizeof(uint32_t));
    grid->start = sphv_array(rows * grid->cells[0] + 2, sizeof(uint32_t));
    grid->row = sphv_array(rows + 1, sizeof(sphv_row));
    return enough && grid->volume && grid->particle && grid->target && grid->start && grid->row;
}

/// Bounds of each row and its targets, and takes the mark of copies off.
static void survey_rows(sphv_cell_grid *grid, size_t rows)
{
    size_t targets = 0;
    for (size_t r = 0; r <= rows; r++) {
        sphv_row *row = &grid->row[r];
        row->first_target = (uint32_t)targets;
        if (r == rows) break;
        for (int i = 0; i < SPHV_DIMENSIONS; i++) {
            row->low[i] = INFINITY;
            row->high[i] = -INFINITY;
        }
        size_t end = grid->start[(r + 1) * grid->cells[0]];
        for (size_t b = grid->start[r * grid->cells[0]]; b < end; b++) {
            for (int i = 1; i < grid->dimension; i++) {
                double x = grid->x[i][b];
                if (x < row->low[i]) row->low[i] = x;
                if (x > row->high[i]) row->high[i] = x;
            }
            if (!(grid->particle[b] & 0x80000000u)) grid->target[targets++] = (uint32_t)b;
            grid->particle[b] &= 0x7fffffffu;
        }
    }
}

sphv_status sphv_cell_grid_make(sphv_cell_grid *grid, const sphv_particles *particles,
                                double radius, double thickness, sphv_error *error)
{
    int exponent;
    frexp(radius, &exponent);
    *grid = (sphv_cell_grid){
        .dimension = particles->dimension, .unit = ldexp(1, -exponent), .cells = {1, 1, 1}};
    struct extent extent = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0};
    each_source(grid, particles, radius, widen, grid, &extent);
    grid->targets = particles->count;
    grid->count = particles->count + extent.copies;
    if (grid->count >= 0x7fffffffu)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE,
                         "%zu particles are more than the 2^31 that "
                         "can be sorted",
                         grid->count);
    for (int i = 0; grid->count && i < grid->dimension; i++)
        if (!(extent.high[i] - extent.low[i] < 1e15))
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "particles are spread over more than 1e15 support radii: their "
                             "coordinates do not tell which are neighbours");
    if (grid->count) choose_cells(grid, &extent, thickness);
    size_t rows = grid->cells[1] * grid->cells[2];
    uint32_t *cell = sphv_room(grid->count, sizeof *cell);
    if (!allocate_cells(grid, rows) || !cell) {
        free(cell);
        sphv_cell_grid_free(grid);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory for sorting %zu particles",
                         particles->count);
    }
    size_t cells = rows * grid->cells[0];
    uint32_t *next = cell;
    each_source(grid, particles, radius, count_source, grid, &next);
    for (size_t c = 0; c < cells; c++) grid->start[c + 1] += grid->start[c];
    struct putting putting = {particles, cell};
    each_source(grid, particles, radius, put_source, grid, &putting);
    free(cell);
    memmove(grid->start + 1, grid->start, cells * sizeof *grid->start);
    grid->start[0] = 0;
    survey_rows(grid, rows);
    return SPHV_OK;
}

/// How far two intervals are apart, rounded like a difference of coordinates.
static double gap(double low, double high, double from, double to)
{
    return fmax(fmax(low - to, from - high), 0);
}

/// Where in a row all sources are neighbours of every point of the box. The differences that decide
/// it are rounded six times at most, and 16 u on either side are more than that.
static void find_sure(const sphv_cell_grid *grid, const sphv_row *row, const uint32_t *start,
                      const double low[SPHV_DIMENSIONS], const double high[SPHV_DIMENSIONS],
                      double limit, double room, sphv_range *range)
{
    double square = 0;
    for (int i = 1; i < grid->dimension; i++) {
        double apart = fmax(high[i] - row->low[i], row->high[i] - low[i]);
        square += apart * apart;
    }
    square *= 1 + 16 * SPHV_U;
    range->sure = range->sure_to = range->from;
    if (!(square < limit)) return;
    double chord = sqrt(limit - square) * (1 - 16 * SPHV_U);
    double from = high[0] - chord + room, to = low[0] + chord - room;
    if (!(from < to)) return;
    size_t sure = start[cell_of(grid, 0, from) + 1], sure_to = start[cell_of(grid, 0, to)];
    if (sure >= sure_to) return;
    range->sure = sure;
    range->sure_to = sure_to;
}

bool sphv_cell_grid_range(const sphv_cell_grid *grid, size_t row, const double low[SPHV_DIMENSIONS],
                          const double high[SPHV_DIMENSIONS], double limit, sphv_range *range)
{
    const sphv_row *of = &grid->row[row];
    const uint32_t *start = grid->start + row * grid->cells[0];
    double room = 4 * SPHV_U * (fabs(low[0]) + fabs(high[0])), square = 0;
    for (int i = 1; i < grid->dimension; i++) {
        double apart = gap(low[i], high[i], of->low[i], of->high[i]);
        square += apart * apart;
    }
    if (!(square < limit)) return false;
    double chord = sqrt(limit - square * (1 - 8 * SPHV_U)) * (1 + 8 * SPHV_U);
    range->from = start[cell_of(grid, 0, low[0] - chord - room)];
    range->to = start[cell_of(grid, 0, high[0] + chord + room) + 1];
    if (range->from >= range->to) return false;
    find_sure(grid, of, start, low, high, limit, room, range);
    return true;
}

size_t sphv_cell_grid_ranges(const sphv_cell_grid *grid, const double low[SPHV_DIMENSIONS],
                             const double high[SPHV_DIMENSIONS], double limit, sphv_range *ranges)
{
    // The radius with room for the rounding of what is added to it.
    double radius = sqrt(limit) * (1 + 8 * SPHV_U);
    size_t first[SPHV_DIMENSIONS] = {0, 0, 0}, last[SPHV_DIMENSIONS] = {0, 0, 0}, count = 0;
    for (int i = 1; i < grid->dimension; i++) {
        double room = 4 * SPHV_U * (fabs(low[i]) + fabs(high[i]));
        first[i] = cell_of(grid, i, low[i] - radius - room);
        last[i] = cell_of(grid, i, high[i] + radius + room);
    }
    for (size_t z = first[2]; z <= last[2]; z++)
        for (size_t y = first[1]; y <= last[1]; y++)
            count += sphv_cell_grid_range(grid, z * grid->cells[1] + y, low, high, limit,
                                          &ranges[count]);
    return count;
}
