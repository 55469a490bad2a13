/// \file rational.h
/// Exact rational arithmetic for kernels: GMP rationals and polynomials over them.
#ifndef SPHVERIFY_CORE_RATIONAL_H
#define SPHVERIFY_CORE_RATIONAL_H

#include <gmp.h>

#include "sphverify/number.h"

/// Reads a decimal or a fraction of decimals exactly.
/// Refuses texts longer than 80 characters and exponents beyond ±400.
sphv_status sphv_rational_parse(const char *text, mpq_t out, sphv_error *error) SPHV_MUST_CHECK;

/// The relative uncertainty of a number written as a decimal of 16 significant digits or more: one
/// unit of its last digit, at least 2u. 0 for fractions and short decimals, which mean themselves.
double sphv_decimal_uncertainty(const char *text);

/// The double nearest to a rational (mpq_get_d truncates; this rounds), ±infinity on overflow.
double sphv_rational_round(const mpq_t value);

/// The two-double number nearest to a rational.
sphv_number sphv_rational_number(const mpq_t value);

/// base^exponent. \pre exponent >= 0
void sphv_rational_power(mpq_t out, const mpq_t base, int exponent);

/// A polynomial with exact coefficients, ascending powers.
typedef struct sphv_polynomial {
    int degree; ///< index of the last stored coefficient, which may be zero
    mpq_t *coefficient;
} sphv_polynomial;

/// Makes the zero polynomial of a storage degree. \return SPHV_RESOURCE_FAILURE without memory
sphv_status sphv_polynomial_make(sphv_polynomial *p, int degree, sphv_error *error) SPHV_MUST_CHECK;
void sphv_polynomial_free(sphv_polynomial *p);

/// Replaces p(q) by p(q + shift), exactly (a Taylor shift by repeated synthetic division).
void sphv_polynomial_shift(sphv_polynomial *p, const mpq_t shift);

/// out = p(q).
void sphv_polynomial_value(mpq_t out, const sphv_polynomial *p, const mpq_t q);

/// out = ∫_from^to q^power · d^order p/dq^order dq for order 0 or 1.
void sphv_polynomial_moment(mpq_t out, const sphv_polynomial *p, int order, int power,
                            const mpq_t from, const mpq_t to);

#endif
