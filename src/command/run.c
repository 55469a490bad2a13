#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command.h"
#include "core/directory.h"
#include "report/scene_facts.h"
#include "report/scene_json.h"
#include "sphverify/report.h"

static int worse(int a, int b)
{
    return a > b ? a : b;
}

static void print_claim(const sphv_claim *claim, const sphv_claim_result *found)
{
    printf("  %-12s  %s\n", sphv_verdict_name(found->verdict), claim->statement);
    printf("  %-12s  %s: expected %.6g ± %.2g", "", claim->measure->name, claim->expected,
           claim->tolerance);
    if (isfinite(found->analytic)) printf(", theory %.6g", found->analytic);
    if (isfinite(found->empirical))
        printf(", measured %.6g\n", found->empirical);
    else
        printf(", too few points to measure\n");
    if (claim->refuted) printf("  %-12s  why it fails: %s\n", "", claim->refuted);
    if (found->surprising && claim->refuted) printf("  %-12s  yet it holds here\n", "");
}

/// What was done for a curve of a statistical scene, its seed, and what failed.
static void print_curve(const sphv_scene_result *result, size_t c)
{
    const sphv_curve *curve = &result->scene->curves[c];
    sphv_curve_facts facts = sphv_curve_facts_collect(result, c);
    printf("  %-12s  %s, %s", curve->id, facts.method, facts.layout);
    if (isfinite(facts.sigma)) printf(", σ/Δx = %g", facts.sigma);
    printf(", volumes %s", facts.volume);
    if (facts.random) printf(", seed %llu", (unsigned long long)curve->experiment.seed);
    if (facts.statistical) {
        char faults[120], realisations[SPHV_REALISATIONS_TEXT];
        sphv_faults_text(faults, sizeof faults, &facts.faults);
        printf(", %s realisations a point, without result: %s",
               sphv_realisations_text(realisations, &facts), faults);
    }
    putchar('\n');
}

static void print_text(const sphv_scene_result *result)
{
    const sphv_scene *scene = result->scene;
    printf("%s: %s\n%s\n\n", scene->name, scene->title, scene->source);
    printf("  %-12s  %zu points agree, %zu disagree, %zu inconclusive\n",
           scene->statistical ? "theory" : "exact form", result->agreeing, result->disagreeing,
           result->inconclusive);
    if (result->paper_agreeing + result->paper_disagreeing + result->paper_inconclusive > 0)
        printf("  paper's form  %zu points agree, %zu disagree, %zu inconclusive\n",
               result->paper_agreeing, result->paper_disagreeing, result->paper_inconclusive);
    if (scene->statistical)
        for (size_t c = 0; c < scene->curve_count; c++) print_curve(result, c);
    putchar('\n');
    for (size_t i = 0; i < scene->claim_count; i++)
        print_claim(&scene->claims[i], &result->claims[i]);
    printf("\n%s: %s (%.3f s)\n", scene->name, sphv_verdict_name(result->verdict), result->seconds);
}

static sphv_status write_csv(const sphv_scene_result *result, const char *directory,
                             sphv_error *error)
{
    char name[96];
    sphv_output_file file;
    snprintf(name, sizeof name, "%.64s.csv", result->scene->name);
    sphv_status status = sphv_output_open(directory, name, &file, error);
    if (status != SPHV_OK) return status;
    sphv_scene_csv(file.stream, result);
    return sphv_output_commit(&file, error);
}

static sphv_status write_plot(const sphv_scene_result *result, const char *directory,
                              sphv_error *error)
{
    char name[96], *svg = NULL;
    sphv_output_file file;
    sphv_error reason;
    sphv_status status = sphv_plot_scene(result, &svg, &reason);
    if (status != SPHV_OK)
        return sphv_fail(error, status, "%.600s; with --no-plot all but the SVG is written",
                         reason.message);
    snprintf(name, sizeof name, "%.64s.svg", result->scene->name);
    status = sphv_output_open(directory, name, &file, error);
    if (status == SPHV_OK) {
        fputs(svg, file.stream);
        status = sphv_output_commit(&file, error);
    }
    free(svg);
    return status;
}

static int run_scene(const sphv_arguments *arguments, const char *name, json_t *all)
{
    const char *directory = sphv_argument(arguments, "output");
    char *path = NULL;
    sphv_scene *scene = NULL;
    sphv_scene_result *result = NULL;
    sphv_error error;
    if (!directory) directory = ".";
    sphv_status status =
        sphv_file_find(arguments->data_directory, "scenes", ".yaml", "scene", name, &path, &error);
    if (status == SPHV_OK)
        status = sphv_scene_load(arguments->data_directory, path, &scene, &error);
    if (status == SPHV_OK)
        status = sphv_scene_run(scene, sphv_progress_bar, scene->name, &result, &error);
    if (status == SPHV_OK) status = write_csv(result, directory, &error);
    if (status == SPHV_OK && !sphv_argument(arguments, "no-plot"))
        status = write_plot(result, directory, &error);
    int exit_status = status == SPHV_OK ? 0 : sphv_report_failure(arguments, &error);
    if (result) {
        json_array_append_new(all, sphv_scene_json(result));
        if (arguments->format == SPHV_FORMAT_TEXT) {
            print_text(result);
            if (status == SPHV_OK)
                printf("written: %s/%s.csv%s\n", directory, scene->name,
                       sphv_argument(arguments, "no-plot") ? "" : " and .svg");
        }
        exit_status = worse(exit_status, sphv_verdict_exit(result->verdict));
    }
    sphv_scene_result_free(result);
    sphv_scene_free(scene);
    free(path);
    return exit_status;
}

/// One row per claim, for CSV and Markdown.
static json_t *claim_rows(const json_t *all)
{
    json_t *rows = json_array(), *scene, *claim;
    size_t i, j;
    json_array_foreach(all, i, scene) json_array_foreach(json_object_get(scene, "claims"), j, claim)
    {
        json_t *row = json_object();
        static const char *const keys[] = {"id",        "statement", "measure",   "expected",
                                           "tolerance", "analytic",  "empirical", "verdict"};
        json_object_set(row, "scene", json_object_get(scene, "scene"));
        for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
            json_object_set(row, keys[k], json_object_get(claim, keys[k]));
        json_array_append_new(rows, row);
    }
    return rows;
}

static int run(const sphv_arguments *arguments)
{
    const char *directory = sphv_argument(arguments, "output");
    sphv_error error;
    if (sphv_output_check(directory ? directory : ".", &error) != SPHV_OK)
        return sphv_report_failure(arguments, &error);
    json_t *all = json_array();
    int status = 0;
    for (int i = 0; i < arguments->operand_count; i++) {
        if (i && arguments->format == SPHV_FORMAT_TEXT) putchar('\n');
        status = worse(status, run_scene(arguments, arguments->operands[i], all));
    }
    if (arguments->format == SPHV_FORMAT_JSON) {
        sphv_print_json(all);
    } else if (arguments->format != SPHV_FORMAT_TEXT) {
        json_t *rows = claim_rows(all);
        sphv_print_rows(arguments->format, rows);
        json_decref(rows);
    }
    json_decref(all);
    return status;
}

static const sphv_option options[] = {
    {"output", 'o', "DIR", "folder for SCENE.csv and SCENE.svg (default: the current one)"},
    {"no-plot", 0, NULL, "write no SVG; gnuplot is then not needed"},
    {NULL, 0, NULL, NULL},
};

const sphv_command sphv_command_run = {
    "run",
    "SCENE...",
    "Regenerate figures: points as CSV, plot as SVG, and a verdict on each claim",
    "SCENE is the name of a scene in the data folder or the path of a scene file. The verdict is\n"
    "'agrees' when both halves agree at every point and every claim turns out as its scene says;\n"
    "claims of a paper that are known not to hold are shown with the reason.\n\n"
    "Example:\n"
    "  sphverify run quinlan-2006-fig-2a -o figures\n",
    1,
    -1,
    options,
    run};
