#include "half_tiles.h"

#include <math.h>
#include <stdlib.h>

#include "memory.h"

enum { TILES_TOGETHER = 4 }; ///< tiles whose targets are sorted by y

static sphv_half_tile make_tile(const sphv_cell_grid *grid, const uint32_t *target, size_t count)
{
    sphv_half_tile tile = {
        .count = (uint32_t)count, .first = target[0], .last = target[0], .low = {0}, .high = {0}};
    for (int i = 0; i < grid->dimension; i++) {
        tile.low[i] = INFINITY;
        tile.high[i] = -INFINITY;
    }
    for (size_t t = 0; t < count; t++) {
        tile.target[t] = target[t];
        if (target[t] < tile.first) tile.first = target[t];
        if (target[t] > tile.last) tile.last = target[t];
        for (int i = 0; i < grid->dimension; i++) {
            double x = grid->x[i][target[t]];
            if (x < tile.low[i]) tile.low[i] = x;
            if (x > tile.high[i]) tile.high[i] = x;
        }
    }
    return tile;
}

/// Sorts by y, equal ones by their order: few enough to be inserted one by one.
static void sort_by_y(const sphv_cell_grid *grid, uint32_t *target, size_t count)
{
    const double *y = grid->x[1];
    for (size_t i = 1; i < count; i++) {
        uint32_t moved = target[i];
        size_t place = i;
        for (; place > 0 && y[target[place - 1]] > y[moved]; place--)
            target[place] = target[place - 1];
        target[place] = moved;
    }
}

bool sphv_half_tiles_make(sphv_half_tiles *tiles, const sphv_cell_grid *grid, size_t size)
{
    size_t rows = grid->cells[1] * grid->cells[2], most = grid->count / size + rows, made = 0;
    tiles->tile = sphv_room(most, sizeof *tiles->tile);
    tiles->row = sphv_room(rows + 1, sizeof *tiles->row);
    if (!tiles->tile || !tiles->row) return false;
    for (size_t r = 0; r < rows; r++) {
        size_t end = grid->start[(r + 1) * grid->cells[0]];
        tiles->row[r] = made;
        for (size_t a = grid->start[r * grid->cells[0]]; a < end; a += TILES_TOGETHER * size) {
            uint32_t target[TILES_TOGETHER * SPHV_HALF_TILE];
            size_t count = end - a < TILES_TOGETHER * size ? end - a : TILES_TOGETHER * size;
            for (size_t t = 0; t < count; t++) target[t] = (uint32_t)(a + t);
            sort_by_y(grid, target, count);
            for (size_t t = 0; t < count; t += size)
                tiles->tile[made++] =
                    make_tile(grid, target + t, count - t < size ? count - t : size);
        }
    }
    tiles->row[rows] = made;
    return true;
}

void sphv_half_tiles_free(sphv_half_tiles *tiles)
{
    free(tiles->tile);
    free(tiles->row);
}
