/// The list of outcomes and its one-line messages.
#include <string.h>

#include "support.h"

static void test_fail_records_status_and_message(void **state)
{
    (void)state;
    sphv_error error = {SPHV_OK, ""};
    assert_int_equal(sphv_fail(&error, SPHV_INVALID_INPUT, "%s:%d: bad", "k.yaml", 7),
                     SPHV_INVALID_INPUT);
    assert_int_equal(error.status, SPHV_INVALID_INPUT);
    assert_string_equal(error.message, "k.yaml:7: bad");
    assert_int_equal(sphv_fail(NULL, SPHV_RESOURCE_FAILURE, "no one listens"),
                     SPHV_RESOURCE_FAILURE);
}

static void test_control_characters_do_not_break_the_line(void **state)
{
    (void)state;
    sphv_error error;
    for (int c = 1; c < 0x80; c++) {
        sphv_fail(&error, SPHV_INVALID_INPUT, "a%cb", c);
        assert_int_equal(strlen(error.message), 3);
        if (c < 0x20 || c == 0x7f)
            assert_int_equal(error.message[1], '?');
        else
            assert_int_equal(error.message[1], c);
    }
}

static void test_long_messages_are_cut(void **state)
{
    (void)state;
    char text[3000];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    sphv_error error;
    sphv_fail(&error, SPHV_INVALID_INPUT, "%s", text);
    assert_int_equal(strlen(error.message), sizeof error.message - 1);
}

static void test_exit_statuses(void **state)
{
    (void)state;
    assert_int_equal(sphv_exit_status(SPHV_OK), 0);
    assert_int_equal(sphv_exit_status(SPHV_INVALID_INPUT), 2);
    assert_int_equal(sphv_exit_status(SPHV_NO_CLOSED_FORM), 2);
    assert_int_equal(sphv_exit_status(SPHV_RESOURCE_FAILURE), 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fail_records_status_and_message),
        cmocka_unit_test(test_control_characters_do_not_break_the_line),
        cmocka_unit_test(test_long_messages_are_cut),
        cmocka_unit_test(test_exit_statuses),
    };
    return run_group(tests);
}
