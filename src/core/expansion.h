/// \file expansion.h
/// Polynomial pieces as Taylor expansions about several centres.
///
/// A polynomial of high degree summed in powers of q, or about one end of a piece as long as its
/// support, cancels: its terms are many times its value. About the nearest of several centres they
/// are not. The coefficients are computed exactly and rounded once.
#ifndef SPHVERIFY_CORE_EXPANSION_H
#define SPHVERIFY_CORE_EXPANSION_H

#include "rational.h"
#include "sphverify/kernel.h"

/// One piece, exactly.
typedef struct sphv_exact_piece {
    mpq_srcptr inner, outer;            ///< where it begins and ends
    const sphv_polynomial *polynomial;  ///< in powers of q
    const sphv_polynomial *about_inner; ///< in powers of q − inner
    const sphv_polynomial *about_outer; ///< in powers of q − outer
} sphv_exact_piece;

/// Fills everything of a piece but its ends.
/// \param over_pi divide by π
/// \param centres how many expansions, from the inner end to the outer; at least 2
sphv_status sphv_piece_expand(sphv_piece *piece, const sphv_exact_piece *exact, bool over_pi,
                              int centres, sphv_error *error) SPHV_MUST_CHECK;
void sphv_piece_free(sphv_piece *piece);

/// Value, first and second derivative at q of a polynomial piece, with running rounding bounds.
void sphv_piece_values(const sphv_piece *piece, double q, sphv_result out[3]);

/// Any derivative at q of a polynomial piece.
sphv_result sphv_piece_derivative(const sphv_piece *piece, int derivative, double q);

/// The double nearest to a rational, or to a rational over π, but for one unit in 2^90.
double sphv_rational_over_pi(const mpq_t value, bool over_pi);

#endif
