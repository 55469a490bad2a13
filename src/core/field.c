#include "sphverify/field.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/field_parse.h"

const sphv_field_row sphv_fields[] = {
    {"sine", "sin(2 pi x)", "Quinlan, Basa and Lastiwka 2006, the field of section 3", {1, 1, 1}},
    {"f1", "sin(pi x) sin(pi y) sin(pi z)", "Sigalotti et al. 2016, eq. 28", {1, 1, 1}},
    {"f2", "x^(5/2) (20 y^5 + 8 x y^3 + x^2 y^2 + 1)", "Sigalotti et al. 2016, eq. 29", {0, 1, 0}},
    {"gaussian",
     "exp(-|x - c|^2/(2 (1/10)^2)), c the middle of the unit box",
     "this project",
     {1, 1, 1}},
    {NULL, NULL, NULL, {0}},
};

static const double pi = 3.14159265358979323846;
static const sphv_factor one = {SPHV_FACTOR_POWER, 0, 0};

/// A single product of the same factor in each of the first `axes` coordinates.
static void product_field(sphv_field *out, sphv_factor factor, int axes)
{
    out->terms = 1;
    out->term[0].coefficient = 1;
    for (int i = 0; i < SPHV_DIMENSIONS; i++) out->term[0].factor[i] = i < axes ? factor : one;
}

/// Eq. 29 multiplied out.
static void f2_field(sphv_field *out)
{
    static const double rows[][3] = {{20, 2.5, 5}, {8, 3.5, 3}, {1, 4.5, 2}, {1, 2.5, 0}};
    out->terms = sizeof rows / sizeof *rows;
    for (int t = 0; t < out->terms; t++) {
        out->term[t].coefficient = rows[t][0];
        for (int i = 0; i < SPHV_DIMENSIONS; i++)
            out->term[t].factor[i] =
                i < 2 ? (sphv_factor){SPHV_FACTOR_POWER, rows[t][1 + i], 0} : one;
    }
}

static void named_field(const char *name, sphv_field *out)
{
    if (strcmp(name, "sine") == 0)
        product_field(out, (sphv_factor){SPHV_FACTOR_SINE, 2 * pi, 0}, 1);
    else if (strcmp(name, "f1") == 0)
        product_field(out, (sphv_factor){SPHV_FACTOR_SINE, pi, 0}, out->dimension);
    else if (strcmp(name, "f2") == 0)
        f2_field(out);
    else
        product_field(out, (sphv_factor){SPHV_FACTOR_BELL, 0.1, 0.5}, out->dimension);
}

sphv_status sphv_field_parse(const char *text, int dimension, sphv_field *out, sphv_error *error)
{
    if (dimension < 1 || dimension > SPHV_DIMENSIONS)
        return sphv_fail(error, SPHV_INVALID_INPUT, "no field in %d dimensions; allowed: 1 to %d",
                         dimension, SPHV_DIMENSIONS);
    if (strlen(text) >= sizeof out->name)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "field '%.40s...' has %zu characters; allowed: up to %zu", text,
                         strlen(text), sizeof out->name - 1);
    *out = (sphv_field){.dimension = dimension};
    snprintf(out->name, sizeof out->name, "%s", text);
    for (const sphv_field_row *row = sphv_fields; row->name; row++) {
        if (strcmp(row->name, text) != 0) continue;
        if (!row->dimensions[dimension - 1])
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "field '%s' in %d dimension%s; allowed: %s%s%s", text, dimension,
                             dimension > 1 ? "s" : "", row->dimensions[0] ? "1 " : "",
                             row->dimensions[1] ? "2 " : "", row->dimensions[2] ? "3" : "");
        named_field(text, out);
        return SPHV_OK;
    }
    return sphv_field_parse_polynomial(text, out, error);
}

/// x^p, within p + 1 roundings: whole and half powers by multiplication.
static double real_power(double x, double p)
{
    double whole = floor(p), rest = p - whole;
    if (!(p >= 0 && p <= 2 * SPHV_FIELD_POWER_MAX && (rest == 0 || rest == 0.5))) return pow(x, p);
    double product = rest == 0 ? 1 : sqrt(x);
    for (int i = 0; i < (int)whole; i++) product *= x;
    return product;
}

/// d^k/dx^k x^p; exactly 0 when that vanishes everywhere.
static double power_derivative(double p, int k, double x)
{
    double falling = 1;
    for (int i = 0; i < k; i++) falling *= p - i;
    return falling == 0 ? 0 : falling * real_power(x, p - k);
}

/// d^k/dx^k sin(px + phase) = p^k sin(px + phase + kπ/2)
static double sine_derivative(double p, double phase, int k, double x)
{
    double argument = p * x + phase, scale = 1;
    for (int i = 0; i < k; i++) scale *= p;
    double turned = k % 2 ? cos(argument) : sin(argument);
    return (k % 4 < 2 ? scale : -scale) * turned;
}

/// d^k/dx^k exp(−t²/2), t = (x − c)/w, = (−1/w)^k He_k(t) exp(−t²/2); He_{k+1} = t He_k − k
/// He_{k−1}
static double bell_derivative(double width, double centre, int k, double x)
{
    double t = (x - centre) / width, before = 0, hermite = 1, scale = exp(-0.5 * t * t);
    for (int i = 0; i < k; i++) {
        double next = t * hermite - i * before;
        before = hermite;
        hermite = next;
        scale /= -width;
    }
    // Far out the exponential is 0 while the polynomial may have overflown.
    return scale == 0 ? 0 : hermite * scale;
}

static double factor_derivative(const sphv_factor *factor, int k, double x)
{
    switch (factor->kind) {
    case SPHV_FACTOR_POWER:
        return power_derivative(factor->parameter, k, x);
    case SPHV_FACTOR_SINE:
        return sine_derivative(factor->parameter, factor->phase, k, x);
    case SPHV_FACTOR_BELL:
        return bell_derivative(factor->parameter, factor->phase, k, x);
    }
    return NAN;
}

/// Whether the k-th derivative vanishes everywhere: it must not meet another factor's infinity.
static bool vanishes(const sphv_factor *factor, int k)
{
    return factor->kind == SPHV_FACTOR_POWER && factor->parameter < k &&
           factor->parameter == floor(factor->parameter);
}

double sphv_field_derivative(const sphv_field *field, const int order[SPHV_DIMENSIONS],
                             const double x[SPHV_DIMENSIONS])
{
    double sum = 0;
    for (int t = 0; t < field->terms; t++) {
        const sphv_field_term *term = &field->term[t];
        double product = term->coefficient;
        for (int i = 0; i < field->dimension; i++) {
            if (vanishes(&term->factor[i], order[i])) {
                product = 0;
                break;
            }
            product *= factor_derivative(&term->factor[i], order[i], x[i]);
        }
        sum += product;
    }
    return sum;
}

void sphv_field_derivatives(const sphv_field *field, int degree, const double x[SPHV_DIMENSIONS],
                            double *out)
{
    const sphv_monomial *monomials = sphv_monomials(field->dimension);
    size_t count = sphv_monomial_count(field->dimension, degree);
    for (size_t m = 0; m < count; m++) out[m] = sphv_field_derivative(field, monomials[m].power, x);
}

static bool repeats(const sphv_factor *factor)
{
    double periods = factor->parameter / (2 * M_PI);
    if (factor->kind == SPHV_FACTOR_SINE) return periods == floor(periods);
    return factor->kind == SPHV_FACTOR_POWER && factor->parameter == 0;
}

bool sphv_field_is_periodic(const sphv_field *field)
{
    for (int t = 0; t < field->terms; t++)
        for (int i = 0; i < field->dimension; i++)
            if (!repeats(&field->term[t].factor[i])) return false;
    return true;
}
