/// \file layout.h
/// Particle positions and volumes around one particle.
#ifndef SPHVERIFY_EMPIRICAL_LAYOUT_H
#define SPHVERIFY_EMPIRICAL_LAYOUT_H

#include "sphverify/particles.h"

/// Particles in order of position, seen from one of them, lengths in units of h. Memory is kept
/// between calls.
typedef struct sphv_neighbourhood {
    int count, capacity;
    int self;                     ///< index of the particle itself
    double origin;                ///< its position in wavelengths
    double *s;                    ///< (x_b − x_a)/h, ascending, within the support
    double *volume;               ///< V_b/h
    double *centroid;             ///< middle of the cell between both neighbours
    double *value, *slope, *bend; ///< Ŵ, dŴ/ds and d²Ŵ/ds² at s; NULL: not evaluated
} sphv_neighbourhood;

/// A layout made ready: for lattice-based layouts nothing is stored, each position is a function of
/// (seed, realisation, index); the others keep one realisation's sorted positions.
typedef struct sphv_cloud {
    const sphv_experiment *experiment;
    int realisation;
    double step;    ///< Δx in wavelengths
    long particles; ///< within one wavelength
    long stored;    ///< positions kept, 0 when each is a function of its index
    double *x;      ///< sorted, from −reach to 1 + reach
    long first;     ///< index of the first stored position that is ≥ 0
} sphv_cloud;

sphv_status sphv_cloud_make(sphv_cloud *cloud, const sphv_experiment *experiment, int realisation,
                            sphv_error *error) SPHV_MUST_CHECK;
void sphv_cloud_free(sphv_cloud *cloud);

/// Gathers the particles within the support of particle `index` (0 … particles − 1) and their
/// volumes. \return SPHV_RESOURCE_FAILURE without memory
sphv_status sphv_cloud_neighbourhood(const sphv_cloud *cloud, long index,
                                     sphv_neighbourhood *out) SPHV_MUST_CHECK;
void sphv_neighbourhood_free(sphv_neighbourhood *neighbourhood);

#endif
