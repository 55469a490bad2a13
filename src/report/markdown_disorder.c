#include <math.h>
#include <stdio.h>

#include "markdown.h"
#include "text.h"

static void put_rules(FILE *stream, const sphv_rule_comparison *rules)
{
    fputs("\n### Which volume rule reproduces the paper\n\n", stream);
    if (!rules->count) {
        fputs("No scene of this report has a claim on perturbed particles with tessellated volumes "
              "or volumes Δx.\n",
              stream);
        return;
    }
    fprintf(stream, "**%s**\n\n| Scene | Claim | Claimed |", rules->conclusion);
    for (int rule = 0; rule < SPHV_RULES; rule++)
        fprintf(stream, " %s: theory | measured | verdict |", sphv_rule_name[rule]);
    fputs("\n|---|---|---|---|---|---|---|---|---|\n", stream);
    for (size_t i = 0; i < rules->count; i++) {
        const sphv_rule_row *row = &rules->rows[i];
        fputs("| ", stream);
        sphv_markdown_text_cell(stream, row->scene->name);
        sphv_markdown_text_cell(stream, row->claim->statement);
        sphv_markdown_number(stream, row->claim->expected, 3);
        fputs(" ± ", stream);
        sphv_markdown_number_cell(stream, row->claim->tolerance, 2);
        for (int rule = 0; rule < SPHV_RULES; rule++) {
            sphv_markdown_number_cell(stream, row->found[rule].analytic, 3);
            sphv_markdown_number_cell(stream, row->found[rule].empirical, 3);
            fprintf(stream, "%s |%s", sphv_verdict_name(row->found[rule].verdict),
                    rule + 1 < SPHV_RULES ? " " : "\n");
        }
    }
}

static void put_fault_cells(FILE *stream, const sphv_fault_counts *faults)
{
    fprintf(stream, "%ld | %ld | %ld | %ld | %ld | %ld | ", faults->estimates, faults->isolated,
            faults->too_few, faults->singular, faults->ill_conditioned, faults->not_finite);
    sphv_markdown_number_cell(stream, faults->worst_condition, 3);
}

void sphv_markdown_disorder(FILE *stream, const sphv_rendering *rendering)
{
    fputs("\n## Disorder\n", stream);
    put_rules(stream, &rendering->rules);
    fputs("\n### Where methods fail\n\n"
          "| Method | Curves | Estimates | Isolated | Too few neighbours | Singular | "
          "Ill-conditioned | "
          "Not finite | Worst condition number |\n|---|---|---|---|---|---|---|---|---|\n",
          stream);
    for (size_t i = 0; i < rendering->method_count; i++) {
        fputs("| ", stream);
        sphv_markdown_text_cell(stream, rendering->methods[i].name);
        fprintf(stream, "%zu | ", rendering->methods[i].curves);
        put_fault_cells(stream, &rendering->methods[i].faults);
        fputc('\n', stream);
    }
}

void sphv_markdown_curves(FILE *stream, const sphv_scene_result *result)
{
    const sphv_scene *scene = result->scene;
    fputs("\n| Curve | Kernel | Method | Layout | Volumes | σ/Δx | Seed | Realisations | Points | "
          "Largest relative difference | Estimates | Isolated | Too few neighbours | Singular | "
          "Ill-conditioned | Not finite | Worst condition number "
          "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
          stream);
    for (size_t c = 0; c < scene->curve_count; c++) {
        sphv_curve_facts facts = sphv_curve_facts_collect(result, c);
        char realisations[SPHV_REALISATIONS_TEXT];
        fputs("| ", stream);
        sphv_markdown_text_cell(stream, scene->curves[c].label);
        sphv_markdown_text_cell(stream, sphv_kernel_name(scene->curves[c].kernel));
        sphv_markdown_text_cell(stream, facts.method);
        sphv_markdown_text_cell(stream, facts.layout);
        sphv_markdown_text_cell(stream, facts.volume);
        sphv_markdown_number_cell(stream, facts.sigma, 6);
        if (facts.random)
            fprintf(stream, "%llu | ", (unsigned long long)scene->curves[c].experiment.seed);
        else
            fputs("– | ", stream);
        fprintf(stream, "%s | ", sphv_realisations_text(realisations, &facts));
        sphv_markdown_tally_cell(stream, facts.exact);
        sphv_markdown_number_cell(stream, facts.relative, 2);
        put_fault_cells(stream, &facts.faults);
        fputc('\n', stream);
    }
}
