/// h is taken for the support radius.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    return right_value(r, h / 2, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h / 2, dim);
}
