/// \file target.h
/// A fuzz target takes any bytes and must come back: no crash, no hang, no undefined behaviour, no
/// NaN that calls itself a number. libFuzzer drives it when built with -Dfuzz=true; the regression
/// test drives it with stored and generated inputs everywhere else.
#ifndef SPHVERIFY_TESTS_FUZZ_TARGET_H
#define SPHVERIFY_TESTS_FUZZ_TARGET_H

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/// Aborts with a message unless the condition holds.
#define FUZZ_REQUIRE(condition)                                                                    \
    do {                                                                                           \
        if (!(condition)) fuzz_abort(#condition, __FILE__, __LINE__);                              \
    } while (0)
void fuzz_abort(const char *condition, const char *file, int line);

/// A path that holds these bytes until the next call.
const char *fuzz_file(const uint8_t *data, size_t size);

#endif
