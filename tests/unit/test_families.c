/// Closed-form families: jets against closed derivatives, bounds against samples.
#include "core/families.h"

#include <gsl/gsl_sf_hermite.h>
#include <math.h>
#include <string.h>

#include "sphverify/kernel.h"
#include "support.h"

static sphv_form form_of(const char *name, int exponent, double support)
{
    return (sphv_form){.family = sphv_family_find(name),
                       .dimension = 1,
                       .exponent = exponent,
                       .support = support,
                       .scale = 1,
                       .transform = 0};
}

/// w^(n)/n! of e^{−q²} is (−1)^n H_n(q) e^{−q²}/n!, with GSL's Hermite polynomials.
static void test_gaussian_against_hermite_polynomials(void **state)
{
    (void)state;
    random_start("Hermite");
    sphv_form form = form_of("gaussian", 0, 3);
    for (int i = 0; i < 100; i++) {
        double q = random_uniform(0, 5), jet[31], factorial = 1;
        sphv_form_jet(&form, q, 30, jet);
        for (int n = 0; n <= 30; n++) {
            if (n) factorial *= n;
            double expected =
                (n % 2 ? -1 : 1) * gsl_sf_hermite_phys(n, q) * exp(-q * q) / factorial;
            // both recurrences are backward stable to n units of the family's own bound
            assert_close(jet[n], expected,
                         (4 * n + 8) * 0x1p-52 * sphv_form_derivative_bound(&form, n));
        }
    }
}

static void test_super_gaussian_is_its_product(void **state)
{
    (void)state;
    random_start("super-Gaussian");
    for (int d = 1; d <= 3; d++) {
        sphv_form form = form_of("super-gaussian", 0, 3);
        form.dimension = d;
        for (int i = 0; i < 50; i++) {
            double q = random_uniform(0, 3), jet[3], g = exp(-q * q), a = 1 + 0.5 * d;
            sphv_form_jet(&form, q, 2, jet);
            double tolerance = 64 * 0x1p-52 * (a + 9);
            assert_close(jet[0], (a - q * q) * g, tolerance);
            assert_close(jet[1], -2 * q * (a + 1 - q * q) * g, tolerance);
            assert_close(2 * jet[2],
                         (-2 * (a + 1) + 4 * (a + 1) * q * q + 6 * q * q - 4 * pow(q, 4)) * g,
                         8 * tolerance);
        }
    }
}

static void test_double_cosine_derivatives(void **state)
{
    (void)state;
    random_start("double cosine");
    sphv_form form = form_of("double-cosine", 0, 2);
    for (int i = 0; i < 100; i++) {
        double q = random_uniform(0, 2), jet[25], factorial = 1;
        sphv_form_jet(&form, q, 24, jet);
        for (int n = 0; n <= 24; n++) {
            if (n) factorial *= n;
            double expected = (4 * pow(M_PI_2, n) * cos(M_PI_2 * q + n * M_PI_2) +
                               pow(M_PI, n) * cos(M_PI * q + n * M_PI_2)) /
                                  factorial +
                              (n == 0 ? 3 : 0);
            // the phases here carry a few u of 2π + nπ/2
            assert_close(jet[n], expected,
                         (40 + 4 * n) * 0x1p-53 * sphv_form_derivative_bound(&form, n));
        }
    }
    // at κ the first four vanish exactly: β = 3 must be found, not nearly found
    double edge[5];
    sphv_form_jet(&form, 2, 4, edge);
    for (int n = 0; n <= 3; n++) assert_close(edge[n], 0, 1e-15);
    assert_true(fabs(edge[4]) > 1);
}

static double sinc_power(double q, double support, int m)
{
    double x = M_PI * q / support;
    return pow(x == 0 ? 1 : sin(x) / x, m);
}

/// (sin x/x)′ = (cos x − sin x/x)/x, whose difference loses u/x: below 0.2 its Taylor series, of
/// which the next term, x^11/518918400, is 4e-17 there.
static double sinc_slope(double x)
{
    double x2 = x * x;
    if (x < 0.2)
        return -x *
               (1.0 / 3 - x2 * (1.0 / 30 - x2 * (1.0 / 840 - x2 * (1.0 / 45360 - x2 / 3991680))));
    return (cos(x) - sin(x) / x) / x;
}

static void test_sinc_values_and_edge_order(void **state)
{
    (void)state;
    random_start("sinc");
    for (int m = 1; m <= 12; m++) {
        sphv_form form = form_of("sinc", m, 2);
        for (int i = 0; i < 30; i++) {
            double q = i ? random_uniform(0, 1.9) : 0, jet[2];
            sphv_form_jet(&form, q, 1, jet);
            double value = sinc_power(q, 2, m);
            assert_close(jet[0], value, (8 + 8 * m) * 0x1p-53);
            double slope = m * sinc_power(q, 2, m - 1) * sinc_slope(M_PI_2 * q) * M_PI_2;
            // the power carries (m + 1)u, sinc_slope 12u of 1, the jet 64 terms of weight 1/64
            assert_close(jet[1], slope, m * M_PI_2 * (40 + 4 * m) * 0x1p-53);
        }
    }
}

/// sup|w^(n)|/n! ≤ bound, sampled over the support, with and without the transform.
static void test_derivative_bounds_hold(void **state)
{
    (void)state;
    random_start("derivative bounds");
    const sphv_form forms[] = {form_of("gaussian", 0, 3),      form_of("super-gaussian", 0, 3),
                               form_of("double-cosine", 0, 2), form_of("sinc", 1, 2),
                               form_of("sinc", 3, 2),          form_of("sinc", 6, 2)};
    for (size_t f = 0; f < sizeof forms / sizeof *forms; f++)
        for (int transformed = 0; transformed < 2; transformed++) {
            sphv_form form = forms[f];
            form.transform = transformed ? 0.4 : 0;
            form.scale = 1.7;
            for (int i = 0; i < 60; i++) {
                double q = random_uniform(0, form.support), jet[SPHV_JET_MAX + 1];
                sphv_form_jet(&form, q, SPHV_JET_MAX, jet);
                for (int n = 0; n <= SPHV_JET_MAX; n++) {
                    double bound = sphv_form_derivative_bound(&form, n);
                    // 1e-13: the jet's rounding, relative to the same bound; below 1e-280 both
                    // are next to underflow
                    if (!(fabs(jet[n]) <= bound * (1 + 1e-13) + 1e-280))
                        fail_msg("%s: |w^(%d)(%g)|/n! is %g, above its bound %g", form.family->name,
                                 n, q, fabs(jet[n]), bound);
                }
            }
        }
}

static void test_finding(void **state)
{
    (void)state;
    int count = 0;
    for (const sphv_family *family = sphv_families; family->name; family++, count++)
        assert_ptr_equal(sphv_family_find(family->name), family);
    assert_true(count >= 4);
    assert_null(sphv_family_find("nonsense"));
    assert_null(sphv_family_find(""));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gaussian_against_hermite_polynomials),
        cmocka_unit_test(test_super_gaussian_is_its_product),
        cmocka_unit_test(test_double_cosine_derivatives),
        cmocka_unit_test(test_sinc_values_and_edge_order),
        cmocka_unit_test(test_derivative_bounds_hold),
        cmocka_unit_test(test_finding),
    };
    return run_group(tests);
}
