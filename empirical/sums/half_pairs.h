/// \file half_pairs.h
/// Each pair visited once, for particles of many neighbours.
#ifndef SPHVERIFY_EMPIRICAL_HALF_PAIRS_H
#define SPHVERIFY_EMPIRICAL_HALF_PAIRS_H

#include "evaluation.h"

/// The direct route with each pair visited once: what a pair adds to one particle's sums, it adds
/// to the other's but for signs and weights, so that distances and radial functions are taken once.
///
/// Work is cut into pairs of rows. Those of one distance between rows, every other one in turn,
/// have no row in common and may be visited at the same time, so a particle's sums grow in an order
/// that does not depend on the threads. \return SPHV_NO_CLOSED_FORM when there is no such pass for
/// the request
sphv_status sphv_evaluate_half_pairs(const sphv_evaluation *evaluation, sphv_error *error);

/// Whether that is possible, and faster than a target at a time.
bool sphv_half_pairs_win(const sphv_evaluation *evaluation);

#endif
