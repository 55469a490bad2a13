#include <math.h>

#include "convergence_facts.h"
#include "markdown.h"
#include "text.h"

static void put_rate_cell(FILE *stream, double rate)
{
    char text[SPHV_RATE_TEXT];
    fprintf(stream, "%s | ", sphv_rate_text(text, rate));
}

static void put_grid(FILE *stream, const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    const sphv_rate_table *table = scene->table;
    fputs(
        "\nPrinted rate → measured slope of log RMSE against log N (theory, same fit); `/n`: slope "
        "of RMSE/n, where that is what was printed.\n\n| Rate of |",
        stream);
    for (size_t c = 0; c < table->column_count; c++) {
        fputc(' ', stream);
        sphv_markdown_text_cell(stream, scene->schemes[table->columns[c]].label);
    }
    fputs("\n|---|", stream);
    for (size_t c = 0; c < table->column_count; c++) fputs("---|", stream);
    fputc('\n', stream);
    for (size_t r = 0; r < table->row_count; r++) {
        fputs("| ", stream);
        sphv_markdown_text_cell(stream, scene->targets[table->rows[r]].name);
        for (size_t c = 0; c < table->column_count; c++) {
            const sphv_cell *cell = &table->cells[r * table->column_count + c];
            const sphv_cell_result *found = &result->cells[r * table->column_count + c];
            char slope[SPHV_RATE_TEXT], theory[SPHV_RATE_TEXT], shared[SPHV_RATE_TEXT];
            if (!cell->there) {
                fputs(" | ", stream);
                continue;
            }
            sphv_put_markdown(stream, cell->text);
            fprintf(stream, " → %s (%s)", sphv_rate_text(slope, found->slope),
                    sphv_rate_text(theory, found->theory));
            if (found->verdict == SPHV_CELL_PER_NEIGHBOUR)
                fprintf(stream, " /n %s", sphv_rate_text(shared, found->per_neighbour));
            fprintf(stream, " **%s** | ", sphv_cell_verdict_short(found->verdict));
        }
        fputc('\n', stream);
    }
}

static void put_groups(FILE *stream, const sphv_convergence_result *result)
{
    const sphv_rate_table *table = result->scene->table;
    fputs("\n| Columns | Printed | Reproduced | Tolerance | Deviation, rms | Allowed | Reason |\n"
          "|---|---|---|---|---|---|---|\n",
          stream);
    for (size_t g = 0; g < table->group_count; g++) {
        fputs("| ", stream);
        sphv_markdown_text_cell(stream, table->groups[g].label);
        fprintf(stream, "%zu | %zu | ", result->groups[g].cells, result->groups[g].reproduced);
        sphv_markdown_number_cell(stream, table->groups[g].tolerance, 3);
        sphv_markdown_number_cell(stream, result->groups[g].rms, 2);
        sphv_markdown_number_cell(stream, table->groups[g].rms, 2);
        sphv_markdown_text_cell(stream, table->groups[g].reason);
        fputc('\n', stream);
    }
}

static void put_cells(FILE *stream, const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    const sphv_rate_table *table = scene->table;
    fputs(
        "\nSlopes of log RMSE; interior: particles at least κh from every side.\n\n"
        "| Quantity | Scheme | Printed | in N | in h | RMSE/n in N | Theory, same fit | Theory, N "
        "→ ∞ | Interior | Interior, theory | Verdict | Remark |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        stream);
    for (size_t i = 0; i < table->row_count * table->column_count; i++) {
        const sphv_cell *cell = &table->cells[i];
        const sphv_cell_result *found = &result->cells[i];
        if (!cell->there) continue;
        fputs("| ", stream);
        sphv_markdown_text_cell(stream, scene->targets[table->rows[i / table->column_count]].name);
        sphv_markdown_text_cell(stream,
                                scene->schemes[table->columns[i % table->column_count]].label);
        sphv_markdown_text_cell(stream, cell->text);
        put_rate_cell(stream, found->slope);
        put_rate_cell(stream, found->slope_h);
        put_rate_cell(stream, found->per_neighbour);
        put_rate_cell(stream, found->theory);
        put_rate_cell(stream, cell->limit);
        put_rate_cell(stream, found->interior);
        put_rate_cell(stream, found->theory_interior);
        fprintf(stream, "%s | ", sphv_cell_verdict_name(found->verdict));
        if (found->surprising || found->evidence_surprises) fputs("**not as expected** ", stream);
        if (cell->why) sphv_put_markdown(stream, cell->why);
        for (size_t e = 0; e < cell->evidence_count; e++) {
            char rate[SPHV_RATE_TEXT];
            fputs(" – ", stream);
            sphv_put_markdown(stream, cell->evidence[e].statement);
            fprintf(stream, ": %s", sphv_rate_text(rate, found->evidence[e]));
        }
        fputs(" |\n", stream);
    }
}

static void put_claims(FILE *stream, const sphv_convergence_result *result)
{
    if (result->scene->claim_count)
        fputs("\n| Claim | Measure | Verdict | Theory | Measured | Expected | Reason of the "
              "tolerance | Remark |\n|---|---|---|---|---|---|---|---|\n",
              stream);
    for (size_t i = 0; i < result->scene->claim_count; i++) {
        const sphv_rate_claim *claim = &result->scene->claims[i];
        const sphv_claim_result *found = &result->claims[i];
        char measure[SPHV_SERIES_TEXT];
        fputs("| ", stream);
        sphv_markdown_text_cell(stream, claim->statement);
        sphv_markdown_text_cell(stream, sphv_claim_series_text(measure, result->scene, claim));
        fprintf(stream, "%s | ", sphv_verdict_name(found->verdict));
        sphv_markdown_number_cell(stream, found->analytic, 4);
        sphv_markdown_number_cell(stream, found->empirical, 4);
        sphv_markdown_number(stream, claim->expected, 6);
        fputs(" ± ", stream);
        sphv_markdown_number_cell(stream, claim->tolerance, 2);
        sphv_markdown_claim_end(stream, claim->reason, found->surprising, claim->refuted);
    }
}

static void put_schemes(FILE *stream, const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    fputs(
        "\n| Scheme | Method | Kernel | h | Particles | Theory: agree / disagree / inconclusive | "
        "Without result |\n|---|---|---|---|---|---|---|\n",
        stream);
    for (size_t s = 0; s < scene->scheme_count; s++) {
        const sphv_scheme *scheme = &scene->schemes[s];
        char text[SPHV_RULE_TEXT], failed[200];
        size_t counts[3];
        sphv_fault_counts faults = sphv_scheme_faults(result, s);
        sphv_scheme_verdicts(result, s, counts);
        sphv_faults_text(failed, sizeof failed, &faults);
        fputs("| ", stream);
        sphv_markdown_text_cell(stream, scheme->label);
        sphv_markdown_text_cell(stream,
                                scheme->has_method ? sphv_methods[scheme->method].name : "–");
        sphv_markdown_text_cell(stream, sphv_kernel_name(scheme->kernel));
        sphv_markdown_text_cell(stream, sphv_h_rule_text(text, scheme));
        sphv_markdown_text_cell(stream, sphv_box_text(text, &scene->boxes[scheme->box].box));
        sphv_markdown_tally_cell(stream, counts);
        sphv_markdown_text_cell(stream, scheme->has_method ? failed : "–");
        fputc('\n', stream);
    }
}

static void put_listed(FILE *stream, const sphv_convergence_result *result)
{
    const sphv_level_list *list = result->scene->listed;
    if (!list) return;
    fprintf(stream,
            "\nn as printed at %zu of %zu levels, h within a unit of its last digit at %zu.\n\n"
            "| N | n printed | n counted | h printed | h |\n|---|---|---|---|---|\n",
            result->listed_neighbours, result->scene->level_count, result->listed_h);
    for (size_t l = 0; l < result->scene->level_count; l++) {
        const sphv_stage *stage = sphv_convergence_stage(result, l, list->scheme);
        fprintf(stream, "| %zu | %s | %zu | %s | ", stage->particles, list->neighbours[l],
                stage->neighbours, list->h[l]);
        sphv_markdown_number_cell(stream, stage->h, 6);
        fputc('\n', stream);
    }
}

void sphv_markdown_convergence(FILE *stream, const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    sphv_markdown_scene_head(stream, scene->title, scene->name, scene->source, result->verdict,
                             scene->notes);
    put_listed(stream, result);
    if (scene->table) {
        put_grid(stream, result);
        put_groups(stream, result);
        put_cells(stream, result);
    }
    put_claims(stream, result);
    put_schemes(stream, result);
}

void sphv_markdown_rates(FILE *stream, const sphv_rendering *rendering)
{
    const sphv_report *report = rendering->report;
    if (!report->convergence_count) return;
    fputs("\n## Rates of convergence\n\n"
          "| Scene | Verdict | Printed rates | Reproduced | As slope of RMSE/n | Not | Theory |\n"
          "|---|---|---|---|---|---|---|\n",
          stream);
    for (size_t i = 0; i < report->convergence_count; i++) {
        const sphv_convergence_result *result = report->convergences[i];
        size_t counts[SPHV_CELL_VERDICTS];
        sphv_cell_counts(result, counts);
        fputs("| ", stream);
        sphv_markdown_text_cell(stream, result->scene->name);
        fprintf(stream, "%s | %zu | %zu | %zu | %zu | ", sphv_verdict_name(result->verdict),
                counts[0] + counts[1] + counts[2], counts[0], counts[1], counts[2]);
        sphv_markdown_tally_cell(stream, result->verdicts);
        fputc('\n', stream);
    }
    for (size_t i = 0; i < report->convergence_count; i++)
        sphv_markdown_convergence(stream, report->convergences[i]);
}
