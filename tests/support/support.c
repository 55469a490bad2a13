#include "support.h"

#include <ftw.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_rng.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

bool is_close(double actual, double expected, double tolerance)
{
    return isfinite(actual) && isfinite(expected) && isfinite(tolerance) && tolerance >= 0 &&
           fabs(actual - expected) <= tolerance;
}

bool is_within_bounds(sphv_result result, double reference)
{
    return is_close(result.value, reference, result.bound);
}

void check_close(double actual, double expected, double tolerance, const char *what,
                 const char *file, int line)
{
    if (is_close(actual, expected, tolerance)) return;
    print_error("%s is %.17g, not %.17g: off by %.3g, allowed %.3g\n", what, actual, expected,
                actual - expected, tolerance);
    _fail(file, line);
}

void check_within_bounds(sphv_result result, double reference, const char *what, const char *file,
                         int line)
{
    if (is_within_bounds(result, reference)) return;
    print_error("%s is %.17g with bound %.3g, but the reference is %.17g: off by %.3g\n", what,
                result.value, result.bound, reference, result.value - reference);
    _fail(file, line);
}

void check_ok(sphv_status status, const sphv_error *error, const char *what, const char *file,
              int line)
{
    if (status == SPHV_OK) return;
    print_error("%s returned %d: %s\n", what, (int)status, error->message);
    _fail(file, line);
}

void assert_failed(sphv_status actual, const sphv_error *error, sphv_status expected,
                   const char *part)
{
    if (actual != expected || error->status != expected || !strstr(error->message, part) ||
        strchr(error->message, '\n'))
        fail_msg("status %d (recorded %d), expected %d, with '%s' in the message '%s'", (int)actual,
                 (int)error->status, (int)expected, part, error->message);
}

static gsl_rng *generator;

static void random_end(void)
{
    gsl_rng_free(generator);
}

void random_start(const char *test)
{
    const char *wanted = getenv("SPHVERIFY_TEST_SEED");
    unsigned long seed = wanted ? strtoul(wanted, NULL, 10) : (unsigned long)time(NULL);
    if (!generator) {
        generator = gsl_rng_alloc(gsl_rng_mt19937);
        atexit(random_end);
    }
    assert_non_null(generator);
    gsl_rng_set(generator, seed);
    print_message("%s: SPHVERIFY_TEST_SEED=%lu\n", test, seed);
}

double random_uniform(double from, double to)
{
    return from + (to - from) * gsl_rng_uniform(generator);
}

double random_log(double from, double to)
{
    return exp(random_uniform(log(from), log(to)));
}

long random_integer(long from, long to)
{
    return from + (long)gsl_rng_uniform_int(generator, (unsigned long)(to - from + 1));
}

bool quick(void)
{
    return getenv("SPHVERIFY_TEST_QUICK") != NULL;
}

const char *data_directory(void)
{
    const char *directory = getenv("SPHVERIFY_DATA");
    if (!directory) fail_msg("SPHVERIFY_DATA does not name the data folder under test");
    return directory;
}

sphv_kernel *load_kernel(const char *name)
{
    sphv_kernel *kernel = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_catalogue_find(data_directory(), name, &kernel, &error), error);
    return kernel;
}

char *folder_make(void)
{
    const char *parent = getenv("TMPDIR");
    char *folder = NULL;
    if (asprintf(&folder, "%s/sphverify-test-XXXXXX", parent ? parent : "/tmp") < 0 ||
        !mkdtemp(folder))
        fail_msg("no temporary folder can be made");
    return folder;
}

static int remove_entry(const char *path, const struct stat *about, int kind, struct FTW *place)
{
    (void)about;
    (void)kind;
    (void)place;
    return remove(path);
}

void folder_remove(char *folder)
{
    nftw(folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    free(folder);
}

char *file_write_bytes(const char *folder, const char *name, const void *bytes, size_t size)
{
    char *path = NULL;
    if (asprintf(&path, "%s/%s", folder, name) < 0) fail_msg("out of memory");
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file) != 0)
        fail_msg("%s cannot be written", path);
    return path;
}

char *file_write(const char *folder, const char *name, const char *text)
{
    return file_write_bytes(folder, name, text, strlen(text));
}

char *file_read(const char *folder, const char *name)
{
    char *path = NULL, *text = NULL;
    size_t size = 0;
    if (asprintf(&path, "%s/%s", folder, name) < 0) fail_msg("out of memory");
    FILE *file = fopen(path, "rb"), *stream = open_memstream(&text, &size);
    if (!file || !stream) fail_msg("%s cannot be read", path);
    for (int c; (c = fgetc(file)) != EOF;) fputc(c, stream);
    bool failed = ferror(file);
    fclose(file);
    if (fclose(stream) != 0 || failed) fail_msg("%s cannot be read", path);
    free(path);
    return text;
}

char *text_with_line(const char *const *lines, int count, int line, const char *replacement)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream) fail_msg("out of memory");
    for (int i = 0; i < count; i++) fprintf(stream, "%s\n", i + 1 == line ? replacement : lines[i]);
    if (fclose(stream) != 0) fail_msg("out of memory");
    return text;
}

sphv_status kernel_from_text(const char *text, sphv_kernel **out, sphv_error *error)
{
    char *folder = folder_make(), *path = file_write(folder, "k.yaml", text);
    sphv_status status = sphv_kernel_load(path, out, error);
    free(path);
    folder_remove(folder);
    return status;
}

void tests_begin(void)
{
    gsl_set_error_handler_off();
}
