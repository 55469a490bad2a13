/// Single precision inside, double results: w(q) is a float, its factor is not.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    float q = (float)(r / h);
    float w = q < 1   ? 1 - 1.5f * q * q + 0.75f * q * q * q
              : q < 2 ? 0.25f * (2 - q) * (2 - q) * (2 - q)
                      : 0;
    return cubic_spline_factor(h, dim) * (double)w;
}

double kernel_derivative(double r, double h, int dim)
{
    float q = (float)(r / h);
    float w = q < 1 ? -3 * q + 2.25f * q * q : q < 2 ? -0.75f * (2 - q) * (2 - q) : 0;
    return cubic_spline_factor(h, dim) / h * (double)w;
}
