/// Another name for the function.
double my_kernel(double r, double h);

double my_kernel(double r, double h)
{
    return r / h;
}
