/// \file number.h
/// Numbers as people write them: decimals and fractions, kept beyond double precision.
#ifndef SPHVERIFY_NUMBER_H
#define SPHVERIFY_NUMBER_H

#include "sphverify/status.h"

/// A real number as an unevaluated sum of two doubles (about 106 bits). A spacing of 4/11 or 1/3
/// is not a double; whether a particle lies just inside a knot, on it, or just outside must not
/// depend on how it was rounded.
typedef struct sphv_number {
    double value;    ///< the nearest double
    double residual; ///< exact number minus `value`, itself rounded
} sphv_number;

/// The number that a double holds exactly.
sphv_number sphv_number_from_double(double value);

/// numerator/denominator. \pre denominator != 0
sphv_number sphv_number_from_ratio(long numerator, long denominator);

/// Reads a decimal (`0.37`, `1e-3`), a fraction (`4/11`, `0.5/3`), or an integer.
/// \param text   the whole text must be used up; no blanks, no hexadecimal, no infinity or NaN
/// \param out    receives the number
/// \param error  receives the reason of a failure
/// \return SPHV_OK, or SPHV_INVALID_INPUT when the text is not such a number, is out of the range
///         of a double, or divides by zero
sphv_status sphv_number_parse(const char *text, sphv_number *out,
                              sphv_error *error) SPHV_MUST_CHECK;

/// Where a knot stands on the lattice j·step, j = 0, 1, 2, …
typedef struct sphv_lattice_place {
    long inside;     ///< number of j ≥ 1 with j·step strictly below the knot
    double fraction; ///< frac(knot/step), in [0, 1)
    int on_lattice;  ///< the knot is itself a lattice point (fraction is exactly 0)
} sphv_lattice_place;

/// Places a knot on a lattice, deciding "inside, on, or outside" exactly to about 100 bits.
/// \pre step > 0, knot >= 0, knot/step < 2^52
sphv_lattice_place sphv_number_place(sphv_number knot, sphv_number step);

#endif
