#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "command.h"
#include "core/directory.h"
#include "sphverify/report.h"

/// Share of the work that the kernels' agreement tables take, for the progress bar.
static const double kernel_share = 0.3;

/// Checks one kernel and compares both halves over its agreement table.
static sphv_status run_kernel(const sphv_catalogue *catalogue, size_t i, sphv_report *report,
                              sphv_error *error)
{
    sphv_check_options options = {.reference = catalogue};
    sphv_status status =
        sphv_check_kernel(catalogue->kernels[i], &options, &report->checks[i], error);
    if (status != SPHV_OK || !sphv_kernel_profile(catalogue->kernels[i], 1)) return status;
    return sphv_agreement_run(catalogue->kernels[i], &report->agreements[i], error);
}

static void count_verdicts(sphv_report *report)
{
    for (size_t i = 0; i < report->kernel_count; i++) {
        const sphv_agreement *agreement = report->agreements[i];
        report->verdict = sphv_verdict_worse(report->verdict, report->checks[i].verdict);
        for (int verdict = SPHV_AGREES; agreement && verdict <= SPHV_INCONCLUSIVE; verdict++)
            if (agreement->exact[verdict])
                report->verdict = sphv_verdict_worse(report->verdict, (sphv_verdict)verdict);
    }
}

/// One kernel to each thread: what a kernel needs in turn keeps no thread waiting.
static sphv_status run_kernels(const sphv_arguments *arguments, sphv_catalogue *catalogue,
                               sphv_report *report, sphv_error *error)
{
    sphv_status first = sphv_catalogue_load(arguments->data_directory, catalogue, error);
    if (first != SPHV_OK) return first;
    report->kernel_count = catalogue->count;
    report->kernels = catalogue->kernels;
    report->agreements = calloc(catalogue->count + 1, sizeof *report->agreements);
    report->checks = calloc(catalogue->count + 1, sizeof *report->checks);
    if (!report->agreements || !report->checks)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    long count = (long)catalogue->count, done = 0;
#pragma omp parallel for schedule(dynamic, 1)
    for (long i = 0; i < count; i++) {
        sphv_error reason;
        sphv_status status = run_kernel(catalogue, (size_t)i, report, &reason);
#pragma omp critical(sphv_report_kernels)
        {
            if (status != SPHV_OK && first == SPHV_OK) {
                first = status;
                *error = reason;
            }
            sphv_progress_bar("kernels", kernel_share * (double)++done / (double)count);
        }
    }
    if (first == SPHV_OK) count_verdicts(report);
    return first;
}

static sphv_status run_one(const sphv_any_scene *scene, sphv_report *report, sphv_error *error)
{
    if (scene->scene) {
        sphv_scene_result **result = &report->scenes[report->scene_count];
        sphv_status status = sphv_scene_run(scene->scene, NULL, NULL, result, error);
        if (status != SPHV_OK) return status;
        report->scene_count++;
        report->verdict = sphv_verdict_worse(report->verdict, (*result)->verdict);
        return SPHV_OK;
    }
    sphv_convergence_result **result = &report->convergences[report->convergence_count];
    sphv_status status = sphv_convergence_run(scene->convergence, NULL, NULL, result, error);
    if (status != SPHV_OK) return status;
    report->convergence_count++;
    report->verdict = sphv_verdict_worse(report->verdict, (*result)->verdict);
    return SPHV_OK;
}

static sphv_status run_scenes(const sphv_arguments *arguments, const sphv_file_list *files,
                              sphv_any_scene *scenes, sphv_report *report, sphv_error *error)
{
    sphv_status status = SPHV_OK;
    report->scenes = calloc(files->count + 1, sizeof(sphv_scene_result *));
    report->convergences = calloc(files->count + 1, sizeof(sphv_convergence_result *));
    if (!report->scenes || !report->convergences)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    for (size_t i = 0; status == SPHV_OK && i < files->count; i++) {
        double share = (double)i / (double)files->count;
        sphv_progress_bar("scenes ", kernel_share + (1 - kernel_share) * share);
        status = sphv_any_scene_load(arguments->data_directory, files->paths[i], &scenes[i], error);
        if (status == SPHV_OK) status = run_one(&scenes[i], report, error);
    }
    return status;
}

static void free_report(sphv_report *report, sphv_catalogue *catalogue, sphv_any_scene *scenes,
                        const sphv_file_list *files)
{
    for (size_t i = 0; report->agreements && i < catalogue->count; i++)
        sphv_agreement_free(report->agreements[i]);
    for (size_t i = 0; report->checks && i < catalogue->count; i++)
        sphv_check_free(&report->checks[i]);
    for (size_t i = 0; i < files->count; i++) {
        if (report->scenes) sphv_scene_result_free(report->scenes[i]);
        if (report->convergences) sphv_convergence_result_free(report->convergences[i]);
        if (scenes) sphv_any_scene_free(&scenes[i]);
    }
    free(report->convergences);
    free(report->agreements);
    free(report->checks);
    free(report->scenes);
    sphv_catalogue_free(catalogue);
}

static void print_summary(const sphv_arguments *arguments, const sphv_report *report,
                          const char *directory, bool plots_missing)
{
    json_t *files = json_pack("[s+, s+, s+]", directory, "/index.html", directory, "/report.json",
                              directory, "/report.md");
    json_t *summary =
        json_pack("{s:s, s:I, s:I, s:b, s:o, s:o}", "verdict", sphv_verdict_name(report->verdict),
                  "kernels", (json_int_t)report->kernel_count, "scenes",
                  (json_int_t)report->scene_count + (json_int_t)report->convergence_count, "plots",
                  !plots_missing, "seconds", sphv_json_number(report->seconds), "files", files);
    if (arguments->format == SPHV_FORMAT_TEXT) {
        printf("%s: %zu kernels and %zu scenes (%.1f s)\n%s/index.html\n",
               sphv_verdict_name(report->verdict), report->kernel_count,
               report->scene_count + report->convergence_count, report->seconds, directory);
    } else if (arguments->format == SPHV_FORMAT_JSON) {
        sphv_print_json(summary);
    } else {
        json_t *rows = json_pack("[O]", summary);
        sphv_print_rows(arguments->format, rows);
        json_decref(rows);
    }
    json_decref(summary);
}

static double seconds_since(const struct timespec *start)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)(now.tv_sec - start->tv_sec) + 1e-9 * (double)(now.tv_nsec - start->tv_nsec);
}

static int run(const sphv_arguments *arguments)
{
    const char *directory = sphv_argument(arguments, "output");
    struct timespec start;
    sphv_catalogue catalogue = {0, NULL};
    sphv_file_list files = {0, NULL};
    sphv_any_scene *scenes = NULL;
    sphv_report report = {.verdict = SPHV_AGREES};
    sphv_error error;
    bool plots_missing = false;
    if (!directory) directory = "report";
    clock_gettime(CLOCK_MONOTONIC, &start);
    sphv_status status = sphv_output_check(directory, &error);
    if (status == SPHV_OK)
        status = sphv_file_list_read(arguments->data_directory, "scenes", ".yaml", &files, &error);
    if (status == SPHV_OK) {
        scenes = calloc(files.count + 1, sizeof *scenes);
        status = scenes ? run_kernels(arguments, &catalogue, &report, &error)
                        : sphv_fail(&error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    if (status == SPHV_OK) status = run_scenes(arguments, &files, scenes, &report, &error);
    report.seconds = seconds_since(&start);
    if (status == SPHV_OK) status = sphv_report_write(&report, directory, &plots_missing, &error);
    report.seconds = seconds_since(&start);
    sphv_progress_bar(NULL, 1);
    int exit_status = sphv_verdict_exit(report.verdict);
    if (status == SPHV_OK)
        print_summary(arguments, &report, directory, plots_missing);
    else
        exit_status = sphv_report_failure(arguments, &error);
    if (status == SPHV_OK && plots_missing)
        fputs("sphverify report: no plots: gnuplot is missing or failed; the tables are complete\n",
              stderr);
    free_report(&report, &catalogue, scenes, &files);
    free(scenes);
    sphv_file_list_free(&files);
    return exit_status;
}

static const sphv_option options[] = {
    {"output", 'o', "DIR", "folder for index.html, report.json and report.md (default: report)"},
    {NULL, 0, NULL, NULL},
};

const sphv_command sphv_command_report = {
    "report",
    "",
    "All kernels and all scenes in one HTML page, with JSON and Markdown beside it",
    "The page is self-contained: plots are inlined and nothing is fetched. Without gnuplot it\n"
    "says so and keeps its tables.\n\n"
    "Example:\n"
    "  sphverify report -o report && xdg-open report/index.html\n",
    0,
    0,
    options,
    run};
