// Files appear whole or not at all, and children that misbehave become one clear line.
#include "support.h"

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "report/child.h"
#include "sphverify/report.h"

static int entries(const char *folder)
{
    DIR *stream = opendir(folder);
    int count = 0;
    assert_non_null(stream);
    for (struct dirent *entry; (entry = readdir(stream));)
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(stream);
    return count;
}

static bool file_exists(const char *folder, const char *name)
{
    char *path = NULL;
    if (asprintf(&path, "%s/%s", folder, name) < 0) fail_msg("out of memory");
    bool found = access(path, F_OK) == 0;
    free(path);
    return found;
}

static void assert_contents(const char *folder, const char *name, const char *expected)
{
    char *text = file_read(folder, name);
    assert_string_equal(text, expected);
    free(text);
}

static void a_commit_gives_the_file_its_name(void **state)
{
    (void)state;
    char *folder = folder_make(), deep[4096];
    sphv_output_file file;
    sphv_error error;
    snprintf(deep, sizeof deep, "%s/a//b/c/", folder);
    assert_ok(sphv_output_open(deep, "out.txt", &file, &error), error);
    fputs("new", file.stream);
    fflush(file.stream);
    assert_false(file_exists(deep, "out.txt")); // not before the commit
    assert_ok(sphv_output_commit(&file, &error), error);
    assert_contents(deep, "out.txt", "new");
    assert_int_equal(entries(deep), 1);
    sphv_output_discard(&file); // harmless
    assert_contents(deep, "out.txt", "new");
    folder_remove(folder);
}

static void a_discard_leaves_the_old_file(void **state)
{
    (void)state;
    char *folder = folder_make();
    free(file_write(folder, "out.txt", "old"));
    sphv_output_file file;
    sphv_error error;
    assert_ok(sphv_output_open(folder, "out.txt", &file, &error), error);
    fputs("half of a new", file.stream);
    fflush(file.stream);
    assert_int_equal(entries(folder), 2);
    sphv_output_discard(&file);
    assert_contents(folder, "out.txt", "old");
    assert_int_equal(entries(folder), 1);
    folder_remove(folder);
}

static void permissions_are_those_of_the_umask(void **state)
{
    (void)state;
    char *folder = folder_make(), path[4096];
    sphv_output_file file;
    sphv_error error;
    struct stat about;
    mode_t mask = umask(027);
    assert_ok(sphv_output_open(folder, "out.txt", &file, &error), error);
    assert_ok(sphv_output_commit(&file, &error), error);
    umask(mask);
    snprintf(path, sizeof path, "%s/out.txt", folder);
    assert_int_equal(stat(path, &about), 0);
    assert_int_equal(about.st_mode & 0777, 0640);
    folder_remove(folder);
}

static void names_cannot_leave_the_folder(void **state)
{
    (void)state;
    static const char *const names[] = {"", ".", "..", "../x", "a/b", "/etc/x", ".hidden"};
    char *folder = folder_make(), longest[300];
    sphv_output_file file;
    sphv_error error;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        assert_failed(sphv_output_open(folder, names[i], &file, &error), &error, SPHV_INVALID_INPUT,
                      "allowed");
    memset(longest, 'x', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    assert_failed(sphv_output_open(folder, longest, &file, &error), &error, SPHV_INVALID_INPUT,
                  "allowed");
    assert_int_equal(entries(folder), 0);
    folder_remove(folder);
}

static void a_place_that_cannot_be_written_is_named(void **state)
{
    (void)state;
    char *folder = folder_make(), *path = file_write(folder, "file", "kept"), below[4096];
    sphv_output_file file;
    sphv_error error;
    snprintf(below, sizeof below, "%s/deeper", path);
    assert_failed(sphv_output_open(path, "x", &file, &error), &error, SPHV_RESOURCE_FAILURE,
                  "cannot be written");
    assert_failed(sphv_output_open(below, "x", &file, &error), &error, SPHV_RESOURCE_FAILURE,
                  strerror(ENOTDIR));
    assert_failed(sphv_output_open("/dev", "full", &file, &error), &error, SPHV_RESOURCE_FAILURE,
                  "/dev/full: cannot be written");
    assert_failed(sphv_output_open("/proc/nothing", "x", &file, &error), &error,
                  SPHV_RESOURCE_FAILURE, "/proc/nothing/x: cannot be written");
    snprintf(below, sizeof below, "%s/taken", folder);
    assert_int_equal(mkdir(below, 0777), 0);
    assert_failed(sphv_output_open(folder, "taken", &file, &error), &error, SPHV_RESOURCE_FAILURE,
                  strerror(EISDIR));
    assert_contents(folder, "file", "kept");
    assert_int_equal(entries(folder), 2);
    free(path);
    folder_remove(folder);
}

/// A limit of the file size stands for the full disk: both fail in write(2).
static void a_full_disk_leaves_nothing_behind(void **state)
{
    (void)state;
    char *folder = folder_make();
    free(file_write(folder, "out.txt", "old"));
    struct rlimit before, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    small = before;
    small.rlim_cur = 4096;
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    sphv_output_file file;
    sphv_error error;
    sphv_status opened = sphv_output_open(folder, "out.txt", &file, &error);
    sphv_status committed = SPHV_OK;
    if (opened == SPHV_OK) {
        for (int i = 0; i < 100000; i++) fputs("0123456789", file.stream);
        committed = sphv_output_commit(&file, &error);
    }
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, handler);
    assert_int_equal(opened, SPHV_OK);
    assert_failed(committed, &error, SPHV_RESOURCE_FAILURE, strerror(EFBIG));
    assert_contents(folder, "out.txt", "old");
    assert_int_equal(entries(folder), 1);
    folder_remove(folder);
}

static sphv_status run(const char *const *arguments, const char *input, double seconds,
                       char **output, size_t *size, sphv_error *error)
{
    return sphv_child_run((char *const *)(uintptr_t)arguments, input, strlen(input), seconds,
                          output, size, error);
}

static void a_child_gets_and_gives_much_text(void **state)
{
    (void)state;
    enum { SIZE = 3000000 };
    char *input = malloc(SIZE + 1), *output;
    assert_non_null(input);
    for (int i = 0; i < SIZE; i++) input[i] = (char)('a' + i % 23);
    input[SIZE] = '\0';
    size_t size;
    sphv_error error;
    const char *const cat[] = {"cat", NULL};
    assert_ok(run(cat, input, 30, &output, &size, &error), error);
    assert_int_equal(size, SIZE);
    assert_string_equal(output, input);
    free(output);
    // A child that does not read must not stop us, nor end us by SIGPIPE.
    const char *const deaf[] = {"true", NULL};
    assert_ok(run(deaf, input, 30, &output, &size, &error), error);
    assert_string_equal(output, "");
    free(output);
    free(input);
}

static void a_child_that_fails_is_quoted(void **state)
{
    (void)state;
    char *output;
    sphv_error error;
    const char *const wrong[] = {"sh", "-c", "echo said; echo reason 1>&2; exit 7", NULL};
    assert_failed(run(wrong, "", 30, &output, NULL, &error), &error, SPHV_RESOURCE_FAILURE,
                  "ended with status 7: reason");
    assert_null(output);
    const char *const killed[] = {"sh", "-c", "kill -SEGV $$", NULL};
    assert_failed(run(killed, "", 30, &output, NULL, &error), &error, SPHV_RESOURCE_FAILURE,
                  "was ended by signal 11");
    const char *const missing[] = {"sphverify-no-such-program", NULL};
    assert_failed(run(missing, "", 30, &output, NULL, &error), &error, SPHV_RESOURCE_FAILURE,
                  "sphverify-no-such-program cannot be run");
}

static void a_child_that_hangs_is_stopped(void **state)
{
    (void)state;
    char *output;
    sphv_error error;
    // Hanging with its output open, and with its output closed.
    static const char *const scripts[] = {"exec sleep 60", "exec 1>&- 2>&-; exec sleep 60"};
    for (int i = 0; i < 2; i++) {
        time_t start = time(NULL);
        const char *const hangs[] = {"sh", "-c", scripts[i], NULL};
        assert_failed(run(hangs, "", 0.2, &output, NULL, &error), &error, SPHV_RESOURCE_FAILURE,
                      "took too long");
        assert_true(time(NULL) - start < 20);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_commit_gives_the_file_its_name),
        cmocka_unit_test(a_discard_leaves_the_old_file),
        cmocka_unit_test(permissions_are_those_of_the_umask),
        cmocka_unit_test(names_cannot_leave_the_folder),
        cmocka_unit_test(a_place_that_cannot_be_written_is_named),
        cmocka_unit_test(a_full_disk_leaves_nothing_behind),
        cmocka_unit_test(a_child_gets_and_gives_much_text),
        cmocka_unit_test(a_child_that_fails_is_quoted),
        cmocka_unit_test(a_child_that_hangs_is_stopped),
    };
    return run_group(tests);
}
