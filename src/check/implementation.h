/// \file implementation.h
/// A user's compiled kernel, called in a child process.
///
/// The library offers
///
///     double kernel_value(double r, double h, int dim);       // W(r, h)
///     double kernel_derivative(double r, double h, int dim);  // dW/dr
///
/// It is loaded by a child process only, with a time limit and with limits on memory and files, so
/// that whatever it does ends in an outcome and not in the end of the suite. This guards against
/// accidents; it is no jail for hostile code.
#ifndef SPHVERIFY_CHECK_IMPLEMENTATION_H
#define SPHVERIFY_CHECK_IMPLEMENTATION_H

#include <stdbool.h>
#include <stddef.h>

#include "sphverify/status.h"

/// Seconds that a library may take for all calls unless told otherwise.
#define SPHV_IMPLEMENTATION_SECONDS 5.0

/// What became of the library.
typedef enum sphv_outcome {
    SPHV_OUTCOME_ANSWERED,   ///< every call returned
    SPHV_OUTCOME_NOT_LOADED, ///< the file is no shared library, or lacks something itself
    SPHV_OUTCOME_NO_SYMBOL,  ///< kernel_value or kernel_derivative is missing
    SPHV_OUTCOME_TRAPPED,    ///< a signal ended it: bad memory access, abort, write to a file …
    SPHV_OUTCOME_TIMED_OUT,  ///< an endless loop, or far too slow
    SPHV_OUTCOME_EXITED,     ///< it called exit
    SPHV_OUTCOME_TAMPERED,   ///< it wrote over memory that is not its own
} sphv_outcome;

const char *sphv_outcome_name(sphv_outcome outcome);

/// One call of both functions.
typedef struct sphv_kernel_call {
    double r, h;
    int dimension;
} sphv_kernel_call;

/// What they returned.
typedef struct sphv_kernel_answer {
    double value, derivative;
} sphv_kernel_answer;

/// How the library behaved.
typedef struct sphv_implementation_run {
    sphv_outcome outcome;
    char message[400];     ///< what happened and where; "" when it answered
    size_t answered;       ///< calls that returned, from the first
    bool repeatable;       ///< the same calls in reverse order returned the same bits
    size_t differing;      ///< otherwise the first call that did not
    bool rounding_changed; ///< it left another rounding mode behind
    size_t printed;        ///< bytes it wrote to standard output or error (up to 64 KiB counted)
    double seconds;
} sphv_implementation_run;

/// Calls the library for every (r, h, dimension), then again in reverse order.
/// \param path       of the shared library; without a `/` it is looked for in the working folder
/// \param time_limit seconds for everything; 0 or less: SPHV_IMPLEMENTATION_SECONDS
/// \param answers    receives `count` answers; NaN for calls that did not return
/// \param run        receives the outcome
/// \return SPHV_OK whatever the library does; SPHV_INVALID_INPUT when there is no such file;
///         SPHV_RESOURCE_FAILURE when no process can be made
sphv_status sphv_implementation_sample(const char *path, double time_limit,
                                       const sphv_kernel_call *calls, size_t count,
                                       sphv_kernel_answer *answers, sphv_implementation_run *run,
                                       sphv_error *error) SPHV_MUST_CHECK;

#endif
