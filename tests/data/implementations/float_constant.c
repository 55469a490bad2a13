/// The constants are in single precision, the rest is not.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    float factor = (float)cubic_spline_factor(1, dim);
    return (double)factor / cubic_spline_factor(1, dim) * right_value(r, h, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    float factor = (float)cubic_spline_factor(1, dim);
    return (double)factor / cubic_spline_factor(1, dim) * right_derivative(r, h, dim);
}
