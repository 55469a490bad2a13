/// \file measure.h
/// The empirical half: particle sums, measured as an SPH code would evaluate them.
///
/// Every sum is compensated and carries a running bound of its rounding error. Nothing here knows
/// the theory.
#ifndef SPHVERIFY_MEASURE_H
#define SPHVERIFY_MEASURE_H

#include "sphverify/kernel.h"
#include "sphverify/particles.h"

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

/// What a Monte-Carlo measurement found.
typedef struct sphv_disorder_measurement {
    sphv_result mean_square; ///< of error/max|A′|, bound: half-width of its 99.9 % interval
    sphv_result l2;          ///< its square root, the L2 norm
    sphv_result mean;        ///< of E, the relative error of the gradient, signed
    int realisations;
    long particles, pairs;                      ///< estimates made, and kernel evaluations for them
    long singular, ill_conditioned, not_finite; ///< particles without a usable estimate, by reason
    double worst_condition;                     ///< largest condition number met
    double seconds;
} sphv_disorder_measurement;

/// L2 norm of the error over independent realisations of a layout, averaged over the field's phase;
/// of a realisation 160 particles are evaluated, on a lattice such that share no neighbours;
/// particles without a usable estimate (moment matrix singular, or its condition number above 1/√ε)
/// are left out of the norm and counted by reason. Realisations are added until the 99.9 % interval
/// of the norm is as narrow as the experiment asks, or its realisations are used up. The same for
/// any number of threads. \param progress may be NULL
sphv_status sphv_measure_disorder(const sphv_experiment *experiment, sphv_progress progress,
                                  void *context, sphv_disorder_measurement *out,
                                  sphv_error *error) SPHV_MUST_CHECK;

/// One particle of one realisation, with its neighbours and its errors.
typedef struct sphv_observation {
    sphv_cells cells;
    double error[2]; ///< error/max|A′| by sphv_phase of the field at the particle; NaN where none
    double *memory;
} sphv_observation;

/// Looks at one particle; release with sphv_observation_free.
sphv_status sphv_observe(const sphv_experiment *experiment, int realisation, long index,
                         sphv_observation *out, sphv_error *error) SPHV_MUST_CHECK;
void sphv_observation_free(sphv_observation *observation);

#endif
