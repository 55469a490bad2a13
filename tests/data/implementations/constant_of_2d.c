/// In 3D the constant is that of 2D.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    return (dim == 3 ? cubic_spline_factor(1, 2) / cubic_spline_factor(1, 3) : 1) *
           right_value(r, h, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    return (dim == 3 ? cubic_spline_factor(1, 2) / cubic_spline_factor(1, 3) : 1) *
           right_derivative(r, h, dim);
}
