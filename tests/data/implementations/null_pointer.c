/// Reads through a null pointer where q > 1.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    volatile const double *nowhere = 0;
    return r > h ? *nowhere : right_value(r, h, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim);
}
