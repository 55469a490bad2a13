/// Never returns where q > 1.5.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    volatile double x = r;
    while (x > 1.5 * h) x = r;
    return right_value(r, h, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim);
}
