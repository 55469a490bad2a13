/// Every result is NaN.
#include <math.h>

#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    (void)r;
    (void)h;
    (void)dim;
    return NAN;
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim);
}
