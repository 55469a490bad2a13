/// \file cells.h
/// Particles sorted into rows of cells, whatever order they came in.
///
/// Rows run along x; each is a strip in two dimensions and a square pencil in three. Within a row
/// particles are sorted by cell, which are so short that a cell holds about one. Neighbours of a
/// target are then a few ranges of the sorted order, one for each row, cut to the support's chord.
#ifndef SPHVERIFY_EMPIRICAL_CELLS_H
#define SPHVERIFY_EMPIRICAL_CELLS_H

#include <stdint.h>

#include "pass.h"

typedef struct sphv_row {
    uint32_t first_target;       ///< in `target`; the next row's ends it
    double low[SPHV_DIMENSIONS]; ///< where its particles begin and end; [0] is unused
    double high[SPHV_DIMENSIONS];
} sphv_row;

typedef struct sphv_cell_grid {
    int dimension;
    double unit;  ///< sorted coordinates are coordinates × unit, a power of two
    size_t count; ///< sources: the particles and, in a periodic box, copies of those near its sides
    double *x[SPHV_DIMENSIONS], *volume;
    uint32_t *particle; ///< that a source is, or is a copy of
    size_t targets;
    uint32_t *target; ///< the sources that are particles themselves, in order
    double low[SPHV_DIMENSIONS],
        per_cell[SPHV_DIMENSIONS]; ///< first cell's begin, cells per length
    size_t cells[SPHV_DIMENSIONS];
    uint32_t *start; ///< [row * cells[0] + cell]: its first source; one more at the end
    sphv_row *row;   ///< [z * cells[1] + y]; one more at the end
    void *memory;    ///< that the arrays are cut from
} sphv_cell_grid;

/// Sorts particles. \param radius of the support
/// \param thickness of a row in mean spacings of the particles; 0: as thick as groups of targets
/// need that are close together
sphv_status sphv_cell_grid_make(sphv_cell_grid *grid, const sphv_particles *particles,
                                double radius, double thickness, sphv_error *error);
void sphv_cell_grid_free(sphv_cell_grid *grid);

/// Ranges of sources that may be within a support of any point of the box low … high.
/// \param limit  the square of the radius of the support, in sorted coordinates
/// \param sure   whether to find out which are neighbours beyond doubt; else none are said to be
/// \param ranges receives at most as many as there are rows. \return their number
size_t sphv_cell_grid_ranges(const sphv_cell_grid *grid, const double low[SPHV_DIMENSIONS],
                             const double high[SPHV_DIMENSIONS], double limit, bool sure,
                             sphv_range *ranges);

/// The same in one row, with the sure ones. \return whether there are any
bool sphv_cell_grid_range(const sphv_cell_grid *grid, size_t row, const double low[SPHV_DIMENSIONS],
                          const double high[SPHV_DIMENSIONS], double limit, sphv_range *range);

#endif
