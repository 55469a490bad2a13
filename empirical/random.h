/// \file random.h
/// Random numbers that are functions of where they are used.
///
/// Philox4x32-10 (Salmon et al. 2011) keyed by the seed, its counter made of a stream and an index:
/// the same numbers in any order and by any number of threads.
#ifndef SPHVERIFY_EMPIRICAL_RANDOM_H
#define SPHVERIFY_EMPIRICAL_RANDOM_H

#include <stdint.h>

/// No normal number of `sphv_normal` is larger: √(−2 ln 2⁻⁵³) = 8.57.
#define SPHV_NORMAL_MAX 8.6

/// A standard normal number that depends on (seed, stream, index) alone, by Box and Muller's
/// transform. Its modulus is below SPHV_NORMAL_MAX.
/// \param stream the realisation on a line, the coordinate in a box
double sphv_normal(uint64_t seed, int stream, long index);

/// The same, uniform on (0, 1).
double sphv_uniform(uint64_t seed, int stream, long index);

#endif
