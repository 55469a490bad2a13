/// \file status.h
/// The one list of outcomes a function can return, and the one-line message that goes with it.
#ifndef SPHVERIFY_STATUS_H
#define SPHVERIFY_STATUS_H

#if defined(__GNUC__)
#define SPHV_MUST_CHECK __attribute__((warn_unused_result))
#define SPHV_PRINTF(string, first) __attribute__((format(printf, string, first)))
#else
#define SPHV_MUST_CHECK
#define SPHV_PRINTF(string, first)
#endif

/// What became of a call. The command line turns each into its exit status (`sphv_exit_status`).
typedef enum sphv_status {
    SPHV_OK = 0,           ///< done
    SPHV_INVALID_INPUT,    ///< the question has no meaning: bad number, bad file, bad option
    SPHV_NO_CLOSED_FORM,   ///< the question has a meaning, but no theory here answers it
    SPHV_RESOURCE_FAILURE, ///< memory, disk, or another program failed
} sphv_status;

/// A status with its message: one line that says where, what, and what is allowed.
/// Messages quote user input with control characters replaced, so one line stays one line.
typedef struct sphv_error {
    sphv_status status;
    char message[1024];
} sphv_error;

/// A number with the half-width of the interval that is claimed to hold the true one.
typedef struct sphv_result {
    double value;
    double bound;
} sphv_result;

/// Records a failure.
/// \param error   receives status and message; may be NULL
/// \param status  the outcome to record and return
/// \param format  printf format of the message, without a final newline
/// \return `status`
sphv_status sphv_fail(sphv_error *error, sphv_status status, const char *format, ...)
    SPHV_PRINTF(3, 4);

/// Exit status of the command line for an outcome: 0 done, 2 bad usage or input, 3 a resource
/// failed. (1, "something disagrees", is a verdict, not an outcome.)
int sphv_exit_status(sphv_status status);

#endif
