/// The compiled profile against exact rational evaluation, GSL quadrature and closed forms.
#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

static sphv_catalogue catalogue;

static int load_catalogue(void **state)
{
    (void)state;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_catalogue_load(data_directory(), &catalogue, &error), error);
    return catalogue.count >= 4 ? 0 : -1;
}

static int free_catalogue(void **state)
{
    (void)state;
    sphv_catalogue_free(&catalogue);
    return 0;
}

/// Calls `check` with every profile of the catalogue.
static void each_profile(void (*check)(const sphv_kernel *, const sphv_profile *))
{
    for (size_t i = 0; i < catalogue.count; i++)
        for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
            const sphv_profile *profile = sphv_kernel_profile(catalogue.kernels[i], d);
            if (profile) check(catalogue.kernels[i], profile);
        }
}

static void check_derivatives(const sphv_kernel *kernel, const sphv_profile *profile)
{
    for (int i = 0; i < (quick() ? 3 : 40); i++) {
        // uniform, and crowded towards the edge, where cancellation would show
        double q = i % 2 ? random_uniform(0, profile->support)
                         : profile->support * (1 - random_log(1e-9, 1));
        for (int n = 0; n <= 12; n++) {
            double exact;
            if (!sphv_kernel_exact_value(kernel, profile->dimension, n, q, &exact)) return;
            sphv_result value = sphv_profile_derivative(profile, n, q);
            // sphv_kernel_exact_value rounds twice, once by π
            value.bound += 3 * 0x1p-53 * fabs(exact);
            assert_within_bounds(value, exact);
        }
    }
}

static void test_derivatives_agree_with_exact_arithmetic(void **state)
{
    (void)state;
    random_start("derivatives");
    each_profile(check_derivatives);
}

static void check_outside(const sphv_kernel *kernel, const sphv_profile *profile)
{
    (void)kernel;
    for (int n = 0; n <= 20; n++) {
        assert_close(sphv_profile_derivative(profile, n, profile->support).value, 0, 0);
        assert_close(sphv_profile_derivative(profile, n, 1e6).value, 0, 0);
    }
}

static void test_nothing_outside_the_support(void **state)
{
    (void)state;
    each_profile(check_outside);
}

/// A jet is the derivatives over factorials, and its Taylor sum is the value nearby.
static void check_jets(const sphv_kernel *kernel, const sphv_profile *profile)
{
    (void)kernel;
    for (int i = 0; i < profile->piece_count; i++) {
        const sphv_piece *piece = &profile->pieces[i];
        double jet[SPHV_JET_MAX + 1], length = piece->outer - piece->inner;
        double about = piece->inner + length * random_uniform(0.2, 0.8);
        sphv_profile_jet(profile, i, about, SPHV_JET_MAX, jet);
        double step = 0.05 * length, sum = 0, size = 0;
        for (int n = 60; n >= 0; n--) {
            sum = sum * step + jet[n];
            size = size * step + fabs(jet[n]);
            // the bound that the theory relies on; 1e-12 is far above the jet's own rounding
            assert_true(fabs(jet[n]) <= piece->derivative_bound[n] * (1 + 1e-12) + 1e-290);
        }
        sphv_result value = sphv_profile_derivative(profile, 0, about + step);
        double tail = 2 * piece->derivative_bound[61] * pow(step, 61);
        assert_close(sum, value.value,
                     value.bound + tail + 64 * 0x1p-52 * size +
                         8 * 0x1p-53 * 3 * piece->derivative_bound[1]);
    }
}

static void test_jets_are_taylor_series(void **state)
{
    (void)state;
    random_start("jets");
    each_profile(check_jets);
}

/// ∫|s|^j Ŵ dV as GSL's adaptive quadrature sees it.
struct moment {
    const sphv_profile *profile;
    int power, derivative;
};

static double moment_integrand(double q, void *context)
{
    const struct moment *of = context;
    return pow(q, of->power) * sphv_profile_derivative(of->profile, of->derivative, q).value;
}

static sphv_result integrate(const sphv_profile *profile, int derivative, int power)
{
    static const double surface[] = {2, 2 * M_PI, 4 * M_PI};
    gsl_integration_workspace *space = gsl_integration_workspace_alloc(200);
    sphv_result sum = {0, 0};
    for (int i = 0; i < profile->piece_count; i++) {
        struct moment of = {profile, power, derivative};
        gsl_function f = {moment_integrand, &of};
        double part, error;
        gsl_integration_qag(&f, profile->pieces[i].inner, profile->pieces[i].outer, 1e-14, 1e-12,
                            200, GSL_INTEG_GAUSS61, space, &part, &error);
        sum.value += surface[profile->dimension - 1] * part;
        sum.bound += surface[profile->dimension - 1] * (error + 1e-14 * fabs(part));
    }
    gsl_integration_workspace_free(space);
    return sum;
}

static void check_moments(const sphv_kernel *kernel, const sphv_profile *profile)
{
    (void)kernel;
    int d = profile->dimension;
    for (int j = 0; j <= (quick() ? 2 : 16); j += 2) {
        sphv_result m = integrate(profile, 0, j + d - 1);
        assert_close(profile->moment[j].value, m.value, profile->moment[j].bound + m.bound);
        sphv_result slope = integrate(profile, 1, j + d);
        assert_close(profile->slope_moment[j].value, -slope.value / (j + d),
                     profile->slope_moment[j].bound + slope.bound / (j + d));
    }
    assert_close(profile->excess, profile->moment[0].value - 1, profile->moment[0].bound + 0x1p-52);
    assert_close(profile->slope_excess, profile->slope_moment[0].value - 1,
                 profile->slope_moment[0].bound + 0x1p-52);
}

static void test_moments_agree_with_quadrature(void **state)
{
    (void)state;
    each_profile(check_moments);
}

/// The excess of a truncated Gaussian is −erfc(κ) in one dimension, −e^{−κ²} in two, and
/// −erfc(κ) − 2κe^{−κ²}/√π in three.
static void test_truncated_gaussian_by_closed_forms(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("gaussian");
    double k = sphv_kernel_profile(kernel, 1)->support;
    double missing[] = {erfc(k), exp(-k * k), erfc(k) + 2 * k * exp(-k * k) / sqrt(M_PI)};
    for (int d = 1; d <= 3; d++) {
        const sphv_profile *profile = sphv_kernel_profile(kernel, d);
        // 64 units in the last place: the quadrature's own bound, relative to the tail
        assert_close(profile->excess, -missing[d - 1], 64 * 0x1p-52 * missing[d - 1]);
        assert_within_bounds(profile->constant, pow(M_PI, -0.5 * d));
        assert_int_equal(profile->boundary_smoothness, -1);
    }
    sphv_kernel_free(kernel);
}

static double evaluate_claim(const char *text)
{
    // "a", "a/b", "a/b/pi": the forms that the shipped files use
    double value = strtod(text, (char **)&text);
    while (*text == '/') {
        text++;
        value /= strncmp(text, "pi", 2) == 0 ? M_PI : strtod(text, (char **)&text);
        if (strncmp(text, "pi", 2) == 0) text += 2;
    }
    if (*text) fail_msg("constant not understood: '%s'", text);
    return value;
}

static void test_claims_of_the_shipped_kernels_hold(void **state)
{
    (void)state;
    for (size_t i = 0; i < catalogue.count; i++) {
        const sphv_kernel *kernel = catalogue.kernels[i];
        const sphv_kernel_claims *claims = sphv_kernel_get_claims(kernel);
        for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
            const sphv_profile *profile = sphv_kernel_profile(kernel, d);
            if (!profile) {
                assert_true(sphv_kernel_refusal(kernel, d)[0]);
                continue;
            }
            if (claims->constant[d - 1]) {
                // catalogue constants carry at least 12 digits
                double claimed = evaluate_claim(claims->constant[d - 1]);
                assert_close(profile->constant.value, claimed, 1e-11 * claimed);
            }
            if (claims->boundary_smoothness)
                assert_int_equal(profile->boundary_smoothness, *claims->boundary_smoothness);
        }
    }
}

static void test_special_spacings(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    for (int n = 1; n <= 100; n++) {
        sphv_number spacing = sphv_profile_special_spacing(profile, n),
                    expected = sphv_number_from_ratio(4, 2 * n + 1);
        assert_close(spacing.value, expected.value, 0);
        assert_close(spacing.residual, expected.residual, 0);
        assert_int_equal(sphv_number_place(profile->support_exact, spacing).inside, n);
    }
    sphv_kernel_free(kernel);
}

/// Knots of the cubic spline: the third derivative jumps at 0, 1 and 2 by amounts known by hand.
static void test_knots_of_the_cubic_spline(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    assert_int_equal(profile->knot_count, 3);
    // Ŵ‴/3!: 1/2 on (0, 1), −1/6 beyond, −1/2 left of the origin
    const double jumps[] = {-1, 2.0 / 3, -1.0 / 6};
    for (int i = 0; i < 3; i++) {
        assert_close(profile->knots[i].position.value, i, 0);
        assert_int_equal(profile->knots[i].order, 3);
        assert_close(profile->knots[i].jump[3], jumps[i], 0x1p-52);
    }
    assert_int_equal(profile->boundary_smoothness, 2);
    sphv_kernel_free(kernel);
    kernel = load_kernel("quinlan-w10");
    profile = sphv_kernel_profile(kernel, 1);
    assert_int_equal(profile->knot_count, 1); // smooth at the origin: the edge alone
    assert_int_equal(profile->knots[0].order, 5);
    sphv_kernel_free(kernel);
}

static void test_exact_texts(void **state)
{
    (void)state;
    char text[200];
    sphv_kernel *kernel = load_kernel("cubic-spline");
    static const char *const constants[] = {"2/3", "10/7/pi", "1/pi"};
    for (int d = 1; d <= 3; d++) {
        sphv_kernel_constant_text(kernel, d, text, sizeof text);
        assert_true(strcmp(text, constants[d - 1]) == 0 || (d == 3 && strcmp(text, "1/1/pi") == 0));
    }
    sphv_kernel_moment_text(kernel, 1, 2, text, sizeof text);
    assert_string_equal(text, "1/3"); // variance of the sum of four uniform variables
    sphv_kernel_moment_text(kernel, 1, 0, text, sizeof text);
    assert_string_equal(text, "1");
    char small[4];
    sphv_kernel_moment_text(kernel, 3, 40, small, sizeof small);
    assert_string_equal(small, ""); // what does not fit is not printed by half
    sphv_kernel_constant_text(kernel, 4, text, sizeof text);
    assert_string_equal(text, "");
    sphv_kernel_free(kernel);
    kernel = load_kernel("gaussian");
    sphv_kernel_constant_text(kernel, 1, text, sizeof text);
    assert_string_equal(text, "");
    double unused;
    assert_false(sphv_kernel_exact_value(kernel, 1, 0, 0.5, &unused));
    sphv_kernel_free(kernel);
}

static void test_dimensions_outside_the_range(void **state)
{
    (void)state;
    const sphv_kernel *kernel = catalogue.kernels[0];
    assert_null(sphv_kernel_profile(kernel, 0));
    assert_null(sphv_kernel_profile(kernel, 4));
    assert_null(sphv_kernel_profile(kernel, -1));
    assert_true(sphv_kernel_refusal(kernel, 4)[0]);
    assert_null(sphv_kernel_gradient(kernel, 1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_derivatives_agree_with_exact_arithmetic),
        cmocka_unit_test(test_nothing_outside_the_support),
        cmocka_unit_test(test_jets_are_taylor_series),
        cmocka_unit_test(test_moments_agree_with_quadrature),
        cmocka_unit_test(test_truncated_gaussian_by_closed_forms),
        cmocka_unit_test(test_claims_of_the_shipped_kernels_hold),
        cmocka_unit_test(test_special_spacings),
        cmocka_unit_test(test_knots_of_the_cubic_spline),
        cmocka_unit_test(test_exact_texts),
        cmocka_unit_test(test_dimensions_outside_the_range),
    };
    tests_begin();
    return cmocka_run_group_tests(tests, load_catalogue, free_catalogue);
}
