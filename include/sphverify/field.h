/// \file field.h
/// Fields: the functions whose estimates are measured, with every derivative in closed form.
///
/// A field is a sum of products of functions of one coordinate each,
/// A(x) = Σ_t c_t Π_i φ_ti(x_i), so that any derivative is a sum of products as well.
#ifndef SPHVERIFY_FIELD_H
#define SPHVERIFY_FIELD_H

#include "sphverify/kernel.h"

enum {
    SPHV_FIELD_TERMS_MAX = 32,
    SPHV_FIELD_POWER_MAX = 16,     ///< of one coordinate in a polynomial
    SPHV_MONOMIAL_DEGREE_MAX = 16, ///< of the table of monomials
    SPHV_QUANTITIES_MAX = 10,      ///< value, gradient and second derivatives in 3D
};

/// Monomials x^α of d coordinates in graded order: 1; x, y, z; x², xy, xz, y², yz, z²; … The order
/// in which moments, Taylor coefficients and the derivatives of an estimate are kept everywhere.
typedef struct sphv_monomial {
    int power[SPHV_DIMENSIONS];
    int degree;
    double factorial; ///< α! = α_1! α_2! α_3!
} sphv_monomial;

/// The table in d dimensions, up to SPHV_MONOMIAL_DEGREE_MAX.
const sphv_monomial *sphv_monomials(int dimension);
/// Number of monomials of degree <= `degree`; 0 for a negative one.
size_t sphv_monomial_count(int dimension, int degree);
/// Where a monomial stands in the table.
size_t sphv_monomial_index(int dimension, const int power[SPHV_DIMENSIONS]);

/// A function of one coordinate.
typedef enum sphv_factor_kind {
    SPHV_FACTOR_POWER, ///< x^p, p >= 0; p need not be whole
    SPHV_FACTOR_SINE,  ///< sin(p x + phase)
    SPHV_FACTOR_BELL,  ///< exp(−(x − phase)²/(2p²))
} sphv_factor_kind;

typedef struct sphv_factor {
    sphv_factor_kind kind;
    double parameter, phase;
} sphv_factor;

typedef struct sphv_field_term {
    double coefficient;
    sphv_factor factor[SPHV_DIMENSIONS];
} sphv_field_term;

typedef struct sphv_field {
    char name[96]; ///< as asked for
    int dimension, terms;
    sphv_field_term term[SPHV_FIELD_TERMS_MAX];
} sphv_field;

/// A named field: one row of one table. The CLI's listing and the tests follow from it.
typedef struct sphv_field_row {
    const char *name, *formula, *reference;
    bool dimensions[SPHV_DIMENSIONS];
} sphv_field_row;

/// Rows `sine`, `f1`, `f2`, `gaussian`; ended by a NULL name. Polynomials need no row.
extern const sphv_field_row sphv_fields[];

/// Reads a field: a name of the table, or a polynomial such as `1 - 2*x*y^2 + 0.5*z`.
/// \return SPHV_INVALID_INPUT with the reason and what is allowed
sphv_status sphv_field_parse(const char *text, int dimension, sphv_field *out,
                             sphv_error *error) SPHV_MUST_CHECK;

/// Whether the field repeats with period 1 in every coordinate, as a box without boundary needs.
bool sphv_field_is_periodic(const sphv_field *field);

/// ∂^α A at x. Infinite or NaN where the derivative does not exist (f2's third in x at x = 0).
double sphv_field_derivative(const sphv_field *field, const int order[SPHV_DIMENSIONS],
                             const double x[SPHV_DIMENSIONS]);

/// All derivatives ∂^α A with |α| <= degree at x, in the order of the monomials.
/// \param out receives sphv_monomial_count(dimension, degree) numbers
void sphv_field_derivatives(const sphv_field *field, int degree, const double x[SPHV_DIMENSIONS],
                            double *out);

#endif
