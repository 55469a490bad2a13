/// \file particles.h
/// Methods, layouts and volume rules: one row of one table each, and the experiment they make up.
#ifndef SPHVERIFY_PARTICLES_H
#define SPHVERIFY_PARTICLES_H

#include <stdint.h>

#include "sphverify/kernel.h"

/// Estimates of a field and its derivatives; equation numbers are Quinlan's (2006).
typedef enum sphv_method {
    SPHV_SPH,       ///< ΣA_b W V_b and −ΣA_b ∇W V_b (eq. 1)
    SPHV_SHEPARD,   ///< ΣA_b W V_b/ΣW V_b and its derivative
    SPHV_BONET_LOK, ///< Shepard's value; mixed correction, eqs. 27–28, denominator differentiated
    SPHV_RKPM,      ///< eq. 26: order 1
    SPHV_RKPM_0,    ///< order 0: Shepard's
    SPHV_RKPM_2,    ///< order 2
    SPHV_SPH_DIFFERENCE, ///< ΣA_b W V_b and −Σ(A_b − A_a)∇W V_b
    SPHV_CSPM, ///< Shepard's value; [Σ(x_b − x_a) ⊗ ∇W V_b] g = Σ(A_b − A_a)∇W V_b
    SPHV_FPM,  ///< value and gradient from the tests W and ∂W of Taylor's series
    SPHV_MSPH, ///< second derivatives too, from the tests W, ∂W and ∂²W
} sphv_method;

/// Where the particles are.
typedef enum sphv_layout {
    SPHV_LATTICE,      ///< x_j = j Δx
    SPHV_PERTURBED,    ///< lattice plus a normal perturbation of standard deviation σ
    SPHV_QUASI_RANDOM, ///< Sobol sequence of density 1/Δx
    SPHV_RANDOM,       ///< independent, uniform, of density 1/Δx
} sphv_layout;

/// What volume a particle stands for.
typedef enum sphv_volume {
    SPHV_VOLUME_LATTICE,     ///< Δx
    SPHV_VOLUME_TESSELLATED, ///< (x_{b+1} − x_{b−1})/2 between neighbours in order
    SPHV_VOLUME_DENSITY,     ///< m/ρ_b, ρ_b = Σ m W
    SPHV_VOLUME_UNIT,        ///< 1
    SPHV_VOLUME_EQUAL,       ///< volume of the box over the number of particles; boxes only
} sphv_volume;

/// A method. On any layout polynomials of these degrees at most are exact; −1: not even constants.
typedef struct sphv_method_row {
    const char *name;
    int consistency;               ///< degree of which every gradient is exact
    int value_consistency;         ///< degree of which every value is exact
    int unknowns[SPHV_DIMENSIONS]; ///< size of the moment matrix in 1, 2 and 3 dimensions; 0: none
    bool scale_free; ///< a common factor of all volumes cancels, so unit volumes make sense
    bool second;     ///< gives second derivatives, exact to the degree of the gradient
    const char *reference;
} sphv_method_row;

/// A named choice.
typedef struct sphv_name_row {
    const char *name, *meaning;
} sphv_name_row;

extern const sphv_method_row sphv_methods[]; ///< indexed by sphv_method, ended by a NULL name
extern const sphv_name_row sphv_layouts[];   ///< indexed by sphv_layout
extern const sphv_name_row sphv_volumes[];   ///< indexed by sphv_volume

/// Estimated quantities: value and gradient, 1 + d, with second derivatives (1 + d)(2 + d)/2.
size_t sphv_method_quantities(sphv_method method, int dimension);

/// Fewest particles within a support, itself included, that can have a regular moment matrix: as
/// many as there are monomials that the gradient is exact for, and at least 1.
size_t sphv_method_least(sphv_method method, int dimension);

/// Reads a name; SPHV_INVALID_INPUT lists the allowed ones.
sphv_status sphv_method_parse(const char *name, sphv_method *out,
                              sphv_error *error) SPHV_MUST_CHECK;
sphv_status sphv_layout_parse(const char *name, sphv_layout *out,
                              sphv_error *error) SPHV_MUST_CHECK;
sphv_status sphv_volume_parse(const char *name, sphv_volume *out,
                              sphv_error *error) SPHV_MUST_CHECK;

/// What is estimated, and on which particles: the gradient of sin(2πx) in one dimension, λ = 1.
typedef struct sphv_experiment {
    const sphv_profile *profile;
    double h;            ///< smoothing length in wavelengths
    sphv_number spacing; ///< mean Δx/h
    sphv_method method;
    sphv_layout layout;
    sphv_volume volume;
    double sigma; ///< σ/Δx of the perturbed layout
    uint64_t seed;
    double width; ///< wanted relative half-width of the L2 norm's 99.9 % interval
    int realisations_min, realisations_max;
} sphv_experiment;

/// Which quarter of the wave a particle sits on; the phase average of a squared error is the mean
/// of both, since the error is linear in the field.
typedef enum sphv_phase {
    SPHV_PHASE_SINE,   ///< A = sin(Ks): value 0, slope k
    SPHV_PHASE_COSINE, ///< A = cos(Ks): value 1, slope 0
} sphv_phase;

/// The particles within the support of one of them with the cells they stand for, in units of h.
typedef struct sphv_cells {
    int count, self;
    const double *s;        ///< s_b = (x_b − x_a)/h, ascending
    const double *centroid; ///< s̄_b, middle of the cell
    const double *volume;   ///< Δs_b, width of the cell
} sphv_cells;

/// Largest σ/Δx accepted.
#define SPHV_SIGMA_MAX 10.0

/// Most particles in a wavelength that a scattered layout may have; a lattice keeps none.
#define SPHV_SCATTERED_MAX 1e7

/// Checks that the parts of an experiment go together.
sphv_status sphv_experiment_check(const sphv_experiment *experiment,
                                  sphv_error *error) SPHV_MUST_CHECK;

#endif
