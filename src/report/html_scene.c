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

/// Heads of sphv_html_tally_cells.
static const char tally_heads[] = "<th scope=col>agree<th scope=col>disagree<th scope=col>inconcl.";

/// Curves of a scene on a lattice: both forms beside measurement.
static void put_lattice_curves(FILE *stream, const sphv_scene_result *result)
{
    bool paper = sphv_scene_has_paper(result), over_q = result->scene->abscissa == SPHV_OVER_Q;
    fprintf(stream,
            "<h4>Agreement by curve</h4>\n" SPHV_HTML_SCROLL "<table><thead><tr>"
            "<th scope=col rowspan=2>Curve<th scope=col rowspan=2>Kernel<th scope=colgroup "
            "colspan=3>%s: points%s<th scope=col rowspan=2>Largest difference"
            "<th scope=col rowspan=2>Its bound<tr>%s%s</thead>\n<tbody>\n",
            over_q ? "Exact arithmetic" : "Exact form",
            paper ? "<th scope=colgroup colspan=3>Paper’s form: points" : "", tally_heads,
            paper ? tally_heads : "");
    for (size_t c = 0; c < result->scene->curve_count; c++) {
        sphv_curve_facts facts = sphv_curve_facts_collect(result, c);
        sphv_html_row_begin(stream, result->scene->curves[c].label);
        fputs("<td><code>", stream);
        sphv_put_html(stream, sphv_kernel_name(result->scene->curves[c].kernel));
        fputs("</code>", stream);
        sphv_html_tally_cells(stream, facts.exact);
        if (paper) sphv_html_tally_cells(stream, facts.paper);
        sphv_html_number_cell(stream, facts.difference, 2);
        sphv_html_number_cell(stream, facts.bound, 2);
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
}

static void put_experiment(FILE *stream, const sphv_curve *curve, const sphv_curve_facts *facts)
{
    sphv_html_row_begin(stream, curve->label);
    fputs("<td><code>", stream);
    sphv_put_html(stream, sphv_kernel_name(curve->kernel));
    fprintf(stream, "</code><td>%s<td>%s<td>%s", facts->method, facts->layout, facts->volume);
    sphv_html_number_cell(stream, facts->sigma, 6);
    if (facts->random)
        fprintf(stream, "<td>%llu", (unsigned long long)curve->experiment.seed);
    else
        fputs("<td>–", stream);
    char realisations[SPHV_REALISATIONS_TEXT];
    fprintf(stream, "<td>%s", sphv_realisations_text(realisations, facts));
}

/// Curves of a statistical scene: what was done, how it agrees, and what failed.
static void put_statistical_curves(FILE *stream, const sphv_scene_result *result)
{
    const sphv_scene *scene = result->scene;
    static const char *const columns[] = {"Curve",
                                          "Kernel",
                                          "Method",
                                          "Layout",
                                          "Volumes",
                                          "σ/Δx",
                                          "Seed",
                                          "Realisa&shy;tions a point",
                                          "Points: agree / disagree / inconcl.",
                                          "Largest relative difference",
                                          "Estimates",
                                          "Without result: singu&shy;lar / ill-cond. / not finite",
                                          "Worst condi&shy;tion number",
                                          NULL};
    fputs("<h4>Agreement by curve</h4>\n", stream);
    sphv_html_table_begin(stream, NULL, columns);
    for (size_t c = 0; c < scene->curve_count; c++) {
        sphv_curve_facts facts = sphv_curve_facts_collect(result, c);
        put_experiment(stream, &scene->curves[c], &facts);
        fprintf(stream, "<td%s>%zu / %zu / %zu",
                facts.exact[SPHV_DISAGREES]      ? " class=d"
                : facts.exact[SPHV_INCONCLUSIVE] ? " class=i"
                                                 : "",
                facts.exact[SPHV_AGREES], facts.exact[SPHV_DISAGREES],
                facts.exact[SPHV_INCONCLUSIVE]);
        sphv_html_number_cell(stream, 100 * facts.relative, 2);
        if (isfinite(facts.relative)) fputs(" %", stream);
        fprintf(stream, "<td>%ld<td>%ld / %ld / %ld", facts.faults.estimates, facts.faults.singular,
                facts.faults.ill_conditioned, facts.faults.not_finite);
        sphv_html_number_cell(stream, facts.faults.worst_condition, 3);
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
    fputs("<p class=soft>Realisations are added until the 99.9 % interval of the mean is as narrow "
          "as the scene asks. The difference is that of the expected norm from the measured one; "
          "where it is large the particles left out, or the order that theory neglects, decide."
          "</p>\n",
          stream);
}

static const char *caption(const sphv_scene_result *result)
{
    if (result->scene->abscissa == SPHV_OVER_Q)
        return "Points: exact arithmetic. Curves: the evaluation that the sums use.";
    if (result->scene->statistical)
        return "Curves: Monte-Carlo mean of the measured norm; its 99.9 % interval is no wider "
               "than "
               "the line where the points agree. Points: expected norm by theory; their bars: its "
               "bound, where that exceeds a tenth of it.";
    if (sphv_scene_has_paper(result))
        return "Curves: measured. Filled points: the exact form. Hollow points: the paper’s form, "
               "where it applies. Points that would touch are drawn only once; the tables count "
               "them all.";
    return "Curves: measured. Points: the exact form. Points that would touch are drawn only once; "
           "the tables count them all.";
}

void sphv_html_scene(FILE *stream, const sphv_rendering *rendering, size_t index)
{
    const sphv_scene_result *result = rendering->report->scenes[index];
    const sphv_scene *scene = result->scene;
    sphv_html_scene_head(stream, "scene", index, scene->title, scene->name, result->verdict,
                         scene->source);
    sphv_html_figure(stream, rendering, rendering->scene_plots[index], caption(result));
    sphv_html_paragraphs(stream, scene->notes, "note");
    put_claims(stream, result);
    (scene->statistical ? put_statistical_curves : put_lattice_curves)(stream, result);
    fputs("</article>\n", stream);
}
