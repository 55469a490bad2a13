/// The 2D constant is rounded to three digits.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    return (dim == 2 ? 0.455 / cubic_spline_factor(1, 2) : 1) * right_value(r, h, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    return (dim == 2 ? 0.455 / cubic_spline_factor(1, 2) : 1) * right_derivative(r, h, dim);
}
