/// \file candidate.h
/// Judging a candidate shape: would these pieces be a sound kernel with the file's own claims?
#ifndef SPHVERIFY_CHECK_CANDIDATE_H
#define SPHVERIFY_CHECK_CANDIDATE_H

#include "check_internal.h"

/// Does the shape meet everything that is claimed or required: value and slope continuous inside
/// and zero at κ, β as claimed, and every claimed constant right to 1e-13?
/// \param kernel  whose claims, support and transform apply
/// \param suspect the knot to look at first; receives the one that failed
bool sphv_candidate_fits(const sphv_kernel *kernel, const sphv_exact_pieces *pieces, int *suspect);

/// Relative change of the constant in d dimensions that the rounding of long decimals allows; 0 for
/// exact coefficients.
double sphv_candidate_constant_rounding(const sphv_exact_pieces *pieces, int d);

/// Jump of the order-th Taylor coefficient at the outer end of a piece, inside minus outside.
void sphv_candidate_jump(mpq_t out, const sphv_exact_pieces *pieces, int piece, int order);

#endif
