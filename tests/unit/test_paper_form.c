/// The paper's truncated form (eq. 16, mended) against the exact form, and where it fails.
#include <math.h>
#include <stdio.h>

#include "sphverify/theory.h"
#include "support.h"

static sphv_prediction predict(const sphv_profile *profile, double h, sphv_number spacing,
                               sphv_form_of_theory form)
{
    sphv_prediction prediction;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_predict_lattice(profile, h, spacing, form, &prediction, &error), error);
    return prediction;
}

/// For W8 and W10 the edge is the only knot: the form is within its own next-term estimate, and
/// that estimate is asymptotic, not a licence.
static void test_within_its_estimate_for_single_knot_kernels(void **state)
{
    (void)state;
    static const char *const names[] = {"quinlan-w8", "quinlan-w10"};
    for (int k = 0; k < 2; k++) {
        sphv_kernel *kernel = load_kernel(names[k]);
        const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
        for (int n = 4; n <= 40; n++)
            for (double h = 1.8e-3; h < 0.1; h *= 1.5) {
                sphv_number spacing = sphv_profile_special_spacing(profile, n);
                sphv_prediction paper = predict(profile, h, spacing, SPHV_FORM_PAPER),
                                exact = predict(profile, h, spacing, SPHV_FORM_EXACT);
                assert_int_equal(paper.rigour, SPHV_RIGOUR_ASYMPTOTIC);
                assert_int_equal(exact.rigour, SPHV_RIGOUR_EXACT);
                assert_close(paper.total.value, exact.total.value,
                             paper.total.bound + exact.total.bound);
                assert_close(paper.smoothing.value, exact.smoothing.value,
                             paper.smoothing.bound + exact.smoothing.bound);
            }
        sphv_kernel_free(kernel);
    }
}

/// The cubic spline's knot at 1 is not in the paper's analysis: the form must be seen to fail.
static void test_outside_its_estimate_for_the_cubic_spline(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    for (int n = 4; n <= 40; n++) {
        sphv_number spacing = sphv_profile_special_spacing(profile, n);
        sphv_prediction paper = predict(profile, 0.02, spacing, SPHV_FORM_PAPER),
                        exact = predict(profile, 0.02, spacing, SPHV_FORM_EXACT);
        double off = fabs(paper.discretisation.value - exact.discretisation.value);
        assert_true(off > paper.discretisation.bound + exact.discretisation.bound);
        // what is missing is the knot at 1, in its leading term p = 3
        double missing = sphv_euler_maclaurin_term(profile, 1, 0.02, spacing, 3);
        assert_true(fabs(missing) > 0.3 * off);
    }
    sphv_kernel_free(kernel);
}

/// Eq. 16 as printed, its one term written out, has the opposite sign (theory §3): W10, A = x,
/// Δs = 4/7, 4/11, 4/19, 4/31 give +3.62e-3, +2.41e-4, +9.06e-6, +4.80e-7, where 30-digit sums give
/// −3.19e-3, −2.29e-4, −8.91e-6, −4.77e-7. The mended form with the paper's two terms must reach
/// the latter, within its own estimate.
static void test_mended_sign_of_equation_16(void **state)
{
    (void)state;
    static const struct {
        int n;
        double printed, measured, last_digit;
    } table[] = {{3, 3.62e-3, -3.19e-3, 1e-5},
                 {5, 2.41e-4, -2.29e-4, 1e-6},
                 {9, 9.06e-6, -8.91e-6, 1e-8},
                 {15, 4.80e-7, -4.77e-7, 1e-9}};
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    for (int i = 0; i < 4; i++) {
        // K → 0 makes the sine linear; at h = 1e-6 the A‴ terms are K² ~ 4e-11 of the A′ terms
        sphv_number spacing = sphv_number_from_ratio(4, 2 * table[i].n + 1);
        double half_digit = 0.501 * table[i].last_digit;
        assert_close(sphv_euler_maclaurin_term(profile, 0, 1e-6, spacing, 6), -table[i].printed,
                     half_digit);
        sphv_prediction paper = predict(profile, 1e-6, spacing, SPHV_FORM_PAPER);
        assert_close(paper.discretisation.value, table[i].measured,
                     half_digit + paper.discretisation.bound);
        assert_true(paper.discretisation.bound < 0.01 * fabs(table[i].measured));
    }
    sphv_kernel_free(kernel);
}

static void test_other_spacings_have_no_paper_form(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    sphv_prediction prediction;
    sphv_error error = {SPHV_OK, ""};
    assert_failed(sphv_predict_lattice(profile, 0.02, sphv_number_from_double(0.37),
                                       SPHV_FORM_PAPER, &prediction, &error),
                  &error, SPHV_NO_CLOSED_FORM, "0.37");
    assert_failed(sphv_predict_lattice(sphv_kernel_profile(kernel, 2), 0.02,
                                       sphv_number_from_double(0.37), SPHV_FORM_EXACT, &prediction,
                                       &error),
                  &error, SPHV_NO_CLOSED_FORM, "2 dimensions");
    const double bad[] = {0, -1, NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 5; i++) {
        assert_failed(sphv_predict_lattice(profile, bad[i], sphv_number_from_double(0.5),
                                           SPHV_FORM_EXACT, &prediction, &error),
                      &error, SPHV_INVALID_INPUT, "positive");
        assert_failed(sphv_predict_lattice(profile, 0.02, sphv_number_from_double(bad[i]),
                                           SPHV_FORM_EXACT, &prediction, &error),
                      &error, SPHV_INVALID_INPUT, "positive");
    }
    assert_string_equal(sphv_form_name(SPHV_FORM_EXACT), "exact");
    assert_string_equal(sphv_form_name(SPHV_FORM_PAPER), "paper");
    assert_string_equal(sphv_rigour_name(SPHV_RIGOUR_EXACT), "exact");
    assert_string_equal(sphv_rigour_name(SPHV_RIGOUR_ASYMPTOTIC), "asymptotic");
    assert_string_equal(sphv_rigour_name(SPHV_RIGOUR_STATISTICAL), "statistical");
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_within_its_estimate_for_single_knot_kernels),
        cmocka_unit_test(test_outside_its_estimate_for_the_cubic_spline),
        cmocka_unit_test(test_mended_sign_of_equation_16),
        cmocka_unit_test(test_other_spacings_have_no_paper_form),
    };
    return run_group(tests);
}
