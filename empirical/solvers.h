/// \file solvers.h
/// The methods' solvers, compiled for several instruction sets.
#ifndef SPHVERIFY_EMPIRICAL_SOLVERS_H
#define SPHVERIFY_EMPIRICAL_SOLVERS_H

#include "sums/sums.h"

enum { SPHV_SUM_DEGREE_MAX = 5 };

/// One method on one block.
typedef struct sphv_solve_task {
    const sphv_sum_block *block;
    const sphv_request *request;
    const double *values; ///< A at the block's particles
    sphv_method_estimates *out;
    size_t least;                          ///< fewest particles of a regular moment matrix
    double reach[SPHV_SUM_DEGREE_MAX + 1]; ///< powers of κ
    double scale[3];                       ///< 1, 1/h, 1/h²
} sphv_solve_task;

/// Solves a block by one method.
typedef void sphv_solver(const sphv_solve_task *task);

/// What an instruction set offers. All of them find the same, bit for bit.
typedef struct sphv_solver_set {
    const char *name;
    sphv_solver *solver[SPHV_MSPH + 1]; ///< by method
} sphv_solver_set;

/// Instruction sets that this processor has, best first, ended by NULL.
const sphv_solver_set *const *sphv_solver_sets(void);

/// As sphv_solve_block, with an instruction set of choice.
void sphv_solve_block_with(const sphv_solver_set *set, const sphv_sum_block *block,
                           const sphv_request *request, const double *values,
                           sphv_method_estimates *out);

#endif
