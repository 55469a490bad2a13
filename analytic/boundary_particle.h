/// \file boundary_particle.h
/// The errors of one particle of a box, and norms over them.
#ifndef SPHVERIFY_ANALYTIC_BOUNDARY_PARTICLE_H
#define SPHVERIFY_ANALYTIC_BOUNDARY_PARTICLE_H

#include "boundary_internal.h"

/// One method.
typedef struct sphv_method_theory {
    sphv_method method;
    int quantities, degree;              ///< of the Taylor series
    int rest_degree;                     ///< of the series in the other coordinates alone
    double tail, rest_tail;              ///< remainders at the current first coordinate
    double *series[SPHV_QUANTITIES_MAX]; ///< response to h^|γ| ∂^γA, without the quantity itself
    double *memory;
    size_t *products;
    size_t *product[SPHV_SHAPE_TERMS]; ///< places of the products of monomials, as far as needed
    sphv_shape shape;
    double size[SPHV_QUANTITIES_MAX]; ///< bound of Σ v|shape function|
} sphv_method_theory;

/// One box, one field, and methods that share moments and derivatives.
typedef struct sphv_box_theory {
    const sphv_profile *profile;
    const sphv_octants *octants;
    sphv_field_theory field;
    int d;
    int degree, rest_degree, shape_degree; ///< the highest of any method's
    bool second;                           ///< a method needs p_2
    double h, volume;                      ///< V/Δx^d
    double *moment[SPHV_RADIALS];
    double *line_moment[SPHV_FIELD_TERMS_MAX][SPHV_RADIALS][SPHV_SHAPE_DEGREE + 1];
    double *reciprocal;                        ///< 1/γ!
    double *derivative;                        ///< h^|γ| ∂^γA at the particle looked at
    double size[SPHV_MONOMIAL_DEGREE_MAX + 1]; ///< Σ|derivative| κ^|γ|/γ! up to each degree
    double *memory;
    int below[SPHV_DIMENSIONS], above[SPHV_DIMENSIONS];
    bool known; ///< moments, shapes and responses are those of `below` and `above`
    size_t count;
    sphv_method_theory of[SPHV_BOX_METHODS_MAX];
} sphv_box_theory;

/// The errors of one particle, and what is not known of them.
typedef struct sphv_particle_errors {
    double value[SPHV_QUANTITIES_MAX], bound[SPHV_QUANTITIES_MAX];
    bool regular;
} sphv_particle_errors;

/// Allocates what the members d, degree, methods, octants and field ask for, to be released with
/// sphv_theory_end.
sphv_status sphv_theory_start(sphv_box_theory *theory, sphv_error *error) SPHV_MUST_CHECK;
void sphv_theory_end(sphv_box_theory *theory);

/// Moments, shape functions and responses where the support is cut so.
void sphv_theory_cut(sphv_box_theory *theory, const int *below, const int *above);

/// Moments of the field's factors along a line where it is singular in its first coordinate; comes
/// before sphv_singular_errors.
void sphv_theory_take_line(sphv_box_theory *theory, const sphv_line *line);

/// Derivatives of the field at a particle; comes before sphv_series_errors.
void sphv_theory_take_derivatives(sphv_box_theory *theory, const sphv_line *const *line);

/// Errors of a particle where the field has a Taylor series, or where it has none in the first
/// coordinate. The support is that of the last sphv_theory_cut.
void sphv_series_errors(const sphv_box_theory *theory, const sphv_method_theory *of,
                        sphv_particle_errors *out);
void sphv_singular_errors(const sphv_box_theory *theory, const sphv_method_theory *of,
                          const sphv_line *const *line, const double *x, sphv_particle_errors *out);

/// Norms over the particles of a lattice. \param out  of each method
sphv_status sphv_theory_predict(sphv_box_theory *theory, const sphv_box *box,
                                sphv_box_prediction *const *out, sphv_error *error) SPHV_MUST_CHECK;

#endif
