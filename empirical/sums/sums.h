/// \file sums.h
/// The sums behind every method, and what evaluates them.
///
/// With s = (x_b − x_a)/h, q = |s|, v = V_b/h^d, δA = A_b − A_a and the radial functions
///
///     p_0 = Ŵ(q),   p_1 = Ŵ′(q)/q,   p_2 = (Ŵ″(q) − Ŵ′(q)/q)/q²
///
/// the kernel's derivatives with respect to s are ∂_i Ŵ = p_1 s_i and ∂_i∂_j Ŵ = p_1 δ_ij + p_2 s_i
/// s_j, so that every method needs only moments Σ v p_k s^α and field sums Σ v p_k s^α δA. At q = 0
/// p_1 is Ŵ″(0) where Ŵ′(0) = 0, else 0, and p_2 is 0; both only meet s^α = 0 or δA = 0 there, save
/// for the moment Σ v p_1.
#ifndef SPHVERIFY_EMPIRICAL_SUMS_H
#define SPHVERIFY_EMPIRICAL_SUMS_H

#include "sphverify/estimate.h"

/// Degrees |α| of the monomials summed, from … to; none when from > to.
typedef struct sphv_degrees {
    int from, to;
} sphv_degrees;

/// A set of sums that belong together, in ascending cost. A request takes the first that covers
/// all its methods.
typedef enum sphv_sum_level {
    /// sph alone, by the direct route: its sums are over A_b itself wherever δA is written, so that
    /// no moments are needed
    SPHV_SUMS_PLAIN,
    SPHV_SUMS_STANDARD,    ///< sph, sph-difference, shepard, rkpm-0
    SPHV_SUMS_FIRST,       ///< bonet-lok, cspm, fpm
    SPHV_SUMS_REPRODUCING, ///< rkpm
    SPHV_SUMS_SECOND,      ///< msph
    SPHV_SUMS_ALL,         ///< rkpm-2, and everything at once
    SPHV_SUM_LEVELS
} sphv_sum_level;

typedef struct sphv_sum_set {
    sphv_degrees moment[3]; ///< per radial function
    sphv_degrees field[3];
} sphv_sum_set;

/// The sets by level, moments and field sums, as an initialiser: the passes have to know them when
/// they are compiled.
#define SPHV_SUM_SETS                                                                              \
    {                                                                                              \
        [SPHV_SUMS_PLAIN] = {{{0, -1}, {1, 0}, {0, -1}}, {{0, 0}, {1, 1}, {0, -1}}},               \
        [SPHV_SUMS_STANDARD] = {{{0, 0}, {1, 1}, {0, -1}}, {{0, 0}, {1, 1}, {0, -1}}},             \
        [SPHV_SUMS_FIRST] = {{{0, 1}, {1, 2}, {0, -1}}, {{0, 0}, {1, 1}, {0, -1}}},                \
        [SPHV_SUMS_REPRODUCING] = {{{0, 2}, {1, 3}, {0, -1}}, {{0, 1}, {1, 2}, {0, -1}}},          \
        [SPHV_SUMS_SECOND] = {{{0, 2}, {0, 3}, {2, 4}}, {{0, 0}, {0, 1}, {2, 2}}},                 \
        [SPHV_SUMS_ALL] = {{{0, 4}, {0, 5}, {2, 4}}, {{0, 2}, {0, 3}, {2, 2}}},                    \
    }
extern const sphv_sum_set sphv_sum_sets[SPHV_SUM_LEVELS];

/// The lowest level that covers a method.
sphv_sum_level sphv_method_level(sphv_method method);

/// The lowest level that covers all methods of a request, by any route.
sphv_sum_level sphv_request_level(const sphv_request *request);

/// Where each sum of a level stands: moments first, then the sums of each field in turn. Within a
/// radial function the order is that of the monomials.
typedef struct sphv_sum_layout {
    int dimension;
    sphv_sum_level level;
    int moment_at[3]; ///< first moment of each radial function; −1: none
    int field_at[3];  ///< first field sum of each radial function, relative to the field's first
    int moments;      ///< number of moments
    int per_field;    ///< number of sums of one field
    /// Σ v|p_k| q^m of the radial functions k = 0, 1, 2 (for bounds), m the lowest degree of the
    /// level's moments of p_k; 0 where it has none.
    int size_at;
    int count;                                      ///< moments + 3 + fields × per_field
    int first_monomial[3], first_field_monomial[3]; ///< table index of the first monomial
} sphv_sum_layout;

sphv_sum_layout sphv_sum_layout_make(int dimension, sphv_sum_level level, int fields);

/// Index of the moment Σ v p_k s^α / of the sum Σ v p_k s^α δA of field f; α as a monomial's place.
static inline int sphv_moment_index(const sphv_sum_layout *layout, int k, int monomial)
{
    return layout->moment_at[k] + monomial - layout->first_monomial[k];
}
static inline int sphv_field_sum_index(const sphv_sum_layout *layout, int f, int k, int monomial)
{
    return layout->moments + 3 + f * layout->per_field + layout->field_at[k] + monomial -
           layout->first_field_monomial[k];
}

/// Sums of a block of particles. Up to eight are solved at a time, so `stride` is a multiple of
/// 8, and sums, rounding and values can be read to the end of the last eight.
typedef struct sphv_sum_block {
    const sphv_sum_layout *layout;
    size_t first, count; ///< in the order of the evaluation
    size_t stride;       ///< sum k of the block's i-th particle is sums[k * stride + i]
    double *sums;
    const size_t *particle;     ///< the particle each stands for
    const unsigned *neighbours; ///< within the support, itself included
    /// Relative error of each summand and of the accumulation: the sum Σ v p_k s^α δA is in error
    /// by at most rounding[i] Σ v|p_k| q^m max|s^α/q^m δA|, m the lowest degree as in `size_at`.
    const double *rounding;
    /// Per field: |δA| of any pair within the support is at most this; max A − min A serves, and
    /// max |A| at the level PLAIN.
    const double *spread;
} sphv_sum_block;

/// Turns a block of sums into estimates: one method, every field. A particle with a fault keeps its
/// estimates when it is merely ill-conditioned, or isolated where no neighbour is needed
/// (sphv_method_least); else they are 0. Where only some fields' estimates overflow the others are
/// kept.
/// \param values  A at the block's particles, values[f * stride + i]
/// \param out     `rounding` is raised to the block's largest: each thread needs its own
void sphv_solve_block(const sphv_sum_block *block, const sphv_request *request,
                      const double *values, sphv_method_estimates *out);

#endif
