/// \file vector.h
/// Vectors of doubles, one target particle in each lane: the few operations of the passes, in
/// AVX-512, in AVX2 with FMA, and in the vectors that GCC and Clang have on every machine. A file
/// that includes it is compiled once for each.
///
/// The project turns contraction off; fma() below is asked for by name, so that the squares of
/// distances, which decide who is a neighbour, stay sums of rounded products on every machine.
#ifndef SPHVERIFY_EMPIRICAL_VECTOR_H
#define SPHVERIFY_EMPIRICAL_VECTOR_H

#include <math.h>

#define SPHV_INLINE static inline __attribute__((always_inline))

#if defined(__AVX512F__) && defined(__AVX512DQ__) && !defined(SPHV_LANES_PLAIN)

#include <immintrin.h>

enum { LANES = 8 };
typedef __m512d vec;
typedef __mmask8 mask;

SPHV_INLINE vec v_load(const double *from)
{
    return _mm512_loadu_pd(from);
}
SPHV_INLINE void v_store(double *to, vec a)
{
    _mm512_storeu_pd(to, a);
}
SPHV_INLINE vec v_set(double a)
{
    return _mm512_set1_pd(a);
}
SPHV_INLINE vec v_add(vec a, vec b)
{
    return _mm512_add_pd(a, b);
}
SPHV_INLINE vec v_sub(vec a, vec b)
{
    return _mm512_sub_pd(a, b);
}
SPHV_INLINE vec v_mul(vec a, vec b)
{
    return _mm512_mul_pd(a, b);
}
SPHV_INLINE vec v_div(vec a, vec b)
{
    return _mm512_div_pd(a, b);
}
SPHV_INLINE vec v_fma(vec a, vec b, vec c)
{
    return _mm512_fmadd_pd(a, b, c);
}
SPHV_INLINE vec v_fnma(vec a, vec b, vec c)
{
    return _mm512_fnmadd_pd(a, b, c);
} ///< c − a b
SPHV_INLINE vec v_sqrt(vec a)
{
    return _mm512_sqrt_pd(a);
}
SPHV_INLINE vec v_max(vec a, vec b)
{
    return _mm512_max_pd(a, b);
}
SPHV_INLINE mask v_less(vec a, vec b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ);
}
SPHV_INLINE vec v_where(mask m, vec a)
{
    return _mm512_maskz_mov_pd(m, a);
} ///< a or 0
SPHV_INLINE vec v_div_where(mask m, vec a, vec b)
{
    return _mm512_maskz_div_pd(m, a, b);
}
SPHV_INLINE vec v_count(vec n, mask m)
{
    return _mm512_mask_add_pd(n, m, n, v_set(1));
}
SPHV_INLINE mask v_both(mask a, mask b)
{
    return a & b;
}
SPHV_INLINE mask v_without(mask a, mask b)
{
    return a & (mask)~b;
}
SPHV_INLINE mask v_first(size_t n)
{
    return n < LANES ? (mask)((1u << n) - 1) : (mask)0xff;
} ///< of the first n lanes
SPHV_INLINE double v_total(vec a)
{
    return _mm512_reduce_add_pd(a);
} ///< over lanes

/// Root and inverse root without the divider: from an estimate of 1/√a good to 14 bits, a series in
/// what is left of 1 − a y², to which its fifth term would add 0.3 u. Each is wrong by 2 u at most:
/// what rounds a·y halves, and the last operation rounds once.
SPHV_INLINE vec v_root_from(vec y, vec a, vec *inverse)
{
    vec root = v_mul(a, y), rest = v_fnma(root, y, v_set(1));
    vec series = v_fma(v_fma(v_set(0.3125), rest, v_set(0.375)), rest, v_set(0.5));
    series = v_mul(series, rest);
    *inverse = v_fma(series, y, y);
    return v_fma(series, root, root);
}
SPHV_INLINE vec v_root_of(vec a, vec *inverse)
{
    return v_root_from(_mm512_rsqrt14_pd(a), a, inverse);
} ///< of positive numbers
SPHV_INLINE vec v_root(vec a, vec *inverse)
{
    return v_root_from(_mm512_maskz_rsqrt14_pd(v_less(v_set(0), a), a), a, inverse);
} ///< 0 for 0

#elif defined(__AVX2__) && defined(__FMA__) && !defined(SPHV_LANES_PLAIN)

#include <immintrin.h>

enum { LANES = 4 };
typedef __m256d vec;
typedef __m256d mask;

SPHV_INLINE vec v_load(const double *from)
{
    return _mm256_loadu_pd(from);
}
SPHV_INLINE void v_store(double *to, vec a)
{
    _mm256_storeu_pd(to, a);
}
SPHV_INLINE vec v_set(double a)
{
    return _mm256_set1_pd(a);
}
SPHV_INLINE vec v_add(vec a, vec b)
{
    return _mm256_add_pd(a, b);
}
SPHV_INLINE vec v_sub(vec a, vec b)
{
    return _mm256_sub_pd(a, b);
}
SPHV_INLINE vec v_mul(vec a, vec b)
{
    return _mm256_mul_pd(a, b);
}
SPHV_INLINE vec v_div(vec a, vec b)
{
    return _mm256_div_pd(a, b);
}
SPHV_INLINE vec v_fma(vec a, vec b, vec c)
{
    return _mm256_fmadd_pd(a, b, c);
}
SPHV_INLINE vec v_fnma(vec a, vec b, vec c)
{
    return _mm256_fnmadd_pd(a, b, c);
}
SPHV_INLINE vec v_sqrt(vec a)
{
    return _mm256_sqrt_pd(a);
}
SPHV_INLINE vec v_max(vec a, vec b)
{
    return _mm256_max_pd(a, b);
}
SPHV_INLINE mask v_less(vec a, vec b)
{
    return _mm256_cmp_pd(a, b, _CMP_LT_OQ);
}
SPHV_INLINE vec v_where(mask m, vec a)
{
    return _mm256_and_pd(m, a);
}
SPHV_INLINE vec v_div_where(mask m, vec a, vec b)
{
    return v_where(m, v_div(a, b));
}
SPHV_INLINE vec v_count(vec n, mask m)
{
    return v_add(n, v_where(m, v_set(1)));
}
SPHV_INLINE mask v_both(mask a, mask b)
{
    return _mm256_and_pd(a, b);
}
SPHV_INLINE mask v_without(mask a, mask b)
{
    return _mm256_andnot_pd(b, a);
}
SPHV_INLINE mask v_first(size_t n)
{
    return v_less(_mm256_set_pd(3, 2, 1, 0), v_set(n < LANES ? (double)n : LANES));
} ///< of the first n lanes
SPHV_INLINE double v_total(vec a)
{
    return (a[0] + a[1]) + (a[2] + a[3]);
} ///< over lanes

#else

enum { LANES = 4 };
typedef double vec __attribute__((vector_size(32)));
typedef long long mask __attribute__((vector_size(32)));

SPHV_INLINE vec v_load(const double *from)
{
    return (vec){from[0], from[1], from[2], from[3]};
}
SPHV_INLINE void v_store(double *to, vec a)
{
    for (int i = 0; i < LANES; i++) to[i] = a[i];
}
SPHV_INLINE vec v_set(double a)
{
    return (vec){a, a, a, a};
}
SPHV_INLINE vec v_add(vec a, vec b)
{
    return a + b;
}
SPHV_INLINE vec v_sub(vec a, vec b)
{
    return a - b;
}
SPHV_INLINE vec v_mul(vec a, vec b)
{
    return a * b;
}
SPHV_INLINE vec v_div(vec a, vec b)
{
    return a / b;
}
#ifdef __ARM_FEATURE_FMA
SPHV_INLINE vec v_fma(vec a, vec b, vec c)
{
    return (vec){__builtin_fma(a[0], b[0], c[0]), __builtin_fma(a[1], b[1], c[1]),
                 __builtin_fma(a[2], b[2], c[2]), __builtin_fma(a[3], b[3], c[3])};
}
#else
SPHV_INLINE vec v_fma(vec a, vec b, vec c)
{
    return a * b + c;
}
#endif
SPHV_INLINE vec v_fnma(vec a, vec b, vec c)
{
    return v_fma(-a, b, c);
}
SPHV_INLINE vec v_sqrt(vec a)
{
    return (vec){sqrt(a[0]), sqrt(a[1]), sqrt(a[2]), sqrt(a[3])};
}
SPHV_INLINE mask v_less(vec a, vec b)
{
    return a < b;
}
SPHV_INLINE vec v_where(mask m, vec a)
{
    return (vec)((mask)a & m);
}
SPHV_INLINE vec v_max(vec a, vec b)
{
    return (vec)(((mask)a & (b < a)) | ((mask)b & ~(b < a)));
}
SPHV_INLINE vec v_div_where(mask m, vec a, vec b)
{
    return v_where(m, v_div(a, b));
}
SPHV_INLINE vec v_count(vec n, mask m)
{
    return v_add(n, v_where(m, v_set(1)));
}
SPHV_INLINE mask v_both(mask a, mask b)
{
    return a & b;
}
SPHV_INLINE mask v_without(mask a, mask b)
{
    return a & ~b;
}
SPHV_INLINE mask v_first(size_t n)
{
    return v_less((vec){0, 1, 2, 3}, v_set(n < LANES ? (double)n : LANES));
} ///< of the first n lanes
SPHV_INLINE double v_total(vec a)
{
    return (a[0] + a[1]) + (a[2] + a[3]);
} ///< over lanes

#endif

#if !(defined(__AVX512F__) && defined(__AVX512DQ__) && !defined(SPHV_LANES_PLAIN))
SPHV_INLINE vec v_root(vec a, vec *inverse)
{
    vec root = v_sqrt(a);
    *inverse = v_div_where(v_less(v_set(0), a), v_set(1), root);
    return root;
}
SPHV_INLINE vec v_root_of(vec a, vec *inverse)
{
    vec root = v_sqrt(a);
    *inverse = v_div(v_set(1), root);
    return root;
}
#endif

#endif
