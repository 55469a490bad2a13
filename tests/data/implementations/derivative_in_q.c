/// The derivative is taken with respect to q: a factor 1/h is missing.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    return right_value(r, h, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    return h * right_derivative(r, h, dim);
}
