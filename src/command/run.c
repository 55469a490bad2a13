#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command.h"
#include "core/directory.h"
#include "report/convergence_json.h"
#include "report/scene_facts.h"
#include "report/scene_json.h"
#include "run_convergence.h"
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
    sphv_error reason;
    sphv_status status = sphv_plot_scene(result, &svg, &reason);
    snprintf(name, sizeof name, "%.64s.svg", result->scene->name);
    return sphv_write_drawn(status, svg, &reason, directory, name, error);
}

/// One row per claim, for CSV and Markdown.
static void add_claim_rows(json_t *rows, const json_t *scene)
{
    json_t *claim;
    size_t j;
    json_array_foreach(json_object_get(scene, "claims"), j, claim)
    {
        json_t *row = json_object();
        static const char *const keys[] = {"id",        "statement", "measure",   "expected",
                                           "tolerance", "analytic",  "empirical", "verdict"};
        json_object_set(row, "scene", json_object_get(scene, "scene"));
        for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
            json_object_set(row, keys[k], json_object_get(claim, keys[k]));
        json_array_append_new(rows, row);
    }
}

/// What `run` found, for the formats that are written once at the end.
struct found {
    json_t *all;  ///< scenes, whole
    json_t *rows; ///< one per claim or printed cell
};

static int run_curves(const sphv_arguments *arguments, const sphv_scene *scene,
                      const char *directory, struct found *found)
{
    sphv_scene_result *result = NULL;
    sphv_error error;
    bool plots = !sphv_argument(arguments, "no-plot");
    sphv_status status = sphv_scene_run(scene, sphv_progress_bar, scene->name, &result, &error);
    if (status == SPHV_OK) status = write_csv(result, directory, &error);
    if (status == SPHV_OK && plots) status = write_plot(result, directory, &error);
    int exit_status = status == SPHV_OK ? 0 : sphv_report_failure(arguments, &error);
    if (!result) return exit_status;
    json_t *json = sphv_scene_json(result);
    add_claim_rows(found->rows, json);
    json_array_append_new(found->all, json);
    if (arguments->format == SPHV_FORMAT_TEXT) {
        print_text(result);
        if (status == SPHV_OK)
            printf("written: %s/%s.csv%s\n", directory, scene->name, plots ? " and .svg" : "");
    }
    exit_status = worse(exit_status, sphv_verdict_exit(result->verdict));
    sphv_scene_result_free(result);
    return exit_status;
}

static int run_convergence(const sphv_arguments *arguments, const sphv_convergence *scene,
                           const char *directory, struct found *found)
{
    sphv_convergence_result *result = NULL;
    sphv_error error;
    bool plots = !sphv_argument(arguments, "no-plot");
    sphv_status status =
        sphv_convergence_run(scene, sphv_progress_bar, scene->name, &result, &error);
    if (status == SPHV_OK) status = sphv_write_convergence(result, directory, plots, &error);
    int exit_status = status == SPHV_OK ? 0 : sphv_report_failure(arguments, &error);
    if (!result) return exit_status;
    json_t *rows = sphv_convergence_rows(result);
    json_array_extend(found->rows, rows);
    json_decref(rows);
    if (arguments->format == SPHV_FORMAT_JSON)
        json_array_append_new(found->all, sphv_convergence_json(result));
    if (arguments->format == SPHV_FORMAT_TEXT) {
        sphv_print_convergence(result);
        if (status == SPHV_OK) {
            printf("written: %s/%s.csv", directory, scene->name);
            for (size_t p = 0; plots && p < scene->plot_count; p++)
                printf(", %s-%s.svg", scene->name, scene->plots[p].id);
            putchar('\n');
        }
    }
    exit_status = worse(exit_status, sphv_verdict_exit(result->verdict));
    sphv_convergence_result_free(result);
    return exit_status;
}

static int run_scene(const sphv_arguments *arguments, const char *name, struct found *found)
{
    const char *directory = sphv_argument(arguments, "output");
    char *path = NULL;
    sphv_any_scene scene = {NULL, NULL};
    sphv_error error;
    if (!directory) directory = ".";
    sphv_status status =
        sphv_file_find(arguments->data_directory, "scenes", ".yaml", "scene", name, &path, &error);
    if (status == SPHV_OK)
        status = sphv_any_scene_load(arguments->data_directory, path, &scene, &error);
    int exit_status = status != SPHV_OK ? sphv_report_failure(arguments, &error)
                      : scene.scene
                          ? run_curves(arguments, scene.scene, directory, found)
                          : run_convergence(arguments, scene.convergence, directory, found);
    sphv_any_scene_free(&scene);
    free(path);
    return exit_status;
}

static int run(const sphv_arguments *arguments)
{
    const char *directory = sphv_argument(arguments, "output");
    sphv_error error;
    if (sphv_output_check(directory ? directory : ".", &error) != SPHV_OK)
        return sphv_report_failure(arguments, &error);
    struct found found = {json_array(), json_array()};
    int status = 0;
    for (int i = 0; i < arguments->operand_count; i++) {
        if (i && arguments->format == SPHV_FORMAT_TEXT) putchar('\n');
        status = worse(status, run_scene(arguments, arguments->operands[i], &found));
    }
    if (arguments->format == SPHV_FORMAT_JSON)
        sphv_print_json(found.all);
    else if (arguments->format != SPHV_FORMAT_TEXT)
        sphv_print_rows(arguments->format, found.rows);
    json_decref(found.all);
    json_decref(found.rows);
    return status;
}

static const sphv_option options[] = {
    {"output", 'o', "DIR", "folder for SCENE.csv and its SVG (default: the current one)"},
    {"no-plot", 0, NULL, "write no SVG; gnuplot is then not needed"},
    {NULL, 0, NULL, NULL},
};

const sphv_command sphv_command_run = {
    "run",
    "SCENE...",
    "Regenerate figures and tables: points as CSV, plots as SVG, and a verdict on each claim",
    "SCENE is the name of a scene in the data folder or the path of a scene file. The verdict is\n"
    "'agrees' when both halves agree at every point and every claim turns out as its scene says;\n"
    "claims of a paper that are known not to hold are shown with the reason.\n"
    "A scene of kind 'convergence' reproduces a table of rates cell by cell; its figures are\n"
    "written as SCENE-FIGURE.svg, and --format csv prints one row per cell.\n\n"
    "Examples:\n"
    "  sphverify run quinlan-2006-fig-2a -o figures\n"
    "  sphverify run sigalotti-2016-table-2 -o figures\n",
    1,
    -1,
    options,
    run};
