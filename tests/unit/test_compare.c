/// Verdicts, fits and the limits of a point.
#include "sphverify/compare.h"

#include <math.h>

#include "support.h"

static sphv_verdict verdict(double a, double bound_a, double e, double bound_e, double scale)
{
    return sphv_compare((sphv_result){a, bound_a}, (sphv_result){e, bound_e}, scale);
}

static void test_verdicts(void **state)
{
    (void)state;
    assert_int_equal(verdict(1, 0, 1, 0, 1), SPHV_AGREES);
    assert_int_equal(verdict(1, 0.002, 1.003, 0.002, 1), SPHV_AGREES);
    assert_int_equal(verdict(1, 0.001, 1.003, 0.001, 1), SPHV_DISAGREES);
    assert_int_equal(verdict(1, 0.006, 1, 0.006, 1), SPHV_INCONCLUSIVE); // 1.2 % could hide
    assert_int_equal(verdict(1, 0.1, 2, 0.1, 1), SPHV_DISAGREES); // wide, but the error shows
    assert_int_equal(verdict(0, 0, 0, 0, 0), SPHV_AGREES);
    assert_int_equal(verdict(0, 1e-20, 0, 0, 0), SPHV_INCONCLUSIVE);
    assert_int_equal(verdict(-1, 0.001, -1, 0.001, -1), SPHV_AGREES); // scale is a size
}

/// What is not a number never agrees.
static void test_nan_never_agrees(void **state)
{
    (void)state;
    const double bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        assert_int_not_equal(verdict(bad[i], 0, 1, 0, 1), SPHV_AGREES);
        assert_int_not_equal(verdict(1, bad[i], 1, 0, 1), SPHV_AGREES);
        assert_int_not_equal(verdict(1, 0, bad[i], 0, 1), SPHV_AGREES);
        assert_int_not_equal(verdict(1, 0, 1, bad[i], 1), SPHV_AGREES);
        assert_int_not_equal(verdict(bad[i], 0, bad[i], 0, 1), SPHV_AGREES);
    }
    assert_int_not_equal(verdict(1, 1e-3, 1, 0, NAN), SPHV_AGREES);
    assert_int_not_equal(verdict(1, -1, 1, 0, 1), SPHV_AGREES); // a negative bound is no bound
}

static void test_worse(void **state)
{
    (void)state;
    static const sphv_verdict order[] = {SPHV_AGREES, SPHV_INCONCLUSIVE, SPHV_DISAGREES};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            assert_int_equal(sphv_verdict_worse(order[i], order[j]), order[i > j ? i : j]);
    assert_string_equal(sphv_verdict_name(SPHV_AGREES), "agrees");
    assert_string_equal(sphv_verdict_name(SPHV_DISAGREES), "disagrees");
    assert_string_equal(sphv_verdict_name(SPHV_INCONCLUSIVE), "inconclusive");
}

static void test_fit_recovers_a_power(void **state)
{
    (void)state;
    enum { COUNT = 30 };
    double x[COUNT], y[COUNT];
    for (int i = 0; i < COUNT; i++) {
        x[i] = pow(1.2, i);
        y[i] = (i % 2 ? -1 : 1) * 0.37 * pow(x[i], 2.385);
    }
    sphv_result slope = sphv_fit_slope(x, y, COUNT);
    // logs carry a few u of their size, at most 12, over an abscissa of length 5
    assert_close(slope.value, 2.385, 64 * 0x1p-53 * 12);
    assert_true(slope.bound < 1e-13);
    y[7] = 0; // a sign change met exactly says nothing about a slope
    y[8] = NAN;
    x[9] = -1;
    assert_close(sphv_fit_slope(x, y, COUNT).value, 2.385, 64 * 0x1p-53 * 12);
}

static void test_fit_of_too_little(void **state)
{
    (void)state;
    const double x[] = {1, 2, 3}, y[] = {1, 4, 9}, none[] = {0, 0, 0};
    assert_true(isnan(sphv_fit_slope(x, y, 0).value));
    assert_true(isnan(sphv_fit_slope(x, y, 1).value));
    assert_close(sphv_fit_slope(x, y, 2).value, 2, 8 * 0x1p-52);
    assert_true(isinf(sphv_fit_slope(x, y, 2).bound)); // two points say nothing of their scatter
    assert_true(isnan(sphv_fit_slope(x, none, 3).value));
    // all at one abscissa: no slope
    const double same[] = {2, 2, 2};
    assert_false(isfinite(sphv_fit_slope(same, y, 3).value));
}

static void test_limits_of_a_point(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    sphv_error error = {SPHV_OK, ""};
    sphv_number half = sphv_number_from_double(0.5);
    assert_ok(sphv_check_point(profile, SPHV_H_MIN, half, &error), error);
    assert_ok(sphv_check_point(profile, SPHV_H_MAX, half, &error), error);
    assert_ok(sphv_check_point(profile, 0.1, sphv_number_from_double(SPHV_SPACING_MIN), &error),
              error);
    const double bad_h[] = {
        0, -0.1, NAN, INFINITY, -INFINITY, 0.99 * SPHV_H_MIN, 1.01 * SPHV_H_MAX};
    for (int i = 0; i < 7; i++)
        assert_failed(sphv_check_point(profile, bad_h[i], half, &error), &error, SPHV_INVALID_INPUT,
                      "h is");
    const double bad_spacing[] = {0, -0.1, NAN, -INFINITY, 0.99 * SPHV_SPACING_MIN};
    for (int i = 0; i < 5; i++)
        assert_failed(
            sphv_check_point(profile, 0.1, sphv_number_from_double(bad_spacing[i]), &error), &error,
            SPHV_INVALID_INPUT, "spacing is");
    const double coarse[] = {2, 2.5, 1e300, INFINITY};
    for (int i = 0; i < 4; i++)
        assert_failed(sphv_check_point(profile, 0.1, sphv_number_from_double(coarse[i]), &error),
                      &error, SPHV_INVALID_INPUT, "no neighbour");
    sphv_point point;
    assert_failed(sphv_evaluate_point(profile, 0.1, sphv_number_from_double(3), SPHV_FORM_EXACT,
                                      false, NULL, NULL, &point, &error),
                  &error, SPHV_INVALID_INPUT, "no neighbour");
    assert_failed(
        sphv_evaluate_point(profile, 0.1, half, SPHV_FORM_PAPER, false, NULL, NULL, &point, &error),
        &error, SPHV_NO_CLOSED_FORM, "paper");
    assert_ok(
        sphv_evaluate_point(profile, 0.1, half, SPHV_FORM_EXACT, true, NULL, NULL, &point, &error),
        error);
    assert_int_equal(point.verdict, SPHV_AGREES);
    assert_close(point.difference, point.analytic.total.value - point.empirical.total.value, 0);
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_verdicts),
        cmocka_unit_test(test_nan_never_agrees),
        cmocka_unit_test(test_worse),
        cmocka_unit_test(test_fit_recovers_a_power),
        cmocka_unit_test(test_fit_of_too_little),
        cmocka_unit_test(test_limits_of_a_point),
    };
    return run_group(tests);
}
