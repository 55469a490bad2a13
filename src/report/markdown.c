#include <math.h>

#include "markdown.h"
#include "text.h"

void sphv_markdown_number(FILE *stream, double value, int digits)
{
    char text[SPHV_NUMBER_TEXT];
    fputs(sphv_number_text(text, value, digits), stream);
}

void sphv_markdown_number_cell(FILE *stream, double value, int digits)
{
    sphv_markdown_number(stream, value, digits);
    fputs(" | ", stream);
}

void sphv_markdown_text_cell(FILE *stream, const char *text)
{
    sphv_put_markdown(stream, text);
    fputs(" | ", stream);
}

void sphv_markdown_scene_head(FILE *stream, const char *title, const char *name, const char *source,
                              sphv_verdict verdict, const char *notes)
{
    fputs("\n### ", stream);
    sphv_put_markdown(stream, title);
    fputs("\n\n", stream);
    sphv_put_markdown(stream, name);
    fputs(". Source: ", stream);
    sphv_put_markdown(stream, source);
    fprintf(stream, ". Verdict: **%s**.\n", sphv_verdict_name(verdict));
    if (!*notes) return;
    fputc('\n', stream);
    sphv_put_markdown(stream, notes);
    fputc('\n', stream);
}

void sphv_markdown_claim_end(FILE *stream, const char *reason, bool surprising, const char *refuted)
{
    sphv_markdown_text_cell(stream, reason);
    if (surprising) fputs("**not as expected** ", stream);
    if (refuted) {
        fputs("known not to hold: ", stream);
        sphv_put_markdown(stream, refuted);
    }
    fputs(" |\n", stream);
}

static void verdict_cell(FILE *stream, sphv_verdict verdict)
{
    fprintf(stream, "%s | ", sphv_verdict_name(verdict));
}

void sphv_markdown_tally_cell(FILE *stream, const size_t counts[3])
{
    if (counts[SPHV_AGREES] + counts[SPHV_DISAGREES] + counts[SPHV_INCONCLUSIVE] == 0)
        fputs("– | ", stream);
    else
        fprintf(stream, "%zu / %zu / %zu | ", counts[SPHV_AGREES], counts[SPHV_DISAGREES],
                counts[SPHV_INCONCLUSIVE]);
}

static void put_verdicts(FILE *stream, const sphv_rendering *rendering)
{
    static const size_t none[3] = {0, 0, 0};
    fputs("## Verdicts\n\nPoints are counted as agree / disagree / inconclusive.\n\n"
          "| Scene | Verdict | Theory | Paper’s form | Claims as stated |\n"
          "|---|---|---|---|---|\n",
          stream);
    for (size_t i = 0; i < rendering->report->scene_count; i++) {
        const sphv_scene_result *result = rendering->report->scenes[i];
        size_t exact[3], paper[3];
        sphv_scene_tallies(result, exact, paper);
        fputs("| ", stream);
        sphv_markdown_text_cell(stream, result->scene->name);
        verdict_cell(stream, result->verdict);
        sphv_markdown_tally_cell(stream, exact);
        sphv_markdown_tally_cell(stream, paper);
        fprintf(stream, "%zu of %zu |\n", sphv_scene_expected_claims(result),
                result->scene->claim_count);
    }
    fputs("\n| Kernel | Verdict | Exact form | Paper’s form | Checks passed "
          "|\n|---|---|---|---|---|\n",
          stream);
    for (size_t i = 0; i < rendering->report->kernel_count; i++) {
        const sphv_kernel_facts *facts = &rendering->facts[i];
        fputs("| ", stream);
        sphv_markdown_text_cell(stream, sphv_kernel_name(facts->kernel));
        verdict_cell(stream, facts->verdict);
        sphv_markdown_tally_cell(stream, facts->agreement ? facts->agreement->exact : none);
        sphv_markdown_tally_cell(stream, facts->agreement ? facts->agreement->paper : none);
        if (facts->check)
            fprintf(stream, "%zu of %zu |\n", facts->checks_passed, facts->checks);
        else
            fprintf(stream, "%zu of %zu claims |\n", facts->claims - facts->claims_refuted,
                    facts->claims);
    }
}

static void put_sign_slip(FILE *stream, const sphv_slips *slips)
{
    fputs("\n### The sign of eq. 11\n\nThe discretisation error of A = x with kernel ", stream);
    sphv_put_markdown(stream, sphv_kernel_name(slips->sign_kernel));
    fputs(".\n\n| Δx/h | measured | bound | eq. 16, sign mended | bound | verdict | eq. 16 as "
          "printed | verdict |\n|---|---|---|---|---|---|---|---|\n",
          stream);
    for (int i = 0; i < SPHV_SIGN_ROWS; i++) {
        const sphv_sign_slip *row = &slips->sign[i];
        fprintf(stream, "| 4/%d | ", 2 * row->n + 1);
        sphv_markdown_number_cell(stream, row->measured.value, 5);
        sphv_markdown_number_cell(stream, row->measured.bound, 2);
        sphv_markdown_number_cell(stream, row->mended.value, 5);
        sphv_markdown_number_cell(stream, row->mended.bound, 2);
        verdict_cell(stream, row->mended_verdict);
        sphv_markdown_number_cell(stream, row->printed.value, 5);
        fprintf(stream, "%s |\n", sphv_verdict_name(row->printed_verdict));
    }
}

static void put_knot_slip(FILE *stream, const sphv_slips *slips)
{
    const sphv_knot_slip *slip = &slips->knot;
    fputs("\n### Interior knots\n\nTerms of the Euler–Maclaurin series of ", stream);
    sphv_put_markdown(stream, sphv_kernel_name(slips->knot_kernel));
    fprintf(stream, " at h/λ = %g, Δx/h = ", slip->h);
    sphv_markdown_number(stream, slip->spacing, 4);
    fputs(".\n\n| knot |", stream);
    for (int i = 0; i < SPHV_KNOT_TERMS; i++) fprintf(stream, " p = %d |", slip->first_order + i);
    fputs("\n|---|", stream);
    for (int i = 0; i < SPHV_KNOT_TERMS; i++) fputs("---|", stream);
    fputc('\n', stream);
    for (int k = 0; k < slip->knot_count; k++) {
        fprintf(stream, "| %s%g | ", slip->position[k] > 0 ? "±" : "", slip->position[k]);
        for (int i = 0; i < SPHV_KNOT_TERMS; i++)
            sphv_markdown_number_cell(stream, slip->term[k][i], 4);
        fputc('\n', stream);
    }
    fputs("\n- measured discretisation error: ", stream);
    sphv_markdown_number(stream, slip->measured.value, 7);
    fputs("\n- exact form, all knots: ", stream);
    sphv_markdown_number(stream, slip->exact.value, 7);
    fprintf(stream, ", %s\n- paper’s form, edge only: ", sphv_verdict_name(slip->exact_verdict));
    sphv_markdown_number(stream, slip->paper.value, 7);
    fprintf(stream, ", %s\n- order at 4/(2n+1): %d by the edge alone, %d by all knots, measured ",
            sphv_verdict_name(slip->paper_verdict), slip->paper_order, slip->predicted_order);
    sphv_markdown_number(stream, slip->fitted_order.value, 5);
    fputc('\n', stream);
}

static void put_slips(FILE *stream, const sphv_slips *slips)
{
    fputs("\n## Slips of the paper, in numbers\n", stream);
    if (slips->sign_kernel) put_sign_slip(stream, slips);
    if (slips->knot_kernel) put_knot_slip(stream, slips);
    fputs("\n### Slips of the text\n\n", stream);
    for (const char *const *line = sphv_slips_of_text; *line; line++) {
        fputs("- ", stream);
        sphv_put_markdown(stream, *line);
        fputc('\n', stream);
    }
}

static void put_claim(FILE *stream, const sphv_claim *claim, const sphv_claim_result *found)
{
    fputs("| ", stream);
    sphv_markdown_text_cell(stream, claim->statement);
    sphv_markdown_text_cell(stream, claim->measure->name);
    verdict_cell(stream, found->verdict);
    sphv_markdown_number_cell(stream, found->analytic, 6);
    sphv_markdown_number_cell(stream, found->empirical, 6);
    sphv_markdown_number(stream, claim->expected, 6);
    if (claim->tolerance > 0) {
        fputs(" ± ", stream);
        sphv_markdown_number(stream, claim->tolerance, 2);
    }
    fputs(" | ", stream);
    sphv_markdown_claim_end(stream, claim->reason, found->surprising, claim->refuted);
}

static void put_scene(FILE *stream, const sphv_scene_result *result)
{
    const sphv_scene *scene = result->scene;
    sphv_markdown_scene_head(stream, scene->title, scene->name, scene->source, result->verdict,
                             scene->notes);
    fputc('\n', stream);
    if (scene->claim_count)
        fputs("| Claim | Measure | Verdict | Theory | Measured | Expected | Reason of the "
              "tolerance | "
              "Remark |\n|---|---|---|---|---|---|---|---|\n",
              stream);
    for (size_t i = 0; i < scene->claim_count; i++)
        put_claim(stream, &scene->claims[i], &result->claims[i]);
    if (scene->statistical) sphv_markdown_curves(stream, result);
}

static void put_constants(FILE *stream, const sphv_kernel_facts *facts)
{
    fputs("| Dimension | Constant | Exactly | File’s claim | Verdict | μ₂ | μ₄ | Fourier transform "
          "first negative at Ωh |\n|---|---|---|---|---|---|---|---|\n",
          stream);
    for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
        const sphv_dimension_facts *of = &facts->dimension[d - 1];
        if (!of->profile) {
            fprintf(stream, "| %dD | refused: ", d);
            sphv_markdown_text_cell(stream, sphv_kernel_refusal(facts->kernel, d));
            fputs("– | – | – | – | – | – |\n", stream);
            continue;
        }
        fprintf(stream, "| %dD | ", d);
        sphv_markdown_number_cell(stream, of->profile->constant.value, 16);
        sphv_markdown_text_cell(stream, *of->constant ? of->constant : "–");
        sphv_markdown_text_cell(stream, of->claim ? of->claim : "none");
        sphv_markdown_text_cell(stream, of->claim ? sphv_verdict_name(of->claim_verdict) : "–");
        sphv_markdown_number_cell(stream, of->profile->moment[2].value, 10);
        sphv_markdown_number_cell(stream, of->profile->moment[4].value, 10);
        sphv_markdown_number_cell(stream, of->fourier.negative ? of->fourier.first_negative : NAN,
                                  5);
        fputc('\n', stream);
    }
}

static void put_agreement(FILE *stream, const sphv_agreement *agreement)
{
    fputs("\nAgreement in one dimension, per h/λ, as agree / disagree / inconclusive over n; the "
          "largest difference from measurement. All numbers are in report.json.\n\n"
          "| h/λ | Exact form | Largest difference | Its bound | Paper’s form |\n"
          "|---|---|---|---|---|\n",
          stream);
    for (size_t h = 0; h < agreement->h_count; h++) {
        const sphv_agreement_cell *row = &agreement->cells[h * agreement->n_count];
        size_t exact[3] = {0, 0, 0}, paper[3] = {0, 0, 0};
        double largest = -1, bound = 0;
        for (size_t n = 0; n < agreement->n_count; n++) {
            const sphv_point *point = &row[n].exact;
            exact[point->verdict]++;
            paper[row[n].paper_verdict]++;
            if (fabs(point->difference) > largest) {
                largest = fabs(point->difference);
                bound = point->analytic.total.bound + point->empirical.total.bound;
            }
        }
        fprintf(stream, "| %g | ", row->h);
        sphv_markdown_tally_cell(stream, exact);
        sphv_markdown_number_cell(stream, largest, 2);
        sphv_markdown_number_cell(stream, bound, 2);
        sphv_markdown_tally_cell(stream, paper);
        fputc('\n', stream);
    }
}

static void put_checks(FILE *stream, const sphv_kernel_facts *facts)
{
    fprintf(stream, "\nChecks passed: %zu of %zu.\n", facts->checks_passed, facts->checks);
    for (size_t i = 0; i < facts->check->count; i++) {
        const sphv_check_result *result = &facts->check->results[i];
        if (result->verdict == SPHV_AGREES) continue;
        fprintf(stream, "- **%s** ", sphv_verdict_name(result->verdict));
        sphv_put_markdown(stream, result->id);
        if (result->dimension) fprintf(stream, " in %dD", result->dimension);
        fputs(", ", stream);
        sphv_put_markdown(stream, result->claim);
        fputs(", worked out ", stream);
        sphv_markdown_number(stream, result->analytic, 10);
        fputs(", measured ", stream);
        sphv_markdown_number(stream, result->empirical, 10);
        fputs(", ", stream);
        sphv_put_markdown(stream, result->cause);
        fputc('\n', stream);
    }
}

static void put_kernel(FILE *stream, const sphv_kernel_facts *facts)
{
    fputs("\n### ", stream);
    sphv_put_markdown(stream, sphv_kernel_title(facts->kernel));
    fputs("\n\n", stream);
    sphv_put_markdown(stream, sphv_kernel_name(facts->kernel));
    fputs(". Source: ", stream);
    sphv_put_markdown(stream, sphv_kernel_source(facts->kernel));
    fprintf(stream, ". Verdict: **%s**. κ = ", sphv_verdict_name(facts->verdict));
    sphv_markdown_number(stream, facts->profile->support, 10);
    fprintf(stream, ", β = %d", facts->profile->boundary_smoothness);
    if (facts->claimed_smoothness)
        fprintf(stream, " (%d claimed: %s)", *facts->claimed_smoothness,
                sphv_verdict_name(facts->smoothness_verdict));
    if (facts->dimension[0].profile)
        fprintf(stream, ", order in Δx/h %d at 2κ/(2n+1) and %d elsewhere (%d by the edge alone)",
                facts->special_order, facts->general_order, facts->edge_order);
    fputs(".\n\n", stream);
    put_constants(stream, facts);
    if (facts->check) put_checks(stream, facts);
    if (facts->agreement) put_agreement(stream, facts->agreement);
    if (sphv_kernel_paper_failure(facts)) {
        fputc('\n', stream);
        sphv_put_markdown(stream, sphv_kernel_paper_failure(facts));
        fputc('\n', stream);
    }
}

void sphv_render_markdown(FILE *stream, const sphv_rendering *rendering)
{
    const sphv_report *report = rendering->report;
    fprintf(stream,
            "# Truncation error of SPH kernels: theory against measurement\n\n**%s** over %zu %s "
            "and %zu %s.\n\n",
            sphv_verdict_name(sphv_rendering_verdict(rendering)), report->kernel_count,
            sphv_plural(report->kernel_count, "kernel", "kernels"),
            report->scene_count + report->convergence_count,
            sphv_plural(report->scene_count + report->convergence_count, "scene", "scenes"));
    put_verdicts(stream, rendering);
    fputs("\n## How to read it\n", stream);
    for (const char *const *line = sphv_report_preface; *line; line++) {
        fputc('\n', stream);
        sphv_put_markdown(stream, *line);
        fputc('\n', stream);
    }
    put_slips(stream, &rendering->slips);
    sphv_markdown_disorder(stream, rendering);
    sphv_markdown_rates(stream, rendering);
    fputs("\n## Kernels\n", stream);
    for (size_t i = 0; i < report->kernel_count; i++) put_kernel(stream, &rendering->facts[i]);
    fputs("\n## Scenes\n", stream);
    for (size_t i = 0; i < report->scene_count; i++) put_scene(stream, report->scenes[i]);
}
