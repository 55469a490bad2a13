/// \file estimate.h
/// The methods: an estimate of the gradient at one particle from its neighbours.
#ifndef SPHVERIFY_EMPIRICAL_ESTIMATE_H
#define SPHVERIFY_EMPIRICAL_ESTIMATE_H

#include "layout.h"

/// Why a particle has no usable estimate.
typedef enum sphv_estimate_fault {
    SPHV_ESTIMATE_SOUND,
    SPHV_ESTIMATE_SINGULAR,        ///< the moment matrix has no inverse: too few neighbours
    SPHV_ESTIMATE_ILL_CONDITIONED, ///< its condition number exceeds 1/√ε
    SPHV_ESTIMATE_NOT_FINITE,
} sphv_estimate_fault;

typedef struct sphv_estimate {
    double gradient;  ///< times h
    double condition; ///< 1-norm condition number of the moment matrix, 1 when there is none
    sphv_estimate_fault fault;
} sphv_estimate;

/// Estimates h·A′ at the particle itself.
/// \param field A_b at the neighbourhood's particles
sphv_estimate sphv_estimate_gradient(sphv_method method, const sphv_profile *profile,
                                     const sphv_neighbourhood *around, const double *field);

/// The error of the gradient divided by max|A′| when the particle sits on the sine's zero or on its
/// crest; the estimate's own findings go to `estimate`.
/// \param field room for as many numbers as the neighbourhood has particles
double sphv_phase_error(const sphv_experiment *experiment, const sphv_neighbourhood *around,
                        sphv_phase phase, double *field, sphv_estimate *estimate);

#endif
