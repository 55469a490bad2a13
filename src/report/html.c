#include "html.h"

#include <stdlib.h>
#include <string.h>

#include "text.h"

void sphv_html_verdict(FILE *stream, sphv_verdict verdict)
{
    const char *name = sphv_verdict_name(verdict);
    fprintf(stream, "<span class=\"v %s\">%s</span>", name, name);
}

void sphv_html_scene_head(FILE *stream, const char *anchor, size_t index, const char *title,
                          const char *name, sphv_verdict verdict, const char *source)
{
    fprintf(stream, "<article id=\"%s-%zu\"><h3>", anchor, index);
    sphv_put_html(stream, title);
    fputs(" (<code>", stream);
    sphv_put_html(stream, name);
    fputs("</code>)</h3>\n<p>Verdict: ", stream);
    sphv_html_verdict(stream, verdict);
    fputs(" <span class=soft>Source: ", stream);
    sphv_put_html(stream, source);
    fputs("</span></p>\n", stream);
}

void sphv_html_number(FILE *stream, double value, int digits)
{
    char text[SPHV_NUMBER_TEXT];
    fputs(sphv_number_text(text, value, digits), stream);
}

void sphv_html_number_cell(FILE *stream, double value, int digits)
{
    fputs("<td>", stream);
    sphv_html_number(stream, value, digits);
}

void sphv_html_verdict_cell(FILE *stream, sphv_verdict verdict)
{
    fputs("<td>", stream);
    sphv_html_verdict(stream, verdict);
}

void sphv_html_text_cell(FILE *stream, const char *text)
{
    fputs("<td class=t>", stream);
    sphv_put_html(stream, text);
}

void sphv_html_row_begin(FILE *stream, const char *text)
{
    fputs("<tr><th scope=row>", stream);
    sphv_put_html(stream, text);
}

void sphv_html_tally_cells(FILE *stream, const size_t counts[3])
{
    size_t all = counts[SPHV_AGREES] + counts[SPHV_DISAGREES] + counts[SPHV_INCONCLUSIVE];
    for (int i = SPHV_AGREES; i <= SPHV_INCONCLUSIVE; i++) {
        if (!all)
            fputs("<td>–", stream);
        else if (counts[i] && i != SPHV_AGREES)
            fprintf(stream, "<td class=%s>%zu", sphv_verdict_name((sphv_verdict)i), counts[i]);
        else
            fprintf(stream, "<td>%zu", counts[i]);
    }
}

void sphv_html_table_begin(FILE *stream, const char *caption, const char *const *columns)
{
    fputs(SPHV_HTML_SCROLL "<table>", stream);
    if (caption) fprintf(stream, "<caption>%s</caption>", caption);
    fputs("<thead><tr>", stream);
    for (; *columns; columns++) fprintf(stream, "<th scope=col>%s", *columns);
    fputs("</thead>\n<tbody>\n", stream);
}

void sphv_html_table_end(FILE *stream)
{
    fputs("</tbody></table></div>\n", stream);
}

void sphv_html_paragraphs(FILE *stream, const char *text, const char *css_class)
{
    while (*text) {
        size_t length = strcspn(text, "\n");
        char *line = strndup(text, length);
        if (line && *line) {
            if (css_class)
                fprintf(stream, "<p class=%s>", css_class);
            else
                fputs("<p>", stream);
            sphv_put_html(stream, line);
            fputs("</p>\n", stream);
        }
        free(line);
        text += length + (text[length] == '\n');
    }
}

void sphv_html_figure(FILE *stream, const sphv_rendering *rendering, const char *svg,
                      const char *caption)
{
    if (svg) {
        fprintf(stream, "<figure>\n%s\n<figcaption>%s</figcaption></figure>\n", svg, caption);
    } else {
        fputs("<p class=warn>No plot: ", stream);
        sphv_put_html(stream, rendering->plot_error.message);
        fputs(". The tables are complete.</p>\n", stream);
    }
}

static void put_kernel_rows(FILE *stream, const sphv_rendering *rendering)
{
    static const size_t none[3] = {0, 0, 0};
    for (size_t i = 0; i < rendering->report->kernel_count; i++) {
        const sphv_kernel_facts *facts = &rendering->facts[i];
        fprintf(stream, "<tr><th scope=row><a href=\"#kernel-%zu\">", i);
        sphv_put_html(stream, sphv_kernel_name(facts->kernel));
        fputs("</a>", stream);
        sphv_html_verdict_cell(stream, facts->verdict);
        sphv_html_tally_cells(stream, facts->agreement ? facts->agreement->exact : none);
        sphv_html_tally_cells(stream, facts->agreement ? facts->agreement->paper : none);
        if (facts->check)
            fprintf(stream, "<td>%zu of %zu\n", facts->checks_passed, facts->checks);
        else
            fprintf(stream, "<td>%zu of %zu\n", facts->claims - facts->claims_refuted,
                    facts->claims);
    }
}

static void put_scene_rows(FILE *stream, const sphv_rendering *rendering)
{
    for (size_t i = 0; i < rendering->report->scene_count; i++) {
        const sphv_scene_result *result = rendering->report->scenes[i];
        size_t exact[3], paper[3];
        sphv_scene_tallies(result, exact, paper);
        fprintf(stream, "<tr><th scope=row><a href=\"#scene-%zu\">", i);
        sphv_put_html(stream, result->scene->name);
        fputs("</a>", stream);
        sphv_html_verdict_cell(stream, result->verdict);
        sphv_html_tally_cells(stream, exact);
        sphv_html_tally_cells(stream, paper);
        fprintf(stream, "<td>%zu of %zu\n", sphv_scene_expected_claims(result),
                result->scene->claim_count);
    }
}

static void put_verdicts(FILE *stream, const sphv_rendering *rendering)
{
    static const char *const heads[] = {"Scene", "Kernel"};
    const char *const claims[] = {
        "Claims<br>as stated", rendering->report->checks ? "Checks<br>passed" : "Claims<br>hold"};
    fputs("<section id=verdicts><h2>Verdicts</h2>\n"
          "<p>Points at which theory and measurement agree, disagree, or at which the bounds are "
          "too wide to tell. The verdict is that of theory (the exact form, or on disordered "
          "particles the expected norm), the claims and the checks; the paper’s form is shown "
          "beside it and does not enter.",
          stream);
    if (rendering->report->convergence_count)
        fputs(" Tables of rates have verdicts of their own <a href=\"#rates\">below</a>.", stream);
    fputs("</p>\n", stream);
    for (int kind = 0; kind < 2; kind++) {
        fprintf(stream,
                SPHV_HTML_SCROLL
                "<table><thead><tr><th scope=col rowspan=2>%s"
                "<th scope=col rowspan=2>Verdict<th scope=colgroup colspan=3>%s: points"
                "<th scope=colgroup colspan=3>Paper’s form: points<th scope=col rowspan=2>%s"
                "<tr><th scope=col>agree<th scope=col>disagree<th scope=col>inconcl."
                "<th scope=col>agree<th scope=col>disagree<th scope=col>inconcl.</thead>\n<tbody>"
                "\n",
                heads[kind], kind == 0 ? "Theory" : "Exact form", claims[kind]);
        (kind == 0 ? put_scene_rows : put_kernel_rows)(stream, rendering);
        sphv_html_table_end(stream);
    }
    fputs("</section>\n", stream);
}

static void put_head(FILE *stream, const sphv_rendering *rendering)
{
    const sphv_report *report = rendering->report;
    fputs("<!DOCTYPE html>\n<html lang=\"en-GB\"><head><meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
          "<meta name=\"color-scheme\" content=\"light dark\">\n"
          "<title>Truncation error of SPH kernels: theory against measurement</title>\n"
          "<style>\n",
          stream);
    for (const char *const *part = sphv_html_style; *part; part++) fputs(*part, stream);
    fputs("</style></head>\n<body>\n<header><h1>Truncation error of SPH kernels: theory against "
          "measurement</h1>\n<p>",
          stream);
    sphv_html_verdict(stream, sphv_rendering_verdict(rendering));
    fprintf(stream, " over %zu %s and %zu %s, computed in ", report->kernel_count,
            sphv_plural(report->kernel_count, "kernel", "kernels"),
            report->scene_count + report->convergence_count,
            sphv_plural(report->scene_count + report->convergence_count, "scene", "scenes"));
    fprintf(stream, report->seconds < 10 ? "%.1f" : "%.0f", report->seconds);
    fputs(" s. The numbers with 17 digits are in <code>report.json</code> beside this "
          "page.</p></header>\n"
          "<nav aria-label=\"Contents\"><ul><li><a href=\"#verdicts\">Verdicts</a>"
          "<li><a href=\"#reading\">How to read it</a><li><a href=\"#slips\">Slips of the "
          "paper</a><li><a href=\"#disorder\">Disorder</a>",
          stream);
    if (report->convergence_count) fputs("<li><a href=\"#rates\">Rates</a>", stream);
    fputs("<li><a href=\"#kernels\">Kernels</a><li><a href=\"#scenes\">Scenes</a>"
          "</ul></nav>\n<main>\n",
          stream);
    if (rendering->plots_missing) {
        fputs("<p class=warn>Plots are missing: ", stream);
        sphv_put_html(stream, rendering->plot_error.message);
        fputs(". The tables are complete.</p>\n", stream);
    }
}

static void put_list(FILE *stream, const sphv_rendering *rendering, bool kernels)
{
    size_t count = kernels ? rendering->report->kernel_count : rendering->report->scene_count;
    fprintf(stream, "<nav aria-label=\"%s\"><ul>", kernels ? "Kernels" : "Scenes");
    for (size_t i = 0; i < count; i++) {
        fprintf(stream, "<li><a href=\"#%s-%zu\">", kernels ? "kernel" : "scene", i);
        sphv_put_html(stream, kernels ? sphv_kernel_name(rendering->report->kernels[i])
                                      : rendering->report->scenes[i]->scene->name);
        fputs("</a>", stream);
    }
    fputs("</ul></nav>\n", stream);
}

void sphv_render_html(FILE *stream, const sphv_rendering *rendering)
{
    put_head(stream, rendering);
    put_verdicts(stream, rendering);
    fputs("<section id=reading><h2>How to read it</h2>\n", stream);
    for (const char *const *line = sphv_report_preface; *line; line++)
        sphv_html_paragraphs(stream, *line, NULL);
    fputs("</section>\n<section id=slips><h2>Slips of the paper, in numbers</h2>\n", stream);
    sphv_html_slips(stream, &rendering->slips);
    fputs("</section>\n<section id=disorder><h2>Disorder</h2>\n", stream);
    sphv_html_disorder(stream, rendering);
    if (rendering->report->convergence_count) {
        fputs("</section>\n<section id=rates><h2>Rates of convergence</h2>\n", stream);
        sphv_html_rates(stream, rendering);
    }
    fputs("</section>\n<section id=kernels><h2>Kernels</h2>\n", stream);
    put_list(stream, rendering, true);
    for (size_t i = 0; i < rendering->report->kernel_count; i++)
        sphv_html_kernel(stream, rendering, i);
    fputs("</section>\n<section id=scenes><h2>Scenes</h2>\n", stream);
    put_list(stream, rendering, false);
    for (size_t i = 0; i < rendering->report->scene_count; i++)
        sphv_html_scene(stream, rendering, i);
    fputs("</section>\n</main></body></html>\n", stream);
}
