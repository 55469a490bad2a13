/// Fields: any text is a field whose derivatives can be evaluated, or a one-line error.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sphverify/field.h"
#include "target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const double at[SPHV_DIMENSIONS] = {0.5, -0.25, 0.125};
    char *text = malloc(size + 1);
    if (!text) return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
        sphv_error error = {SPHV_OK, ""};
        sphv_field field;
        if (sphv_field_parse(text, d, &field, &error) != SPHV_OK) {
            FUZZ_REQUIRE(error.status == SPHV_INVALID_INPUT);
            FUZZ_REQUIRE(error.message[0] != '\0' && !strpbrk(error.message, "\n\r\033"));
            continue;
        }
        FUZZ_REQUIRE(field.terms >= 1 && field.terms <= SPHV_FIELD_TERMS_MAX);
        for (int t = 0; t < field.terms; t++) FUZZ_REQUIRE(isfinite(field.term[t].coefficient));
        double derivatives[SPHV_QUANTITIES_MAX];
        sphv_field_derivatives(&field, 2, at, derivatives);
        // A field that depends on less than it may is the same in more dimensions.
        sphv_field wider;
        if (d < SPHV_DIMENSIONS && sphv_field_parse(text, d + 1, &wider, &error) == SPHV_OK &&
            strcmp(text, "f1") != 0 && strcmp(text, "gaussian") != 0)
            FUZZ_REQUIRE(wider.terms == field.terms);
    }
    free(text);
    return 0;
}
