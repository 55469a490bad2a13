/// The gradient is W′/q, as in ∇W = (W′/q) q.
#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    return right_value(r, h, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    return r > 0 ? right_derivative(r, h, dim) * h / r : 0;
}
