/// A program of somebody else's: the error of the gradient at one point through the installed
/// library.
#include <math.h>
#include <sphverify/sphverify.h>
#include <stdio.h>

int main(int argc, char **argv)
{
    sphv_kernel *kernel;
    sphv_error error;
    sphv_point point;
    if (argc != 2 || sphv_kernel_load(argv[1], &kernel, &error) != SPHV_OK) {
        fprintf(stderr, "%s\n", argc == 2 ? error.message : "usage: consumer KERNEL-FILE");
        return 2;
    }
    if (sphv_evaluate_point(sphv_kernel_profile(kernel, 1), 0.02, sphv_number_from_ratio(4, 11),
                            SPHV_FORM_EXACT, false, NULL, NULL, &point, &error) != SPHV_OK) {
        fprintf(stderr, "%s\n", error.message);
        return 2;
    }
    printf("%s: E = %.10e, %s\n", sphv_kernel_name(kernel), point.analytic.total.value,
           sphv_verdict_name(point.verdict));
    sphv_kernel_free(kernel);
    return point.verdict == SPHV_AGREES ? 0 : 1;
}
