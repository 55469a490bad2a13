/// Writes to a file.
#include <stdio.h>

#include "cubic_spline.h"

double kernel_value(double r, double h, int dim)
{
    FILE *file = tmpfile();
    if (file) {
        fprintf(file, "%g\n", r);
        fclose(file);
    }
    return right_value(r, h, dim);
}

double kernel_derivative(double r, double h, int dim)
{
    return right_derivative(r, h, dim);
}
