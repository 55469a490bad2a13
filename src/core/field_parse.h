/// \file field_parse.h
/// Polynomials as text.
#ifndef SPHVERIFY_CORE_FIELD_PARSE_H
#define SPHVERIFY_CORE_FIELD_PARSE_H

#include "sphverify/field.h"

/// Reads a polynomial; the whole text must be one.
///
///     polynomial = [sign] product {sign product}      sign = "+" | "-"
///     product    = factor {"*" factor}
///     factor     = number | ("x" | "y" | "z") ["^" digits]
///
/// Blanks may stand between symbols; numbers are decimals or fractions. Equal monomials are added.
/// \param out name and dimension are set; receives the terms
/// \return SPHV_INVALID_INPUT with the column of what is wrong
sphv_status sphv_field_parse_polynomial(const char *text, sphv_field *out,
                                        sphv_error *error) SPHV_MUST_CHECK;

#endif
