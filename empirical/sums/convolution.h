/// \file convolution.h
/// What the parts of the convolution route share.
#ifndef SPHVERIFY_EMPIRICAL_CONVOLUTION_H
#define SPHVERIFY_EMPIRICAL_CONVOLUTION_H

#include <math.h>

#include "lattice_table.h"
#include "transform.h"

/// A radial function times a monomial.
typedef struct sphv_sum_kernel {
    int k, monomial;
} sphv_sum_kernel;

enum { SPHV_SUM_KERNELS = 128 }; ///< of the highest level in three dimensions: 35 + 56 + 31

/// A convolution on its way.
typedef struct sphv_convolution {
    const sphv_evaluation *evaluation;
    sphv_lattice_table table;
    sphv_transform transform;
    sphv_sum_kernel moment[SPHV_SUM_KERNELS], field[SPHV_SUM_KERNELS];
    size_t fields;
    double *moments;  ///< [moment * classes + class]
    double *bound[3]; ///< per class: what its sums are wrong by, in units of κ^(|α| − m)
    double *counts;   ///< per class: neighbours
    double *centre;   ///< middle of each field's range
    double **sums;    ///< Σ K(b − a)(A_b − centre), [field * per_field + kernel]
    double transform_error[3]; ///< of those, in units of κ^(|α| − m) and the field's spread
    size_t done, steps;
} sphv_convolution;

static inline const sphv_monomial *sphv_kernel_monomial(const sphv_convolution *of,
                                                        const sphv_sum_kernel *kernel)
{
    return &sphv_monomials(of->table.dimension)[kernel->monomial];
}

static inline sphv_offset_function sphv_kernel_function(const sphv_convolution *of,
                                                        const sphv_sum_kernel *kernel)
{
    return (sphv_offset_function){of->table.p[kernel->k], of->table.volume,
                                  sphv_kernel_monomial(of, kernel)};
}

/// κ^(|α| − m).
static inline double sphv_kernel_reach(const sphv_convolution *of, const sphv_sum_kernel *kernel)
{
    int extra = sphv_kernel_monomial(of, kernel)->degree - of->table.lowest[kernel->k];
    return pow(of->evaluation->request->profile->support, extra);
}

/// Fills in `sums` and `transform_error`.
sphv_status sphv_convolve_fields(sphv_convolution *of) SPHV_MUST_CHECK;

#endif
