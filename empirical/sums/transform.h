/// \file transform.h
/// Fourier transforms of cubes of complex numbers, with a bound of their rounding error.
#ifndef SPHVERIFY_EMPIRICAL_TRANSFORM_H
#define SPHVERIFY_EMPIRICAL_TRANSFORM_H

#include <gsl/gsl_fft_complex.h>
#include <stdbool.h>

#include "sphverify/status.h"

enum { SPHV_PARALLEL_MIN = 10000 }; ///< fewer points are not worth the wait for other threads

/// Transforms of cubes with `size` points a side, the first coordinate running slowest.
typedef struct sphv_transform {
    int dimension;
    size_t size, points;
    gsl_fft_complex_wavetable *table;
} sphv_transform;

/// The least size >= `least` with no prime factor above 5.
size_t sphv_transform_size(size_t least);

sphv_status sphv_transform_make(sphv_transform *transform, int dimension,
                                size_t size) SPHV_MUST_CHECK;
void sphv_transform_free(sphv_transform *transform);

/// Transforms in place, ẑ(k) = Σ z(j) e^(−2πi k·j/size). The same bit for bit for any number of
/// threads.
/// \param data   real and imaginary parts in turn
/// \param filled only points whose coordinates are all below this are not zero
sphv_status sphv_transform_forward(const sphv_transform *transform, double *data,
                                   size_t filled) SPHV_MUST_CHECK;

/// The same with e^(+2πi k·j/size), not divided by the number of points.
/// \param wanted only points whose coordinates are all below this are right afterwards
sphv_status sphv_transform_backward(const sphv_transform *transform, double *data,
                                    size_t wanted) SPHV_MUST_CHECK;

/// ε such that ‖computed − exact‖₂ <= ε ‖exact‖₂, and max|computed − exact| <= ε Σ|input|.
///
/// A pass of radix r multiplies by twiddle factors and adds r numbers. GSL's factors are cos and
/// sin of a product with three roundings of an angle below 2π, so within 16u of the unit circle's
/// point; with the multiplication 20u. Its sums of 2 to 6 numbers are at most seven roundings deep
/// with coefficients of modulus up to 5/4: 12u. Each output is thus off by 32u of the sum of the
/// moduli of its r inputs; such errors meet no output twice, so that through all passes they add up
/// to 32u of Σ|input| for each pass. In the 2-norm the moduli may cost a factor √r over the exact
/// pass. 32u √r is at most 31u log2 r for r = 2 … 6 (21u √2 for r = 2), so 40u log2(points) holds
/// for both, second order included.
double sphv_transform_error(const sphv_transform *transform);

#endif
