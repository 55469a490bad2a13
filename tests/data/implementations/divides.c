/// An integer division by zero.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    volatile int zero = 0;
    return right_value(r, h, dim) * (7 / zero);
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim);
}
