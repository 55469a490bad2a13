/// The checks themselves: that each result is consistent with its own bound, that narrow violations
/// are found exactly, and that what a check calls wrong is wrong.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/constant_text.h"
#include "core/kernel_internal.h"
#include "sphverify/check.h"
#include "support.h"

static sphv_check_report check_in(const sphv_kernel *kernel, int dimension, bool quick_only)
{
    sphv_check_options options = {.dimension = dimension, .quick = quick_only};
    sphv_check_report report;
    sphv_error error;
    assert_ok(sphv_check_kernel(kernel, &options, &report, &error), error);
    return report;
}

static sphv_check_report check(const sphv_kernel *kernel, bool quick_only)
{
    return check_in(kernel, 0, quick_only);
}

static sphv_check_report check_text(const char *text)
{
    sphv_kernel *kernel;
    sphv_error error;
    assert_ok(kernel_from_text(text, &kernel, &error), error);
    sphv_check_report report = check(kernel, true);
    sphv_kernel_free(kernel);
    return report;
}

/// The first result of a row, or one that disagrees when there is such.
static const sphv_check_result *find(const sphv_check_report *report, const char *id)
{
    const sphv_check_result *first = NULL;
    for (size_t i = 0; i < report->count; i++) {
        if (strcmp(report->results[i].id, id) != 0) continue;
        if (report->results[i].verdict == SPHV_DISAGREES) return &report->results[i];
        if (!first) first = &report->results[i];
    }
    assert_non_null(first);
    return first;
}

static void test_constants_are_read(void **state)
{
    (void)state;
    const double pi = acos(-1);
    const struct {
        const char *text;
        double value;
    } cases[] = {
        {"2/3", 2.0 / 3},
        {"10/7/pi", 10 / (7 * pi)},
        {"10 / (7*pi)", 10 / (7 * pi)},
        {"pi^(-1/2)", 1 / sqrt(pi)},
        {"pi^-1.5", 1 / (pi * sqrt(pi))},
        {"1/sqrt(pi)", 1 / sqrt(pi)},
        {"-2^2", -4},
        {"2^-2", 0.25},
        {"2^3^2", 512},
        {"1-2-3", -4},
        {"2+3*4", 14},
        {"8/4/2", 1},
        {"1e-3", 1e-3},
        {".5", 0.5},
        {"1/π", 1 / pi},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        long double value;
        sphv_error error;
        assert_ok(sphv_constant_parse(cases[i].text, &value, &error), error);
        assert_close((double)value, cases[i].value, 4e-16 * fabs(cases[i].value));
    }
}

static void test_other_texts_are_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "",      " ",   "1/0",   "0/0",        "1//2",  "2 3",    "2pi",      "(1",     "1)",
        "nan",   "inf", "0x10",  "1e",         "1e999", "sqrt 2", "sqrt(-1)", "exp(1)", "1;2",
        "pi pi", "--",  "1e400", "(-2)^(1/3)", "%n",    "`id`",   "$(id)",    "\xff"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        long double value;
        sphv_error error;
        assert_failed(sphv_constant_parse(texts[i], &value, &error), &error, SPHV_INVALID_INPUT,
                      "allowed");
    }
    char deep[160];
    memset(deep, '(', sizeof deep - 1);
    deep[sizeof deep - 1] = '\0';
    long double value;
    sphv_error error;
    assert_failed(sphv_constant_parse(deep, &value, &error), &error, SPHV_INVALID_INPUT, "allowed");
    memset(deep, '-', sizeof deep - 1);
    assert_failed(sphv_constant_parse(deep, &value, &error), &error, SPHV_INVALID_INPUT, "allowed");
}

/// Every result of a sound kernel is finite where it must be, and its verdict follows from its
/// numbers: each kernel in one dimension, a third of them in each. The self-test has every
/// dimension of all.
static void test_verdicts_follow_from_numbers(void **state)
{
    (void)state;
    sphv_catalogue catalogue;
    sphv_error error;
    assert_ok(sphv_catalogue_load(data_directory(), &catalogue, &error), error);
    for (size_t k = 0; k < catalogue.count; k++) {
        const sphv_kernel *kernel = catalogue.kernels[k];
        int d = (int)(k % SPHV_DIMENSIONS) + 1;
        sphv_check_report report =
            check_in(kernel, sphv_kernel_profile(kernel, d) ? d : 1, quick());
        if (report.verdict != SPHV_AGREES) print_message("%s\n", report.kernel);
        assert_int_equal(report.verdict, SPHV_AGREES);
        for (size_t i = 0; i < report.count; i++) {
            const sphv_check_result *result = &report.results[i];
            assert_true(strlen(result->claim) > 0);
            assert_true(result->bound >= 0);
            if (isfinite(result->analytic) && isfinite(result->empirical))
                assert_close(result->empirical, result->analytic, result->bound);
            else
                assert_true(result->informative || *result->cause);
        }
        sphv_check_free(&report);
    }
    sphv_catalogue_free(&catalogue);
}

/// w′ = −(q − 1/3)², which touches zero, and the same plus 1e-9: positive within 3e-5 of 1/3, which
/// no sampling sees.
static void test_narrow_violations_are_found(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        char text[400];
        snprintf(text, sizeof text,
                 "name: ripple\ntitle: t\nsupport: 1\ndimensions: [1]\npieces:\n"
                 "  - {until: 1, coefficients: [\"2\", \"%s\", \"1/3\", \"-1/3\"]}\n"
                 "claims: {monotone: true}\n",
                 i ? "-111111110/1000000000" : "-1/9");
        sphv_check_report report = check_text(text);
        const sphv_check_result *monotone = find(&report, "monotone");
        assert_close(monotone->analytic, i ? 0 : 1, 0);
        assert_close(monotone->empirical, i ? 0 : 1, 0);
        assert_int_equal(monotone->verdict, i ? SPHV_DISAGREES : SPHV_AGREES);
        sphv_check_free(&report);
    }
}

/// A double zero is not negative; two zeros a millionth apart are.
static void test_touching_zero_is_not_negative(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        char text[400];
        snprintf(text, sizeof text,
                 "name: touch\ntitle: t\nsupport: 1\ndimensions: [1]\npieces:\n"
                 "  - {until: 1, coefficients: [\"%s\", \"-1\", \"1\"]}\n"
                 "claims: {non_negative: true}\n",
                 i ? "0.249999999999" : "1/4");
        sphv_check_report report = check_text(text);
        assert_int_equal(find(&report, "sign")->verdict, i ? SPHV_DISAGREES : SPHV_AGREES);
        sphv_check_free(&report);
    }
}

/// Constants right to 1e-14 pass, and no more than that.
static void test_tolerance_of_constants(void **state)
{
    (void)state;
    static const struct {
        const char *constant;
        sphv_verdict verdict;
    } cases[] = {
        {"0.66666666666666666", SPHV_AGREES},   // 1e-17 off
        {"0.6666666666666726", SPHV_AGREES},    // 9e-15
        {"0.6666666666666746", SPHV_DISAGREES}, // 1.2e-14
        {"0.6666666666666587", SPHV_DISAGREES}, // −1.2e-14
        {"2/3.0000000000001", SPHV_DISAGREES},  // 3e-14
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[500];
        snprintf(text, sizeof text,
                 "name: c\ntitle: t\nsupport: 2\ndimensions: [1]\npieces:\n"
                 "  - {until: 1, coefficients: [\"1\", \"0\", \"-3/2\", \"3/4\"]}\n"
                 "  - {until: 2, coefficients: [\"2\", \"-3\", \"3/2\", \"-1/4\"]}\n"
                 "constants: {1d: \"%s\"}\n",
                 cases[i].constant);
        sphv_check_report report = check_text(text);
        assert_int_equal(find(&report, "normalisation")->verdict, cases[i].verdict);
        sphv_check_free(&report);
    }
}

/// Coefficients of 17 digits are taken for what they stand for; of 12 digits they are not.
static void test_long_decimals(void **state)
{
    (void)state;
    static const char *const last[] = {"0.66666666666666663", "0.666666666667"};
    for (int i = 0; i < 2; i++) {
        char text[400];
        // (1 − q)²(1 + 2q) · 2/3
        snprintf(text, sizeof text,
                 "name: d\ntitle: t\nsupport: 1\ndimensions: [1]\npieces:\n"
                 "  - {until: 1, coefficients: [\"%s\", \"0\", \"-2\", \"4/3\"]}\n"
                 "claims: {boundary_smoothness: 1, non_negative: true}\n",
                 last[i]);
        sphv_check_report report = check_text(text);
        assert_int_equal(report.verdict, i ? SPHV_DISAGREES : SPHV_AGREES);
        sphv_check_free(&report);
    }
}

/// A dimension that is not declared is refused; one that cannot be normalised is a finding.
static void test_dimensions(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("monaghan-m4-prime");
    sphv_check_options options = {.dimension = 3};
    sphv_check_report report;
    sphv_error error;
    assert_failed(sphv_check_kernel(kernel, &options, &report, &error), &error, SPHV_INVALID_INPUT,
                  "allowed");
    options.dimension = 2;
    assert_ok(sphv_check_kernel(kernel, &options, &report, &error), error);
    for (size_t i = 0; i < report.count; i++)
        assert_true(report.results[i].dimension == 0 || report.results[i].dimension == 2);
    assert_int_equal(report.verdict, SPHV_AGREES);
    sphv_check_free(&report);
    sphv_kernel_free(kernel);
}

/// The numbers of a known kernel, from Quinlan 2006 and elementary integrals.
static void test_numbers_of_the_cubic_spline(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    sphv_check_report report = check(kernel, false);
    assert_close(find(&report, "normalisation")->empirical, 2.0 / 3, 1e-14);
    assert_close(find(&report, "moments")->empirical, 1.0 / 3, 1e-14);
    assert_close(find(&report, "boundary-smoothness")->analytic, 2, 0);
    assert_close(find(&report, "smoothing-order")->analytic, 2, 0);
    // Interior knots decide: order 3, not β + 2 = 4 (theory of this project).
    assert_close(find(&report, "discretisation-order")->analytic, 3, 0);
    assert_close(find(&report, "discretisation-order")->empirical, 3, 0.1);
    sphv_check_free(&report);
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_constants_are_read),
        cmocka_unit_test(test_other_texts_are_refused),
        cmocka_unit_test(test_verdicts_follow_from_numbers),
        cmocka_unit_test(test_narrow_violations_are_found),
        cmocka_unit_test(test_touching_zero_is_not_negative),
        cmocka_unit_test(test_tolerance_of_constants),
        cmocka_unit_test(test_long_decimals),
        cmocka_unit_test(test_dimensions),
        cmocka_unit_test(test_numbers_of_the_cubic_spline),
    };
    return run_group(tests);
}
