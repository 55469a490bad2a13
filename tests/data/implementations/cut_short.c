/// Zero from q = 1.8 on.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    return r < 1.8 * h ? right_value(r, h, dim) : 0;
}

double kernel_derivative(double r, double h, int dim)
{
    return r < 1.8 * h ? right_derivative(r, h, dim) : 0;
}
