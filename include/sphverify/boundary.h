/// \file boundary.h
/// The analytic half in a box: what truncated supports do to each method.
///
/// Near an edge the support is cut, the odd moments of the kernel no longer vanish, and the leading
/// error of a method changes its order. The estimate at a particle is a functional of the field;
/// expanded in Taylor series it is Σ_α h^|α| ∂^αA/α! times a quotient of truncated moments. Here
/// those moments are closed forms or quadratures of the kernel, never sums over a box's particles.
#ifndef SPHVERIFY_BOUNDARY_H
#define SPHVERIFY_BOUNDARY_H

#include "sphverify/box.h"
#include "sphverify/field.h"
#include "sphverify/theory.h"

/// Moments over the support cut by the sides of a box, in units of h:
/// moment[k][α] = ∫ p_k(|s|) s^α ds over {|s| < κ, s_i > −below_i, s_i < above_i}, with p_0 = Ŵ,
/// p_1 = Ŵ′/q, p_2 = (Ŵ″ − Ŵ′/q)/q².
/// \param below, above  distance to the sides in units of h; κ or more where a side is out of reach
/// \param degree        highest |α|
/// \param out           [k] receives sphv_monomial_count(d, degree) results each
sphv_status sphv_truncated_moments(const sphv_profile *profile, const double *below,
                                   const double *above, int degree, sphv_result *out[3],
                                   sphv_error *error) SPHV_MUST_CHECK;

/// What moments a prediction is made of.
typedef enum sphv_moment_source {
    SPHV_MOMENTS_LATTICE,   ///< the kernel's sums over a half, quarter or whole lattice: exact
    SPHV_MOMENTS_CONTINUUM, ///< its integrals over the support, cut where the outermost cells end
    /// As the first, and on perturbed lattices from every neighbour, however many: slow. Else
    /// supports of more than four spacings are summed by rules.
    SPHV_MOMENTS_EVERY,
} sphv_moment_source;

enum { SPHV_BOX_METHODS_MAX = SPHV_MSPH + 1 }; ///< methods that may be asked for at once

/// A prediction of the root mean square error over the particles of a box.
typedef struct sphv_box_prediction {
    size_t quantities;
    sphv_result rmse[SPHV_QUANTITIES_MAX];     ///< over all particles
    sphv_result interior[SPHV_QUANTITIES_MAX]; ///< over those further than κh from every side
    /// Standard deviation of the two over realisations of a perturbed lattice, or more than that:
    /// 0 on the lattice, infinite where theory does not tell.
    double scatter[SPHV_QUANTITIES_MAX], interior_scatter[SPHV_QUANTITIES_MAX];
    double excluded; ///< particles without a usable moment matrix, left out of the norms
    sphv_rigour rigour;
    bool exists[SPHV_QUANTITIES_MAX]; ///< false where derivatives of the field are not integrable
} sphv_box_prediction;

/// Predicts the RMSE of a method over a lattice, or a perturbed lattice of small amplitude, in the
/// unit box. On the latter it is the root of the expected mean square over realisations.
/// \return SPHV_NO_CLOSED_FORM for layouts, volumes, methods or dimensions without a theory
sphv_status sphv_predict_box(const sphv_box *box, const sphv_profile *profile, double h,
                             sphv_method method, const sphv_field *field, sphv_box_prediction *out,
                             sphv_error *error) SPHV_MUST_CHECK;

/// The same from one kind of moments. Those of the continuum are the limit of many neighbours: they
/// are in error by that of the midpoint rule, of order (Δx/h)².
sphv_status sphv_predict_box_from(const sphv_box *box, const sphv_profile *profile, double h,
                                  sphv_method method, const sphv_field *field,
                                  sphv_moment_source source, sphv_box_prediction *out,
                                  sphv_error *error) SPHV_MUST_CHECK;

/// Predicts several methods at once, which share moments: the same numbers, sooner.
/// \param methods  no more than SPHV_BOX_METHODS_MAX
/// \param out      of each method; without quantities where there is no theory
sphv_status sphv_predict_box_methods(const sphv_box *box, const sphv_profile *profile, double h,
                                     size_t count, const sphv_method *methods,
                                     const sphv_field *field, sphv_box_prediction *out,
                                     sphv_error *error) SPHV_MUST_CHECK;

/// What the papers ask of a kernel on particles, one component of each, V = Δx^d, s = (x_b −
/// x_a)/h. Equation numbers are Sigalotti's (2016).
typedef enum sphv_consistency_measure {
    SPHV_NORMALISATION, ///< ΣWV − 1 (eqs. 10, 14): translations
    SPHV_CENTRE,        ///< Σs_i WV (eq. 16, l = 1)
    SPHV_SPREAD, ///< Σs_i² WV (eqs. 16, l = 2, and 18): the intrinsic diffusion σ²/h² (eq. 20)
    SPHV_FLATNESS, ///< Σh∂_iW V (eq. 22, l = 0)
    SPHV_ROTATION, ///< −Σs_i h∂_iW V − 1 (eq. 27, diagonal)
    SPHV_SHEAR,    ///< −Σs_i h∂_jW V (eq. 27, off the diagonal; 0 in one dimension)
    SPHV_CONSISTENCY_MEASURES
} sphv_consistency_measure;

extern const sphv_name_row sphv_consistency_measures[]; ///< ended by a NULL name

typedef struct sphv_consistency {
    double neighbours; ///< n_nb: lattice points within the support, the particle included
    /// On the lattice, by the kernel's sums over it. Centre, flatness and shear vanish by symmetry.
    sphv_result lattice[SPHV_CONSISTENCY_MEASURES];
    /// The same by Poisson's formula, as the continuum's value (of the spread: μ_2/d) and aliases,
    /// Fourier transforms at 2π|m|/Δs, m ≠ 0: why the errors fall with n_nb as they do. The bound
    /// is infinite for kernels with β < 2, whose aliases fall too slowly to be summed.
    sphv_result aliases[SPHV_CONSISTENCY_MEASURES];
    /// Expectation and standard deviation where every coordinate of every particle is perturbed.
    /// The deviation is to leading order amplitude (Δx/h)^(1 + d/2) √∫|∇z|², z the measure's
    /// summand: n_nb^−(1/2 + 1/d).
    sphv_result mean[SPHV_CONSISTENCY_MEASURES], deviation[SPHV_CONSISTENCY_MEASURES];
    /// That leading order, for a variance of amplitude² (normal) or amplitude²/3 (uniform).
    double leading_deviation[SPHV_CONSISTENCY_MEASURES];
} sphv_consistency;

/// Predicts the measures of an interior particle.
/// \param spacing    Δs = Δx/h, below κ
/// \param amplitude  of the perturbation in Δx, as in sphv_box; 0 for the lattice alone
/// \return SPHV_INVALID_INPUT for arguments outside their ranges
sphv_status sphv_predict_consistency(const sphv_profile *profile, double spacing,
                                     sphv_jitter jitter, double amplitude, sphv_consistency *out,
                                     sphv_error *error) SPHV_MUST_CHECK;

#endif
