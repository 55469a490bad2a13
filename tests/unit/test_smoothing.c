/// The smoothing error against GSL's oscillatory quadrature and closed Fourier transforms.
#include <gsl/gsl_integration.h>
#include <math.h>

#include "sphverify/theory.h"
#include "support.h"

struct integrand {
    const sphv_profile *profile;
    double K;
};

static double f(double s, void *context)
{
    const struct integrand *of = context;
    return -2 * sin(of->K * s) / of->K * sphv_profile_derivative(of->profile, 1, s).value;
}

/// ∫ f ds − 1 by adaptive quadrature over each piece.
static sphv_result by_quadrature(const sphv_profile *profile, double h)
{
    gsl_integration_workspace *space = gsl_integration_workspace_alloc(1000);
    struct integrand of = {profile, 2 * M_PI * h};
    gsl_function function = {f, &of};
    sphv_result sum = {-1, 0};
    for (int i = 0; i < profile->piece_count; i++) {
        double part, error;
        gsl_integration_qag(&function, profile->pieces[i].inner, profile->pieces[i].outer, 1e-15,
                            1e-13, 1000, GSL_INTEG_GAUSS61, space, &part, &error);
        sum.value += part;
        sum.bound += error + 1e-14 * (1 + fabs(part));
    }
    gsl_integration_workspace_free(space);
    return sum;
}

static void test_against_quadrature(void **state)
{
    (void)state;
    random_start("smoothing");
    sphv_catalogue catalogue;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_catalogue_load(data_directory(), &catalogue, &error), error);
    for (size_t i = 0; i < catalogue.count; i++) {
        const sphv_profile *profile = sphv_kernel_profile(catalogue.kernels[i], 1);
        for (int l = 0; profile && l < (quick() ? 2 : 12); l++) {
            double h = random_log(1e-3, 5);
            sphv_result value = sphv_smoothing_error(profile, h), other = by_quadrature(profile, h);
            assert_close(value.value, other.value, value.bound + other.bound);
            // the accuracy promised for the range of the figures
            if (h <= 0.2) assert_true(value.bound <= fmax(1e-12 * fabs(value.value), 1e-14));
        }
    }
    sphv_catalogue_free(&catalogue);
}

/// For kernels continuous at the edge 1 + E_s is the Fourier transform at K: (sin(K/2)/(K/2))^4
/// for the cubic spline. Small h is the test of cancellation.
static void test_cubic_spline_closed_form(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    for (double h = 1e-8; h < 8; h *= 1.7) {
        double x = M_PI * h; // K/2
        sphv_result value = sphv_smoothing_error(profile, h);
        if (x > 0.3) {
            assert_close(value.value, pow(sin(x) / x, 4) - 1, value.bound + 16 * 0x1p-53);
            continue;
        }
        // log of the transform: 4 log(sin x/x) = −4(x²/6 + x⁴/180 + x⁶/2835 + x⁸/37800 + …);
        // the next term is 4·x¹⁰/467775, its successors smaller by x²/π² each
        double x2 = x * x;
        double logarithm = -4 * x2 * (1.0 / 6 + x2 * (1.0 / 180 + x2 * (1.0 / 2835 + x2 / 37800)));
        double neglected = 4 * 1.02 * pow(x, 10) / 467775;
        double expected = expm1(logarithm);
        assert_close(value.value, expected,
                     value.bound + neglected + 16 * 0x1p-53 * fabs(expected));
        assert_true(value.bound <= 1e-13 * fabs(value.value));
    }
    sphv_kernel_free(kernel);
}

/// Whole Gaussian: 1 + E_s = e^{−K²/4}; cutting at κ = 3 changes it by what lies outside, at most
/// ∫_3^∞ |f| ds ≤ 2 ∫_3^∞ s |Ŵ′| ds = 2(3Ŵ(3) + ∫_3^∞ Ŵ ds).
static void test_gaussian_closed_form(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("gaussian");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    double outside = 6 * exp(-9) / sqrt(M_PI) + erfc(3);
    for (double h = 1e-4; h < 2; h *= 1.5) {
        double K = 2 * M_PI * h;
        sphv_result value = sphv_smoothing_error(profile, h);
        assert_close(value.value, expm1(-K * K / 4), value.bound + outside);
    }
    // and as h → 0 exactly that much is missing
    assert_close(sphv_smoothing_error(profile, 1e-9).value, -outside, 1e-15);
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_quadrature),
        cmocka_unit_test(test_cubic_spline_closed_form),
        cmocka_unit_test(test_gaussian_closed_form),
    };
    return run_group(tests);
}
