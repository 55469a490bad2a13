/// \file radial.h
/// The radial functions p_0, p_1, p_2 of a profile (sums.h), compiled for vector loops.
#ifndef SPHVERIFY_EMPIRICAL_RADIAL_H
#define SPHVERIFY_EMPIRICAL_RADIAL_H

#include "sums.h"

enum { SPHV_RADIAL_KNOTS = 16, SPHV_RADIAL_TERMS = 24 };

/// How the radial functions are evaluated. With t_i = max(0, k_i − q), k_i the knots, a polynomial
/// kernel is a sum of polynomials in the t_i.
typedef enum sphv_radial_form {
    SPHV_RADIAL_QUOTIENT, ///< one piece, and p_1 is a polynomial in t as well
    SPHV_RADIAL_SLOPE,    ///< p_1 = Ŵ′/q with a division
    SPHV_RADIAL_PROFILE,  ///< each pair from the profile: slow, for every kernel
} sphv_radial_form;

/// p_k = Σ_i t_i^low Σ_j term[k][i][j] t_i^j, j < terms; divided by r where `over_q` says so, the
/// terms being multiplied by h already.
typedef struct sphv_radial {
    const sphv_profile *profile;
    sphv_radial_form form;
    double h, inverse_h, limit; ///< limit (κh)²
    int knots;
    double knot[SPHV_RADIAL_KNOTS]; ///< k_i; the first is the edge κ
    int low[3], terms[3];
    bool over_q[3];
    double term[3][SPHV_RADIAL_KNOTS][SPHV_RADIAL_TERMS];
    /// sup |p_k| q^m and what rounding may add to it, as in the sums of sizes; with the form
    /// PROFILE sizes are summed pair by pair instead.
    double size[3];
    double slope[4]; ///< sup |Ŵ^(n)|
} sphv_radial;

/// Compiles a profile for the sums of a level.
void sphv_radial_make(sphv_radial *radial, const sphv_profile *profile, double h,
                      sphv_sum_level level);

/// The radial functions of one pair from the profile, and their sizes |p_k| q^m with what rounding
/// may add, m the lowest degree of the level's moments.
/// \param square of the distance, of which alone it depends on which side of a knot the pair is
void sphv_radial_values(const sphv_radial *radial, sphv_sum_level level, double square, double p[3],
                        double size[3]);

#endif
