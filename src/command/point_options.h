/// \file point_options.h
/// Reading the options that name a kernel and a point.
#ifndef SPHVERIFY_COMMAND_POINT_OPTIONS_H
#define SPHVERIFY_COMMAND_POINT_OPTIONS_H

#include "command.h"
#include "sphverify/kernel.h"

/// A required number option, decimal or fraction.
sphv_status sphv_number_option(const sphv_arguments *arguments, const char *option,
                               sphv_number *out, sphv_error *error) SPHV_MUST_CHECK;

/// An optional number, decimal or fraction.
sphv_status sphv_real_option(const sphv_arguments *arguments, const char *option, double otherwise,
                             double *out, sphv_error *error) SPHV_MUST_CHECK;

/// An optional whole number from `least` to `most`.
sphv_status sphv_whole_option(const sphv_arguments *arguments, const char *option, long least,
                              long most, long otherwise, long *out,
                              sphv_error *error) SPHV_MUST_CHECK;

/// --dim: 1, 2 or 3, or `fallback` when it is not given.
sphv_status sphv_dimension_option(const sphv_arguments *arguments, int fallback, int *out,
                                  sphv_error *error) SPHV_MUST_CHECK;

/// An option with a fixed list of words; the first is the default.
/// \param words NULL-terminated; \param out receives the index
sphv_status sphv_word_option(const sphv_arguments *arguments, const char *option,
                             const char *const *words, int *out, sphv_error *error) SPHV_MUST_CHECK;

/// The profile of a kernel in d dimensions, or the reason why there is none.
sphv_status sphv_profile_required(const sphv_kernel *kernel, int dimension,
                                  const sphv_profile **out, sphv_error *error) SPHV_MUST_CHECK;

#endif
