#include <math.h>
#include <string.h>

#include "html.h"
#include "text.h"

static void put_found(FILE *stream, int rule, const sphv_claim_result *found)
{
    fprintf(stream, "<td data-head=\"With %s\">", sphv_rule_name[rule]);
    sphv_html_number(stream, found->analytic, 3);
    fputs(" / ", stream);
    sphv_html_number(stream, found->empirical, 3);
    fputs("<td>", stream);
    sphv_html_verdict(stream, found->verdict);
}

static void put_scene_link(FILE *stream, const sphv_rendering *rendering, const char *name)
{
    const sphv_report *report = rendering->report;
    const char *kind = NULL;
    size_t index = 0;
    for (size_t i = 0; !kind && i < report->scene_count; i++)
        if (strcmp(report->scenes[i]->scene->name, name) == 0) {
            kind = "scene";
            index = i;
        }
    for (size_t i = 0; !kind && i < report->convergence_count; i++)
        if (strcmp(report->convergences[i]->scene->name, name) == 0) {
            kind = "rates";
            index = i;
        }
    if (kind) fprintf(stream, "<a href=\"#%s-%zu\">", kind, index);
    sphv_put_html(stream, name);
    if (kind) fputs("</a>", stream);
}

static void put_rules(FILE *stream, const sphv_rendering *rendering)
{
    const sphv_rule_comparison *rules = &rendering->rules;
    fputs("<h3>Which volume rule reproduces the paper</h3>\n", stream);
    if (!rules->count) {
        fputs("<p>No scene of this report has a claim on perturbed particles with tessellated "
              "volumes or volumes Δx.</p>\n",
              stream);
        return;
    }
    fprintf(stream, "<p><strong>%s</strong></p>\n", rules->conclusion);
    fputs(
        "<p>Each claim is judged with the volumes (x<sub>b+1</sub> − x<sub>b−1</sub>)/2 and with "
        "the volumes Δx, all else equal; the tolerance is that of its scene.</p>\n" SPHV_HTML_SCROLL
        "<table class=stacked><thead><tr><th scope=col rowspan=2>Scene<th scope=col rowspan=2 "
        "class=t>Claim"
        "<th scope=col rowspan=2>Claimed",
        stream);
    for (int rule = 0; rule < SPHV_RULES; rule++)
        fprintf(stream, "<th scope=colgroup colspan=2>With %s", sphv_rule_name[rule]);
    fputs("<tr>", stream);
    for (int rule = 0; rule < SPHV_RULES; rule++)
        fputs("<th scope=col>theory / measured<th scope=col>verdict", stream);
    fputs("</thead>\n<tbody>\n", stream);
    for (size_t i = 0; i < rules->count; i++) {
        const sphv_rule_row *row = &rules->rows[i];
        fputs("<tr><th scope=row>", stream);
        put_scene_link(stream, rendering, row->scene->name);
        sphv_html_text_cell(stream, row->claim->statement);
        fputs("<br><span class=soft>", stream);
        sphv_put_html(stream, row->claim->measure->name);
        fputs(", ", stream);
        sphv_put_html(stream, row->scene->curves[row->claim->curve].label);
        fputs("</span>", stream);
        fputs("<td data-head=Claimed>", stream);
        sphv_html_number(stream, row->claim->expected, 3);
        fputs(" ± ", stream);
        sphv_html_number(stream, row->claim->tolerance, 2);
        for (int rule = 0; rule < SPHV_RULES; rule++) put_found(stream, rule, &row->found[rule]);
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
}

static void put_worst(FILE *stream, const sphv_rendering *rendering,
                      const sphv_fault_counts *faults)
{
    fputs("<td class=t>", stream);
    if (!faults->worst_scene) {
        fputs("–", stream);
        return;
    }
    put_scene_link(stream, rendering, faults->worst_scene);
    fputs(", h = ", stream);
    sphv_html_number(stream, faults->worst_h, 3);
    fputs(", Δx/h = ", stream);
    sphv_html_number(stream, faults->worst_spacing, 3);
}

static void put_methods(FILE *stream, const sphv_rendering *rendering)
{
    fputs("<h3>Where methods fail</h3>\n<p>Estimates over all scenes. A particle without a usable "
          "estimate (no neighbours, fewer than unknowns, moment matrix singular, its condition "
          "number above 1/√ε, or a result that is not finite) is counted here and left out of the "
          "norms. Curves are those of scenes in one dimension and the schemes of convergence "
          "scenes.</p>\n" SPHV_HTML_SCROLL
          "<table><thead><tr><th scope=col rowspan=2>Method<th scope=col rowspan=2>Curves"
          "<th scope=col rowspan=2>Estimates<th scope=colgroup colspan=6>Without a usable result"
          "<th scope=colgroup colspan=2>Worst condition number<tr><th scope=col>isolated"
          "<th scope=col>too few neigh&shy;bours<th scope=col>singular"
          "<th scope=col>ill-conditioned<th scope=col>not finite<th scope=col>share"
          "<th scope=col>value<th scope=col class=t>met in</thead>\n<tbody>\n",
          stream);
    for (size_t i = 0; i < rendering->method_count; i++) {
        const sphv_method_facts *of = &rendering->methods[i];
        const sphv_fault_counts *faults = &of->faults;
        long failed = sphv_faults_sum(faults);
        sphv_html_row_begin(stream, of->name);
        fprintf(stream, "<td>%zu<td>%ld<td>%ld<td>%ld<td>%ld<td>%ld<td>%ld<td>", of->curves,
                faults->estimates, faults->isolated, faults->too_few, faults->singular,
                faults->ill_conditioned, faults->not_finite);
        sphv_html_number(
            stream, faults->estimates ? 100 * (double)failed / (double)faults->estimates : NAN, 2);
        fputs(faults->estimates ? " %" : "", stream);
        sphv_html_number_cell(stream, faults->worst_condition, 3);
        put_worst(stream, rendering, faults);
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
}

void sphv_html_disorder(FILE *stream, const sphv_rendering *rendering)
{
    put_rules(stream, rendering);
    put_methods(stream, rendering);
}
