/// The assertions themselves: a checker that lets NaN pass checks nothing.
#include <math.h>
#include <stdio.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support.h"

static void test_close_numbers_are_close(void **state)
{
    (void)state;
    assert_true(is_close(2.385, 2.385, 0));
    assert_true(is_close(2.385, 2.386, 0.0011));
    assert_false(is_close(2.385, 2.386, 0.0009));
    assert_true(is_within_bounds((sphv_result){-0.3, 0.01}, -0.309));
    assert_false(is_within_bounds((sphv_result){-0.3, 0.01}, -0.311));
}

static void test_meaningless_numbers_are_never_close(void **state)
{
    (void)state;
    const double bad[] = {NAN, -NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 4; i++) {
        assert_false(is_close(bad[i], 1, 1));
        assert_false(is_close(1, bad[i], 1));
        assert_false(is_close(1, 1, bad[i]));
        assert_false(is_close(bad[i], bad[i], 1));
        assert_false(is_close(bad[i], bad[i], INFINITY));
        assert_false(is_within_bounds((sphv_result){bad[i], 1}, 1));
        assert_false(is_within_bounds((sphv_result){1, bad[i]}, 1));
        assert_false(is_within_bounds((sphv_result){1, 1}, bad[i]));
    }
    assert_false(is_close(1, 1, -0x1p-1074));
}

static void close_nan_actual(void **state)
{
    (void)state;
    assert_close(NAN, 1, 1);
}

static void close_nan_expected(void **state)
{
    (void)state;
    assert_close(1, NAN, 1);
}

static void close_nan_tolerance(void **state)
{
    (void)state;
    assert_close(1, 1, NAN);
}

static void bounds_nan(void **state)
{
    (void)state;
    assert_within_bounds(((sphv_result){NAN, 1}), 1);
}

static void close_too_far(void **state)
{
    (void)state;
    assert_close(1, 1.5, 0.25);
}

static void close_enough(void **state)
{
    (void)state;
    assert_close(1, 1.5, 0.75);
}

/// Number of failures CMocka reports for one test, run in a child so that ours does not fail.
static int failures_of(void (*test)(void **))
{
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        const struct CMUnitTest tests[] = {{"inner", test, NULL, NULL, NULL}};
        if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)) _exit(99);
        _exit(cmocka_run_group_tests(tests, NULL, NULL));
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void test_assertions_fail_when_they_should(void **state)
{
    (void)state;
    assert_int_equal(failures_of(close_nan_actual), 1);
    assert_int_equal(failures_of(close_nan_expected), 1);
    assert_int_equal(failures_of(close_nan_tolerance), 1);
    assert_int_equal(failures_of(bounds_nan), 1);
    assert_int_equal(failures_of(close_too_far), 1);
    assert_int_equal(failures_of(close_enough), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_close_numbers_are_close),
        cmocka_unit_test(test_meaningless_numbers_are_never_close),
        cmocka_unit_test(test_assertions_fail_when_they_should),
    };
    return run_group(tests);
}
