/// One coefficient is wrong in the sixth digit.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    double q = r / h;
    return right_value(r, h, dim) +
           cubic_spline_factor(h, dim) * (q < 1 ? 1e-6 * q * q * (1 - q) : 0);
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim);
}
