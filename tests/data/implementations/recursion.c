/// Recurses for ever.
#include "cubic_spline.h"

#if defined(__GNUC__) && __GNUC__ >= 12 && !defined(__clang__)
#pragma GCC diagnostic ignored "-Winfinite-recursion"
#endif

static double (*volatile again)(double r, double h, int dim) = kernel_value;

static double deeper(double r, double h, int dim)
{
    return 1 + again(r, h, dim);
}

double kernel_value(double r, double h, int dim)
{
    return deeper(r, h, dim) + 1;
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim);
}
