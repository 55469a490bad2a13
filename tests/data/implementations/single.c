/// Everything in single precision.
double kernel_value(double r, double h, int dim);
double kernel_derivative(double r, double h, int dim);

static float factor(float h, int dim)
{
    const float pi = 3.14159265f;
    return dim == 1 ? 2 / (3 * h) : dim == 2 ? 10 / (7 * pi * h * h) : 1 / (pi * h * h * h);
}

double kernel_value(double r, double h, int dim)
{
    float q = (float)r / (float)h;
    float w = q < 1   ? 1 - 1.5f * q * q + 0.75f * q * q * q
              : q < 2 ? 0.25f * (2 - q) * (2 - q) * (2 - q)
                      : 0;
    return (double)(factor((float)h, dim) * w);
}

double kernel_derivative(double r, double h, int dim)
{
    float q = (float)r / (float)h;
    float w = q < 1 ? -3 * q + 2.25f * q * q : q < 2 ? -0.75f * (2 - q) * (2 - q) : 0;
    return (double)(factor((float)h, dim) / (float)h * w);
}
