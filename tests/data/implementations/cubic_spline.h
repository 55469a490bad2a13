/// The cubic B-spline, written as a particle code would, for the libraries of this folder.
#ifndef CUBIC_SPLINE_H
#define CUBIC_SPLINE_H

double kernel_value(double r, double h, int dim);
double kernel_derivative(double r, double h, int dim);

/// C_d h^−d
static inline double cubic_spline_factor(double h, int dim)
{
    static const double pi = 3.14159265358979323846;
    return dim == 1 ? 2 / (3 * h) : dim == 2 ? 10 / (7 * pi * h * h) : 1 / (pi * h * h * h);
}

static inline double cubic_spline(double q)
{
    if (q < 1) return 1 - 1.5 * q * q + 0.75 * q * q * q;
    return q < 2 ? 0.25 * (2 - q) * (2 - q) * (2 - q) : 0;
}

static inline double cubic_spline_slope(double q)
{
    if (q < 1) return -3 * q + 2.25 * q * q;
    return q < 2 ? -0.75 * (2 - q) * (2 - q) : 0;
}

static inline double right_value(double r, double h, int dim)
{
    return cubic_spline_factor(h, dim) * cubic_spline(r / h);
}

static inline double right_derivative(double r, double h, int dim)
{
    return cubic_spline_factor(h, dim) / h * cubic_spline_slope(r / h);
}

#endif
