/// \file half_pairs.h
/// Each pair visited once, for standard SPH with many neighbours.
#ifndef SPHVERIFY_EMPIRICAL_HALF_PAIRS_H
#define SPHVERIFY_EMPIRICAL_HALF_PAIRS_H

#include "evaluation.h"

/// The direct route with each pair visited once, for sums of the level PLAIN: what a pair adds to
/// one particle's sums it adds to the other's but for a sign and a weight, so that distances and
/// radial functions are taken once. Sums of higher levels are too many for the registers to hold
/// those of both particles: visiting each of their pairs twice is faster.
///
/// Work is cut into pairs of rows. Those of one distance between rows, every other one in turn,
/// have no row in common and are visited at the same time, so a particle's sums grow in an order
/// that does not depend on the threads.
///
/// For two or three dimensions, one or two fields, not for periodic boxes.
/// \return SPHV_NO_CLOSED_FORM for kernels that are not compiled or have a cusp at the origin, and
/// for fields that overflow
sphv_status sphv_evaluate_half_pairs(const sphv_evaluation *evaluation, sphv_error *error);

/// Whether that is possible for a request, and faster than a target at a time.
bool sphv_half_pairs_win(const sphv_evaluation *evaluation);

/// What particles have on average, were they spread evenly; 0 where that says nothing.
typedef struct sphv_mean {
    double reach;      ///< the support's radius in spacings
    double neighbours; ///< of a particle in the interior
} sphv_mean;
sphv_mean sphv_mean_of(const sphv_evaluation *evaluation);

#endif
