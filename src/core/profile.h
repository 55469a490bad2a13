/// \file profile.h
/// Building the normalised profile Ŵ of a kernel in one dimension count.
#ifndef SPHVERIFY_CORE_PROFILE_H
#define SPHVERIFY_CORE_PROFILE_H

#include "families.h"
#include "rational.h"
#include "sphverify/kernel.h"

/// Polynomial pieces with exact ends and coefficients, ascending from q = 0.
typedef struct sphv_exact_pieces {
    int count;
    mpq_t *outer;                ///< piece i ends here; piece 0 begins at 0
    sphv_polynomial *polynomial; ///< in powers of q
    /// Relative uncertainty of numbers that the file writes as decimals of 16 digits or more, which
    /// stand for others that no decimal holds; 0 when all are short decimals or fractions.
    double rounding;
} sphv_exact_pieces;

/// What that uncertainty can make of the order-th Taylor coefficient of a piece about q:
/// rounding · Σ|a_k| C(k, order) q^(k − order).
double sphv_exact_pieces_rounding(const sphv_exact_pieces *pieces, int piece, int order, double q);

sphv_status sphv_exact_pieces_make(sphv_exact_pieces *pieces, int count,
                                   sphv_error *error) SPHV_MUST_CHECK;
sphv_status sphv_exact_pieces_copy(sphv_exact_pieces *to, const sphv_exact_pieces *from,
                                   int extra_degree, sphv_error *error) SPHV_MUST_CHECK;
void sphv_exact_pieces_free(sphv_exact_pieces *pieces);
/// Can exact arithmetic carry them? A common denominator of all moments has the size of that of the
/// coefficients plus, for every power of q, that of the ends; fractions with nothing in common
/// would make it so long that a kernel takes hours.
bool sphv_exact_pieces_manageable(const sphv_exact_pieces *pieces);
void sphv_exact_pieces_scale(sphv_exact_pieces *pieces, const mpq_t factor);
/// Multiplies every piece by (1 − a q²); the pieces must have two degrees to spare.
void sphv_exact_pieces_transform(sphv_exact_pieces *pieces, const mpq_t a);
/// out = ∫_0^κ q^power · d^order w/dq^order dq, piece by piece.
void sphv_exact_pieces_moment(mpq_t out, const sphv_exact_pieces *pieces, int order, int power);

/// Surface of the unit sphere in d dimensions without its power of π: 2, 2π, 4π.
int sphv_sphere_factor(int dimension);
/// π^(d > 1), the power of π that `sphv_sphere_factor` leaves out.
double sphv_sphere_pi(int dimension);

/// Compiles exact pieces. `pieces` hold C_d π^(d>1) w, so the profile is pieces/π^(d>1).
/// \param constant C_d π^(d>1) exactly
sphv_status sphv_profile_from_pieces(sphv_profile *out, int dimension,
                                     const sphv_exact_pieces *pieces, const mpq_t constant,
                                     sphv_error *error) SPHV_MUST_CHECK;

/// Fills the moments of a profile and their excesses, each good to one rounding.
sphv_status sphv_profile_moments(sphv_profile *profile, const sphv_exact_pieces *exact,
                                 sphv_error *error) SPHV_MUST_CHECK;

/// Compiles a closed form: finds its constant by quadrature.
/// \param fourth_order apply w(q)(1 − a q²) with a from the moments
sphv_status sphv_profile_from_form(sphv_profile *out, const sphv_form *form, sphv_number support,
                                   bool fourth_order, sphv_error *error) SPHV_MUST_CHECK;

void sphv_profile_free(sphv_profile *profile);

#endif
