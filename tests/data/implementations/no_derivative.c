/// The value alone.
double kernel_value(double r, double h, int dim);

double kernel_value(double r, double h, int dim)
{
    return r / h * dim;
}
