/// \file half_tiles.h
/// Targets in tiles: a few that are close together, of one row.
#ifndef SPHVERIFY_EMPIRICAL_HALF_TILES_H
#define SPHVERIFY_EMPIRICAL_HALF_TILES_H

#include "cells.h"

typedef struct sphv_half_tiles {
    sphv_half_tile *tile;
    size_t *row; ///< first tile of each row; one more at the end
} sphv_half_tiles;

/// Cuts the particles of each row into tiles. Neighbours in the order of the cells are next to each
/// other along x only: some at a time are taken in the order of y.
/// \param size of a tile, SPHV_HALF_TILE at most. \return false without memory
bool sphv_half_tiles_make(sphv_half_tiles *tiles, const sphv_cell_grid *grid, size_t size);
void sphv_half_tiles_free(sphv_half_tiles *tiles);

#endif
