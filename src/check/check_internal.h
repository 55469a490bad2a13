/// \file check_internal.h
/// Shared by the checks: what they work on, and how they record a finding.
#ifndef SPHVERIFY_CHECK_INTERNAL_H
#define SPHVERIFY_CHECK_INTERNAL_H

#include "core/kernel_internal.h"
#include "sphverify/check.h"

/// A claimed constant counts as exact when it is right to this relative error.
static const double SPHV_CONSTANT_TOLERANCE = 1e-14;

/// One kernel under examination.
typedef struct sphv_examination {
    const sphv_kernel *kernel;
    const sphv_check_options *options;
    sphv_check_report *report;
    int first_dimension; ///< the lowest legal one that is examined; 0 when there is none
    bool shape_varies;   ///< w itself depends on the dimension
    char repair[320];    ///< what a search for the mistake in the pieces found; "" when nothing
    bool repair_sought;
    double claimed_ratio[SPHV_DIMENSIONS]; ///< claimed constant over C_d; 1 without a claim
    /// How exact a claimed constant has to be: 1e-14, and what coefficients of 16 digits or more
    /// leave.
    double tolerance[SPHV_DIMENSIONS];
} sphv_examination;

/// A check of one kernel in one dimension (0 when it is run once for all).
typedef sphv_status (*sphv_check_function)(sphv_examination *of, int dimension, sphv_error *error);

/// Adds a result, with NaN for its numbers and the verdict `agrees`.
/// \param dimension 0: holds in every dimension
/// \return NULL without memory, recorded in `error`
sphv_check_result *sphv_check_add(sphv_examination *of, const char *id, int dimension,
                                  sphv_error *error);

void sphv_check_claim(sphv_check_result *result, const char *format, ...) SPHV_PRINTF(2, 3);
/// Appends to the cause, after "; " when something is there.
void sphv_check_cause(sphv_check_result *result, const char *format, ...) SPHV_PRINTF(2, 3);

/// Sets both halves and their bound; they disagree when further apart than the bound.
void sphv_check_numbers(sphv_check_result *result, double analytic, double empirical, double bound);

/// Records that the requirement itself is not met.
void sphv_check_fail(sphv_check_result *result);

/// The normalised profile of a legal dimension; of the first legal one for 0.
const sphv_profile *sphv_check_profile(const sphv_examination *of, int dimension);

/// The result's dimension when a shape is examined in dimension d: 0 unless the shape varies.
int sphv_check_shape_dimension(const sphv_examination *of, int dimension);

/// Is this a kernel cut off from an infinite one by design?
bool sphv_check_truncated(const sphv_examination *of);

/// Appends what the search for a mistake in the pieces found, or what the kernel resembles.
void sphv_check_name_shape_cause(sphv_examination *of, sphv_check_result *result);

/// The checks. Each file of this folder holds those of one subject.
sphv_status sphv_check_dimension_legality(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_normalisation(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_support(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_peak(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_evenness(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_continuity(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_boundary(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_monotone(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_sign(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_moments(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_smoothing_order(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_derivative(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_truncation(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_truncation_nd(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_order(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_fourier(sphv_examination *of, int dimension, sphv_error *error);
sphv_status sphv_check_implementation(sphv_examination *of, int unused, sphv_error *error);

#endif
