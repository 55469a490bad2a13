/// \file constant_text.h
/// Normalisation constants as kernel files write them: `10/7/pi`, `pi^(-1/2)`, `0.5641895835`.
#ifndef SPHVERIFY_CORE_CONSTANT_TEXT_H
#define SPHVERIFY_CORE_CONSTANT_TEXT_H

#include "sphverify/status.h"

/// Reads an expression of numbers, pi, + - * / ^, sqrt(…) and brackets.
/// \param text  at most 200 characters; `a/b/c` is (a/b)/c, `-x^2` is −(x^2), products are written
/// \param out   receives the value, to a few units of the last place of a long double
/// \return SPHV_INVALID_INPUT for anything else, or a value that is not finite
sphv_status sphv_constant_parse(const char *text, long double *out,
                                sphv_error *error) SPHV_MUST_CHECK;

#endif
