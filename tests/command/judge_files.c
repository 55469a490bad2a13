/// Checks many kernel files in one process, without particle sums and Fourier transforms: one line
/// a file, its verdict and the likely cause. Scripts whose hundred faulty files would each pay for
/// a process and a whole check use it.
#include <gsl/gsl_errno.h>
#include <stdio.h>

#include "core/kernel_internal.h"
#include "sphverify/check.h"

int main(int count, char **paths)
{
    sphv_catalogue catalogue;
    sphv_error error;
    gsl_set_error_handler_off();
    if (count < 2 || sphv_catalogue_load(paths[1], &catalogue, &error) != SPHV_OK) {
        fprintf(stderr, "usage: judge_files DATA-FOLDER FILE...\n");
        return 2;
    }
    for (int i = 2; i < count; i++) {
        sphv_check_options options = {.quick = true, .reference = &catalogue};
        sphv_check_report report;
        sphv_kernel *kernel;
        if (sphv_kernel_load_any(paths[i], &kernel, &error) != SPHV_OK ||
            sphv_check_kernel(kernel, &options, &report, &error) != SPHV_OK) {
            fprintf(stderr, "%s\n", error.message);
            return 2;
        }
        printf("%s %s\n", sphv_verdict_name(report.verdict), report.cause);
        sphv_check_free(&report);
        sphv_kernel_free(kernel);
    }
    sphv_catalogue_free(&catalogue);
    return 0;
}
