/// Orders: what the knots predict against what fits of measurements give.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sphverify/compare.h"
#include "support.h"

/// The fitted order of the measured discretisation error over special spacings n = first … 4·first,
/// with the smoothing error taken away analytically. h is tiny, so that Taylor terms of the field
/// do not mix orders.
static sphv_result fitted_order(const sphv_profile *profile, int first)
{
    enum { POINTS = 12 };
    double x[POINTS], y[POINTS];
    const double h = 1e-3;
    sphv_error error = {SPHV_OK, ""};
    sphv_result smoothing = sphv_smoothing_error(profile, h);
    for (int i = 0; i < POINTS; i++) {
        // even n only: the fraction at a knot κ/2 then stays 1/4 or 3/4 by turns, of one size
        int n = first + 2 * (i * 3 * first / (2 * (POINTS - 1)));
        sphv_number spacing = sphv_profile_special_spacing(profile, n);
        sphv_measurement measured;
        assert_ok(sphv_measure_lattice(profile, h, spacing, &measured, &error), error);
        x[i] = spacing.value;
        y[i] = measured.total.value - smoothing.value;
        // what is fitted must be well above the measurement's own rounding
        assert_true(fabs(y[i]) > 1e3 * (measured.total.bound + smoothing.bound));
    }
    return sphv_fit_slope(x, y, POINTS);
}

/// Kernels whose only knots are the edge and those of κ/2, and whose leading term is not hidden by
/// a larger next one in the range fitted. The fit differs from the order by what the next term, two
/// orders up, contributes: (Δs/Δs_0)² relative; over n ≥ 12 at most 0.25 of an order.
static void test_fitted_orders_are_the_predicted_ones(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int first;
    } kernels[] = {{"quinlan-w8", 14}, {"quinlan-w10", 8}, {"cubic-spline", 12}, {"gaussian", 40}};
    for (size_t k = 0; k < sizeof kernels / sizeof *kernels; k++) {
        sphv_kernel *kernel = load_kernel(kernels[k].name);
        const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
        sphv_result slope = fitted_order(profile, kernels[k].first);
        int predicted = sphv_predicted_order(profile, true, NULL);
        print_message("%s: predicted %d, fitted %.3f +- %.3f\n", kernels[k].name, predicted,
                      slope.value, slope.bound);
        assert_close(slope.value, predicted, 0.25);
        sphv_kernel_free(kernel);
    }
}

/// β + 2 is what the paper predicts: right for W8 and W10, one too many for the cubic spline, whose
/// measured order must be told apart from it.
static void test_the_cubic_spline_is_of_third_order(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    sphv_result slope = fitted_order(profile, 12);
    assert_int_equal(profile->boundary_smoothness + 2, 4);
    assert_true(slope.value < 3.5);
    int knot = -1;
    assert_int_equal(sphv_predicted_order(profile, true, &knot), 3);
    assert_close(profile->knots[knot].position.value, 1, 0);
    sphv_kernel_free(kernel);
}

/// Second order in h where smoothing dominates, and a floor where discretisation does.
static void test_smoothing_order_and_floor(void **state)
{
    (void)state;
    enum { POINTS = 20 };
    double h[POINTS], high[POINTS], low[POINTS];
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    sphv_error error = {SPHV_OK, ""};
    sphv_number fine = sphv_profile_special_spacing(profile, 40),
                coarse = sphv_profile_special_spacing(profile, 4);
    for (int i = 0; i < POINTS; i++) {
        sphv_measurement measured;
        h[i] = 0.005 * pow(10, i / (POINTS - 1.0));
        assert_ok(sphv_measure_lattice(profile, h[i], fine, &measured, &error), error);
        high[i] = measured.total.value;
        assert_ok(sphv_measure_lattice(profile, h[i] / 100, coarse, &measured, &error), error);
        low[i] = measured.total.value;
    }
    // E_s = −K²μ₂/2 + K⁴μ₄/24: at h ≤ 0.05 the second is below K²/12 < 1 % of the first; so is the
    // share of an order by which it bends the slope, twice over
    assert_close(sphv_fit_slope(h, high, POINTS).value, 2, 0.02);
    // the floor: E_d of Δs = 4/9 is 6e-4, E_s at h ≤ 5e-4 below 2e-6
    assert_close(sphv_fit_slope(h, low, POINTS).value, 0, 0.01);
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fitted_orders_are_the_predicted_ones),
        cmocka_unit_test(test_the_cubic_spline_is_of_third_order),
        cmocka_unit_test(test_smoothing_order_and_floor),
    };
    return run_group(tests);
}
