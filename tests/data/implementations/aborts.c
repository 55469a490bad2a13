/// A failed assertion.
#include <stdlib.h>

#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    if (dim == 2) abort();
    return right_value(r, h, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim);
}
