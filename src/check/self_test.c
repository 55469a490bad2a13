#include "sphverify/check.h"
#include <stdlib.h>
sphv_status sphv_check_self_test(const sphv_catalogue *catalogue, sphv_progress progress,
                                 void *context, sphv_self_test *out, sphv_error *error)
{
    (void)catalogue;
    (void)progress;
    (void)context;
    (void)out;
    return sphv_fail(error, SPHV_NO_CLOSED_FORM, "not yet");
}
void sphv_self_test_free(sphv_self_test *test)
{
    free(test->defects);
}
