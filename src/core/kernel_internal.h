/// \file kernel_internal.h
/// What the kernel file reader hands to the kernel.
#ifndef SPHVERIFY_CORE_KERNEL_INTERNAL_H
#define SPHVERIFY_CORE_KERNEL_INTERNAL_H

#include "profile.h"
#include "sphverify/kernel.h"

struct sphv_kernel {
    char *path, *name, *title, *source;
    sphv_kernel_claims claims;
    int claimed_value[4];       ///< storage behind the integer pointers of `claims`
    bool polynomial;            ///< pieces, not a closed form
    bool fourth_order;          ///< transform: fourth-order
    sphv_exact_pieces pieces;   ///< w(q) of the file
    sphv_exact_pieces gradient; ///< w′(q) of the file, count 0 when it gives none
    sphv_form form;             ///< closed form, without dimension and scale
    sphv_number support;
    bool declared[SPHV_DIMENSIONS];
    /// Per dimension: normalised exact pieces times π^(d>1), C_d π^(d>1), compiled profiles.
    sphv_exact_pieces exact[SPHV_DIMENSIONS];
    mpq_t constant[SPHV_DIMENSIONS];
    sphv_profile profile[SPHV_DIMENSIONS];
    sphv_profile gradient_profile[SPHV_DIMENSIONS];
    char refusal[SPHV_DIMENSIONS][160];
};

/// An empty kernel. \return NULL without memory
sphv_kernel *sphv_kernel_new(void);

/// sphv_kernel_load, but a kernel that no declared dimension can normalise is handed over too, with
/// the reasons as its refusals: a check of the file has to say more about it than that.
sphv_status sphv_kernel_load_any(const char *path, sphv_kernel **out,
                                 sphv_error *error) SPHV_MUST_CHECK;

/// Normalises and compiles every declared dimension; refuses those in which ∫W dV is not positive.
/// \return SPHV_INVALID_INPUT when no dimension is left
sphv_status sphv_kernel_compile(sphv_kernel *kernel, sphv_error *error) SPHV_MUST_CHECK;

#endif
