/// Fourier transforms against closed forms, and the sign search.
#include <gsl/gsl_math.h>
#include <gsl/gsl_sf_bessel.h>
#include <math.h>
#include <stdio.h>

#include "sphverify/theory.h"
#include "support.h"

static double sinc(double x)
{
    return fabs(x) < 1e-8 ? 1 - x * x / 6 : sin(x) / x;
}

/// The B-spline M_n is the n-fold convolution of the unit box: sinc(Ω/2)^n in one dimension.
static void test_splines_are_powers_of_sinc(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int n;
    } splines[] = {{"quadratic-spline", 3},
                   {"cubic-spline", 4},
                   {"quartic-spline", 5},
                   {"quintic-spline", 6},
                   {"nonic-spline", 10}};
    for (size_t i = 0; i < sizeof splines / sizeof *splines; i++) {
        sphv_kernel *kernel = load_kernel(splines[i].name);
        const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
        for (double omega = 0; omega < 60; omega += 0.37)
            assert_within_bounds(sphv_fourier_transform(profile, omega),
                                 gsl_pow_int(sinc(omega / 2), splines[i].n));
        sphv_kernel_free(kernel);
    }
}

/// (1 − q²/4)^5: 2^(ν) Γ(ν+1) J_ν(2Ω)/(2Ω)^ν with ν = 5 + d/2 (Sonine's integral).
static void test_w10_is_a_bessel_function(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    for (int d = 1; d <= 3; d++) {
        double nu = 5 + 0.5 * d;
        for (double omega = 0.5; omega < 30; omega += 0.31) {
            double x = 2 * omega;
            double expected = pow(2, nu) * tgamma(nu + 1) * gsl_sf_bessel_Jnu(nu, x) / pow(x, nu);
            sphv_result value = sphv_fourier_transform(sphv_kernel_profile(kernel, d), omega);
            // GSL states J_ν to a few parts in 1e13 of its envelope, here at most that of x = ν
            double envelope =
                pow(2, nu) * tgamma(nu + 1) / pow(x, nu) * fmin(1, sqrt(2 / (M_PI * x)));
            assert_close(value.value, expected,
                         value.bound + 1e-12 * fmax(envelope, fabs(expected)));
        }
    }
    sphv_kernel_free(kernel);
}

static void test_gaussian_in_three_dimensions(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("gaussian");
    for (int d = 1; d <= 3; d++) {
        const sphv_profile *profile = sphv_kernel_profile(kernel, d);
        for (double omega = 0; omega < 12; omega += 0.5)
            // what the cut at κ removes is at most the missing mass
            assert_close(sphv_fourier_transform(profile, omega).value, exp(-omega * omega / 4),
                         fabs(profile->excess) + 1e-14);
    }
    sphv_kernel_free(kernel);
}

static void test_at_zero_it_is_the_integral(void **state)
{
    (void)state;
    sphv_catalogue catalogue;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_catalogue_load(data_directory(), &catalogue, &error), error);
    for (size_t i = 0; i < catalogue.count; i++)
        for (int d = 1; d <= 3; d++) {
            const sphv_profile *profile = sphv_kernel_profile(catalogue.kernels[i], d);
            if (!profile) continue;
            sphv_result whole = sphv_fourier_transform(profile, 0);
            assert_close(whole.value, profile->moment[0].value,
                         whole.bound + profile->moment[0].bound);
        }
    sphv_catalogue_free(&catalogue);
}

static void test_first_negative_wavenumber(void **state)
{
    (void)state;
    // sinc(Ω/2)^5 first turns negative at Ω = 2π; sinc^4 never does
    sphv_kernel *kernel = load_kernel("quartic-spline");
    sphv_fourier_sign sign = sphv_fourier_find_sign(sphv_kernel_profile(kernel, 1));
    assert_true(sign.negative);
    // sinc⁵ is flat there: below its bound b it is known to be negative only once
    // ((Ω − 2π)/2π)^5 > b; b is below 1e-14, so within (1e-14)^(1/5) of 2π, relatively
    assert_close(sign.first_negative, 2 * M_PI, 2 * M_PI * pow(1e-14, 0.2));
    assert_true(sign.minimum < 0 && sign.minimum_at > sign.first_negative);
    sphv_kernel_free(kernel);
    kernel = load_kernel("cubic-spline");
    sign = sphv_fourier_find_sign(sphv_kernel_profile(kernel, 1));
    assert_false(sign.negative);
    assert_true(sign.searched > 10);
    sphv_kernel_free(kernel);
    // Wendland's kernels are positive definite: that is what they were made for
    kernel = load_kernel("wendland-c4");
    for (int d = 2; d <= 3; d++)
        assert_false(sphv_fourier_find_sign(sphv_kernel_profile(kernel, d)).negative);
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_splines_are_powers_of_sinc),
        cmocka_unit_test(test_w10_is_a_bessel_function),
        cmocka_unit_test(test_gaussian_in_three_dimensions),
        cmocka_unit_test(test_at_zero_it_is_the_integral),
        cmocka_unit_test(test_first_negative_wavenumber),
    };
    return run_group(tests);
}
