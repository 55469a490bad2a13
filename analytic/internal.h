/// \file internal.h
/// Shared inside the analytic half only.
#ifndef SPHVERIFY_ANALYTIC_INTERNAL_H
#define SPHVERIFY_ANALYTIC_INTERNAL_H

#include <float.h>

#include "sphverify/theory.h"

static const double SPHV_U = DBL_EPSILON / 2; ///< unit roundoff

/// F(Ω) = ∫ f(s) cos(Ωs) ds of f(s) = −sin(Ks) Ŵ′(s)/K, by quadrature. F(0) − 1 = E_s.
sphv_result sphv_gradient_mode(const sphv_profile *profile, double K, double wavenumber);

/// f^(order)(knot−) − f^(order)(knot+) of that f; `magnitude` receives the sum of the moduli of its
/// parts, with sines and cosines replaced by 1.
double sphv_gradient_jump(const sphv_knot *knot, double K, int order, double *magnitude);

/// A bound of ∫|f^(order)| ds over the pieces.
double sphv_gradient_variation(const sphv_profile *profile, double K, int order);

/// sin(Ks)/K, also for tiny K.
double sphv_sine_over(double K, double s);

/// A function of q = |s|, smooth between the kernel's knots and of the kernel's size.
typedef double (*sphv_radial_function)(const sphv_profile *profile, double q);

/// ∫ g(|s|) e^{−iΩ·s} dV over the support, by quadrature. \param wavenumber Ω ≥ 0
sphv_result sphv_radial_transform(const sphv_profile *profile, sphv_radial_function radial,
                                  double wavenumber);

/// Eq. 16; see sphv_predict_lattice.
sphv_status sphv_predict_paper(const sphv_profile *profile, double h, sphv_number spacing,
                               sphv_prediction *out, sphv_error *error) SPHV_MUST_CHECK;

#endif
