/// The outer piece goes on beyond the support.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    double q = r / h;
    return q < 1 ? right_value(r, h, dim)
                 : cubic_spline_factor(h, dim) * 0.25 * (2 - q) * (2 - q) * (2 - q);
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim);
}
