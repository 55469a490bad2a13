/// The generalised Euler–Maclaurin series against Poisson's and against a plain sum.
#include <gsl/gsl_sf_zeta.h>
#include <math.h>
#include <stdio.h>

#include "sphverify/theory.h"
#include "support.h"

/// Kernels with knots of every kind: smooth inside, knots inside, value jump, order-1 edge.
static const char *const names[] = {
    "quinlan-w10",       "quinlan-w8",  "cubic-spline", "gaussian",     "johnson-quadratic",
    "monaghan-m4-prime", "wendland-c2", "sinc-3",       "double-cosine"};
enum { NAMES = sizeof names / sizeof *names };

/// 1 + E as anyone would write it, in long double.
static sphv_result plain_sum(const sphv_profile *profile, double h, sphv_number spacing)
{
    long double sum = -1, size = 1;
    long inside = sphv_number_place(profile->support_exact, spacing).inside;
    for (long j = 1; j <= inside; j++) {
        double q = (double)j * spacing.value;
        sphv_result slope = sphv_profile_derivative(profile, 1, q);
        double curve = sphv_profile_derivative(profile, 2, q).value;
        long double weight = 2 * spacing.value * sin(2 * M_PI * h * q) / (2 * M_PI * h);
        sum -= weight * slope.value;
        // slope's bound, q's rounding (one u of q, and the residual of the spacing), sine and
        // weight
        size +=
            fabsl(weight) * (slope.bound * 0x1p53 + 2 * fabs(curve) * q + 12 * fabs(slope.value));
    }
    return (sphv_result){(double)sum, (double)(size * 0x1p-53)};
}

static void test_series_poisson_and_sum_agree(void **state)
{
    (void)state;
    random_start("three routes");
    for (int k = 0; k < NAMES; k++) {
        sphv_kernel *kernel = load_kernel(names[k]);
        const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
        for (int i = 0; i < (quick() ? 2 : 20); i++) {
            double h = random_log(2e-3, 0.4);
            // not a divisor of a knot, where Poisson's tail does not converge for value jumps
            sphv_number spacing = sphv_number_from_double(random_uniform(0.05, 0.9));
            sphv_result smoothing = sphv_smoothing_error(profile, h);
            sphv_result series = sphv_discretisation_error(profile, h, spacing, NULL, NULL);
            sphv_result poisson = sphv_predict_poisson(profile, h, spacing, 40);
            sphv_result sum = plain_sum(profile, h, spacing);
            double total = smoothing.value + series.value,
                   bound = smoothing.bound + series.bound + 0x1p-52 * fabs(total);
            assert_close(total, sum.value, bound + sum.bound);
            assert_close(total, poisson.value, bound + poisson.bound);
            assert_close(poisson.value, sum.value, sum.bound + poisson.bound);
        }
        sphv_kernel_free(kernel);
    }
}

/// Poisson's bound must be telling, not merely true: below 1 % of the error it is to check, which
/// is what the comparator asks of any bound.
static void test_poisson_is_telling(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    for (double step = 0.3; step < 1; step += 0.07) {
        sphv_number spacing = sphv_number_from_double(step);
        sphv_result poisson = sphv_predict_poisson(profile, 0.02, spacing, 20);
        assert_true(poisson.bound < 0.01 * fabs(poisson.value));
    }
    sphv_kernel_free(kernel);
}

/// Knots on the lattice: the bound may be infinite there, for kernels whose slope jumps on a
/// particle, but it is never NaN.
static void test_poisson_with_knots_on_the_lattice(void **state)
{
    (void)state;
    for (int k = 0; k < NAMES; k++) {
        sphv_kernel *kernel = load_kernel(names[k]);
        const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
        sphv_number spacing = sphv_number_from_ratio(1, 2);
        sphv_result poisson = sphv_predict_poisson(profile, 0.05, spacing, 20),
                    sum = plain_sum(profile, 0.05, spacing);
        assert_false(isnan(poisson.value) || isnan(poisson.bound));
        assert_true(fabs(poisson.value - sum.value) <= poisson.bound + sum.bound);
        sphv_kernel_free(kernel);
    }
}

/// The terms by hand for the cubic spline at the special spacing 4/11, kh = 0.04π (theory §3):
/// the knots 0, 1 and 2 together give −2.997e-3 at p = 3 and −3.45e-4 at p = 4.
static void test_cubic_spline_terms(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    sphv_number spacing = sphv_number_from_ratio(4, 11);
    double sum[5] = {0};
    for (int p = 1; p <= 4; p++)
        for (int knot = 0; knot < profile->knot_count; knot++)
            sum[p] += sphv_euler_maclaurin_term(profile, knot, 0.02, spacing, p);
    assert_close(sum[1], 0, 0);
    assert_close(sum[2], 0, 0);
    assert_close(sum[3], -2.997e-3, 0.5e-6); // all printed digits
    assert_close(sum[4], -3.45e-4, 0.5e-6);
    // p = 3 comes from the knot at 1 alone: the fraction there is 3/4, at 2 a half, at 0 none
    double middle = sphv_euler_maclaurin_term(profile, 1, 0.02, spacing, 3);
    assert_close(sum[3], middle, 0);
    // by hand: f″ jumps by −sin(K)/K·4, B̄_3(3/4)/3! = −1/128, two knots, minus sign, Δs³
    double K = 0.04 * M_PI;
    double by_hand = -2 * pow(4.0 / 11, 3) * (-1.0 / 128) * (-sin(K) / K * 4);
    assert_close(middle, by_hand, 16 * 0x1p-53 * fabs(by_hand));
    sphv_kernel_free(kernel);
}

/// The whole discretisation error of W10 for A = x (K → 0) at Δs = 4/7, 4/11, …: measured in
/// theory §3 by 30-digit sums.
static void test_w10_for_a_linear_field(void **state)
{
    (void)state;
    static const struct {
        int n;
        double measured, last_digit;
    } table[] = {
        {3, -3.19e-3, 1e-5}, {5, -2.29e-4, 1e-6}, {9, -8.91e-6, 1e-8}, {15, -4.77e-7, 1e-9}};
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    for (int i = 0; i < 4; i++) {
        // h = 1e-6: the field's curvature adds K² ~ 4e-11, below every digit printed
        sphv_result value = sphv_discretisation_error(
            profile, 1e-6, sphv_number_from_ratio(4, 2 * table[i].n + 1), NULL, NULL);
        assert_close(value.value, table[i].measured, 0.51 * table[i].last_digit + 1e-10);
        assert_true(value.bound < 1e-6 * fabs(value.value));
    }
    sphv_kernel_free(kernel);
}

static void test_predicted_orders(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int special, any;
    } expected[] = {
        {"quinlan-w10", 6, 5}, {"quinlan-w8", 4, 3}, {"cubic-spline", 3, 3}, {"gaussian", 2, 1}};
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        sphv_kernel *kernel = load_kernel(expected[i].name);
        const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
        int knot = -1;
        assert_int_equal(sphv_predicted_order(profile, true, &knot), expected[i].special);
        assert_true(knot >= 0 && knot < profile->knot_count);
        assert_int_equal(sphv_predicted_order(profile, false, NULL), expected[i].any);
        sphv_kernel_free(kernel);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_series_poisson_and_sum_agree),
        cmocka_unit_test(test_poisson_is_telling),
        cmocka_unit_test(test_poisson_with_knots_on_the_lattice),
        cmocka_unit_test(test_cubic_spline_terms),
        cmocka_unit_test(test_w10_for_a_linear_field),
        cmocka_unit_test(test_predicted_orders),
    };
    return run_group(tests);
}
