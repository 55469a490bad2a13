/// Number parsing: any text is a finite number or a one-line error.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/constant_text.h"
#include "sphverify/number.h"
#include "target.h"

static void require_one_line(const sphv_error *error)
{
    FUZZ_REQUIRE(error->status == SPHV_INVALID_INPUT);
    FUZZ_REQUIRE(error->message[0] != '\0' && !strpbrk(error->message, "\n\r\033"));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    if (!text) return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    sphv_error error = {SPHV_OK, ""};
    sphv_number number;
    if (sphv_number_parse(text, &number, &error) == SPHV_OK)
        FUZZ_REQUIRE(isfinite(number.value) && isfinite(number.residual));
    else
        require_one_line(&error);
    long double constant;
    error = (sphv_error){SPHV_OK, ""};
    if (sphv_constant_parse(text, &constant, &error) == SPHV_OK)
        FUZZ_REQUIRE(isfinite(constant));
    else
        require_one_line(&error);
    free(text);
    return 0;
}
