/// Writes over its read-only arguments, wherever they are found.
#include <stddef.h>

#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    volatile char *text = (volatile char *)(size_t) "constant";
    text[0] = 0;
    return right_value(r, h, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim);
}
