#include <stdlib.h>

#include "internal.h"

/// From the smallest h/λ of the paper's figures, 0.0018, up to half a wavelength.
static const double smoothing_lengths[] = {0.0018, 0.005, 0.01, 0.022, 0.05, 0.1, 0.2, 0.35, 0.5};
enum { H_COUNT = sizeof smoothing_lengths / sizeof *smoothing_lengths, N_FIRST = 2, N_LAST = 40 };

static sphv_status evaluate(const sphv_profile *profile, sphv_agreement_cell *cell,
                            sphv_error *error)
{
    sphv_number spacing = sphv_profile_special_spacing(profile, cell->n);
    sphv_status status = sphv_evaluate_point(profile, cell->h, spacing, SPHV_FORM_EXACT, false,
                                             NULL, NULL, &cell->exact, error);
    if (status == SPHV_OK)
        status = sphv_compare_paper(profile, cell->h, spacing, &cell->exact.empirical, &cell->paper,
                                    &cell->paper_verdict, error);
    return status;
}

sphv_status sphv_agreement_run(const sphv_kernel *kernel, sphv_agreement **out, sphv_error *error)
{
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    if (!profile)
        return sphv_fail(error, SPHV_INVALID_INPUT, "kernel '%s': %s", sphv_kernel_name(kernel),
                         sphv_kernel_refusal(kernel, 1));
    sphv_agreement *agreement = calloc(1, sizeof *agreement);
    if (agreement)
        agreement->cells = calloc(H_COUNT * (N_LAST - N_FIRST + 1), sizeof *agreement->cells);
    if (!agreement || !agreement->cells) {
        free(agreement);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    agreement->kernel = kernel;
    agreement->h_count = H_COUNT;
    agreement->n_count = N_LAST - N_FIRST + 1;
    long count = (long)(agreement->h_count * agreement->n_count);
    sphv_status first = SPHV_OK;
#pragma omp parallel for schedule(dynamic, 8)
    for (long i = 0; i < count; i++) {
        sphv_agreement_cell *cell = &agreement->cells[i];
        cell->h = smoothing_lengths[i / (long)agreement->n_count];
        cell->n = N_FIRST + (int)(i % (long)agreement->n_count);
        sphv_error reason;
        sphv_status status = evaluate(profile, cell, &reason);
        if (status != SPHV_OK) {
#pragma omp critical(sphv_agreement_failure)
            {
                first = status;
                sphv_fail(error, status, "%s", reason.message);
            }
        }
    }
    if (first != SPHV_OK) {
        sphv_agreement_free(agreement);
        return first;
    }
    for (long i = 0; i < count; i++) {
        agreement->exact[agreement->cells[i].exact.verdict]++;
        agreement->paper[agreement->cells[i].paper_verdict]++;
    }
    *out = agreement;
    return SPHV_OK;
}

void sphv_agreement_free(sphv_agreement *agreement)
{
    if (!agreement) return;
    free(agreement->cells);
    free(agreement);
}
