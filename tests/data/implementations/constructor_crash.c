/// Crashes while it is loaded.
#include <stdlib.h>

#include "cubic_spline.h"

__attribute__((constructor)) static void at_load(void)
{
    abort();
}

double kernel_value(double r, double h, int dim)
{
    return right_value(r, h, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim);
}
