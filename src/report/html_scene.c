#include <math.h>

#include "html.h"
#include "text.h"

static void put_range(FILE *stream, const sphv_scene *scene, const sphv_claim *claim)
{
    static const char *const names[] = {
        [SPHV_OVER_Q] = "q", [SPHV_OVER_H] = "h/λ", [SPHV_OVER_SPACING] = "Δx/h"};
    fputs("<br><span class=soft>", stream);
    sphv_put_html(stream, claim->measure->meaning);
    fputs("; curve “", stream);
    sphv_put_html(stream, scene->curves[claim->curve].label);
    if (claim->has_reference) {
        fputs("” against “", stream);
        sphv_put_html(stream, scene->curves[claim->reference].label);
    }
    fprintf(stream, "”, %s ", names[scene->abscissa]);
    sphv_html_number(stream, claim->from, 4);
    fputs(" … ", stream);
    sphv_html_number(stream, claim->to, 4);
    if (claim->special_only) fputs(", only Δx/h = 2κ/(2n+1)", stream);
    fputs("</span>", stream);
}

static void put_claim(FILE *stream, const sphv_scene *scene, const sphv_claim *claim,
                      const sphv_claim_result *found)
{
    fputs("<tr><td class=t>", stream);
    sphv_put_html(stream, claim->statement);
    put_range(stream, scene, claim);
    sphv_html_verdict_cell(stream, found->verdict);
    sphv_html_number_cell(stream, found->analytic, 6);
    sphv_html_number_cell(stream, found->empirical, 6);
    fputs("<td>", stream);
    sphv_html_number(stream, claim->expected, 6);
    if (claim->tolerance > 0) {
        fputs(" ± ", stream);
        sphv_html_number(stream, claim->tolerance, 2);
    }
    sphv_html_text_cell(stream, claim->reason);
    fputs("<td class=t>", stream);
    if (claim->refuted && !found->surprising) {
        fputs("Known not to hold: ", stream);
        sphv_put_html(stream, claim->refuted);
    } else if (claim->refuted) {
        fputs("<strong>Not as expected:</strong> the scene says it does not hold: ", stream);
        sphv_put_html(stream, claim->refuted);
    } else if (found->surprising) {
        fputs("<strong>Not as expected.</strong>", stream);
    }
    fputc('\n', stream);
}

static void put_claims(FILE *stream, const sphv_scene_result *result)
{
    static const char *const columns[] = {
        "Claim and measure",       "Verdict", "Theory", "Measured", "Expected",
        "Reason of the tolerance", "Remark",  NULL};
    const sphv_scene *scene = result->scene;
    if (!scene->claim_count) return;
    fputs("<h4>Claims</h4>\n", stream);
    sphv_html_table_begin(stream, NULL, columns);
    for (size_t i = 0; i < scene->claim_count; i++)
        put_claim(stream, scene, &scene->claims[i], &result->claims[i]);
    sphv_html_table_end(stream);
}

static void put_curve_row(FILE *stream, const sphv_scene_result *result, size_t c)
{
    size_t exact[3] = {0, 0, 0}, paper[3] = {0, 0, 0};
    double largest = 0, bound = 0;
    for (size_t i = 0; i < result->sample_count[c]; i++) {
        const sphv_sample *sample = &result->samples[c][i];
        exact[sample->point.verdict]++;
        if (sample->n >= 0) paper[sample->paper_verdict]++;
        if (fabs(sample->point.difference) > largest) {
            largest = fabs(sample->point.difference);
            bound = sample->point.analytic.total.bound + sample->point.empirical.total.bound;
        }
    }
    sphv_html_row_begin(stream, result->scene->curves[c].label);
    fputs("<td><code>", stream);
    sphv_put_html(stream, sphv_kernel_name(result->scene->curves[c].kernel));
    fputs("</code>", stream);
    sphv_html_tally_cells(stream, exact);
    sphv_html_tally_cells(stream, paper);
    sphv_html_number_cell(stream, largest, 2);
    sphv_html_number_cell(stream, bound, 2);
    fputc('\n', stream);
}

static void put_curves(FILE *stream, const sphv_scene_result *result)
{
    fputs("<h4>Agreement by curve</h4>\n<div class=scroll tabindex=0><table><thead><tr>"
          "<th scope=col rowspan=2>Curve<th scope=col rowspan=2>Kernel<th scope=colgroup "
          "colspan=3>Exact form: points<th scope=colgroup colspan=3>Paper’s form: points"
          "<th scope=col rowspan=2>Largest difference<th scope=col rowspan=2>Its bound"
          "<tr><th scope=col>agree<th scope=col>disagree<th scope=col>inconcl."
          "<th scope=col>agree<th scope=col>disagree<th scope=col>inconcl.</thead>\n<tbody>\n",
          stream);
    for (size_t c = 0; c < result->scene->curve_count; c++) put_curve_row(stream, result, c);
    sphv_html_table_end(stream);
}

void sphv_html_scene(FILE *stream, const sphv_rendering *rendering, size_t index)
{
    const sphv_scene_result *result = rendering->report->scenes[index];
    const sphv_scene *scene = result->scene;
    fprintf(stream, "<article id=\"scene-%zu\"><h3>", index);
    sphv_put_html(stream, scene->title);
    fputs(" (<code>", stream);
    sphv_put_html(stream, scene->name);
    fputs("</code>)</h3>\n<p>Verdict: ", stream);
    sphv_html_verdict(stream, result->verdict);
    fputs(" <span class=soft>Source: ", stream);
    sphv_put_html(stream, scene->source);
    fputs("</span></p>\n", stream);
    sphv_html_figure(stream, rendering, rendering->scene_plots[index],
                     scene->abscissa == SPHV_OVER_Q
                         ? "Points: exact arithmetic. Curves: the evaluation that the sums use."
                         : "Curves: measured. Filled points: the exact form. Hollow points: the "
                           "paper’s form, where it applies. Points that would touch are drawn "
                           "only once; the tables count them all.");
    sphv_html_paragraphs(stream, scene->notes, "note");
    put_claims(stream, result);
    put_curves(stream, result);
    fputs("</article>\n", stream);
}
