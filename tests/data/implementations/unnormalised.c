/// w(q) without its constant.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    return right_value(r, h, dim) / cubic_spline_factor(1, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim) / cubic_spline_factor(1, dim);
}
