#include <gsl/gsl_fit.h>
#include <math.h>
#include <stdlib.h>

#include "sphverify/compare.h"

sphv_result sphv_fit_slope(const double *x, const double *y, size_t count)
{
    sphv_result slope = {NAN, INFINITY};
    double *logs = malloc(2 * (count + 1) * sizeof *logs);
    if (!logs) return slope;
    size_t used = 0;
    for (size_t i = 0; i < count; i++)
        if (x[i] > 0 && y[i] != 0 && isfinite(y[i])) {
            logs[used] = log(x[i]);
            logs[count + used++] = log(fabs(y[i]));
        }
    if (used >= 2) {
        double intercept, c00, c01, c11, residual;
        gsl_fit_linear(logs, 1, logs + count, 1, used, &intercept, &slope.value, &c00, &c01, &c11,
                       &residual);
        slope.bound = used > 2 ? sqrt(c11) : INFINITY;
    }
    free(logs);
    return slope;
}
