#include <math.h>

#include "convergence_facts.h"
#include "html.h"
#include "text.h"

static void put_rate(FILE *stream, double rate)
{
    char text[SPHV_RATE_TEXT];
    fputs(sphv_rate_text(text, rate), stream);
}

static void put_rate_cell(FILE *stream, double rate)
{
    fputs("<td>", stream);
    put_rate(stream, rate);
}

static void put_cell_verdict(FILE *stream, sphv_cell_verdict verdict, const char *word)
{
    fprintf(stream, "<span class=\"v %s\">%s</span>", sphv_cell_verdict_class(verdict), word);
}

/// One printed number in the table as the paper has it: what was printed, found and predicted.
static void put_grid_cell(FILE *stream, const sphv_cell *cell, const sphv_cell_result *found)
{
    if (!cell->there) {
        fputs("<td>", stream);
        return;
    }
    fputs("<td><b>", stream);
    sphv_put_html(stream, cell->text);
    fputs("</b><br>", stream);
    put_rate(stream, found->slope);
    fputs(" <span class=soft>(", stream);
    put_rate(stream, found->theory);
    fputs(")</span><br>", stream);
    if (found->verdict == SPHV_CELL_PER_NEIGHBOUR) {
        fputs("<span class=soft>/n</span> ", stream);
        put_rate(stream, found->per_neighbour);
        fputs("<br>", stream);
    }
    put_cell_verdict(stream, found->verdict, sphv_cell_verdict_short(found->verdict));
}

static void put_grid(FILE *stream, const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    const sphv_rate_table *table = scene->table;
    fputs(
        "<p>Each cell: <b>the printed rate</b>; the measured slope of log RMSE against log N over "
        "all levels, and in brackets the slope that theory predicts by the same fit; where that "
        "is what the paper must have printed, the slope of RMSE/n.</p>\n" SPHV_HTML_SCROLL
        "<table class=rates><thead><tr><th scope=col>Rate of",
        stream);
    for (size_t c = 0; c < table->column_count; c++) {
        fputs("<th scope=col>", stream);
        sphv_put_html(stream, scene->schemes[table->columns[c]].label);
    }
    fputs("</thead>\n<tbody>\n", stream);
    for (size_t r = 0; r < table->row_count; r++) {
        sphv_html_row_begin(stream, scene->targets[table->rows[r]].name);
        for (size_t c = 0; c < table->column_count; c++)
            put_grid_cell(stream, &table->cells[r * table->column_count + c],
                          &result->cells[r * table->column_count + c]);
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
}

static void put_groups(FILE *stream, const sphv_convergence_result *result)
{
    static const char *const columns[] = {"Columns",        "Printed", "Reproduced", "Tolerance",
                                          "Deviation, rms", "Allowed", "Reason",     NULL};
    const sphv_rate_table *table = result->scene->table;
    sphv_html_table_begin(stream, "Printed rates that are reproduced, in either sense", columns);
    for (size_t g = 0; g < table->group_count; g++) {
        const sphv_group_result *found = &result->groups[g];
        sphv_html_row_begin(stream, table->groups[g].label);
        fprintf(stream, "<td>%zu<td>%zu", found->cells, found->reproduced);
        sphv_html_number_cell(stream, table->groups[g].tolerance, 3);
        fputs(found->surprising ? "<td class=d>" : "<td>", stream);
        sphv_html_number(stream, found->rms, 2);
        sphv_html_number_cell(stream, table->groups[g].rms, 2);
        sphv_html_text_cell(stream, table->groups[g].reason);
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
}

/// Cells that are not reproduced, each with why and with the settings that were tried.
static void put_unreproduced(FILE *stream, const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    const sphv_rate_table *table = scene->table;
    bool any = false;
    for (size_t i = 0; i < table->row_count * table->column_count; i++) {
        const sphv_cell *cell = &table->cells[i];
        const sphv_cell_result *found = &result->cells[i];
        if (!cell->there ||
            (found->verdict != SPHV_CELL_NOT_REPRODUCED && !cell->why && !found->surprising))
            continue;
        if (!any) fputs("<h4>Not reproduced, and the evidence</h4>\n<ul>\n", stream);
        any = true;
        fputs("<li><b>", stream);
        sphv_put_html(stream, scene->targets[table->rows[i / table->column_count]].name);
        fputs(" by ", stream);
        sphv_put_html(stream, scene->schemes[table->columns[i % table->column_count]].label);
        fputs("</b>: printed ", stream);
        sphv_put_html(stream, cell->text);
        fputs(", measured ", stream);
        put_rate(stream, found->slope);
        fputs(". ", stream);
        if (cell->why) sphv_put_html(stream, cell->why);
        if (found->surprising)
            fputs(" <strong>This is not what the scene expects.</strong>", stream);
        for (size_t e = 0; e < cell->evidence_count; e++) {
            fputs(e ? "<li>" : "<ul><li>", stream);
            sphv_put_html(stream, cell->evidence[e].statement);
            fputs(": ", stream);
            put_rate(stream, found->evidence[e]);
            fputs(cell->evidence[e].matches ? ", the printed number" : ", not the printed number",
                  stream);
            double off = fabs(found->evidence[e] - cell->printed);
            if ((off <= table->groups[table->group[i % table->column_count]].tolerance) !=
                cell->evidence[e].matches)
                fputs(" – <strong>expected, but it is not so</strong>", stream);
        }
        fputs(cell->evidence_count ? "</ul>\n" : "\n", stream);
    }
    if (any) fputs("</ul>\n", stream);
}

static void put_cells(FILE *stream, const sphv_convergence_result *result)
{
    static const char *const columns[] = {
        "Quantity",         "Scheme",        "Printed",
        "Slope in N",       "Slope in h",    "Slope of RMSE/n in N",
        "Theory, same fit", "Theory, N → ∞", "Interior",
        "Interior, theory", "Verdict",       NULL};
    const sphv_convergence *scene = result->scene;
    const sphv_rate_table *table = scene->table;
    fputs("<details><summary>Cell by cell: rates in N and in h, interior only, and theory</summary>"
          "\n",
          stream);
    sphv_html_table_begin(
        stream,
        "Least-squares slopes of log RMSE over all levels. Interior: particles at "
        "least κh from every side.",
        columns);
    for (size_t i = 0; i < table->row_count * table->column_count; i++) {
        const sphv_cell *cell = &table->cells[i];
        const sphv_cell_result *found = &result->cells[i];
        if (!cell->there) continue;
        sphv_html_row_begin(stream, scene->targets[table->rows[i / table->column_count]].name);
        fputs("<td>", stream);
        sphv_put_html(stream, scene->schemes[table->columns[i % table->column_count]].label);
        fputs("<td>", stream);
        sphv_put_html(stream, cell->text);
        put_rate_cell(stream, found->slope);
        put_rate_cell(stream, found->slope_h);
        put_rate_cell(stream, found->per_neighbour);
        put_rate_cell(stream, found->theory);
        put_rate_cell(stream, cell->limit);
        put_rate_cell(stream, found->interior);
        put_rate_cell(stream, found->theory_interior);
        fputs("<td>", stream);
        put_cell_verdict(stream, found->verdict, sphv_cell_verdict_name(found->verdict));
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
    fputs("</details>\n", stream);
}

static void put_listed(FILE *stream, const sphv_convergence_result *result)
{
    static const char *const columns[] = {"N", "n printed", "n counted", "h printed", "h", NULL};
    const sphv_convergence *scene = result->scene;
    const sphv_level_list *list = scene->listed;
    fprintf(stream,
            "<p>n, particles nearer than κh to the middle of the square: %zu of %zu exactly as "
            "printed. h: %zu of %zu within a unit of the last printed digit.</p>\n",
            result->listed_neighbours, scene->level_count, result->listed_h, scene->level_count);
    sphv_html_table_begin(stream, NULL, columns);
    for (size_t l = 0; l < scene->level_count; l++) {
        const sphv_stage *stage = sphv_convergence_stage(result, l, list->scheme);
        fprintf(stream, "<tr><th scope=row>%zu<td>", stage->particles);
        sphv_put_html(stream, list->neighbours[l]);
        fprintf(stream, "<td>%zu<td>", stage->neighbours);
        sphv_put_html(stream, list->h[l]);
        sphv_html_number_cell(stream, stage->h, 6);
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
}

static void put_claim(FILE *stream, const sphv_convergence_result *result, size_t index)
{
    const sphv_rate_claim *claim = &result->scene->claims[index];
    const sphv_claim_result *found = &result->claims[index];
    char measure[SPHV_SERIES_TEXT];
    fputs("<tr><td class=t>", stream);
    sphv_put_html(stream, claim->statement);
    fputs("<br><span class=soft>", stream);
    sphv_put_html(stream, sphv_claim_series_text(measure, result->scene, claim));
    fputs("</span><td data-head=\"Verdict\">", stream);
    sphv_html_verdict(stream, found->verdict);
    if (claim->refuted && !found->surprising) fputs("<br><span class=soft>as known</span>", stream);
    fputs("<td data-head=\"Theory\">", stream);
    sphv_html_number(stream, found->analytic, 4);
    fputs("<td data-head=\"Measured\">", stream);
    sphv_html_number(stream, found->empirical, 4);
    fputs("<td data-head=\"Claimed\">", stream);
    sphv_html_number(stream, claim->expected, 6);
    fputs(" ± ", stream);
    sphv_html_number(stream, claim->tolerance, 2);
    fputs("<td class=t data-head=\"Why\">", stream);
    sphv_put_html(stream, claim->reason);
    if (found->surprising)
        fputs("<br><strong>This is not what the scene expects.</strong>", stream);
    if (claim->refuted) {
        fputs("<br><strong>Known not to hold:</strong> ", stream);
        sphv_put_html(stream, claim->refuted);
    }
    fputc('\n', stream);
}

static void put_claims(FILE *stream, const sphv_convergence_result *result)
{
    if (!result->scene->claim_count) return;
    fputs("<h4>Claims</h4>\n" SPHV_HTML_SCROLL "<table class=stacked><thead><tr>"
          "<th scope=col>Claim and how it is measured<th scope=col>Verdict<th scope=col>Theory"
          "<th scope=col>Measured<th scope=col>Claimed<th scope=col class=t>Tolerance and "
          "remarks</thead>\n<tbody>\n",
          stream);
    for (size_t i = 0; i < result->scene->claim_count; i++) put_claim(stream, result, i);
    sphv_html_table_end(stream);
}

static void put_schemes(FILE *stream, const sphv_convergence_result *result)
{
    static const char *const columns[] = {"Scheme",
                                          "Method",
                                          "Kernel",
                                          "h",
                                          "Particles",
                                          "Theory: agree / disagree / inconcl.",
                                          "Largest difference",
                                          "Without result",
                                          "Worst condi&shy;tion number",
                                          NULL};
    const sphv_convergence *scene = result->scene;
    fputs("<h4>Schemes</h4>\n", stream);
    sphv_html_table_begin(stream, NULL, columns);
    for (size_t s = 0; s < scene->scheme_count; s++) {
        const sphv_scheme *scheme = &scene->schemes[s];
        char text[SPHV_RULE_TEXT], failed[200];
        size_t counts[3];
        sphv_fault_counts faults = sphv_scheme_faults(result, s);
        double largest = sphv_scheme_largest_difference(result, s);
        sphv_scheme_verdicts(result, s, counts);
        sphv_faults_text(failed, sizeof failed, &faults);
        sphv_html_row_begin(stream, scheme->label);
        fprintf(stream, "<td>%s<td><code>",
                scheme->has_method ? sphv_methods[scheme->method].name : "–");
        sphv_put_html(stream, sphv_kernel_name(scheme->kernel));
        fputs("</code><td>", stream);
        sphv_put_html(stream, sphv_h_rule_text(text, scheme));
        sphv_html_text_cell(stream, sphv_box_text(text, &scene->boxes[scheme->box].box));
        fprintf(stream, "<td%s>%zu / %zu / %zu",
                counts[SPHV_DISAGREES]      ? " class=d"
                : counts[SPHV_INCONCLUSIVE] ? " class=i"
                                            : "",
                counts[SPHV_AGREES], counts[SPHV_DISAGREES], counts[SPHV_INCONCLUSIVE]);
        sphv_html_number_cell(stream, 100 * largest, 2);
        if (isfinite(largest)) fputs(" %", stream);
        sphv_html_text_cell(stream, scheme->has_method ? failed : "–");
        sphv_html_number_cell(stream, faults.worst_condition, 3);
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
}

/// RMSE by level for the value rows: enough to see the numbers; all of them are in the files.
static void put_levels(FILE *stream, const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    if (!scene->target_count) return;
    fputs("<details><summary>RMSE at every level, measured and predicted</summary>\n", stream);
    for (size_t s = 0; s < scene->scheme_count; s++) {
        if (!scene->schemes[s].has_method) continue;
        fputs(SPHV_HTML_SCROLL "<table><caption>", stream);
        sphv_put_html(stream, scene->schemes[s].label);
        fputs(", RMSE over all particles; theory in brackets</caption><thead><tr><th scope=col>N"
              "<th scope=col>h<th scope=col>n",
              stream);
        for (size_t t = 0; t < scene->target_count; t++)
            if (!scene->targets[t].altered && sphv_convergence_point(result, 0, s, t)->there)
                fprintf(stream, "<th scope=col>%s", scene->targets[t].name);
        fputs("</thead>\n<tbody>\n", stream);
        for (size_t l = 0; l < scene->level_count; l++) {
            const sphv_stage *stage = sphv_convergence_stage(result, l, s);
            fprintf(stream, "<tr><th scope=row>%zu", stage->particles);
            sphv_html_number_cell(stream, stage->h, 4);
            fprintf(stream, "<td>%zu", stage->neighbours);
            for (size_t t = 0; t < scene->target_count; t++) {
                const sphv_rate_point *point = &stage->points[t];
                if (!point->there || scene->targets[t].altered) continue;
                sphv_html_number_cell(stream, point->whole.counted ? point->whole.rmse : NAN, 5);
                if (!point->predicted[0]) continue;
                fprintf(stream, "<br><span class=\"%s\">(",
                        point->verdict[0] == SPHV_DISAGREES ? "disagrees" : "soft");
                sphv_html_number(stream, point->prediction[0].value, 5);
                fputs(")</span>", stream);
            }
            fputc('\n', stream);
        }
        sphv_html_table_end(stream);
    }
    fputs("</details>\n", stream);
}

static void put_plots(FILE *stream, const sphv_rendering *rendering, size_t index)
{
    const sphv_convergence *scene = rendering->report->convergences[index]->scene;
    if (!scene->plot_count) return;
    fputs("<div class=figures>\n", stream);
    for (size_t p = 0; p < scene->plot_count; p++) {
        const sphv_rate_plot *plot = &scene->plots[p];
        const char *svg = rendering->rate_plots[index] ? rendering->rate_plots[index][p] : NULL;
        if (!svg) {
            sphv_html_figure(stream, rendering, NULL, "");
            continue;
        }
        fprintf(stream, "<figure>\n%s\n<figcaption>", svg);
        sphv_put_html(stream, plot->title);
        fputs(plot->picture ? "" : ". Lines: measured; hollow: theory, where it has a number.",
              stream);
        fputs("</figcaption></figure>\n", stream);
    }
    fputs("</div>\n", stream);
}

void sphv_html_convergence(FILE *stream, const sphv_rendering *rendering, size_t index)
{
    const sphv_convergence_result *result = rendering->report->convergences[index];
    const sphv_convergence *scene = result->scene;
    sphv_html_scene_head(stream, "rates", index, scene->title, scene->name, result->verdict,
                         scene->source);
    sphv_html_paragraphs(stream, scene->notes, "note");
    if (scene->listed) put_listed(stream, result);
    if (scene->table) {
        put_grid(stream, result);
        put_groups(stream, result);
        put_unreproduced(stream, result);
        put_cells(stream, result);
    }
    put_claims(stream, result);
    put_plots(stream, rendering, index);
    put_schemes(stream, result);
    put_levels(stream, result);
    fputs("</article>\n", stream);
}

void sphv_html_rates(FILE *stream, const sphv_rendering *rendering)
{
    const sphv_report *report = rendering->report;
    fputs("<p>RMSE and rates on particles in a box. A table of the paper is reproduced cell by "
          "cell; where a printed rate cannot be, the settings that were tried instead were run and "
          "stand beside it. Rates are against N, the number of particles, unless said: in two "
          "dimensions N<sup>−1</sup> at a fixed number of neighbours is second order in h. "
          "The metric is the root mean square error (RMSE) wherever no other is named; mean "
          "absolute, largest and mean square error and standard deviation stand beside it in the "
          "files.</p>\n" SPHV_HTML_SCROLL "<table><thead><tr><th scope=col rowspan=2>Scene"
          "<th scope=col rowspan=2>Verdict<th scope=colgroup colspan=4>Printed rates"
          "<th scope=colgroup colspan=3>Theory: points<th scope=col rowspan=2>Claims<br>as stated"
          "<tr><th scope=col>all<th scope=col>repro&shy;duced<th scope=col>as RMSE/n"
          "<th scope=col>not<th scope=col>agree<th scope=col>disagree<th scope=col>inconcl."
          "</thead>\n<tbody>\n",
          stream);
    for (size_t i = 0; i < report->convergence_count; i++) {
        const sphv_convergence_result *result = report->convergences[i];
        size_t counts[SPHV_CELL_VERDICTS], expected = 0;
        sphv_cell_counts(result, counts);
        for (size_t c = 0; c < result->scene->claim_count; c++)
            expected += !result->claims[c].surprising;
        fprintf(stream, "<tr><th scope=row><a href=\"#rates-%zu\">", i);
        sphv_put_html(stream, result->scene->name);
        fputs("</a>", stream);
        sphv_html_verdict_cell(stream, result->verdict);
        if (result->scene->table)
            fprintf(stream, "<td>%zu<td>%zu<td>%zu<td>%zu", counts[0] + counts[1] + counts[2],
                    counts[0], counts[1], counts[2]);
        else
            fputs("<td>–<td>–<td>–<td>–", stream);
        sphv_html_tally_cells(stream, result->verdicts);
        fprintf(stream, "<td>%zu of %zu\n", expected, result->scene->claim_count);
    }
    sphv_html_table_end(stream);
    for (size_t i = 0; i < report->convergence_count; i++)
        sphv_html_convergence(stream, rendering, i);
}
