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

/// Why the tolerance is what it is, and what became of a claim that is known not to hold.
static void put_explanation(FILE *stream, const sphv_claim *claim, bool surprising)
{
    fputs("<td class=t data-head=\"Why\">", stream);
    sphv_put_html(stream, claim->reason);
    if (surprising) fputs("<br><strong>This is not what the scene expects.</strong>", stream);
    if (claim->refuted) {
        fputs("<br><strong>Known not to hold:</strong> ", stream);
        sphv_put_html(stream, claim->refuted);
    }
    fputc('\n', stream);
}

static void put_claim(FILE *stream, const sphv_scene *scene, const sphv_claim *claim,
                      const sphv_claim_result *found)
{
    fputs("<tr><td class=t>", stream);
    sphv_put_html(stream, claim->statement);
    put_range(stream, scene, claim);
    fputs("<td data-head=\"Verdict\">", stream);
    sphv_html_verdict(stream, found->verdict);
    if (claim->refuted && !found->surprising) fputs("<br><span class=soft>as known</span>", stream);
    fputs("<td data-head=\"Theory\">", stream);
    sphv_html_number(stream, found->analytic, 6);
    fputs("<td data-head=\"Measured\">", stream);
    sphv_html_number(stream, found->empirical, 6);
    fputs("<td data-head=\"Claimed\">", stream);
    sphv_html_number(stream, claim->expected, 6);
    if (claim->tolerance > 0) {
        fputs(" ± ", stream);
        sphv_html_number(stream, claim->tolerance, 2);
    }
    put_explanation(stream, claim, found->surprising);
}

static void put_claims(FILE *stream, const sphv_scene_result *result)
{
    const sphv_scene *scene = result->scene;
    if (!scene->claim_count) return;
    fputs("<h4>Claims</h4>\n" SPHV_HTML_SCROLL "<table class=stacked><thead><tr>"
          "<th scope=col>Claim and how it is measured<th scope=col>Verdict<th scope=col>Theory"
          "<th scope=col>Measured<th scope=col>Claimed<th scope=col class=t>Tolerance and "
          "remarks</thead>\n"
          "<tbody>\n",
          stream);
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
    fputs("<h4>Agreement by curve</h4>\n" SPHV_HTML_SCROLL "<table><thead><tr>"
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
