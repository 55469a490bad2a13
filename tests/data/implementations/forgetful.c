/// Each call returns something else.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    static int calls = 0;
    return right_value(r, h, dim) * (1 + 1e-3 * (++calls % 7));
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim);
}
