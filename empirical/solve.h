/// \file solve.h
/// What the methods share: a few particles' sums with their bounds. The files that include this are
/// compiled once for each instruction set.
#ifndef SPHVERIFY_EMPIRICAL_SOLVE_H
#define SPHVERIFY_EMPIRICAL_SOLVE_H

#include "dense.h"
#include "solvers.h"

/// Particles of a block that are solved side by side.
typedef struct sphv_pack {
    sphv_lanes size[3]; ///< rounding Σ v|p_k| q^m
    sphv_lane_mask kept, sound;
    const sphv_solve_task *task;
    const sphv_sum_block *block;
    size_t at, have; ///< first of the pack, and how many
    bool all;        ///< full, and each particle sound
    unsigned char fault[SPHV_LANES];
} sphv_pack;

/// Exponents of the monomials through degree 2, in the order of sphv_monomials.
static const signed char sphv_low_powers[SPHV_DIMENSIONS][10][SPHV_DIMENSIONS] = {
    {{0}, {1}, {2}},
    {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}},
    {{0, 0, 0},
     {1, 0, 0},
     {0, 1, 0},
     {0, 0, 1},
     {2, 0, 0},
     {1, 1, 0},
     {1, 0, 1},
     {0, 2, 0},
     {0, 1, 1},
     {0, 0, 2}},
};

/// A monomial by its exponents.
typedef struct sphv_exponents {
    int x, y, z;
} sphv_exponents;

SPHV_INLINE sphv_exponents sphv_low_monomial(const int d, int index)
{
    const signed char *power = sphv_low_powers[d - 1][index];
    return (sphv_exponents){power[0], power[1], power[2]};
}

/// s^α s^β.
SPHV_INLINE sphv_exponents sphv_times(sphv_exponents a, sphv_exponents b)
{
    return (sphv_exponents){a.x + b.x, a.y + b.y, a.z + b.z};
}

/// s_k.
SPHV_INLINE sphv_exponents sphv_coordinate(int k)
{
    return (sphv_exponents){k == 0, k == 1, k == 2};
}

SPHV_INLINE int sphv_exponent(sphv_exponents a, int k)
{
    return k == 0 ? a.x : k == 1 ? a.y : a.z;
}

/// s^α/s_k, for a positive exponent of s_k.
SPHV_INLINE sphv_exponents sphv_over(sphv_exponents a, int k)
{
    return (sphv_exponents){a.x - (k == 0), a.y - (k == 1), a.z - (k == 2)};
}

/// Place of a monomial in the order of sphv_monomials.
SPHV_INLINE int sphv_place(const int d, sphv_exponents a)
{
    int degree = a.x + a.y + a.z, rest = a.y + a.z;
    if (d == 1) return degree;
    if (d == 2) return degree * (degree + 1) / 2 + a.y;
    return degree * (degree + 1) * (degree + 2) / 6 + rest * (rest + 1) / 2 + a.z;
}

/// κ^(|α| − m): what |s^α|/q^m is at most.
SPHV_INLINE double sphv_pack_reach(const sphv_pack *pack, int k, sphv_exponents a)
{
    int from = sphv_sum_sets[pack->block->layout->level].moment[k].from;
    return pack->task->reach[a.x + a.y + a.z - from];
}

/// Σ v p_k s^α.
SPHV_INLINE sphv_bounded sphv_moment(const sphv_pack *pack, const int d, int k, sphv_exponents a)
{
    int index = sphv_moment_index(pack->block->layout, k, sphv_place(d, a));
    const double *from = pack->block->sums + (size_t)index * pack->block->stride + pack->at;
    return (sphv_bounded){sphv_lanes_load(from), pack->size[k] * sphv_pack_reach(pack, k, a)};
}

/// Σ v p_k s^α (A_b − A_a).
SPHV_INLINE sphv_bounded sphv_field_sum(const sphv_pack *pack, const int d, size_t field, int k,
                                        sphv_exponents a)
{
    int index = sphv_field_sum_index(pack->block->layout, (int)field, k, sphv_place(d, a));
    const double *from = pack->block->sums + (size_t)index * pack->block->stride + pack->at;
    return (sphv_bounded){sphv_lanes_load(from), pack->size[k] * (sphv_pack_reach(pack, k, a) *
                                                                  pack->block->spread[field])};
}

/// A_a.
SPHV_INLINE sphv_bounded sphv_own_value(const sphv_pack *pack, size_t field)
{
    const double *from = pack->task->values + field * pack->block->stride + pack->at;
    return sphv_bounded_exact(sphv_lanes_load(from));
}

/// Makes the pack of the block's particles `at` and after; what is found out about them is left.
SPHV_INLINE void sphv_pack_make(sphv_pack *pack, const sphv_solve_task *task, size_t at)
{
    const sphv_sum_block *block = task->block;
    size_t rest = block->count - at;
    sphv_lanes rounding = sphv_lanes_load(block->rounding + at);
    pack->task = task;
    pack->block = block;
    pack->at = at;
    pack->have = rest < SPHV_LANES ? rest : SPHV_LANES;
    for (int k = 0; k < 3; k++) {
        size_t index = (size_t)block->layout->size_at + (size_t)k;
        pack->size[k] = rounding * sphv_lanes_load(block->sums + index * block->stride + at);
    }
}

/// Condition of a 1 × 1 matrix that is a sum, from its defect: a bound of how much of it cancels.
SPHV_INLINE sphv_lanes sphv_pack_cancellation(const sphv_pack *pack, sphv_lanes defect)
{
    const double *rounding = pack->block->rounding + pack->at;
    return sphv_dense_raise(sphv_lanes_of(1), defect / sphv_lanes_load(rounding));
}

/// Solves the packs of a block from `at` on, compiled for each dimension.
#define SPHV_EACH_PACK(task, in_one, in_two, in_three)                                             \
    {                                                                                              \
        const size_t count = (task)->block->count;                                                 \
        const int dimension = (task)->block->layout->dimension;                                    \
        for (size_t at = 0; dimension == 1 && at < count; at += SPHV_LANES) (in_one);              \
        for (size_t at = 0; dimension == 2 && at < count; at += SPHV_LANES) (in_two);              \
        for (size_t at = 0; dimension == 3 && at < count; at += SPHV_LANES) (in_three);            \
    }

/// The name of a solver of the instruction set that this is compiled for.
#define SPHV_SOLVER(name) SPHV_SOLVER_OF(name, SPHV_SET)
#define SPHV_SOLVER_OF(name, set) SPHV_SOLVER_JOIN(name, set)
#define SPHV_SOLVER_JOIN(name, set) sphv_solve_##name##_##set

sphv_solver SPHV_SOLVER(standard);
sphv_solver SPHV_SOLVER(difference);
sphv_solver SPHV_SOLVER(shepard);
sphv_solver SPHV_SOLVER(bonet_lok);
sphv_solver SPHV_SOLVER(cspm);
sphv_solver SPHV_SOLVER(fpm);
sphv_solver SPHV_SOLVER(msph);
sphv_solver SPHV_SOLVER(rkpm_1);
sphv_solver SPHV_SOLVER(rkpm_2);

#endif
