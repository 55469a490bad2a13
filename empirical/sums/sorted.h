/// \file sorted.h
/// What every way of visiting pairs starts from: particles sorted into cells, their volumes and
/// fields in that order, and the kernel compiled.
#ifndef SPHVERIFY_EMPIRICAL_SORTED_H
#define SPHVERIFY_EMPIRICAL_SORTED_H

#include "cells.h"
#include "evaluation.h"

typedef struct sphv_sorted {
    const sphv_evaluation *evaluation;
    sphv_cell_grid grid;
    sphv_radial radial;
    double *v;       ///< V/h^d of each source, where the sources' volumes were
    double v_most;   ///< max |V|/h^d
    double rounding; ///< of a summand
    size_t fields;   ///< the request's
    void *memory;    ///< that the fields are cut from
    double **field;  ///< of each source; one at least, of zeros when there are none
    double *scale;   ///< of each sum of the layout, from powers of d to powers of s
} sphv_sorted;

/// \param thickness of the rows, see sphv_cell_grid_make
sphv_status sphv_sorted_make(sphv_sorted *sorted, const sphv_evaluation *evaluation,
                             double thickness, sphv_error *error);
void sphv_sorted_free(sphv_sorted *sorted);

/// Writes the bounds of `count` particles of a block, from its `at`-th: the sizes of their summands
/// from the number of their neighbours, and their rounding.
/// \param depth most additions that any of their summands goes through
void sphv_sorted_bound(const sphv_sorted *sorted, sphv_worker *worker, size_t at, size_t count,
                       const double *neighbours, double depth);

#endif
