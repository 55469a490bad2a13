/// \file cell_sort.h
/// Puts sources into the cells of a grid.
#ifndef SPHVERIFY_EMPIRICAL_CELL_SORT_H
#define SPHVERIFY_EMPIRICAL_CELL_SORT_H

#include "../clones.h"
#include "cells.h"

/// Marks a copy among the particles of a grid that is being made.
#define SPHV_CELL_COPY 0x80000000u

/// Sources that a grid holds at most: a number and a bit for each axis fit 32 bits.
enum { SPHV_CELL_SOURCES_MAX = 1 << 29 };

/// Where particles are, and how many copies of them a periodic box has beyond its sides.
typedef struct sphv_extent {
    double low[SPHV_DIMENSIONS], high[SPHV_DIMENSIONS]; ///< in sorted coordinates
    size_t copies;
} sphv_extent;

sphv_extent sphv_cell_extent(const sphv_cell_grid *grid, const sphv_particles *particles,
                             double radius);

/// Fills x, volume, particle (copies marked) and start of a grid whose cells are chosen and whose
/// arrays have room: sources by cell, and within a cell by particle. \return false without memory
bool sphv_cell_sort(sphv_cell_grid *grid, const sphv_particles *particles, double radius);

/// The cell of a coordinate along an axis: monotone in it, rounding included.
SPHV_INLINE int sphv_cell_of(const sphv_cell_grid *grid, int axis, double x)
{
    double cell = (x - grid->low[axis]) * grid->per_cell[axis];
    double last = (double)(grid->cells[axis] - 1);
    cell = cell > 0 ? cell : 0;
    return (int)(cell < last ? cell : last);
}

#endif
