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

enum {
    SPHV_JITTER_MONOMIALS = 35, ///< of degree 4 in three dimensions
    /// Places of a neighbour that are asked for more than once: its own, and those displaced by a
    /// node of a free displacement, once or twice, or of a folded one in a coordinate, and by free
    /// ones in two.
    SPHV_JITTER_SLOTS = 1 + 6 * SPHV_DIMENSIONS + 2 * SPHV_DIMENSIONS * (SPHV_DIMENSIONS - 1),
};

/// What all methods need of a neighbour at one place.
typedef struct sphv_jitter_slot {
    bool known, known_value, inside;                                ///< inside the support
    double p[SPHV_RADIALS], monomial[SPHV_JITTER_MONOMIALS], value; ///< the last of the field
} sphv_jitter_slot;

/// A particle that is not the one looked at.
typedef struct sphv_jitter_neighbour {
    double s[SPHV_DIMENSIONS], x[SPHV_DIMENSIONS], value;
    double weight; ///< of how many it stands
    const sphv_displacement *moved[SPHV_DIMENSIONS];
    sphv_jitter_slot *slot;
} sphv_jitter_neighbour;

/// A particle and its neighbours, for methods to share.
typedef struct sphv_jitter_cloud {
    const sphv_box *box;
    const sphv_profile *profile;
    const sphv_field *field;
    int d;
    size_t monomials; ///< as many as any method needs
    double h, dx, ds, v;
    bool wide;                 ///< too many neighbours to take every one
    double x[SPHV_DIMENSIONS]; ///< mean place of the particle
    const sphv_displacement *moved[SPHV_DIMENSIONS];
    size_t count;
    sphv_jitter_neighbour *neighbour;
    sphv_jitter_slot *slots;
    sphv_displacement free, low, high; ///< in the box, on its lower and its upper sides
} sphv_jitter_cloud;

/// A method's shape functions without the weights that are 0.
typedef struct sphv_jitter_parts {
    int count, radial[SPHV_RADIALS * SPHV_SHAPE_TERMS];
    size_t monomial[SPHV_RADIALS * SPHV_SHAPE_TERMS];
    double weight[SPHV_RADIALS * SPHV_SHAPE_TERMS][SPHV_QUANTITIES_MAX];
} sphv_jitter_parts;

/// The sums of one method around the particle.
typedef struct sphv_jitter_sums {
    sphv_jitter_cloud *cloud;
    sphv_method method;
    int degree; ///< of the highest monomial in a shape function
    size_t quantities, terms;
    sphv_shape shape; ///< where all are at their mean places, as is what follows
    sphv_jitter_parts parts;
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

/// Methods on one box, and one field.
typedef struct sphv_jitter_group {
    sphv_jitter_cloud cloud;
    size_t count;
    sphv_jitter_sums sums[SPHV_BOX_METHODS_MAX];
} sphv_jitter_group;

/// What perturbations do to the particle whose neighbours were taken last.
/// \return false where the moment matrix is singular, or so nearly that a perturbation changes its
///         inverse by orders of magnitude
bool sphv_jitter_effects(sphv_jitter_sums *of, sphv_jitter_effect *to);

/// h^|β| times the error where all are at their mean places. False where the moment matrix is
/// singular.
bool sphv_jitter_error(sphv_jitter_sums *of, double *out);

/// What the perturbation of a coordinate is at x: on a side of the box it is folded inwards.
const sphv_displacement *sphv_jitter_at(const sphv_jitter_cloud *cloud, double x);

/// Memory for a particle and some neighbours, to be released with sphv_jitter_cloud_free.
sphv_status sphv_jitter_cloud_make(sphv_jitter_cloud *cloud, size_t neighbours,
                                   sphv_error *error) SPHV_MUST_CHECK;
void sphv_jitter_cloud_free(sphv_jitter_cloud *cloud);

/// A neighbour to be filled in: nothing is known of it but its number.
sphv_jitter_neighbour *sphv_jitter_next(sphv_jitter_cloud *cloud, double weight);

/// A displacement by `along` Δx in a coordinate, and by `across` in an earlier one.
typedef struct sphv_jitter_move {
    int coordinate;
    double along;
    int across_coordinate;
    double across;
} sphv_jitter_move;

/// What methods need of a displaced neighbour. \param value  whether that of the field, too
/// \param scratch  for places that are asked for once
const sphv_jitter_slot *sphv_jitter_look(const sphv_jitter_cloud *cloud,
                                         const sphv_jitter_neighbour *b, sphv_jitter_move by,
                                         bool value, sphv_jitter_slot *scratch);

/// The same of the particle itself.
void sphv_jitter_self(const sphv_jitter_cloud *cloud, sphv_jitter_slot *out);

/// Starts the sums of a box whose arguments have been checked.
/// \param volume V/Δx^d; \param every  to take every neighbour, however many
void sphv_jitter_start(const sphv_box *box, const sphv_profile *profile, double h, double volume,
                       bool every, const sphv_field *field, sphv_jitter_group *out);

/// Adds a method.
/// \return SPHV_NO_CLOSED_FORM where perturbations are too large, or for a method whose sensitivity
///         to displacements is not known
sphv_status sphv_jitter_add(sphv_jitter_group *group, sphv_method method,
                            sphv_error *error) SPHV_MUST_CHECK;

/// Adds up the expected squares of the errors over a box, neighbour by neighbour.
/// \param out  of each method
sphv_status sphv_predict_jitter(sphv_jitter_group *group, const sphv_field_theory *field,
                                sphv_box_prediction *const *out, sphv_error *error) SPHV_MUST_CHECK;

/// Adds to predictions for the lattice what perturbations change where supports are wide.
sphv_status sphv_widen_jitter(sphv_jitter_group *group, sphv_box_prediction *const *out,
                              sphv_error *error) SPHV_MUST_CHECK;

#endif
