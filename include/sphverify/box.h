/// \file box.h
/// Particles in the unit box [0, 1]^d.
///
/// A box says what particles there are; the particles themselves are made from it when they are
/// needed, the same ones by any number of threads.
#ifndef SPHVERIFY_BOX_H
#define SPHVERIFY_BOX_H

#include "sphverify/particles.h"

/// Where the particles of a lattice stand.
typedef enum sphv_placement {
    SPHV_PLACEMENT_VERTEX, ///< x = iΔx, Δx = 1/(side − 1): on the edges too
    SPHV_PLACEMENT_CELL,   ///< x = (i + 1/2)Δx, Δx = 1/side
} sphv_placement;

/// How a lattice is perturbed, coordinate by coordinate.
typedef enum sphv_jitter {
    SPHV_JITTER_NORMAL,  ///< standard deviation `amplitude` Δx
    SPHV_JITTER_UNIFORM, ///< even between ±`amplitude` Δx
} sphv_jitter;

/// A choice of particles.
typedef struct sphv_box {
    int dimension;
    size_t side; ///< particles along a side; side^dimension in all, for every layout
    sphv_layout layout;
    sphv_placement placement;
    bool
        periodic; ///< no boundary: what leaves on one side enters on the other. Cell placement only
    sphv_jitter jitter;
    double amplitude; ///< of the perturbed layout, in Δx
    bool reflected;   ///< what a perturbation moves out of the box is reflected into it
    sphv_volume volume;
    uint64_t seed;
} sphv_box;

extern const sphv_name_row sphv_placements[]; ///< indexed by sphv_placement, ended by a NULL name
extern const sphv_name_row sphv_jitters[];    ///< indexed by sphv_jitter

/// Most particles a box may hold.
#define SPHV_BOX_PARTICLES_MAX 200000000.0

/// Checks that the parts of a box go together.
sphv_status sphv_box_check(const sphv_box *box, sphv_error *error) SPHV_MUST_CHECK;

/// Mean spacing Δx: 1/(side − 1) with vertex placement of a lattice or perturbed lattice, else
/// 1/side.
double sphv_box_spacing(const sphv_box *box);

/// Particles of one box, coordinate by coordinate.
typedef struct sphv_particles {
    int dimension;
    size_t count;
    double *x[SPHV_DIMENSIONS]; ///< unused coordinates are NULL
    double *volume;             ///< V_b, in units of length^d
    double spacing;             ///< Δx
    size_t lattice_side;        ///< of an unperturbed lattice, x running slowest; else 0
    bool periodic;
} sphv_particles;

#endif
