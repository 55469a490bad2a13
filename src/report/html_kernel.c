#include <math.h>

#include "html.h"
#include "text.h"

static void put_properties(FILE *stream, const sphv_kernel_facts *facts)
{
    const sphv_profile *profile = facts->dimension[0].profile;
    fputs("<dl><dt>Source<dd>", stream);
    const char *source = sphv_kernel_source(facts->kernel);
    sphv_put_html(stream, *source ? source : "none named in the file");
    fputs("<dt>Support κ<dd>", stream);
    sphv_html_number(stream, facts->profile->support, 10);
    fprintf(stream, "<dt>Boundary smoothness β<dd>%d found", facts->profile->boundary_smoothness);
    if (facts->claimed_smoothness) {
        fprintf(stream, ", %d claimed: ", *facts->claimed_smoothness);
        sphv_html_verdict(stream, facts->smoothness_verdict);
    }
    if (facts->profile->boundary_smoothness < 0)
        fputs(" (truncated: the value itself jumps at the edge)", stream);
    if (profile) {
        fprintf(stream, "<dt>Order in Δx/h<dd>%d at Δx/h = 2κ/(2n+1), decided by the knot s = ",
                facts->special_order);
        sphv_html_number(stream, profile->knots[facts->special_knot].position.value, 6);
        fprintf(stream, "; %d elsewhere, by s = ", facts->general_order);
        sphv_html_number(stream, profile->knots[facts->general_knot].position.value, 6);
        if (facts->special_order < facts->edge_order)
            fprintf(stream, "; the edge alone would give %d, the other knots lower it",
                    facts->edge_order);
    }
    for (int d = 1; d <= SPHV_DIMENSIONS; d++)
        if (!facts->dimension[d - 1].profile) {
            fprintf(stream, "<dt>%dD refused<dd>", d);
            sphv_put_html(stream, sphv_kernel_refusal(facts->kernel, d));
        }
    fputs("</dl>\n", stream);
}

static void put_exact(FILE *stream, const char *exact, sphv_result value)
{
    fputs("<td>", stream);
    if (*exact) {
        fputs("<code>", stream);
        sphv_put_html(stream, exact);
        fputs("</code> = ", stream);
    }
    sphv_html_number(stream, value.value, *exact ? 8 : 10);
    if (!*exact && value.bound > 0) {
        fputs(" ± ", stream);
        sphv_html_number(stream, value.bound, 2);
    }
}

static void put_dimensions(FILE *stream, const sphv_kernel_facts *facts)
{
    static const char *const columns[] = {"Dim.",
                                          "Constant C, recomputed",
                                          "File’s claim",
                                          "Verdict",
                                          "μ<sub>2</sub>",
                                          "μ<sub>4</sub>",
                                          "Fourier transform, relative to Ŵ<sub>F</sub>(0)",
                                          NULL};
    sphv_html_table_begin(stream, "Constants and moments", columns);
    for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
        const sphv_dimension_facts *of = &facts->dimension[d - 1];
        if (!of->profile) continue;
        fprintf(stream, "<tr><th scope=row>%dD", d);
        put_exact(stream, of->constant, of->profile->constant);
        fputs("<td>", stream);
        if (of->claim) {
            fputs("<code>", stream);
            sphv_put_html(stream, of->claim);
            fputs("</code>", stream);
            sphv_html_verdict_cell(stream, of->claim_verdict);
        } else {
            fputs("none<td>", stream);
        }
        put_exact(stream, of->moment[1], of->profile->moment[2]);
        put_exact(stream, of->moment[2], of->profile->moment[4]);
        fputs("<td class=t>", stream);
        if (of->fourier.negative) {
            fputs("negative from Ωh = ", stream);
            sphv_html_number(stream, of->fourier.first_negative, 5);
            fputs(", least ", stream);
            sphv_html_number(stream, of->fourier.minimum, 3);
            fputs(" at ", stream);
            sphv_html_number(stream, of->fourier.minimum_at, 4);
        } else {
            fputs("not negative up to Ωh = ", stream);
            sphv_html_number(stream, of->fourier.searched, 4);
        }
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
}

static void put_knots(FILE *stream, const sphv_profile *profile)
{
    static const char *const columns[] = {"Knot s", "Lowest derivative that jumps, c",
                                          "Jump of Ŵ<sup>(c)</sup>", NULL};
    sphv_html_table_begin(stream, "Knots", columns);
    for (int i = 0; i < profile->knot_count; i++) {
        const sphv_knot *knot = &profile->knots[i];
        fprintf(stream, "<tr><th scope=row>%s", knot->position.value > 0 ? "±" : "");
        sphv_html_number(stream, knot->position.value, 10);
        fprintf(stream, "<td>%d", knot->order);
        sphv_html_number_cell(stream, knot->jump[knot->order] * tgamma(knot->order + 1.0), 8);
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
}

static void put_grid(FILE *stream, const sphv_agreement *agreement, bool paper)
{
    static const char *const cells[] = {"<td>✓", "<td class=d>✗", "<td class=i>?"};
    const size_t *counts = paper ? agreement->paper : agreement->exact;
    fprintf(stream,
            SPHV_HTML_SCROLL
            "<table class=grid><caption>%s: ✓ agrees (%zu), "
            "✗ disagrees (%zu), ? inconclusive (%zu)</caption><thead><tr><th scope=col>h/λ \\ n",
            paper ? "Paper’s form" : "Exact form", counts[SPHV_AGREES], counts[SPHV_DISAGREES],
            counts[SPHV_INCONCLUSIVE]);
    for (size_t n = 0; n < agreement->n_count; n++)
        fprintf(stream, "<th scope=col>%d", agreement->cells[n].n);
    fputs("</thead>\n<tbody>\n", stream);
    for (size_t h = 0; h < agreement->h_count; h++) {
        const sphv_agreement_cell *row = &agreement->cells[h * agreement->n_count];
        fprintf(stream, "<tr><th scope=row>%g", row->h);
        for (size_t n = 0; n < agreement->n_count; n++)
            fputs(cells[paper ? row[n].paper_verdict : row[n].exact.verdict], stream);
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
}

/// The n whose numbers are shown: each to 6, then steps of a quarter. The grids judge every n, and
/// report.json holds the numbers of all.
static bool is_shown(int n)
{
    static const int shown[] = {2, 3, 4, 5, 6, 8, 10, 13, 16, 20, 26, 32, 40};
    for (size_t i = 0; i < sizeof shown / sizeof *shown; i++)
        if (shown[i] == n) return true;
    return false;
}

static void put_cell(FILE *stream, const sphv_agreement_cell *cell)
{
    static const char *const marks[] = {"<td>✓", "<td class=d>✗", "<td class=i>?"};
    const sphv_point *exact = &cell->exact;
    fprintf(stream, "<th>%d", cell->n);
    sphv_html_number_cell(stream, exact->analytic.discretisation.value, 6);
    sphv_html_number_cell(stream, exact->analytic.total.value, 6);
    sphv_html_number_cell(stream, exact->empirical.total.value, 6);
    sphv_html_number_cell(stream, exact->difference, 1);
    sphv_html_number_cell(stream, exact->analytic.total.bound + exact->empirical.total.bound, 2);
    fputs(marks[exact->verdict], stream);
    sphv_html_number_cell(stream, cell->paper.total.value, 6);
    sphv_html_number_cell(stream, cell->paper.total.bound, 2);
    fprintf(stream, "%s\n", marks[cell->paper_verdict]);
}

static void put_numbers(FILE *stream, const sphv_agreement *agreement)
{
    static const char *const columns[] = {"h/λ",        "smoothing E<sub>s</sub>",
                                          "n",          "discretisation E<sub>d</sub>",
                                          "total E",    "measured E",
                                          "difference", "bound of both",
                                          "exact form", "paper’s E",
                                          "its bound",  "paper’s form",
                                          NULL};
    fputs("<details><summary>Numbers of these grids</summary>\n", stream);
    sphv_html_table_begin(
        stream,
        "Exact form, measurement, and the paper’s form at Δx/h = 2κ/(2n+1); every "
        "n is in report.json, with 17 digits",
        columns);
    for (size_t h = 0; h < agreement->h_count; h++) {
        const sphv_agreement_cell *row = &agreement->cells[h * agreement->n_count];
        int shown = 0;
        for (size_t n = 0; n < agreement->n_count; n++) shown += is_shown(row[n].n);
        fprintf(stream, "<tr><th scope=rowgroup rowspan=%d>%g<td rowspan=%d>", shown, row->h,
                shown);
        sphv_html_number(stream, row->exact.analytic.smoothing.value, 6);
        for (size_t n = 0, first = 1; n < agreement->n_count; n++) {
            if (!is_shown(row[n].n)) continue;
            if (!first) fputs("<tr>", stream);
            first = 0;
            put_cell(stream, &row[n]);
        }
    }
    sphv_html_table_end(stream);
    fputs("</details>\n", stream);
}

static void put_agreement(FILE *stream, const sphv_kernel_facts *facts)
{
    fputs("<h4>Agreement over h/λ and n, Δx/h = 2κ/(2n+1), one dimension</h4>\n", stream);
    if (!facts->agreement) {
        fputs("<p>The kernel is not legal in one dimension.</p>\n", stream);
        return;
    }
    put_grid(stream, facts->agreement, false);
    put_grid(stream, facts->agreement, true);
    const char *failure = sphv_kernel_paper_failure(facts);
    if (failure) sphv_html_paragraphs(stream, failure, NULL);
    put_numbers(stream, facts->agreement);
}

static void put_check_rows(FILE *stream, const sphv_check_report *check, bool failures)
{
    static const char *const columns[] = {"Check",    "Dim.",  "Verdict",           "Worked out",
                                          "Measured", "Bound", "Claim and remarks", NULL};
    sphv_html_table_begin(stream, NULL, columns);
    for (size_t i = 0; i < check->count; i++) {
        const sphv_check_result *result = &check->results[i];
        if (failures && result->verdict == SPHV_AGREES) continue;
        sphv_html_row_begin(stream, result->id);
        if (result->dimension)
            fprintf(stream, "<td>%dD", result->dimension);
        else
            fputs("<td>all", stream);
        if (result->informative && result->verdict == SPHV_AGREES)
            fputs("<td>stated", stream);
        else
            sphv_html_verdict_cell(stream, result->verdict);
        sphv_html_number_cell(stream, result->analytic, 8);
        sphv_html_number_cell(stream, result->empirical, 8);
        sphv_html_number_cell(stream, result->bound, 2);
        sphv_html_text_cell(stream, result->claim);
        if (*result->cause) {
            fputs("; ", stream);
            sphv_put_html(stream, result->cause);
        }
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
}

/// What failed is shown at once, the rest on request.
static void put_checks(FILE *stream, const sphv_kernel_facts *facts)
{
    if (!facts->check) return;
    fprintf(stream, "<h4>Checks</h4>\n<p>%zu of %zu passed.</p>\n", facts->checks_passed,
            facts->checks);
    if (facts->checks_passed < facts->checks) put_check_rows(stream, facts->check, true);
    fputs("<details><summary>All checks</summary>\n", stream);
    put_check_rows(stream, facts->check, false);
    fputs("</details>\n", stream);
}

void sphv_html_kernel(FILE *stream, const sphv_rendering *rendering, size_t index)
{
    const sphv_kernel_facts *facts = &rendering->facts[index];
    fprintf(stream, "<article id=\"kernel-%zu\"><h3>", index);
    sphv_put_html(stream, sphv_kernel_title(facts->kernel));
    fputs(" (<code>", stream);
    sphv_put_html(stream, sphv_kernel_name(facts->kernel));
    fputs("</code>)</h3>\n<p>Verdict: ", stream);
    sphv_html_verdict(stream, facts->verdict);
    fputs("</p>\n", stream);
    put_properties(stream, facts);
    put_dimensions(stream, facts);
    put_knots(stream, facts->profile);
    sphv_html_figure(stream, rendering, rendering->kernel_plots[index],
                     "The kernel with its derivatives, and its Fourier transform relative to its "
                     "integral, linear and logarithmic; where it is negative, particles can pair.");
    put_checks(stream, facts);
    put_agreement(stream, facts);
    fputs("</article>\n", stream);
}
