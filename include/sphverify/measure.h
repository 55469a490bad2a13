/// \file measure.h
/// The empirical half: particle sums, measured as an SPH code would evaluate them.
///
/// Every sum is compensated and carries a running bound of its rounding error. Nothing here knows
/// the theory.
#ifndef SPHVERIFY_MEASURE_H
#define SPHVERIFY_MEASURE_H

#include "sphverify/kernel.h"

/// What a measurement on a lattice found.
typedef struct sphv_measurement {
    sphv_result total; ///< E, the relative error of the gradient, signed
    sphv_result l2;    ///< RMS error over a wavelength divided by max|A′|
    long particles;    ///< particles at which the gradient was estimated
    long neighbours;   ///< particles within the support of one of them, itself included
    long pairs;        ///< kernel evaluations
    double seconds;    ///< wall time
} sphv_measurement;

/// Called now and then with the part of the work that is done, 0 to 1.
typedef void (*sphv_progress)(void *context, double done);

/// Standard SPH gradient, −Σ_b A_b W′(x_b − x_a) Δx (eq. 1), of A = sin(2πx) on a uniform lattice.
///
/// Ŵ is even, so every particle of an infinite lattice has the same relative error: one particle
/// is evaluated, at x_a = 0, with its neighbours folded in pairs. l2 is |E|/√2.
///
/// \param profile  Ŵ in one dimension
/// \param h        smoothing length in wavelengths, 0 < h
/// \param spacing  Δs, 0 < Δs < κ
/// \param out      receives the measurement
/// \param error    receives the reason of a failure
sphv_status sphv_measure_lattice(const sphv_profile *profile, double h, sphv_number spacing,
                                 sphv_measurement *out, sphv_error *error) SPHV_MUST_CHECK;

/// The same at every particle of one wavelength, each with all its neighbours, beyond the ends of
/// the wavelength too. E is the least-squares factor of A′ in the errors; l2 is
/// RMS(error)/RMS(A′)/√2 over those particles, equal to |E|/√2 when the error is E·A′.
/// \param progress may be NULL
sphv_status sphv_measure_lattice_exhaustive(const sphv_profile *profile, double h,
                                            sphv_number spacing, sphv_progress progress,
                                            void *context, sphv_measurement *out,
                                            sphv_error *error) SPHV_MUST_CHECK;

#endif
