/// \file lanes.h
/// Particles side by side, one in each lane of a vector, and numbers that carry a bound of their
/// rounding error.
///
/// Eight where a file is compiled for registers that hold as many, else four: compilers take
/// comparisons of vectors wider than registers apart, lane by lane. Lanes never mix, so a
/// particle's result depends neither on its neighbours in the pack nor on their number.
#ifndef SPHVERIFY_EMPIRICAL_LANES_H
#define SPHVERIFY_EMPIRICAL_LANES_H

#include <math.h>
#include <string.h>

#include "clones.h"
#include "internal.h"

#if defined(__AVX512F__) && defined(__AVX512DQ__)
#include <immintrin.h>
enum { SPHV_LANES = 8 };
typedef double sphv_lanes __attribute__((vector_size(64)));
typedef long long sphv_lane_mask __attribute__((vector_size(64)));
#else
enum { SPHV_LANES = 4 };
typedef double sphv_lanes __attribute__((vector_size(32)));
typedef long long sphv_lane_mask __attribute__((vector_size(32))); ///< all bits set where true
#endif

SPHV_INLINE sphv_lanes sphv_lanes_of(double value)
{
    return (sphv_lanes){0} + value;
}

SPHV_INLINE sphv_lanes sphv_lanes_load(const double *from)
{
    sphv_lanes lanes;
    memcpy(&lanes, from, sizeof lanes);
    return lanes;
}

SPHV_INLINE sphv_lanes sphv_lanes_abs(sphv_lanes a)
{
    return (sphv_lanes)((sphv_lane_mask)a & 0x7fffffffffffffffLL);
}

SPHV_INLINE sphv_lanes sphv_lanes_choose(sphv_lane_mask mask, sphv_lanes yes, sphv_lanes no)
{
    return (sphv_lanes)((mask & (sphv_lane_mask)yes) | (~mask & (sphv_lane_mask)no));
}

SPHV_INLINE sphv_lane_mask sphv_lanes_finite(sphv_lanes a)
{
    return sphv_lanes_abs(a) <= DBL_MAX;
}

SPHV_INLINE sphv_lanes sphv_lanes_max(sphv_lanes a, sphv_lanes b)
{
    return sphv_lanes_choose(a > b, a, b);
}

SPHV_INLINE bool sphv_lanes_any(sphv_lane_mask mask)
{
#if defined(__AVX512F__) && defined(__AVX512DQ__)
    return _mm512_movepi64_mask((__m512i)mask) != 0;
#else
    long long any = 0;
    for (int l = 0; l < SPHV_LANES; l++) any |= mask[l];
    return any != 0;
#endif
}

/// A number whose true value is within `error` of `value`. The errors' own arithmetic is off by a
/// few u in relation to them; whoever hands a bound on widens it by SPHV_BOUND_SLACK. Underflow is
/// not counted.
typedef struct sphv_bounded {
    sphv_lanes value, error;
} sphv_bounded;

static const double SPHV_BOUND_SLACK = 1 + 1e-10;

SPHV_INLINE sphv_bounded sphv_bounded_exact(sphv_lanes value)
{
    return (sphv_bounded){value, (sphv_lanes){0}};
}

SPHV_INLINE sphv_bounded sphv_bounded_add(sphv_bounded a, sphv_bounded b)
{
    sphv_lanes value = a.value + b.value;
    return (sphv_bounded){value, a.error + b.error + SPHV_U * sphv_lanes_abs(value)};
}

SPHV_INLINE sphv_bounded sphv_bounded_subtract(sphv_bounded a, sphv_bounded b)
{
    return sphv_bounded_add(a, (sphv_bounded){-b.value, b.error});
}

SPHV_INLINE sphv_bounded sphv_bounded_multiply(sphv_bounded a, sphv_bounded b)
{
    sphv_lanes value = a.value * b.value;
    return (sphv_bounded){value, sphv_lanes_abs(a.value) * b.error +
                                     a.error * (sphv_lanes_abs(b.value) + b.error) +
                                     SPHV_U * sphv_lanes_abs(value)};
}

/// 1/b, off by at most e/(|b|(|b| − e)) ≤ (1 + 2t) t/|b| with t = e/|b| ≤ 1/2.
/// \return an infinite error where t is larger: b may be 0
SPHV_INLINE sphv_bounded sphv_bounded_reciprocal(sphv_bounded b)
{
    sphv_lanes value = 1.0 / b.value, size = sphv_lanes_abs(value), t = b.error * size;
    sphv_lanes error = ((1.0 + 2.0 * t) * t + 2 * SPHV_U) * size;
    return (sphv_bounded){value, sphv_lanes_choose(t <= 0.5, error, sphv_lanes_of(INFINITY))};
}

/// Times a power of two, or another factor with an exact product.
SPHV_INLINE sphv_bounded sphv_bounded_scale(sphv_bounded a, double factor)
{
    return (sphv_bounded){factor * a.value, fabs(factor) * a.error};
}

#endif
