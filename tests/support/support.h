/// \file support.h
/// What every test program shares: assertions that NaN cannot pass, seeds that are printed,
/// temporary folders, and the shipped kernels.
#ifndef SPHVERIFY_TESTS_SUPPORT_H
#define SPHVERIFY_TESTS_SUPPORT_H

// CMocka wants these before its own header.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdbool.h>

#include "sphverify/kernel.h"

/// |actual − expected| ≤ tolerance, with every argument finite and tolerance ≥ 0: a NaN anywhere,
/// or a tolerance that lets everything pass, is not close.
bool is_close(double actual, double expected, double tolerance);

/// The interval of `result` holds `reference`: both finite, and the bound ≥ 0.
bool is_within_bounds(sphv_result result, double reference);

#define assert_close(actual, expected, tolerance)                                                  \
    check_close((actual), (expected), (tolerance), #actual, __FILE__, __LINE__)
#define assert_within_bounds(result, reference)                                                    \
    check_within_bounds((result), (reference), #result, __FILE__, __LINE__)
/// \param call  an expression of type sphv_status that fills the sphv_error named `error`
#define assert_ok(call, error) check_ok((call), &(error), #call, __FILE__, __LINE__)

void check_close(double actual, double expected, double tolerance, const char *what,
                 const char *file, int line);
void check_within_bounds(sphv_result result, double reference, const char *what, const char *file,
                         int line);
void check_ok(sphv_status status, const sphv_error *error, const char *what, const char *file,
              int line);

/// Fails unless the call failed with that status and a message of one line that holds `part`.
void assert_failed(sphv_status actual, const sphv_error *error, sphv_status expected,
                   const char *part);

/// Random numbers of a test. The seed is SPHVERIFY_TEST_SEED, or the time of day, and is printed.
void random_start(const char *test);
double random_uniform(double from, double to); ///< uniform on [from, to)
double random_log(double from, double to);     ///< uniform in the logarithm
long random_integer(long from, long to);       ///< uniform on from … to

/// Whether to take few samples, for slow checkers such as valgrind (SPHVERIFY_TEST_QUICK).
bool quick(void);

/// The data folder under test (SPHVERIFY_DATA).
const char *data_directory(void);

/// Loads a shipped kernel; fails the test when that fails. The caller frees it.
sphv_kernel *load_kernel(const char *name);

/// A new empty folder below $TMPDIR, with a name that the caller frees with folder_remove.
char *folder_make(void);
/// Removes the folder with all it holds, and frees its name.
void folder_remove(char *folder);

/// Writes `size` bytes to folder/name. The caller frees the path.
char *file_write_bytes(const char *folder, const char *name, const void *bytes, size_t size);
/// The same for a text.
char *file_write(const char *folder, const char *name, const char *text);

/// Reads folder/name whole, ended by a zero that is no part of it; fails the test when it cannot be
/// read. The caller frees the text.
char *file_read(const char *folder, const char *name);

/// Lines as one text, each ended, with one of them (from 1; 0: none) replaced. The caller frees it.
char *text_with_line(const char *const *lines, int count, int line, const char *replacement);

/// Loads a kernel from a text, through a temporary file.
sphv_status kernel_from_text(const char *text, sphv_kernel **out, sphv_error *error);

/// Runs tests as a CMocka group with GSL's aborting error handler off, as the program does.
#define run_group(tests) (tests_begin(), cmocka_run_group_tests(tests, NULL, NULL))
void tests_begin(void);

#endif
