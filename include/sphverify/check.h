/// \file check.h
/// Kernel admission: does a kernel file say the truth about its kernel, and is it a kernel at all?
///
/// A check states a claim (of the file, or one that every kernel must meet), works it out exactly
/// (analytic half), measures it in floating point (empirical half), and judges. A check that fails
/// names the likely cause by trying hypotheses and keeping one that fits to rounding.
#ifndef SPHVERIFY_CHECK_H
#define SPHVERIFY_CHECK_H

#include <stdio.h>

#include "sphverify/compare.h"
#include "sphverify/kernel.h"

/// What one check found.
typedef struct sphv_check_result {
    const char *id;   ///< row of the table of checks
    int dimension;    ///< 1, 2 or 3; 0 when the finding holds in every dimension
    char claim[200];  ///< what is claimed, as a sentence
    double claimed;   ///< the number claimed; NaN when the file claims none
    double analytic;  ///< worked out exactly; NaN when there is no number
    double empirical; ///< measured; NaN when there is no number
    double bound;     ///< |analytic − empirical| may not exceed this
    bool informative; ///< nothing is required of the kernel here: the numbers are stated
    sphv_verdict verdict;
    char cause[400]; ///< likely cause of a failure, or a remark; "" when there is none
} sphv_check_result;

/// All findings on one kernel.
typedef struct sphv_check_report {
    char kernel[72], title[208], path[400];
    sphv_verdict verdict; ///< the worst of all results
    char cause[400];      ///< the likely cause of a failure, the most telling one; "" without one
    size_t count, capacity;
    sphv_check_result *results;
    double seconds;
} sphv_check_report;

/// How to check.
typedef struct sphv_check_options {
    int dimension; ///< only this one; 0: every dimension that the file declares
    /// Only the checks of the file's own numbers: exact arithmetic and quadrature, without particle
    /// sums and Fourier transforms; and the library, where there is one. For the self-test, which
    /// asks whether a defect is caught at all.
    bool quick;
    /// Known kernels, to name the one that a faulty file resembles; may be NULL.
    const sphv_catalogue *reference;
    const char *implementation; ///< path of a user's shared library, or NULL
    double time_limit;          ///< for that library, seconds; 0: the default
} sphv_check_options;

/// Checks a kernel.
/// \param out    receives the report, to be released with sphv_check_free
/// \return SPHV_OK whatever the verdict; SPHV_INVALID_INPUT for a dimension the kernel does not
///         declare; SPHV_RESOURCE_FAILURE
sphv_status sphv_check_kernel(const sphv_kernel *kernel, const sphv_check_options *options,
                              sphv_check_report *out, sphv_error *error) SPHV_MUST_CHECK;
void sphv_check_free(sphv_check_report *report);

/// One row of the table of checks, for listings.
typedef struct sphv_check_row {
    const char *id, *meaning;
} sphv_check_row;

/// The checks in the order of the report; NULL beyond the last.
const sphv_check_row *sphv_check_row_at(size_t index);

/// What the self-test found for one kind of defect.
typedef struct sphv_defect_tally {
    const char *id, *meaning;
    int applied;   ///< variants made that differ from the kernel beyond rounding
    int unchanged; ///< variants that rounding hides (a coefficient 3/4 rounded to three digits)
    int caught;
    int named;         ///< of those, variants whose cause was named too
    char checks[200];  ///< ids of the checks that caught it, by frequency, with counts
    char missed[200];  ///< the first variant that was not caught; "" when there is none
    char unnamed[200]; ///< the first one whose cause was not named
} sphv_defect_tally;

typedef struct sphv_self_test {
    size_t count;
    sphv_defect_tally *defects;
    int kernels;      ///< sound kernels checked
    int false_alarms; ///< of those, kernels that raised something
    char alarm[200];  ///< the first of them
    sphv_verdict verdict;
    double seconds;
} sphv_self_test;

/// Applies every kind of defect to every kernel of a catalogue, on all processors.
sphv_status sphv_check_self_test(const sphv_catalogue *catalogue, sphv_progress progress,
                                 void *context, sphv_self_test *out,
                                 sphv_error *error) SPHV_MUST_CHECK;
void sphv_self_test_free(sphv_self_test *test);

#endif
