/// \file quadrature.h
/// Composite Gauss–Legendre quadrature of entire functions, on GSL's 32-point rule.
#ifndef SPHVERIFY_CORE_QUADRATURE_H
#define SPHVERIFY_CORE_QUADRATURE_H

#include "sphverify/status.h"

/// ∫_from^to f dx in panels no longer than `panel`.
///
/// The 32-point rule's truncation error on a panel of length ℓ is ℓ^65 (32!)^4/(65 (64!)^3) times
/// sup |f^(64)| < ℓ^65 · 4e-127 · sup |f^(64)|: below 1e-40 sup|f| for every f of exponential type
/// τ with τℓ ≤ 16, which is how callers choose `panel`. The bound returned is therefore that of
/// rounding: 16 u Σ weight·|f|, for an f evaluated to a few units in its last place.
sphv_result sphv_quadrature(double (*f)(double x, void *context), void *context, double from,
                            double to, double panel);

/// ∫_from^to q^(first + j) w(q) dq for j = 0 … count − 1, with w evaluated once per node.
///
/// \param values  receives w and w′ at q in out[0] and out[1], with their bounds
/// \param out     receives the integrals; the bound holds the error of w, of the nodes' places
///                (through w′) and of the summation. \pre count <= SPHV_MOMENT_MAX + 1
sphv_status sphv_quadrature_moments(void (*values)(const void *context, double q,
                                                   sphv_result out[3]),
                                    const void *context, double from, double to, double panel,
                                    int first, int count, sphv_result *out) SPHV_MUST_CHECK;

#endif
