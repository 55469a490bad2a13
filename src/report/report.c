#include <stdlib.h>

#include "plot.h"
#include "rendering.h"

const char *const sphv_report_preface[] = {
    "SPH estimates the gradient of A = sin(2πx/λ) on a uniform lattice as (1 + E) times the true "
    "one. E is the relative truncation error: a smoothing part (the kernel has a width) and a "
    "discretisation part (particles are a sum, not an integral).",
    "Two independent halves work out each number: the analytic half from the kernel’s moments and "
    "knots, without summing over particles; the empirical half from particle sums, without any "
    "theory. Each carries a bound of its own error.",
    "“agrees” means that the two differ by no more than the sum of their bounds, and that the "
    "bounds would reveal an error of 1 %; “inconclusive”, that they would not; “disagrees”, that "
    "the difference is larger than the bounds. The exact form of the theory counts all knots at "
    "any spacing; the paper’s form is eq. 16 of Quinlan, Basa and Lastiwka 2006 with its signs "
    "mended, judged by the size of its first neglected terms.",
    "On disordered particles, and for methods other than standard SPH, theory predicts the "
    "expected "
    "L₂ norm of the error over the perturbations and its bound is the size of the order it "
    "neglects; "
    "the measurement is a Monte-Carlo mean over realisations, its bound half of the 99.9 % "
    "interval. "
    "They agree where the two intervals meet; it is “inconclusive” where either is wider than the "
    "scene asks.",
    NULL};

sphv_verdict sphv_rendering_verdict(const sphv_rendering *rendering)
{
    sphv_verdict verdict = rendering->report->verdict;
    for (size_t i = 0; i < rendering->report->kernel_count; i++)
        verdict = sphv_verdict_worse(verdict, rendering->facts[i].verdict);
    return verdict;
}

void sphv_scene_tallies(const sphv_scene_result *result, size_t exact[3], size_t paper[3])
{
    exact[SPHV_AGREES] = result->agreeing;
    exact[SPHV_DISAGREES] = result->disagreeing;
    exact[SPHV_INCONCLUSIVE] = result->inconclusive;
    paper[SPHV_AGREES] = result->paper_agreeing;
    paper[SPHV_DISAGREES] = result->paper_disagreeing;
    paper[SPHV_INCONCLUSIVE] = result->paper_inconclusive;
}

size_t sphv_scene_expected_claims(const sphv_scene_result *result)
{
    size_t expected = 0;
    for (size_t i = 0; i < result->scene->claim_count; i++)
        expected += !result->claims[i].surprising;
    return expected;
}

/// Draws the plot that stands at a place in the list of all: kernels, scenes, then the figures of
/// each convergence scene.
static sphv_status draw_plot(sphv_rendering *rendering, size_t place, sphv_error *error)
{
    const sphv_report *report = rendering->report;
    char id[48];
    if (place < report->kernel_count) {
        snprintf(id, sizeof id, "k%zu", place);
        return sphv_plot_kernel_as(report->kernels[place], id, &rendering->kernel_plots[place],
                                   error);
    }
    place -= report->kernel_count;
    if (place < report->scene_count) {
        snprintf(id, sizeof id, "s%zu", place);
        return sphv_plot_scene_as(report->scenes[place], id, &rendering->scene_plots[place], error);
    }
    place -= report->scene_count;
    size_t index = 0;
    while (place >= report->convergences[index]->scene->plot_count)
        place -= report->convergences[index++]->scene->plot_count;
    snprintf(id, sizeof id, "c%zu-%zu", index, place);
    return sphv_plot_rates_as(report->convergences[index], place, id,
                              &rendering->rate_plots[index][place], error);
}

/// Draws all plots, two or more at a time.
static void draw_plots(sphv_rendering *rendering)
{
    const sphv_report *report = rendering->report;
    long count = (long)(report->kernel_count + report->scene_count);
    for (size_t i = 0; i < report->convergence_count; i++)
        count += (long)report->convergences[i]->scene->plot_count;
#pragma omp parallel for schedule(dynamic, 1)
    for (long i = 0; i < count; i++) {
        sphv_error error;
        if (draw_plot(rendering, (size_t)i, &error) != SPHV_OK) {
#pragma omp critical(sphv_report_plots)
            {
                rendering->plots_missing = true;
                rendering->plot_error = error;
            }
        }
    }
}

/// Room for the figures of the convergence scenes.
static bool make_rate_plots(sphv_rendering *rendering)
{
    const sphv_report *report = rendering->report;
    rendering->rate_plots = calloc(report->convergence_count + 1, sizeof *rendering->rate_plots);
    bool whole = rendering->rate_plots != NULL;
    for (size_t i = 0; whole && i < report->convergence_count; i++) {
        size_t plots = report->convergences[i]->scene->plot_count;
        rendering->rate_plots[i] = calloc(plots + 1, sizeof **rendering->rate_plots);
        whole = rendering->rate_plots[i] != NULL;
    }
    return whole;
}

static sphv_status prepare(sphv_rendering *rendering, sphv_error *error)
{
    const sphv_report *report = rendering->report;
    rendering->facts = calloc(report->kernel_count + 1, sizeof *rendering->facts);
    rendering->kernel_plots = calloc(report->kernel_count + 1, sizeof *rendering->kernel_plots);
    rendering->scene_plots = calloc(report->scene_count + 1, sizeof *rendering->scene_plots);
    bool room = make_rate_plots(rendering);
    if (!rendering->facts || !rendering->kernel_plots || !rendering->scene_plots || !room)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    long count = (long)report->kernel_count;
#pragma omp parallel for schedule(dynamic, 1)
    for (long i = 0; i < count; i++)
        sphv_kernel_facts_collect(report->kernels[i], report->agreements[i],
                                  report->checks ? &report->checks[i] : NULL, &rendering->facts[i]);
    rendering->methods = sphv_method_facts_collect(report, &rendering->method_count);
    if (!rendering->methods) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    sphv_status status = sphv_slips_compute(report, &rendering->slips, error);
    if (status == SPHV_OK) status = sphv_volume_rules_compute(report, &rendering->rules, error);
    if (status == SPHV_OK) draw_plots(rendering);
    return status;
}

static void release(sphv_rendering *rendering)
{
    for (size_t i = 0; rendering->kernel_plots && i < rendering->report->kernel_count; i++)
        free(rendering->kernel_plots[i]);
    for (size_t i = 0; rendering->scene_plots && i < rendering->report->scene_count; i++)
        free(rendering->scene_plots[i]);
    for (size_t i = 0; rendering->rate_plots && i < rendering->report->convergence_count; i++) {
        size_t plots = rendering->report->convergences[i]->scene->plot_count;
        for (size_t p = 0; rendering->rate_plots[i] && p < plots; p++)
            free(rendering->rate_plots[i][p]);
        free(rendering->rate_plots[i]);
    }
    free(rendering->rate_plots);
    free(rendering->kernel_plots);
    free(rendering->scene_plots);
    free(rendering->facts);
    free(rendering->methods);
    sphv_volume_rules_free(&rendering->rules);
}

/// Writes all files before the first gets its name, so that a report is never half of two runs.
static sphv_status write_files(const sphv_rendering *rendering, const char *directory,
                               sphv_error *error)
{
    static const char *const names[] = {"report.json", "report.md", "index.html"};
    enum { FILES = sizeof names / sizeof *names };
    sphv_output_file files[FILES] = {{NULL, NULL, NULL}};
    sphv_status status = SPHV_OK;
    for (int i = 0; status == SPHV_OK && i < FILES; i++)
        status = sphv_output_open(directory, names[i], &files[i], error);
    if (status == SPHV_OK) {
        if (!sphv_render_json(files[0].stream, rendering))
            status = sphv_fail(error, SPHV_RESOURCE_FAILURE, "%s: cannot be written: out of memory",
                               files[0].path);
        sphv_render_markdown(files[1].stream, rendering);
        sphv_render_html(files[2].stream, rendering);
    }
    for (int i = 0; status == SPHV_OK && i < FILES; i++)
        status = sphv_output_commit(&files[i], error);
    for (int i = 0; i < FILES; i++) sphv_output_discard(&files[i]);
    return status;
}

sphv_status sphv_report_write(const sphv_report *report, const char *directory, bool *plots_missing,
                              sphv_error *error)
{
    sphv_rendering rendering = {.report = report};
    sphv_status status = prepare(&rendering, error);
    if (status == SPHV_OK) status = write_files(&rendering, directory, error);
    if (plots_missing) *plots_missing = rendering.plots_missing;
    release(&rendering);
    return status;
}
