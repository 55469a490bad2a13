/// The nonic B-spline as a sum of truncated powers, the textbook form.
double kernel_value(double r, double h, int dim);
double kernel_derivative(double r, double h, int dim);

static double power(double x, int n)
{
    double product = 1;
    while (n-- > 0) product *= x;
    return product;
}

static double sum(double q, int exponent)
{
    static const double binomial[] = {1, -10, 45, -120, 210};
    double total = 0;
    for (int k = 0; k < 5; k++)
        if (q < 5 - k) total += binomial[k] * power(5 - k - q, exponent);
    return total;
}

static double factor(double h, int dim)
{
    const double pi = 3.14159265358979323846;
    double constant = dim == 1 ? 1. / 362880 : dim == 2 ? 11 / (2922230 * pi) : 1 / (604800 * pi);
    return constant / power(h, dim);
}

double kernel_value(double r, double h, int dim)
{
    return factor(h, dim) * sum(r / h, 9);
}

double kernel_derivative(double r, double h, int dim)
{
    return -9 * factor(h, dim) / h * sum(r / h, 8);
}
