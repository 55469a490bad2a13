#include <math.h>

#include "html.h"
#include "text.h"

static void put_sign(FILE *stream, const sphv_slips *slips)
{
    static const char *const columns[] = {
        "Δx/h",    "measured E<sub>d</sub>", "bound",   "eq. 16, sign mended",  "bound",
        "verdict", "eq. 16 as printed",      "verdict", "its first term alone", NULL};
    fputs("<h3>The sign of eq. 11</h3>\n<p>The second Euler–Maclaurin formula is Δx Σf = ∫f − Σ…; "
          "eq. 11 prints +, and eqs. 12, 15 and 16 carry it. A norm hides the sign; the sum with "
          "the smoothing error does not. Kernel <code>",
          stream);
    sphv_put_html(stream, sphv_kernel_name(slips->sign_kernel));
    fputs("</code>, A = x (h/λ → 0). The bound of eq. 16 is the size of the terms it leaves "
          "out.</p>\n",
          stream);
    sphv_html_table_begin(stream, NULL, columns);
    for (int i = 0; i < SPHV_SIGN_ROWS; i++) {
        const sphv_sign_slip *row = &slips->sign[i];
        fprintf(stream, "<tr><th scope=row>4/%d", 2 * row->n + 1);
        sphv_html_number_cell(stream, row->measured.value, 5);
        sphv_html_number_cell(stream, row->measured.bound, 2);
        sphv_html_number_cell(stream, row->mended.value, 5);
        sphv_html_number_cell(stream, row->mended.bound, 2);
        sphv_html_verdict_cell(stream, row->mended_verdict);
        sphv_html_number_cell(stream, row->printed.value, 5);
        sphv_html_verdict_cell(stream, row->printed_verdict);
        sphv_html_number_cell(stream, -row->first_term, 3);
        fputc('\n', stream);
    }
    sphv_html_table_end(stream);
}

static void put_knot_terms(FILE *stream, const sphv_knot_slip *slip)
{
    fputs(SPHV_HTML_SCROLL "<table><caption>Terms of the Euler–Maclaurin series by "
                           "knot</caption><thead><tr><th scope=col>knot",
          stream);
    for (int i = 0; i < SPHV_KNOT_TERMS; i++)
        fprintf(stream, "<th scope=col>p = %d", slip->first_order + i);
    fputs("</thead>\n<tbody>\n", stream);
    for (int k = 0; k < slip->knot_count; k++) {
        fprintf(stream, "<tr><th scope=row>s = %s%g%s", slip->position[k] > 0 ? "±" : "",
                slip->position[k], k + 1 == slip->knot_count ? " (edge)" : "");
        for (int i = 0; i < SPHV_KNOT_TERMS; i++)
            sphv_html_number_cell(stream, slip->term[k][i], 4);
        fputc('\n', stream);
    }
    fputs("<tr><th scope=row>all", stream);
    for (int i = 0; i < SPHV_KNOT_TERMS; i++) {
        double sum = 0;
        for (int k = 0; k < slip->knot_count; k++) sum += slip->term[k][i];
        sphv_html_number_cell(stream, sum, 4);
    }
    fputc('\n', stream);
    sphv_html_table_end(stream);
}

static void put_knots(FILE *stream, const sphv_slips *slips)
{
    static const char *const columns[] = {"E<sub>d</sub>", "value", "bound", "verdict", NULL};
    const sphv_knot_slip *slip = &slips->knot;
    fputs("<h3>Interior knots</h3>\n<p>The analysis counts only the edge of the support and "
          "predicts order β + 2 from it. The third derivative of the cubic B-spline jumps at "
          "interior knots too, and at Δx/h = 4/(2n+1) their terms of lower order do not vanish. "
          "Kernel <code>",
          stream);
    sphv_put_html(stream, sphv_kernel_name(slips->knot_kernel));
    fprintf(stream, "</code>, h/λ = %g, Δx/h = ", slip->h);
    sphv_html_number(stream, slip->spacing, 4);
    fputs(".</p>\n", stream);
    put_knot_terms(stream, slip);
    sphv_html_table_begin(stream, NULL, columns);
    sphv_html_row_begin(stream, "measured");
    sphv_html_number_cell(stream, slip->measured.value, 7);
    sphv_html_number_cell(stream, slip->measured.bound, 2);
    fputs("<td>\n", stream);
    sphv_html_row_begin(stream, "exact form, all knots");
    sphv_html_number_cell(stream, slip->exact.value, 7);
    sphv_html_number_cell(stream, slip->exact.bound, 2);
    sphv_html_verdict_cell(stream, slip->exact_verdict);
    sphv_html_row_begin(stream, "paper’s form, edge only");
    sphv_html_number_cell(stream, slip->paper.value, 7);
    sphv_html_number_cell(stream, slip->paper.bound, 2);
    sphv_html_verdict_cell(stream, slip->paper_verdict);
    sphv_html_table_end(stream);
    fprintf(stream,
            "<p>Order in Δx/h at 4/(2n+1): %d by the edge alone, %d by all knots; measured "
            "slope over n = 5 … 40 at h/λ = 10<sup>−4</sup>: ",
            slip->paper_order, slip->predicted_order);
    sphv_html_number(stream, slip->fitted_order.value, 5);
    fputs(" ± ", stream);
    sphv_html_number(stream, slip->fitted_order.bound, 2);
    fputs(" (standard error of the fit).</p>\n", stream);
}

void sphv_html_slips(FILE *stream, const sphv_slips *slips)
{
    if (slips->sign_kernel) put_sign(stream, slips);
    if (slips->knot_kernel) put_knots(stream, slips);
    if (!slips->sign_kernel || !slips->knot_kernel)
        fputs("<p>The numbers of a slip need its kernel, quinlan-w10 or cubic-spline, in one "
              "dimension; this report does not have both.</p>\n",
              stream);
    fputs("<h3>Slips of the text</h3>\n<ul>\n", stream);
    for (const char *const *line = sphv_slips_of_text; *line; line++) {
        fputs("<li>", stream);
        sphv_put_html(stream, *line);
        fputc('\n', stream);
    }
    fputs("</ul>\n", stream);
}
