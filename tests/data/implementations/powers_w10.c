/// Quinlan's W10 in powers of q, in one dimension as the paper prints it but to 17 digits.
double kernel_value(double r, double h, int dim);
double kernel_derivative(double r, double h, int dim);

static double factor(int dim)
{
    const double pi = 3.14159265358979323846;
    return dim == 1 ? 693. / 1024 : dim == 2 ? 1.5 / pi : 9009. / 8192 / pi;
}

static double power(double h, int n)
{
    double product = 1;
    while (n-- > 0) product *= h;
    return product;
}

double kernel_value(double r, double h, int dim)
{
    double q = r / h, s = q * q;
    if (q >= 2) return 0;
    return factor(dim) / power(h, dim) *
           (1 + s * (-1.25 + s * (0.625 + s * (-0.15625 + s * (0.01953125 - s / 1024)))));
}

double kernel_derivative(double r, double h, int dim)
{
    double q = r / h, s = q * q;
    if (q >= 2) return 0;
    return factor(dim) / power(h, dim + 1) * q *
           (-2.5 + s * (2.5 + s * (-0.9375 + s * (0.15625 - s * 10 / 1024))));
}
