#include "cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../internal.h"
#include "cell_sort.h"
#include "chunks.h"
#include "memory.h"

/// Targets in a group should be close together: a row is as thick as the square or cube that holds
/// SPHV_LANES_MAX particles, and cells are as long as one particle needs.
static const double THICKNESS[SPHV_DIMENSIONS] = {0, 2.83, 2};

void sphv_cell_grid_free(sphv_cell_grid *grid)
{
    free(grid->memory);
    *grid = (sphv_cell_grid){0};
}

/// Cells along each axis for particles spread over these lengths. Axes along which there is hardly
/// more than one row's thickness get one cell and do not count.
static void choose_cells(sphv_cell_grid *grid, const sphv_extent *extent, double thickness)
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

static void place_cells(sphv_cell_grid *grid, size_t rows, sphv_arena *arena)
{
    for (int i = 0; i < grid->dimension; i++)
        grid->x[i] = sphv_arena_take(arena, grid->count + SPHV_SPARE, sizeof *grid->x[i]);
    grid->volume = sphv_arena_take(arena, grid->count + SPHV_SPARE, sizeof *grid->volume);
    grid->particle = sphv_arena_take(arena, grid->count, sizeof *grid->particle);
    grid->target = sphv_arena_take(arena, grid->targets, sizeof *grid->target);
    grid->start = sphv_arena_take(arena, rows * grid->cells[0] + 2, sizeof *grid->start);
    grid->row = sphv_arena_take(arena, rows + 1, sizeof *grid->row);
}

static bool allocate_cells(sphv_cell_grid *grid, size_t rows)
{
    sphv_arena arena = {NULL, 0};
    place_cells(grid, rows, &arena);
    if (!sphv_arena_reserve(&arena)) return false;
    grid->memory = arena.memory;
    place_cells(grid, rows, &arena);
    for (int n = 0; n < SPHV_SPARE; n++) {
        for (int i = 0; i < grid->dimension; i++) grid->x[i][grid->count + (size_t)n] = 0;
        grid->volume[grid->count + (size_t)n] = 0;
    }
    return true;
}

/// Bounds of a row, and how many targets it has.
static void survey_row(const sphv_cell_grid *grid, size_t r, sphv_row *row)
{
    const size_t from = grid->start[r * grid->cells[0]],
                 end = grid->start[(r + 1) * grid->cells[0]];
    for (int i = 0; i < SPHV_DIMENSIONS; i++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t b = from; i > 0 && i < grid->dimension && b < end; b++) {
            double x = grid->x[i][b];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        row->low[i] = low;
        row->high[i] = high;
    }
    row->first_target = 0;
    for (size_t b = from; b < end; b++) row->first_target += !(grid->particle[b] & SPHV_CELL_COPY);
}

/// Lists the targets of a row, and takes the mark of copies off.
static void list_targets(const sphv_cell_grid *grid, size_t r)
{
    size_t end = grid->start[(r + 1) * grid->cells[0]], at = grid->row[r].first_target;
    for (size_t b = grid->start[r * grid->cells[0]]; b < end; b++) {
        if (!(grid->particle[b] & SPHV_CELL_COPY)) grid->target[at++] = (uint32_t)b;
        grid->particle[b] &= ~SPHV_CELL_COPY;
    }
}

static void survey_rows(sphv_cell_grid *grid, size_t rows)
{
    uint32_t targets = 0;
    grid->row[rows].first_target = 0;
#pragma omp parallel for schedule(static) if (sphv_chunks(grid->count) > 1)
    for (size_t r = 0; r < rows; r++) survey_row(grid, r, &grid->row[r]);
    for (size_t r = 0; r <= rows; r++) {
        uint32_t here = grid->row[r].first_target;
        grid->row[r].first_target = targets;
        targets += here;
    }
#pragma omp parallel for schedule(static) if (sphv_chunks(grid->count) > 1)
    for (size_t r = 0; r < rows; r++) list_targets(grid, r);
}

sphv_status sphv_cell_grid_make(sphv_cell_grid *grid, const sphv_particles *particles,
                                double radius, double thickness, sphv_error *error)
{
    int exponent;
    frexp(radius, &exponent);
    *grid = (sphv_cell_grid){
        .dimension = particles->dimension, .unit = ldexp(1, -exponent), .cells = {1, 1, 1}};
    sphv_extent extent = sphv_cell_extent(grid, particles, radius);
    grid->targets = particles->count;
    grid->count = particles->count + extent.copies;
    if (grid->count >= SPHV_CELL_SOURCES_MAX)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE,
                         "%zu particles are more than the 2^29 that can be sorted", grid->count);
    for (int i = 0; grid->count && i < grid->dimension; i++)
        if (!(extent.high[i] - extent.low[i] < 1e15))
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "particles are spread over more than 1e15 support radii: their "
                             "coordinates do not tell which are neighbours");
    if (grid->count) choose_cells(grid, &extent, thickness);
    size_t rows = grid->cells[1] * grid->cells[2];
    if (!allocate_cells(grid, rows) || !sphv_cell_sort(grid, particles, radius)) {
        sphv_cell_grid_free(grid);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory for sorting %zu particles",
                         particles->count);
    }
    survey_rows(grid, rows);
    return SPHV_OK;
}

/// How far two intervals are apart, rounded like a difference of coordinates.
static double gap(double low, double high, double from, double to)
{
    double below = low - to, above = from - high, apart = below > above ? below : above;
    return apart > 0 ? apart : 0;
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
    size_t sure = start[sphv_cell_of(grid, 0, from) + 1],
           sure_to = start[sphv_cell_of(grid, 0, to)];
    if (sure >= sure_to) return;
    range->sure = sure;
    range->sure_to = sure_to;
}

/// Room for the rounding of what is added to the ends of a box.
static double room_of(double low, double high)
{
    return 4 * SPHV_U * (fabs(low) + fabs(high));
}

/// The sources of a row that may be near. \return whether there are any
SPHV_INLINE bool find_near(const sphv_cell_grid *grid, const int dimension, size_t row,
                           const double low[SPHV_DIMENSIONS], const double high[SPHV_DIMENSIONS],
                           double limit, sphv_range *range)
{
    const sphv_row *of = &grid->row[row];
    const uint32_t *start = grid->start + row * grid->cells[0];
    double room = room_of(low[0], high[0]), square = 0;
    for (int i = 1; i < dimension; i++) {
        double apart = gap(low[i], high[i], of->low[i], of->high[i]);
        square += apart * apart;
    }
    if (!(square < limit)) return false;
    double chord = sqrt(limit - square * (1 - 8 * SPHV_U)) * (1 + 8 * SPHV_U);
    range->from = start[sphv_cell_of(grid, 0, low[0] - chord - room)];
    range->to = start[sphv_cell_of(grid, 0, high[0] + chord + room) + 1];
    range->sure = range->sure_to = range->from;
    return range->from < range->to;
}

bool sphv_cell_grid_range(const sphv_cell_grid *grid, size_t row, const double low[SPHV_DIMENSIONS],
                          const double high[SPHV_DIMENSIONS], double limit, sphv_range *range)
{
    if (!find_near(grid, grid->dimension, row, low, high, limit, range)) return false;
    find_sure(grid, &grid->row[row], grid->start + row * grid->cells[0], low, high, limit,
              room_of(low[0], high[0]), range);
    return true;
}

SPHV_INLINE size_t find_ranges(const sphv_cell_grid *grid, const int dimension,
                               const double low[SPHV_DIMENSIONS],
                               const double high[SPHV_DIMENSIONS], double limit, bool sure,
                               sphv_range *ranges)
{
    // The radius with room for the rounding of what is added to it.
    double radius = sqrt(limit) * (1 + 8 * SPHV_U);
    int first[SPHV_DIMENSIONS] = {0, 0, 0}, last[SPHV_DIMENSIONS] = {0, 0, 0};
    size_t count = 0;
    for (int i = 1; i < dimension; i++) {
        double room = room_of(low[i], high[i]);
        first[i] = sphv_cell_of(grid, i, low[i] - radius - room);
        last[i] = sphv_cell_of(grid, i, high[i] + radius + room);
    }
    for (int z = first[2]; z <= last[2]; z++)
        for (int y = first[1]; y <= last[1]; y++) {
            size_t row = (size_t)z * grid->cells[1] + (size_t)y;
            count += sure ? sphv_cell_grid_range(grid, row, low, high, limit, &ranges[count])
                          : find_near(grid, dimension, row, low, high, limit, &ranges[count]);
        }
    return count;
}

size_t sphv_cell_grid_ranges(const sphv_cell_grid *grid, const double low[SPHV_DIMENSIONS],
                             const double high[SPHV_DIMENSIONS], double limit, bool sure,
                             sphv_range *ranges)
{
    if (grid->dimension == 2) return find_ranges(grid, 2, low, high, limit, sure, ranges);
    if (grid->dimension == 3) return find_ranges(grid, 3, low, high, limit, sure, ranges);
    return find_ranges(grid, 1, low, high, limit, sure, ranges);
}
