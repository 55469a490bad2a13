/// Fields: derivatives against independent evaluations of the printed formulas, and the parser of
/// polynomials against good text and bad bytes.
#include "sphverify/field.h"

#include <complex.h>
#include <float.h>
#include <gsl/gsl_math.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

#define U (DBL_EPSILON / 2)

/// A bicomplex number a + j b with complex a and b: steps along two imaginary units at once give
/// second derivatives without subtracting (Lantoine, Russell and Dargent 2012).
typedef struct bicomplex {
    double complex a, b;
} bicomplex;

static bicomplex real_number(double x)
{
    return (bicomplex){x, 0};
}
static bicomplex plus(bicomplex p, bicomplex q)
{
    return (bicomplex){p.a + q.a, p.b + q.b};
}
static bicomplex times(bicomplex p, bicomplex q)
{
    return (bicomplex){p.a * q.a - p.b * q.b, p.a * q.b + p.b * q.a};
}
static bicomplex whole_power(bicomplex x, int n)
{
    bicomplex product = real_number(1);
    for (int i = 0; i < n; i++) product = times(product, x);
    return product;
}
/// g(a + jb) = g(a) + j g′(a) b, exact to first order in b: b is a step of 1e-100.
static bicomplex bicomplex_sin(bicomplex x)
{
    return (bicomplex){csin(x.a), ccos(x.a) * x.b};
}
static bicomplex bicomplex_exp(bicomplex x)
{
    return (bicomplex){cexp(x.a), cexp(x.a) * x.b};
}
static bicomplex root(bicomplex x)
{
    double complex a = csqrt(x.a);
    return (bicomplex){a, x.b / (2 * a)};
}

/// The formulas as printed: eqs. 28 and 29 of Sigalotti et al., and the two others.
static bicomplex printed(const char *name, int d, const bicomplex x[3])
{
    bicomplex product = real_number(1), square = real_number(0);
    if (strcmp(name, "sine") == 0) return bicomplex_sin(times(real_number(2 * M_PI), x[0]));
    if (strcmp(name, "f1") == 0) {
        for (int i = 0; i < d; i++)
            product = times(product, bicomplex_sin(times(real_number(M_PI), x[i])));
        return product;
    }
    if (strcmp(name, "gaussian") == 0) {
        for (int i = 0; i < d; i++)
            square = plus(square, whole_power(plus(x[i], real_number(-0.5)), 2));
        return bicomplex_exp(times(real_number(-50), square));
    }
    bicomplex bracket = times(real_number(20), whole_power(x[1], 5));
    bracket = plus(bracket, times(times(real_number(8), x[0]), whole_power(x[1], 3)));
    bracket = plus(bracket, times(whole_power(x[0], 2), whole_power(x[1], 2)));
    return times(times(whole_power(x[0], 2), root(x[0])), plus(bracket, real_number(1)));
}

/// ∂_i∂_j of the printed formula: steps of 1e-100 along i and j of both imaginary units.
static double printed_second(const char *name, int d, const double at[3], int i, int j)
{
    const double step = 1e-100;
    bicomplex x[3];
    for (int k = 0; k < 3; k++)
        x[k] = (bicomplex){at[k] + (k == i ? I * step : 0), k == j ? step : 0};
    return cimag(printed(name, d, x).b) / step / step;
}

static double printed_first(const char *name, int d, const double at[3], int i)
{
    const double step = 1e-100;
    bicomplex x[3];
    for (int k = 0; k < 3; k++) x[k] = (bicomplex){at[k] + (k == i ? I * step : 0), 0};
    return cimag(printed(name, d, x).a) / step;
}

/// Both evaluations round: each of at most 40 operations by u of the largest term, and the
/// arguments of sines and exponentials, of size up to 2π and 50/4·d, by u of their own size.
/// A product of largest terms of the second derivatives: f2 has 20·5·4 y³ = 400, sine (2π)², the
/// bell 100(1 + 25), at most.
static const double largest_term = 2600 * 3;

static void test_printed_formulas(void **state)
{
    (void)state;
    random_start("fields");
    for (const sphv_field_row *row = sphv_fields; row->name; row++)
        for (int d = 1; d <= 3; d++) {
            sphv_field field;
            sphv_error error = {SPHV_OK, ""};
            if (!row->dimensions[d - 1]) {
                assert_failed(sphv_field_parse(row->name, d, &field, &error), &error,
                              SPHV_INVALID_INPUT, "allowed: 2");
                continue;
            }
            assert_ok(sphv_field_parse(row->name, d, &field, &error), error);
            assert_string_equal(field.name, row->name);
            for (int l = 0; l < (quick() ? 50 : 2000); l++) {
                double x[3], got[SPHV_QUANTITIES_MAX];
                for (int i = 0; i < 3; i++) x[i] = l % 10 ? random_uniform(0, 1) : (l / 10 + i) % 2;
                // The singular point of f2 is looked at below; csqrt(0) has no slope.
                if (x[0] == 0) x[0] = 1e-9;
                sphv_field_derivatives(&field, 2, x, got);
                const double tolerance = (40 + 50) * U * largest_term;
                bicomplex there[3] = {real_number(x[0]), real_number(x[1]), real_number(x[2])};
                assert_close(got[0], creal(printed(row->name, d, there).a), tolerance);
                size_t q = 1;
                for (int i = 0; i < d; i++, q++)
                    assert_close(got[q], printed_first(row->name, d, x, i), tolerance);
                for (int i = 0; i < d; i++)
                    for (int j = i; j < d; j++, q++)
                        assert_close(got[q], printed_second(row->name, d, x, i, j), tolerance);
                assert_int_equal(q, sphv_monomial_count(d, 2));
            }
        }
}

/// Higher orders by what they must satisfy: (∂/∂x)^(n+2) = −p² (∂/∂x)^n of a sine; the Gaussian's
/// recursion; x ∂^(n+1) = (p − n) ∂^n of a power; each factor's derivative alone.
static void test_high_orders(void **state)
{
    (void)state;
    random_start("high orders");
    sphv_field sine, bell, f2;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_field_parse("sine", 1, &sine, &error), error);
    assert_ok(sphv_field_parse("gaussian", 1, &bell, &error), error);
    assert_ok(sphv_field_parse("f2", 2, &f2, &error), error);
    for (int l = 0; l < 200; l++) {
        double x[3] = {random_uniform(0.01, 1), random_uniform(0, 1), 0}, s[17], b[17];
        sphv_field_derivatives(&sine, 16, x, s);
        sphv_field_derivatives(&bell, 16, x, b);
        double p = 2 * M_PI, t = (x[0] - 0.5) / 0.1, size = exp(-t * t / 2);
        double absolute[2] = {size, fabs(t) * size / 0.1};
        for (int n = 0; n + 2 <= 16; n++) {
            assert_close(s[n + 2], -p * p * s[n], 40 * U * pow(p, n + 2));
            // g″ = −(t g′ + (n+1) g/w)/w with g = ∂^n; errors are of the size of the recursion run
            // with absolute values, the exponential's argument t²/2 ≤ 12.5 among them
            double expected = -(t * b[n + 1] + (n + 1) * b[n] / 0.1) / 0.1;
            double next = (fabs(t) * absolute[1] + (n + 1) * absolute[0] / 0.1) / 0.1;
            assert_close(b[n + 2], expected, (8 * (n + 3) + 60) * U * next);
            absolute[0] = absolute[1];
            absolute[1] = next;
        }
        // Whole powers end; f2's halves never do. Against each term's falling factorial.
        for (int k = 0; k <= 8; k++)
            for (int m = 0; m <= 6; m++) {
                static const double rows[][3] = {
                    {20, 2.5, 5}, {8, 3.5, 3}, {1, 4.5, 2}, {1, 2.5, 0}};
                long double expected = 0, largest = 0;
                for (int r = 0; r < 4; r++) {
                    long double term = rows[r][0];
                    for (int i = 0; i < k; i++) term *= rows[r][1] - i;
                    for (int i = 0; i < m; i++) term *= rows[r][2] - i;
                    if (term == 0) continue;
                    term *= powl(x[0], rows[r][1] - k) * powl(x[1], rows[r][2] - m);
                    expected += term;
                    largest += fabsl(term);
                }
                double got = sphv_field_derivative(&f2, (const int[]){k, m, 0}, x);
                assert_close(got, (double)expected, (k + m + 12) * U * (double)largest);
            }
    }
}

/// f2 at and beyond its edge: everything to second order exists at x = 0, no more does; to the left
/// there is no such function.
static void test_singular_edge(void **state)
{
    (void)state;
    sphv_field f2;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_field_parse("f2", 2, &f2, &error), error);
    double got[10];
    sphv_field_derivatives(&f2, 2, (const double[]){0, 0.5, 0}, got);
    for (int q = 0; q < 6; q++) assert_close(got[q], 0, 0);
    const double edge[] = {0, 0.5, 0}, corner[] = {0, 0, 0}, outside[] = {-0.01, 0.5, 0};
    assert_true(isinf(sphv_field_derivative(&f2, (const int[]){3, 0, 0}, edge)));
    // The last term, x^(5/2), does not depend on y: its infinity must not meet that zero.
    assert_true(isinf(sphv_field_derivative(&f2, (const int[]){3, 1, 0}, edge)));
    assert_true(!isfinite(sphv_field_derivative(&f2, (const int[]){3, 0, 0}, corner)));
    assert_true(isnan(sphv_field_derivative(&f2, (const int[]){0, 0, 0}, outside)));
    assert_close(sphv_field_derivative(&f2, (const int[]){0, 6, 0}, outside), 0, 0);
    // Whole powers know no edge.
    sphv_field cube;
    assert_ok(sphv_field_parse("x^3*y", 2, &cube, &error), error);
    assert_close(sphv_field_derivative(&cube, (const int[]){0, 0, 0}, outside), -5e-7, 2e-22);
    assert_close(sphv_field_derivative(&cube, (const int[]){3, 1, 0}, edge), 6, 0);
    assert_close(sphv_field_derivative(&cube, (const int[]){4, 0, 0}, edge), 0, 0);
    // Far outside the bell is 0, not 0 times an overflow.
    sphv_field bell;
    assert_ok(sphv_field_parse("gaussian", 1, &bell, &error), error);
    for (int k = 0; k <= 16; k++)
        assert_close(
            sphv_field_derivative(&bell, (const int[]){k, 0, 0}, (const double[]){1e30, 0, 0}), 0,
            0);
}

/// Position and content of the table of monomials agree, in every dimension.
static void test_monomials(void **state)
{
    (void)state;
    static const int second[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0},
                                    {1, 1, 0}, {1, 0, 1}, {0, 2, 0}, {0, 1, 1}, {0, 0, 2}};
    for (int i = 0; i < 10; i++)
        assert_memory_equal(sphv_monomials(3)[i].power, second[i], sizeof second[i]);
    for (int d = 1; d <= 3; d++) {
        const sphv_monomial *table = sphv_monomials(d);
        size_t count = sphv_monomial_count(d, SPHV_MONOMIAL_DEGREE_MAX);
        assert_int_equal(count, d == 1 ? 17 : d == 2 ? 153 : 969);
        assert_int_equal(sphv_monomial_count(d, -1), 0);
        for (size_t m = 0; m < count; m++) {
            int degree = 0;
            double factorial = 1;
            for (int i = 0; i < 3; i++) {
                degree += table[m].power[i];
                assert_true(i < d || table[m].power[i] == 0);
                factorial *= tgamma(table[m].power[i] + 1);
            }
            assert_int_equal(degree, table[m].degree);
            // tgamma of whole numbers up to 17 is exact to a few roundings
            assert_close(table[m].factorial, factorial, 8 * U * factorial);
            assert_true(m == 0 || table[m].degree >= table[m - 1].degree);
            assert_int_equal(sphv_monomial_index(d, table[m].power), m);
        }
    }
}

static double value_of(const char *text, int d, const double *x)
{
    sphv_field field;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_field_parse(text, d, &field, &error), error);
    return sphv_field_derivative(&field, (const int[]){0, 0, 0}, x);
}

static void test_polynomials(void **state)
{
    (void)state;
    const double at[] = {2, 3, 5};
    static const struct {
        const char *text;
        double value;
    } good[] = {
        {"1 - 2*x*y^2 + 0.5*z", 1 - 36 + 2.5},
        {"0", 0},
        {"-x", -2},
        {"+x^0", 1},
        {" \t3/4 * x ^ 2 ", 3},
        {"x*x*y*2*z", 120},
        {"x+x+x-x", 4},
        {"1e2*x-1.5E-1*y", 200 - 0.45},
        {"x^16", 65536},
    };
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        assert_close(value_of(good[i].text, 3, at), good[i].value, 4 * U * 200);
    static const struct {
        const char *text;
        int dimension;
        const char *part;
    } bad[] = {
        {"", 2, "column 1: it ends too soon"},
        {"   ", 2, "column 4: it ends too soon"},
        {"x +", 2, "column 4: it ends too soon"},
        {"x y", 2, "column 3: no sign here"},
        {"2x", 2, "column 2: no sign here"},
        {"x--1", 2, "column 3: no part"},
        {"x*-1", 2, "column 3: no part"},
        {"x^", 2, "column 3: no power"},
        {"x^-1", 2, "column 3: no power"},
        {"x^1.5", 2, "column 4: no sign here"},
        {"x^17", 2, "column 3: too high a power"},
        {"x^99999999999999999999", 2, "column 3: too high a power"},
        {"x^9*x^8", 2, "column 5: too high a power of one coordinate"},
        {"y", 1, "column 1: no part of a polynomial; allowed: a number, x, or"},
        {"x + z", 2, "column 5: no part of a polynomial; allowed: a number, x, y, or"},
        {"cosine", 3, "sine f1 gaussian"},
        {"f3", 2, "sine f1 f2 gaussian"},
        {"1e999*x", 2, "column 1: a number that cannot be read"},
        {"1/0", 2, "column 1: a number that cannot be read"},
        {"x + 1.2.3", 2, "column 5: a number that cannot be read"},
        {"1e200*1e200", 2, "column 1: a coefficient that overflows"},
        {"1e308 + 1e308", 2, "column 9: a coefficient that overflows"},
        {"nan", 2, "column 1"},
        {"x\x80", 2, "column 2"},
        {"x\n", 2, "column 2"},
        {"(x)", 2, "column 1"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sphv_field field;
        sphv_error error = {SPHV_OK, ""};
        assert_failed(sphv_field_parse(bad[i].text, bad[i].dimension, &field, &error), &error,
                      SPHV_INVALID_INPUT, bad[i].part);
    }
    char text[400];
    sphv_field field;
    sphv_error error = {SPHV_OK, ""};
    memset(text, 'x', sizeof text);
    text[sizeof text - 1] = '\0';
    assert_failed(sphv_field_parse(text, 2, &field, &error), &error, SPHV_INVALID_INPUT,
                  "399 characters; allowed: up to 95");
    for (int d = 0; d <= 4; d += 4)
        assert_failed(sphv_field_parse("x", d, &field, &error), &error, SPHV_INVALID_INPUT,
                      "allowed: 1 to 3");
}

/// The longest text makes fewer terms than a field can hold.
static void test_many_terms(void **state)
{
    (void)state;
    char text[96];
    sphv_field field;
    sphv_error error = {SPHV_OK, ""};
    strcpy(text, "1+x+y+z");
    int terms = 4;
    for (int p = 2; strlen(text) + 4 < sizeof text && p < 10; p++)
        for (int i = 0; i < 3 && strlen(text) + 4 < sizeof text; i++, terms++)
            sprintf(text + strlen(text), "+%c^%d", "xyz"[i], p);
    assert_true(terms < SPHV_FIELD_TERMS_MAX);
    assert_ok(sphv_field_parse(text, 3, &field, &error), error);
    assert_int_equal(field.terms, terms);
}

/// Any bytes: refused in one line or a polynomial whose values are what a second reading gives.
static void test_random_bytes(void **state)
{
    (void)state;
    random_start("random polynomials");
    static const char alphabet[] = "xyz0123456789.+-*^/eE \t()q\x80\xff\n";
    int accepted = 0;
    for (int l = 0; l < (quick() ? 2000 : 100000); l++) {
        char text[128];
        size_t length = (size_t)random_integer(0, l % 50 ? 8 : 120);
        size_t letters = l % 2 ? sizeof alphabet - 1 : 22;
        for (size_t i = 0; i < length; i++)
            text[i] = alphabet[random_integer(0, (long)letters - 1)];
        text[length] = '\0';
        sphv_field field;
        sphv_error error = {SPHV_OK, ""};
        if (sphv_field_parse(text, (int)random_integer(1, 3), &field, &error) != SPHV_OK) {
            assert_null(strchr(error.message, '\n'));
            assert_non_null(strstr(error.message, "allowed"));
            continue;
        }
        accepted++;
        assert_true(field.terms >= 1 && field.terms <= SPHV_FIELD_TERMS_MAX);
        double derivatives[10];
        sphv_field_derivatives(&field, 2, (const double[]){0.5, -0.25, 0.125}, derivatives);
        for (size_t q = 0; q < sphv_monomial_count(field.dimension, 2); q++)
            assert_true(!isnan(derivatives[q]));
    }
    assert_true(accepted > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_printed_formulas), cmocka_unit_test(test_high_orders),
        cmocka_unit_test(test_singular_edge),    cmocka_unit_test(test_monomials),
        cmocka_unit_test(test_polynomials),      cmocka_unit_test(test_many_terms),
        cmocka_unit_test(test_random_bytes),
    };
    return run_group(tests);
}
