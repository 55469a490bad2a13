/// \file radial.h
/// Radial integrals of w by adaptive quadrature, independent of the core's fixed rules.
#ifndef SPHVERIFY_CHECK_RADIAL_H
#define SPHVERIFY_CHECK_RADIAL_H

#include "check_internal.h"

/// A factor of the integrand: g(q, argument).
typedef double (*sphv_radial_weight)(double q, double argument);

/// ∫ Ŵ(q) g(q) dV over the support, or over the whole of a truncated kernel.
/// \param whole beyond κ too, for truncated families
sphv_result sphv_radial_integral(const sphv_profile *profile, bool whole, sphv_radial_weight weight,
                                 double argument);

double sphv_weight_one(double q, double unused);
double sphv_weight_power(double q, double exponent);

/// The spherical average of e^{−iΩ·s} in d dimensions, and the same minus 1 without cancellation.
sphv_radial_weight sphv_weight_wave(int dimension);
sphv_radial_weight sphv_weight_wave_less_one(int dimension);

#endif
