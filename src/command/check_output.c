#include "check_output.h"

#include <math.h>
#include <string.h>

#include "command.h"
#include "report/text.h"

json_t *sphv_check_json(const sphv_check_report *report)
{
    json_t *checks = json_array();
    for (size_t i = 0; i < report->count; i++)
        json_array_append_new(checks, sphv_check_result_json(&report->results[i]));
    return json_pack("{s:o, s:o, s:o, s:s, s:o, s:o, s:o}", "kernel",
                     sphv_json_text(report->kernel), "title", sphv_json_text(report->title), "path",
                     sphv_json_text(report->path), "verdict", sphv_verdict_name(report->verdict),
                     "cause", sphv_json_text_or_null(report->cause), "seconds",
                     sphv_json_number(report->seconds), "checks", checks);
}

json_t *sphv_check_rows_json(const sphv_check_report *report)
{
    json_t *rows = json_array();
    for (size_t i = 0; i < report->count; i++) {
        json_t *row = json_pack("{s:o}", "kernel", sphv_json_text(report->kernel));
        json_t *result = sphv_check_result_json(&report->results[i]);
        json_object_update(row, result);
        json_decref(result);
        json_array_append_new(rows, row);
    }
    return rows;
}

static void put_padded(FILE *stream, const char *text, int width)
{
    char one[5];
    int used = 0;
    for (; sphv_text_next(&text, one); used++) fputs(one, stream);
    for (; used < width; used++) fputc(' ', stream);
}

static void put_number(FILE *stream, double value)
{
    char text[SPHV_NUMBER_TEXT] = "-";
    if (isfinite(value)) snprintf(text, sizeof text, "%.12g", value == 0 ? 0 : value);
    fprintf(stream, "%20s", text);
}

static const char *dimension_text(int dimension)
{
    static const char *const names[] = {"all", "1D", "2D", "3D"};
    return names[dimension];
}

/// Lines that are only stated carry no verdict of their own.
static const char *word(const sphv_check_result *result)
{
    return result->informative && result->verdict == SPHV_AGREES
               ? "stated"
               : sphv_verdict_name(result->verdict);
}

/// The cause of one result. What the whole report names at its end is not repeated at each check.
static void put_cause(FILE *stream, const sphv_check_report *report,
                      const sphv_check_result *result)
{
    char text[sizeof result->cause];
    snprintf(text, sizeof text, "%s", result->cause);
    char *known = *report->cause ? strstr(text, report->cause) : NULL;
    if (known) {
        *known = '\0';
        if (known - text >= 2) known[-2] = '\0'; // the "; " before it
    }
    // Where both halves agree with each other and not with the file, its number is the news.
    bool differs = result->verdict == SPHV_DISAGREES && isfinite(result->claimed) &&
                   result->claimed != result->analytic;
    if (differs) fprintf(stream, "\n  %-12s  -> the file says %.12g", "", result->claimed);
    if (!*text) return;
    fprintf(stream, "\n  %-12s  %s ", "", result->verdict == SPHV_AGREES ? "note:" : "->");
    put_padded(stream, text, 0);
}

void sphv_check_print_text(FILE *stream, const sphv_check_report *report)
{
    put_padded(stream, report->kernel, 0);
    fputs(": ", stream);
    put_padded(stream, report->title, 0);
    fputs("\n\n", stream);
    fprintf(stream, "  %-12s  %-20s  %-3s  %20s  %20s  %8s\n", "", "check", "dim", "analytic",
            "measured", "bound");
    for (size_t i = 0; i < report->count; i++) {
        const sphv_check_result *result = &report->results[i];
        fprintf(stream, "  %-12s  %-20s  %-3s  ", word(result), result->id,
                dimension_text(result->dimension));
        put_number(stream, result->analytic);
        fputs("  ", stream);
        put_number(stream, result->empirical);
        fprintf(stream, "  %8.1e  ", result->bound);
        put_padded(stream, result->claim, 0);
        put_cause(stream, report, result);
        fputc('\n', stream);
    }
    fputc('\n', stream);
    put_padded(stream, report->kernel, 0);
    fprintf(stream, ": %s", sphv_verdict_name(report->verdict));
    for (size_t i = 0, named = 0; i < report->count; i++)
        if (report->results[i].verdict != SPHV_AGREES)
            fprintf(stream, "%s%s (%s)", named++ ? ", " : ": ", report->results[i].id,
                    dimension_text(report->results[i].dimension));
    fprintf(stream, " (%.2f s)\n", report->seconds);
    if (*report->cause) {
        fputs("likely cause: ", stream);
        put_padded(stream, report->cause, 0);
        fputc('\n', stream);
    }
}

void sphv_check_print_markdown(FILE *stream, const sphv_check_report *report)
{
    fputs("# ", stream);
    sphv_put_markdown(stream, report->kernel);
    fputs(": ", stream);
    sphv_put_markdown(stream, report->title);
    fprintf(stream, "\n\nVerdict: **%s**\n\n", sphv_verdict_name(report->verdict));
    if (*report->cause) {
        fputs("Likely cause: ", stream);
        sphv_put_markdown(stream, report->cause);
        fputs("\n\n", stream);
    }
    fputs(
        "| Check | Dimension | Claim | Claimed | Analytic | Measured | Bound | Verdict | Cause or "
        "remark |\n|---|---|---|---|---|---|---|---|---|\n",
        stream);
    for (size_t i = 0; i < report->count; i++) {
        const sphv_check_result *result = &report->results[i];
        const double numbers[] = {result->claimed, result->analytic, result->empirical};
        fprintf(stream, "| %s | %s | ", result->id, dimension_text(result->dimension));
        sphv_put_markdown(stream, result->claim);
        for (int k = 0; k < 3; k++) {
            char text[SPHV_NUMBER_TEXT];
            fprintf(stream, " | %s", sphv_number_text(text, numbers[k], 15));
        }
        fprintf(stream, " | %.1e | %s | ", result->bound, word(result));
        sphv_put_markdown(stream, result->cause);
        fputs(" |\n", stream);
    }
}

json_t *sphv_self_test_json(const sphv_self_test *test)
{
    json_t *defects = json_array();
    for (size_t i = 0; i < test->count; i++) {
        const sphv_defect_tally *tally = &test->defects[i];
        json_array_append_new(
            defects,
            json_pack("{s:s, s:s, s:i, s:i, s:i, s:i, s:s, s:s, s:s}", "id", tally->id, "defect",
                      tally->meaning, "applied", tally->applied, "unchanged", tally->unchanged,
                      "caught", tally->caught, "cause_named", tally->named, "checks", tally->checks,
                      "missed", tally->missed, "unnamed", tally->unnamed));
    }
    return json_pack("{s:s, s:i, s:i, s:s, s:o, s:o}", "verdict", sphv_verdict_name(test->verdict),
                     "kernels", test->kernels, "false_alarms", test->false_alarms, "first_alarm",
                     test->alarm, "seconds", sphv_json_number(test->seconds), "defects", defects);
}

void sphv_self_test_print(FILE *stream, const sphv_self_test *test)
{
    int applied = 0, caught = 0;
    fprintf(stream, "%-22s %7s %6s %6s %9s  %s\n", "defect", "applied", "caught", "named",
            "unchanged", "caught by");
    for (size_t i = 0; i < test->count; i++) {
        const sphv_defect_tally *tally = &test->defects[i];
        fprintf(stream, "%-22s %7d %6d %6d %9d  %s\n", tally->id, tally->applied, tally->caught,
                tally->named, tally->unchanged, tally->checks);
        if (*tally->unnamed) fprintf(stream, "%-22s not named: %s\n", "", tally->unnamed);
        if (*tally->missed) fprintf(stream, "%-22s missed: %s\n", "", tally->missed);
        applied += tally->applied;
        caught += tally->caught;
    }
    fprintf(stream,
            "\n%zu kinds of defect, %d faulty kernels, %d caught; %d sound kernels, %d raised "
            "something%s%s\n%s (%.1f s)\n",
            test->count, applied, caught, test->kernels, test->false_alarms,
            *test->alarm ? ": " : "", test->alarm, sphv_verdict_name(test->verdict), test->seconds);
}
