/// \file estimate.h
/// The methods in one dimension: gradients at one particle from its neighbours.
#ifndef SPHVERIFY_EMPIRICAL_ESTIMATE_H
#define SPHVERIFY_EMPIRICAL_ESTIMATE_H

#include "layout.h"
#include "sphverify/estimate.h"

enum { SPHV_FIELDS_TOGETHER = 2 }; ///< fields estimated in one pass over the neighbours

typedef struct sphv_estimate {
    double gradient[SPHV_FIELDS_TOGETHER]; ///< times h
    double condition;                      ///< of the moment matrix, 1 when there is none
    sphv_fault fault;
    bool usable; ///< an isolated particle's may be: the sum over itself alone is a legal estimate
} sphv_estimate;

/// Estimates h·A′ of up to SPHV_FIELDS_TOGETHER fields at the particle itself.
/// \param field A_b at the neighbourhood's particles, per field
sphv_estimate sphv_estimate_gradient(sphv_method method, const sphv_profile *profile,
                                     const sphv_neighbourhood *around, int fields,
                                     const double *const *field);

/// The errors of the gradient divided by max|A′| when the particle sits on the sine's zero and on
/// its crest.
/// \param field room for twice as many numbers as the neighbourhood has particles
/// \param error indexed by sphv_phase
sphv_estimate sphv_phase_errors(const sphv_experiment *experiment, const sphv_neighbourhood *around,
                                double *field, double error[2]);

#endif
