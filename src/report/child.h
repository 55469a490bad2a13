/// \file child.h
/// Runs another program: text in, text out, within a time limit.
#ifndef SPHVERIFY_REPORT_CHILD_H
#define SPHVERIFY_REPORT_CHILD_H

#include <stddef.h>

#include "sphverify/status.h"

/// Runs a program found on PATH, never through a shell.
///
/// The input goes in through a socket, so that a child that dies early is a returned error and
/// not a SIGPIPE. May be called from several threads at once.
///
/// \param arguments  argv, ended by NULL; arguments[0] is looked up on PATH
/// \param input      text for its standard input; \param input_size its length in bytes
/// \param seconds    time limit; the child is killed when it is exceeded
/// \param output     receives its standard output, ended by '\0', for the caller to free
/// \param output_size receives the length of the output; may be NULL
/// \param error      receives the reason of a failure
/// \return SPHV_OK when it ended by itself with status 0, else SPHV_RESOURCE_FAILURE
sphv_status sphv_child_run(char *const *arguments, const char *input, size_t input_size,
                           double seconds, char **output, size_t *output_size,
                           sphv_error *error) SPHV_MUST_CHECK;

#endif
