/// \file facts.h
/// What the report says of a kernel, worked out once for all of its formats.
#ifndef SPHVERIFY_REPORT_FACTS_H
#define SPHVERIFY_REPORT_FACTS_H

#include "sphverify/check.h"
#include "sphverify/scene.h"

enum { SPHV_FACT_MOMENTS = 3, SPHV_FACT_TEXT = 96 };

/// A kernel in one dimension.
typedef struct sphv_dimension_facts {
    const sphv_profile *profile;                    ///< NULL where the kernel is not legal
    char constant[SPHV_FACT_TEXT];                  ///< C_d as an exact expression, or ""
    const char *claim;                              ///< the file's C_d, or NULL
    double claimed;                                 ///< its value; NaN when it cannot be read
    sphv_verdict claim_verdict;                     ///< of the claim, where there is one
    char moment[SPHV_FACT_MOMENTS][SPHV_FACT_TEXT]; ///< μ_0, μ_2, μ_4 exactly, or ""
    sphv_fourier_sign fourier;
} sphv_dimension_facts;

typedef struct sphv_kernel_facts {
    const sphv_kernel *kernel;
    const sphv_agreement *agreement; ///< NULL where the kernel is not legal in one dimension
    sphv_dimension_facts dimension[SPHV_DIMENSIONS];
    const sphv_profile *profile;   ///< in the lowest legal dimension
    const int *claimed_smoothness; ///< β of the file, or NULL
    sphv_verdict smoothness_verdict;
    int special_order, special_knot; ///< order in Δx/h at 2κ/(2n+1), and the knot that decides it
    int general_order, general_knot; ///< the same at arbitrary spacings
    int edge_order; ///< what β alone predicts at special spacings: β + 2, or β + 1 for odd β
    size_t claims, claims_refuted;
    const sphv_check_report *check; ///< NULL when the kernel was not checked
    size_t checks, checks_passed;   ///< without those that state a number and require nothing
    sphv_verdict verdict; ///< the worst of the exact form's agreement, the claims and the checks
} sphv_kernel_facts;

/// Collects the facts. They point into kernel, agreement and check.
/// \param agreement, check  may be NULL
void sphv_kernel_facts_collect(const sphv_kernel *kernel, const sphv_agreement *agreement,
                               const sphv_check_report *check, sphv_kernel_facts *facts);

/// Why the paper's form disagrees with measurement, where it does; NULL where it does not.
const char *sphv_kernel_paper_failure(const sphv_kernel_facts *facts);

/// The worst verdict of an agreement table, from its counts.
sphv_verdict sphv_tally_verdict(const size_t counts[3]);

#endif
