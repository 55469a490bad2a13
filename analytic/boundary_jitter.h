/// \file boundary_jitter.h
/// Boxes whose lattice is perturbed.
#ifndef SPHVERIFY_ANALYTIC_BOUNDARY_JITTER_H
#define SPHVERIFY_ANALYTIC_BOUNDARY_JITTER_H

#include "boundary_internal.h"

enum { SPHV_JITTER_NODES = 3 }; ///< of a displacement's rule, the middle one in the middle

/// A bound above this part of a prediction makes it worthless: the next order is no longer small.
#define SPHV_JITTER_BOUND_MAX 0.25

/// A displacement in Δx: its mean, and where beside that with what probability.
typedef struct sphv_displacement {
    double mean, at[SPHV_JITTER_NODES], weight[SPHV_JITTER_NODES];
} sphv_displacement;

/// A particle that is not the one looked at.
typedef struct sphv_jitter_neighbour {
    double s[SPHV_DIMENSIONS], x[SPHV_DIMENSIONS], value;
    double weight; ///< of how many it stands
    const sphv_displacement *moved[SPHV_DIMENSIONS];
} sphv_jitter_neighbour;

/// The sums around one particle.
typedef struct sphv_jitter_sums {
    const sphv_box *box;
    const sphv_profile *profile;
    const sphv_field *field;
    sphv_method method;
    int d, degree; ///< of the highest monomial in a shape function
    size_t quantities, terms;
    double h, ds, v;
    bool wide;                 ///< too many neighbours to take every one
    double x[SPHV_DIMENSIONS]; ///< mean place of the particle
    const sphv_displacement *moved[SPHV_DIMENSIONS];
    size_t count;
    sphv_jitter_neighbour *neighbour;
    sphv_displacement free, low, high; ///< in the box, on its lower and its upper sides
    sphv_shape shape;                  ///< where all are at their mean places, as is what follows
    double own, estimate[SPHV_QUANTITIES_MAX]; ///< A_a and h^|β| times the estimates
} sphv_jitter_sums;

/// Moments of h^|β| times the error at one particle, and the moduli of what the next order in the
/// amplitude has added to the variance.
typedef struct sphv_jitter_effect {
    double mean[SPHV_QUANTITIES_MAX], variance[SPHV_QUANTITIES_MAX], next[SPHV_QUANTITIES_MAX];
    double own[SPHV_QUANTITIES_MAX]; ///< variance that the particle's own displacement makes
    /// Of B⁻¹δB, B the moment matrix: the variance, and the mean on the diagonal.
    double matrix[SPHV_QUANTITIES_MAX][SPHV_QUANTITIES_MAX], drift[SPHV_QUANTITIES_MAX];
    double rounding[SPHV_QUANTITIES_MAX]; ///< of the error's root mean square
} sphv_jitter_effect;

/// Puts together the neighbours of a particle. `neighbour` has room for all lines within reach.
void sphv_jitter_neighbours(sphv_jitter_sums *of, const sphv_line *const *line);

/// What perturbations do to the particle whose neighbours were taken last.
/// \return false where the moment matrix is singular, or so nearly that a perturbation changes its
///         inverse by orders of magnitude
bool sphv_jitter_effects(sphv_jitter_sums *of, sphv_jitter_effect *to);

/// What the perturbation of a coordinate is at x: on a side of the box it is folded inwards.
const sphv_displacement *sphv_jitter_at(const sphv_jitter_sums *of, double x);

/// h^|β| times the error where all are at their mean places. False where the moment matrix is
/// singular.
bool sphv_jitter_error(sphv_jitter_sums *of, double *out);

/// Starts the sums of a box whose arguments have been checked.
/// \param volume V/Δx^d; \param every  to take every neighbour, however many
/// \return SPHV_NO_CLOSED_FORM where perturbations are too large, or for a method whose sensitivity
///         to displacements is not known
sphv_status sphv_jitter_start(const sphv_box *box, const sphv_profile *profile, double h,
                              double volume, bool every, sphv_method method,
                              const sphv_field *field, sphv_jitter_sums *out,
                              sphv_error *error) SPHV_MUST_CHECK;

/// Adds up the expected squares of the errors over a box, neighbour by neighbour.
sphv_status sphv_predict_jitter(sphv_jitter_sums *of, const sphv_field_theory *field,
                                sphv_box_prediction *out, sphv_error *error) SPHV_MUST_CHECK;

/// Adds to a prediction for the lattice what perturbations change where supports are wide.
sphv_status sphv_widen_jitter(sphv_jitter_sums *of, sphv_box_prediction *out,
                              sphv_error *error) SPHV_MUST_CHECK;

#endif
