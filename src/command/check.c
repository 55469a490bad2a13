#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_output.h"
#include "command.h"
#include "core/directory.h"
#include "core/kernel_internal.h"
#include "point_options.h"
#include "sphverify/report.h"

/// What the command line asks for, and the answers so far.
struct session {
    const sphv_arguments *arguments;
    sphv_check_options options;
    sphv_catalogue reference;
    json_t *answers; ///< one object per kernel, or flat rows for CSV and Markdown
    int status;
    char **written; ///< names of files in -o, so that two kernels of one name stay apart
    size_t written_count;
};

static void worsen(struct session *session, int status)
{
    if (status > session->status) session->status = status;
}

static sphv_status write_one(const sphv_check_report *report, const char *directory,
                             const char *stem, bool json, sphv_error *error)
{
    char name[120];
    sphv_output_file file;
    snprintf(name, sizeof name, "check-%.90s.%s", stem, json ? "json" : "md");
    sphv_status status = sphv_output_open(directory, name, &file, error);
    if (status != SPHV_OK) return status;
    if (json) {
        json_t *object = sphv_check_json(report);
        json_dumpf(object, file.stream, JSON_INDENT(2) | JSON_REAL_PRECISION(17));
        fputc('\n', file.stream);
        json_decref(object);
    } else {
        sphv_check_print_markdown(file.stream, report);
    }
    return sphv_output_commit(&file, error);
}

/// NAME, or NAME-2, NAME-3 … when kernels of one name are checked together.
static void choose_stem(struct session *session, const char *name, char *stem, size_t size)
{
    snprintf(stem, size, "%s", name);
    for (int copy = 2;; copy++) {
        bool taken = false;
        for (size_t i = 0; i < session->written_count; i++)
            taken = taken || strcmp(session->written[i], stem) == 0;
        if (!taken) break;
        snprintf(stem, size, "%.70s-%d", name, copy);
    }
    char **grown = realloc(session->written, (session->written_count + 1) * sizeof *grown);
    if (!grown) return;
    session->written = grown;
    grown[session->written_count] = strdup(stem);
    if (grown[session->written_count]) session->written_count++;
}

static void show(struct session *session, const sphv_check_report *report)
{
    const sphv_arguments *arguments = session->arguments;
    if (arguments->format == SPHV_FORMAT_TEXT) {
        sphv_check_print_text(stdout, report);
    } else if (arguments->format == SPHV_FORMAT_MARKDOWN) {
        sphv_check_print_markdown(stdout, report);
    } else if (arguments->format == SPHV_FORMAT_JSON) {
        json_array_append_new(session->answers, sphv_check_json(report));
    } else {
        json_t *rows = sphv_check_rows_json(report);
        json_array_extend(session->answers, rows);
        json_decref(rows);
    }
}

/// One kernel of several: what was asked for and what came of it.
struct task {
    const char *name;
    sphv_status status;
    sphv_error error;
    sphv_check_report report;
};

static void check_one(const struct session *session, struct task *task)
{
    sphv_kernel *kernel = NULL;
    char *path = NULL;
    task->status = sphv_file_find(session->arguments->data_directory, "kernels", ".yaml", "kernel",
                                  task->name, &path, &task->error);
    if (task->status == SPHV_OK) task->status = sphv_kernel_load_any(path, &kernel, &task->error);
    free(path);
    if (task->status == SPHV_OK)
        task->status = sphv_check_kernel(kernel, &session->options, &task->report, &task->error);
    sphv_kernel_free(kernel);
}

/// Shows and writes one answer; a bad file is one line on stderr.
static void finish_one(struct session *session, struct task *task, bool first)
{
    const char *directory = sphv_argument(session->arguments, "output");
    sphv_error error;
    if (task->status != SPHV_OK) {
        worsen(session, sphv_report_failure(session->arguments, &task->error));
        return;
    }
    if (!first && (session->arguments->format == SPHV_FORMAT_TEXT ||
                   session->arguments->format == SPHV_FORMAT_MARKDOWN))
        putchar('\n');
    show(session, &task->report);
    worsen(session, sphv_verdict_exit(task->report.verdict));
    if (directory) {
        char stem[96];
        choose_stem(session, task->report.kernel, stem, sizeof stem);
        sphv_status status = write_one(&task->report, directory, stem, true, &error);
        if (status == SPHV_OK) status = write_one(&task->report, directory, stem, false, &error);
        if (status != SPHV_OK) worsen(session, sphv_report_failure(session->arguments, &error));
    }
    sphv_check_free(&task->report);
}

/// Checks kernels on all processors and answers in their order; the others are still checked when
/// one file is bad.
static void check_several(struct session *session, char *const *names, size_t count)
{
    struct task *tasks = calloc(count + 1, sizeof *tasks);
    if (!tasks) {
        sphv_error error;
        (void)sphv_fail(&error, SPHV_RESOURCE_FAILURE, "out of memory");
        worsen(session, sphv_report_failure(session->arguments, &error));
        return;
    }
#pragma omp parallel for schedule(dynamic) if (count > 1)
    for (size_t i = 0; i < count; i++) {
        tasks[i].name = names[i];
        check_one(session, &tasks[i]);
    }
    for (size_t i = 0; i < count; i++) finish_one(session, &tasks[i], i == 0);
    free(tasks);
}

static void check_all(struct session *session)
{
    sphv_file_list files;
    sphv_error error;
    if (sphv_file_list_read(session->arguments->data_directory, "kernels", ".yaml", &files,
                            &error) != SPHV_OK) {
        worsen(session, sphv_report_failure(session->arguments, &error));
        return;
    }
    check_several(session, files.paths, files.count);
    sphv_file_list_free(&files);
}

static int self_test(struct session *session)
{
    sphv_error error;
    sphv_self_test test;
    sphv_catalogue catalogue;
    sphv_status status =
        sphv_catalogue_load(session->arguments->data_directory, &catalogue, &error);
    if (status != SPHV_OK) return sphv_report_failure(session->arguments, &error);
    status = sphv_check_self_test(&catalogue, sphv_progress_bar, "self-test", &test, &error);
    sphv_catalogue_free(&catalogue);
    if (status != SPHV_OK) return sphv_report_failure(session->arguments, &error);
    json_t *answer = sphv_self_test_json(&test);
    if (session->arguments->format == SPHV_FORMAT_TEXT)
        sphv_self_test_print(stdout, &test);
    else if (session->arguments->format == SPHV_FORMAT_JSON)
        sphv_print_json(answer);
    else
        sphv_print_rows(session->arguments->format, json_object_get(answer, "defects"));
    json_decref(answer);
    int exit_status = sphv_verdict_exit(test.verdict);
    sphv_self_test_free(&test);
    return exit_status;
}

static sphv_status read_options(struct session *session, sphv_error *error)
{
    const sphv_arguments *arguments = session->arguments;
    bool all = sphv_argument(arguments, "all") != NULL;
    if (arguments->operand_count && (all || sphv_argument(arguments, "self-test")))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "kernels named beside --%s; allowed: one or "
                         "the other",
                         all ? "all" : "self-test");
    session->options.implementation = sphv_argument(arguments, "implementation");
    if (session->options.implementation && arguments->operand_count != 1)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "--implementation with %d kernels; allowed: the one kernel that the "
                         "library computes",
                         arguments->operand_count);
    const char *seconds = sphv_argument(arguments, "time-limit");
    if (seconds) {
        sphv_number limit;
        sphv_status status = sphv_number_parse(seconds, &limit, error);
        if (status != SPHV_OK) return status;
        if (!(limit.value >= 0.01 && limit.value <= 3600))
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "--time-limit %.40s; allowed: 0.01 to 3600 seconds", seconds);
        session->options.time_limit = limit.value;
    }
    return sphv_dimension_option(arguments, 0, &session->options.dimension, error);
}

/// JSON: the object of the one kernel that was asked for, or a list of several.
static void print_answers(const struct session *session)
{
    if (json_array_size(session->answers) == 0) return; // stderr has said why
    if (session->arguments->format == SPHV_FORMAT_JSON)
        sphv_print_json(session->arguments->operand_count == 1 ? json_array_get(session->answers, 0)
                                                               : session->answers);
    else if (session->arguments->format == SPHV_FORMAT_CSV)
        sphv_print_rows(SPHV_FORMAT_CSV, session->answers);
}

static int run(const sphv_arguments *arguments)
{
    sphv_error error;
    struct session session = {.arguments = arguments};
    sphv_status status = read_options(&session, &error);
    if (status != SPHV_OK) return sphv_report_failure(arguments, &error);
    if (sphv_argument(arguments, "self-test")) return self_test(&session);
    // The catalogue helps to name causes; a kernel can be checked without it.
    if (sphv_catalogue_load(arguments->data_directory, &session.reference, &error) == SPHV_OK)
        session.options.reference = &session.reference;
    session.answers = json_array();
    if (arguments->operand_count)
        check_several(&session, arguments->operands, (size_t)arguments->operand_count);
    else
        check_all(&session);
    print_answers(&session);
    json_decref(session.answers);
    for (size_t i = 0; i < session.written_count; i++) free(session.written[i]);
    free(session.written);
    sphv_catalogue_free(&session.reference);
    return session.status;
}

static const sphv_option options[] = {
    {"dim", 'd', "D", "only this dimension: 1, 2 or 3 (default: all that the file declares)"},
    {"all", 'a', NULL, "the whole catalogue (also when no kernel is named)"},
    {"output", 'o', "DIR", "also write check-NAME.json and check-NAME.md to this folder"},
    {"implementation", 'i', "FILE", "a shared library that computes K: check it against the file"},
    {"time-limit", 't', "S", "seconds that the library may take (default: 5)"},
    {"self-test", 0, NULL, "apply every kind of defect to every kernel; are all caught?"},
    {NULL, 0, NULL, NULL},
};

const sphv_command sphv_command_check = {
    "check",
    "[K...]",
    "Check kernel files against theory; the verdict is the exit status",
    "K is a catalogue name or the path of a kernel file. Constants, derivatives and properties\n"
    "that the file claims are verified, and so is what every kernel must meet: it is positive\n"
    "and largest at the origin, value and slope are continuous and vanish at the edge. A check\n"
    "that fails names the likely cause. Lines marked 'stated' require nothing.\n\n"
    "With --implementation the functions\n"
    "  double kernel_value(double r, double h, int dim)       W(r, h)\n"
    "  double kernel_derivative(double r, double h, int dim)  dW/dr\n"
    "of a shared library are called in a child process and judged by their own rounding.\n\n"
    "Examples:\n"
    "  sphverify check cubic-spline\n"
    "  sphverify check mine.yaml --dim 3 --format json\n"
    "  sphverify check cubic-spline --implementation ./libmine.so\n"
    "  sphverify check --all -o checks\n",
    0,
    -1,
    options,
    run};
