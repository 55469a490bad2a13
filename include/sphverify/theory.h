/// \file theory.h
/// The analytic half: closed-form predictions of the truncation error.
///
/// Source: Quinlan, Basa and Lastiwka 2006 (equation numbers below are theirs), derived in
/// analytic/README.md. Nothing here sums over particles.
#ifndef SPHVERIFY_THEORY_H
#define SPHVERIFY_THEORY_H

#include "sphverify/kernel.h"
#include "sphverify/particles.h"

/// Which discretisation series is evaluated.
typedef enum sphv_form_of_theory {
    SPHV_FORM_EXACT, ///< all knots, any Δs, summed until the remainder is below rounding
    SPHV_FORM_PAPER, ///< eq. 16 with its signs mended and exactly the terms the paper used
} sphv_form_of_theory;

/// How far a bound can be trusted.
typedef enum sphv_rigour {
    SPHV_RIGOUR_EXACT,       ///< series remainder and rounding are bounded
    SPHV_RIGOUR_ASYMPTOTIC,  ///< the bound is the size of the first neglected terms
    SPHV_RIGOUR_STATISTICAL, ///< an expectation with a standard error
} sphv_rigour;

const char *sphv_form_name(sphv_form_of_theory form);
const char *sphv_rigour_name(sphv_rigour rigour);

/// The relative error E of the gradient of a sine on a uniform lattice, in its parts.
typedef struct sphv_prediction {
    sphv_result smoothing;      ///< E_s = ∫f ds − 1
    sphv_result discretisation; ///< E_d = Δs Σ f(jΔs) − ∫f ds
    sphv_result total;          ///< E = E_s + E_d
    sphv_result l2;             ///< |E|/√2: RMS error over a wavelength divided by max|A′|
    sphv_rigour rigour;
    int terms; ///< Euler–Maclaurin terms used at each knot
    int modes; ///< alias modes evaluated by quadrature beside the series
} sphv_prediction;

/// Standard SPH on an infinite uniform lattice in one dimension, A = A0 sin(2πx), λ = 1.
///
/// With K = 2πh and f(s) = −sin(Ks) Ŵ′(s)/K the estimate is (1 + E) A′ at every particle, where
/// 1 + E = Δs Σ_j f(jΔs). The exact form adds the generalised Euler–Maclaurin series over all knots
/// and carries a bound of its remainder and rounding; the paper's form is eq. 16.
///
/// \param profile  Ŵ in one dimension
/// \param h        smoothing length in wavelengths, 0 < h
/// \param spacing  Δs, 0 < Δs; the paper's form needs Δs = 2κ/(2n+1) (eq. 17)
/// \param form     which series
/// \param out      receives the prediction
/// \param error    receives the reason of a failure
/// \return SPHV_OK; SPHV_NO_CLOSED_FORM for the paper's form at another spacing;
///         SPHV_INVALID_INPUT for arguments outside their ranges
sphv_status sphv_predict_lattice(const sphv_profile *profile, double h, sphv_number spacing,
                                 sphv_form_of_theory form, sphv_prediction *out,
                                 sphv_error *error) SPHV_MUST_CHECK;

/// The same E by Poisson summation, 1 + E = Σ_m F(2πm/Δs) with F the Fourier transform of f: a
/// third route that uses neither the knots' series nor a particle sum.
/// \param modes  alias pairs ±1 … ±modes to sum; the rest is bounded, not dropped
sphv_result sphv_predict_poisson(const sphv_profile *profile, double h, sphv_number spacing,
                                 int modes);

/// Smoothing error E_s = ∫f ds − 1 (eq. 9 summed), bound included.
sphv_result sphv_smoothing_error(const sphv_profile *profile, double h);

/// Discretisation error E_d by the generalised Euler–Maclaurin series over all knots.
/// \param terms, modes receive the lengths used; either may be NULL
sphv_result sphv_discretisation_error(const sphv_profile *profile, double h, sphv_number spacing,
                                      int *terms, int *modes);

/// One term of that series, for reports: 2(−1)^p Δs^p B̄_p(κ_i/Δs)/p! [f^(p−1)(κ_i−) −
/// f^(p−1)(κ_i+)].
double sphv_euler_maclaurin_term(const sphv_profile *profile, int knot, double h,
                                 sphv_number spacing, int p);

/// The order in Δs that the exact series predicts as h → 0 at the special spacings 2κ/(2n+1), from
/// the smoothness at every knot, and the knot that decides it.
int sphv_predicted_order(const sphv_profile *profile, bool special_spacing, int *deciding_knot);

/// Fourier transform of the profile, Ŵ_F(Ω) = ∫Ŵ(|s|) e^{−iΩ·s} dV, by quadrature.
/// \param wavenumber Ω in units of 1/h, Ω ≥ 0
sphv_result sphv_fourier_transform(const sphv_profile *profile, double wavenumber);

/// Where the Fourier transform of a profile first turns negative, and its minimum.
typedef struct sphv_fourier_sign {
    bool negative;         ///< it does, beyond its bound, below `searched`
    double first_negative; ///< first wavenumber Ω (units 1/h) at which it is negative
    double minimum;        ///< least value found, relative to Ŵ_F(0)
    double minimum_at;
    double searched; ///< the search ended here
} sphv_fourier_sign;

sphv_fourier_sign sphv_fourier_find_sign(const sphv_profile *profile);

/// Periodic Bernoulli function over factorial, B̄_p(θ)/p!, without its first `modes` Fourier modes.
/// \pre p >= 1, 0 <= fraction < 1; for p = 1 and fraction 0 the mean of both sides, 0
sphv_result sphv_periodic_bernoulli(int p, double fraction, int modes);

/// Expected L2 norm of the error over the perturbations of a layout: √E[error²]/max|A′|, averaged
/// over the field's phase. Only `l2` is a number then; its bound is the size of the neglected
/// order.
///
/// A method's estimate is a function of a few sums Σ_b z(x_b − x_a) V_b. For volumes Δx and
/// tessellated ones their means and covariances over the perturbations are exact (each summand
/// depends on one or three of them); for density volumes they are the main effects of each
/// particle's perturbation, exact to second order in σ for the mean and to first for the
/// covariance, and the bound is an estimate. The function is then averaged to second order in the
/// sums' fluctuations.
/// \return SPHV_NO_CLOSED_FORM for random and quasi-random layouts
sphv_status sphv_predict_disorder(const sphv_experiment *experiment, sphv_prediction *out,
                                  sphv_error *error) SPHV_MUST_CHECK;

/// Closed forms for standard SPH with volumes Δx on a perturbed lattice (theory of this project).
typedef struct sphv_lattice_noise {
    sphv_result mean; ///< expected relative error E of the gradient
    double noise_l2;  ///< L2 norm of the scatter about the mean, to first order in σ
    double l2;        ///< √(mean²/2 + noise²)
} sphv_lattice_noise;

/// Mean: each alias of the lattice sum is multiplied by the characteristic function of the distance
/// of two perturbations, E = E_s + Σ_{m≠0} F(2πm/Δs) e^{−(2πmσ)²} − Δs E[f(√2 σΔs ξ)], the last
/// term taking out the particle itself, which keeps its place. Scatter: (σ/Δx) (Δx/h)^(3/2) √(∫Ŵ″²
/// + K²Ŵ′² ds)/(K√2), K = 2πh: of order 1/h, and 3/2 in Δx/h. \param sigma σ/Δx ≥ 0
sphv_lattice_noise sphv_predict_lattice_noise(const sphv_profile *profile, double h,
                                              sphv_number spacing, double sigma);

enum { SPHV_TERMS_MAX = 5 };

/// A term of eq. 20 (standard SPH) or eq. 25 (consistent methods).
typedef struct sphv_term_row {
    const char *name;  ///< as evaluated
    const char *order; ///< as printed in eqs. 22–23
    sphv_phase phase;  ///< where on the wave it acts: with A and A″, or with A′ and A‴
} sphv_term_row;

/// Eq. 20 or 25 for actual particles: each printed term, divided by max|A′|. The sums' coefficients
/// δ_b, s̄_b and Δs_b are those of the cells, not averages. Eq. 20 is the discretisation error
/// alone. Terms of the same order in h but higher in Δs are left out, as in the paper. \param terms
/// receives SPHV_TERMS_MAX numbers at most \return the rows, ended by one without a name; NULL when
/// the method or volume rule has none
const sphv_term_row *sphv_disorder_terms(const sphv_experiment *experiment, const sphv_cells *cells,
                                         double *terms);

#endif
