/// Compiled kernels, right and wrong, through `check --implementation`: every defect is noticed and
/// named, and right ones, in double or single precision and in any usual form, raise nothing.
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "check/implementation.h"
#include "sphverify/check.h"

static void library_path(char *path, size_t size, const char *name)
{
    const char *folder = getenv("SPHVERIFY_TEST_MODULES");
    assert_non_null(folder);
    snprintf(path, size, "%s/%s.so", folder, name);
}

static void check_library(const char *kernel_name, const char *library, double time_limit,
                          sphv_check_report *report)
{
    char path[1024];
    sphv_error error;
    library_path(path, sizeof path, library);
    sphv_kernel *kernel = load_kernel(kernel_name);
    // the kernel file itself is sound, and checked elsewhere
    sphv_check_options options = {.quick = true, .implementation = path, .time_limit = time_limit};
    assert_ok(sphv_check_kernel(kernel, &options, report, &error), error);
    sphv_kernel_free(kernel);
}

/// Does the result belong to the library, not to the file?
static bool concerns_library(const sphv_check_result *result)
{
    return strncmp(result->id, "implementation", strlen("implementation")) == 0;
}

static void test_right_libraries_raise_nothing(void **state)
{
    (void)state;
    static const struct {
        const char *kernel, *library;
        bool single;
    } cases[] = {
        {"cubic-spline", "right", false},
        {"quinlan-w10", "powers_w10", false},
        {"nonic-spline", "truncated_powers_m10", false},
        {"cubic-spline", "single", true},
        {"cubic-spline", "single_inside", true},
        {"cubic-spline", "prints", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sphv_check_report report;
        check_library(cases[i].kernel, cases[i].library, 60, &report);
        size_t seen = 0;
        for (size_t k = 0; k < report.count; k++) {
            const sphv_check_result *result = &report.results[k];
            if (!concerns_library(result)) continue;
            if (result->verdict != SPHV_AGREES)
                print_error("%s: %s in %dD: %s (%.17g, %.17g, bound %.3g)\n", cases[i].library,
                            result->id, result->dimension, result->cause, result->analytic,
                            result->empirical, result->bound);
            assert_int_equal(result->verdict, SPHV_AGREES);
            if (strcmp(result->id, "implementation") == 0)
                assert_int_equal(strstr(result->cause, "single precision") != NULL,
                                 cases[i].single);
            seen++;
        }
        // One for all, and per dimension finite, value, derivative, support and scaling, and in
        // one dimension the truncation error.
        assert_int_equal(seen, 1 + 3 * 5 + 1);
        sphv_check_free(&report);
    }
}

struct wrong {
    const char *library;
    int dimension;     ///< of the result that must fail; 0: of the library as a whole
    const char *id;    ///< that must fail
    const char *cause; ///< words that its cause must hold
};

static void expect(const struct wrong *wrong, double time_limit)
{
    sphv_check_report report;
    check_library("cubic-spline", wrong->library, time_limit, &report);
    assert_int_equal(report.verdict, SPHV_DISAGREES);
    bool found = false;
    for (size_t k = 0; k < report.count; k++) {
        const sphv_check_result *result = &report.results[k];
        if (strcmp(result->id, wrong->id) != 0 || result->dimension != wrong->dimension) continue;
        found = true;
        if (result->verdict != SPHV_DISAGREES || !strstr(result->cause, wrong->cause))
            print_error("%s: %s in %dD: verdict %s, cause '%s'\n", wrong->library, result->id,
                        result->dimension, sphv_verdict_name(result->verdict), result->cause);
        assert_int_equal(result->verdict, SPHV_DISAGREES);
        assert_non_null(strstr(result->cause, wrong->cause));
    }
    assert_true(found);
    sphv_check_free(&report);
}

static void test_wrong_results_are_named(void **state)
{
    (void)state;
    static const struct wrong cases[] = {
        {"float_constant", 1, "implementation-value", "rounded to single precision"},
        {"float_constant", 1, "implementation-truncation", "times what theory says"},
        {"three_digits", 2, "implementation-value", "rounded to 3 digits"},
        {"constant_of_2d", 3, "implementation-value", "that of 2D"},
        {"unnormalised", 1, "implementation-value", "not normalised"},
        {"missing_factor_q", 2, "implementation-derivative", "lacks a factor q"},
        {"flipped", 1, "implementation-derivative", "sign is flipped"},
        {"flipped", 1, "implementation-truncation", "-1 times what theory says"},
        {"single_flipped", 3, "implementation-derivative", "sign is flipped"},
        {"derivative_in_q", 2, "implementation-scaling", "a factor 1/h is missing"},
        {"support_radius", 3, "implementation-value", "h is the support radius"},
        {"coefficient", 1, "implementation-value", "from q = 0.0"},
        {"not_cut_off", 1, "implementation-support", "not zero at q = 2.0"},
        {"cut_short", 2, "implementation-derivative", "zero from q = 1.80"},
        {"nan_everywhere", 1, "implementation-finite", "NaN"},
        {"nan_at_origin", 1, "implementation-finite", "only at r = 0"},
        {"forgetful", 0, "implementation", "when called again"},
        {"rounds_up", 0, "implementation", "rounding mode"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) expect(&cases[i], 60);
}

static void test_misbehaviour_is_named(void **state)
{
    (void)state;
    static const struct wrong cases[] = {
        {"no_symbol", 0, "implementation", "no function 'kernel_value'"},
        {"no_derivative", 0, "implementation", "no function 'kernel_derivative'"},
        {"null_pointer", 0, "implementation", "trapped: signal 11"},
        {"wild_pointer", 0, "implementation", "trapped: signal 11"},
        {"recursion", 0, "implementation", "trapped: signal 11"},
        {"divides", 0, "implementation", "trapped: signal 8"},
        {"aborts", 0, "implementation", "in 2D: it aborts"},
        {"constructor_crash", 0, "implementation", "while it was loaded"},
        {"writes_file", 0, "implementation", "it writes to a file"},
        {"exits", 0, "implementation", "exited: it ended the program"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) expect(&cases[i], 60);
}

static void test_time_limit(void **state)
{
    (void)state;
    static const struct wrong cases[] = {
        {"endless_loop", 0, "implementation", "timed out"},
        {"stops", 0, "implementation", "timed out"},
        {"memory_hog", 0, "implementation", ""}, // out of memory first, or out of time
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) expect(&cases[i], 0.2);
}

static void test_files_that_are_no_library(void **state)
{
    (void)state;
    sphv_kernel_call call = {1, 1, 1};
    sphv_kernel_answer answer;
    sphv_implementation_run run;
    sphv_error error;
    char *folder = folder_make();
    assert_failed(
        sphv_implementation_sample("/nowhere/libmine.so", 1, &call, 1, &answer, &run, &error),
        &error, SPHV_INVALID_INPUT, "libmine.so");
    assert_failed(sphv_implementation_sample(folder, 1, &call, 1, &answer, &run, &error), &error,
                  SPHV_INVALID_INPUT, "not a file");
    static const char *const texts[] = {"", "hello\n",
                                        "\x7f"
                                        "ELF\x02\x01\x01"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        char *path = file_write(folder, "text.so", texts[i]);
        assert_ok(sphv_implementation_sample(path, 60, &call, 1, &answer, &run, &error), error);
        assert_int_equal(run.outcome, SPHV_OUTCOME_NOT_LOADED);
        assert_true(run.message[0] != '\0');
        assert_true(isnan(answer.value) && isnan(answer.derivative));
        free(path);
    }
    folder_remove(folder);
}

/// A right library cut off or with bytes changed anywhere: whatever it then is, an outcome results.
static void test_damaged_library(void **state)
{
    (void)state;
    char path[1024];
    library_path(path, sizeof path, "right");
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    static unsigned char bytes[1 << 17];
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    assert_true(size > 1000);
    char *folder = folder_make();
    sphv_kernel_call call = {1, 1, 1};
    int rounds = quick() ? 3 : 60;
    for (int i = 0; i < rounds; i++) {
        sphv_kernel_answer answer;
        sphv_implementation_run run;
        sphv_error error;
        size_t kept = i % 3 == 0 ? (size_t)random_integer(1, (long)size) : size;
        size_t at = (size_t)random_integer(0, (long)size - 1);
        unsigned char before = bytes[at];
        if (i % 3) bytes[at] ^= (unsigned char)random_integer(1, 255);
        char *damaged = file_write_bytes(folder, "damaged.so", bytes, kept);
        bytes[at] = before;
        assert_ok(sphv_implementation_sample(damaged, 2, &call, 1, &answer, &run, &error), error);
        assert_non_null(sphv_outcome_name(run.outcome));
        free(damaged);
    }
    folder_remove(folder);
}

/// Answers arrive in the order of the calls, and what follows a trap is NaN.
static void test_answers_up_to_a_trap(void **state)
{
    (void)state;
    char path[1024];
    sphv_kernel_call calls[] = {{0.5, 1, 1}, {0, 2, 3}, {1.5, 1, 2}, {0.5, 1, 1}};
    enum { COUNT = sizeof calls / sizeof *calls };
    sphv_kernel_answer answers[COUNT];
    sphv_implementation_run run;
    sphv_error error;
    library_path(path, sizeof path, "right");
    assert_ok(sphv_implementation_sample(path, 60, calls, COUNT, answers, &run, &error), error);
    assert_int_equal(run.outcome, SPHV_OUTCOME_ANSWERED);
    assert_int_equal(run.answered, COUNT);
    assert_true(run.repeatable);
    assert_int_equal(run.printed, 0);
    // 2/3 (1 − 3/8 + 3/32) and 2/3 (−3/2 + 9/16); 1/(8π); a few roundings each.
    assert_close(answers[0].value, 23. / 48, 1e-15);
    assert_close(answers[0].derivative, -0.625, 1e-15);
    assert_close(answers[1].value, 0.039788735772973836, 1e-16);
    library_path(path, sizeof path, "null_pointer");
    assert_ok(sphv_implementation_sample(path, 60, calls, COUNT, answers, &run, &error), error);
    assert_int_equal(run.outcome, SPHV_OUTCOME_TRAPPED);
    assert_int_equal(run.answered, 2);
    assert_close(answers[0].value, 23. / 48, 1e-15);
    assert_true(isnan(answers[2].value) && isnan(answers[3].value));
}

int main(void)
{
    random_start("implementation");
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_answers_up_to_a_trap),
        cmocka_unit_test(test_right_libraries_raise_nothing),
        cmocka_unit_test(test_wrong_results_are_named),
        cmocka_unit_test(test_misbehaviour_is_named),
        cmocka_unit_test(test_time_limit),
        cmocka_unit_test(test_files_that_are_no_library),
        cmocka_unit_test(test_damaged_library),
    };
    return run_group(tests);
}
