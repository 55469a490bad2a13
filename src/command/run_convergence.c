#include "run_convergence.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "report/convergence_facts.h"
#include "report/scene_facts.h"
#include "report/text.h"

enum { FIRST_COLUMN = 22, COLUMN = 9 };

/// A text in a column, padded by characters, not bytes.
static void put_padded(const char *text, int width)
{
    int length = sphv_text_length(text);
    printf("%*s%s", length < width ? width - length : 1, "", text);
}

static void put_rates(const char *name, const sphv_convergence_result *result, size_t row,
                      double (*value)(const sphv_cell_result *))
{
    const sphv_rate_table *table = result->scene->table;
    printf("  %-*s", FIRST_COLUMN - 2, name);
    for (size_t c = 0; c < table->column_count; c++) {
        char text[SPHV_RATE_TEXT];
        size_t i = row * table->column_count + c;
        put_padded(table->cells[i].there ? sphv_rate_text(text, value(&result->cells[i])) : "",
                   COLUMN);
    }
    putchar('\n');
}

static double slope(const sphv_cell_result *cell)
{
    return cell->slope;
}

static double per_neighbour(const sphv_cell_result *cell)
{
    return cell->per_neighbour;
}

static double theory(const sphv_cell_result *cell)
{
    return cell->theory;
}

static double interior(const sphv_cell_result *cell)
{
    return cell->interior;
}

static void print_row(const sphv_convergence_result *result, size_t row)
{
    static const char *const marks[] = {"yes", "RMSE/n", "no"};
    const sphv_rate_table *table = result->scene->table;
    printf("%-*s", FIRST_COLUMN, result->scene->targets[table->rows[row]].name);
    for (size_t c = 0; c < table->column_count; c++) {
        const sphv_cell *cell = &table->cells[row * table->column_count + c];
        put_padded(cell->there ? cell->text : "", COLUMN);
    }
    putchar('\n');
    put_rates("slope of RMSE", result, row, slope);
    put_rates("slope of RMSE/n", result, row, per_neighbour);
    put_rates("theory", result, row, theory);
    put_rates("interior", result, row, interior);
    printf("  %-*s", FIRST_COLUMN - 2, "reproduced");
    for (size_t c = 0; c < table->column_count; c++) {
        size_t i = row * table->column_count + c;
        put_padded(table->cells[i].there ? marks[result->cells[i].verdict] : "", COLUMN);
    }
    putchar('\n');
}

static void print_unexpected(const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    const sphv_rate_table *table = scene->table;
    for (size_t i = 0; i < table->row_count * table->column_count; i++) {
        const sphv_cell *cell = &table->cells[i];
        const sphv_cell_result *found = &result->cells[i];
        if (!cell->there || (!cell->why && !found->surprising)) continue;
        printf("  %s by %s, printed %s: %s%s\n",
               scene->targets[table->rows[i / table->column_count]].name,
               scene->schemes[table->columns[i % table->column_count]].label, cell->text,
               sphv_cell_verdict_name(found->verdict),
               found->surprising ? " (not what the scene expects)" : "");
        if (cell->why) printf("    %s\n", cell->why);
        for (size_t e = 0; e < cell->evidence_count; e++) {
            char rate[SPHV_RATE_TEXT];
            printf("    - %s: %s\n", cell->evidence[e].statement,
                   sphv_rate_text(rate, found->evidence[e]));
        }
    }
}

static void print_table(const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    const sphv_rate_table *table = scene->table;
    printf("%-*s", FIRST_COLUMN, "rate in N, printed");
    for (size_t c = 0; c < table->column_count; c++)
        put_padded(scene->schemes[table->columns[c]].label, COLUMN);
    putchar('\n');
    for (size_t r = 0; r < table->row_count; r++) print_row(result, r);
    putchar('\n');
    for (size_t g = 0; g < table->group_count; g++)
        printf("  %-12s  %s: %zu of %zu rates reproduced to %.3g, deviation %.2g rms\n",
               result->groups[g].surprising ? "disagrees" : "agrees", table->groups[g].label,
               result->groups[g].reproduced, result->groups[g].cells, table->groups[g].tolerance,
               result->groups[g].rms);
    putchar('\n');
    print_unexpected(result);
}

static void print_schemes(const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    for (size_t s = 0; s < scene->scheme_count; s++) {
        const sphv_scheme *scheme = &scene->schemes[s];
        char h[SPHV_RULE_TEXT], box[SPHV_RULE_TEXT], failed[200];
        sphv_fault_counts faults = sphv_scheme_faults(result, s);
        sphv_faults_text(failed, sizeof failed, &faults);
        printf("  %-12s  %s, %s, %s; %s%s%s\n", scheme->label,
               scheme->has_method ? sphv_methods[scheme->method].name : "counted only",
               sphv_kernel_name(scheme->kernel), sphv_h_rule_text(h, scheme),
               sphv_box_text(box, &scene->boxes[scheme->box].box),
               scheme->has_method ? "; without result: " : "", scheme->has_method ? failed : "");
    }
}

static void print_claims(const sphv_convergence_result *result)
{
    for (size_t i = 0; i < result->scene->claim_count; i++) {
        const sphv_rate_claim *claim = &result->scene->claims[i];
        const sphv_claim_result *found = &result->claims[i];
        char measure[SPHV_SERIES_TEXT];
        printf("  %-12s  %s\n  %-12s  %s: expected %.6g ± %.2g", sphv_verdict_name(found->verdict),
               claim->statement, "", sphv_claim_series_text(measure, result->scene, claim),
               claim->expected, claim->tolerance);
        if (isfinite(found->analytic)) printf(", theory %.6g", found->analytic);
        printf(isfinite(found->empirical) ? ", measured %.6g\n" : ", nothing to measure\n",
               found->empirical);
        if (claim->refuted) printf("  %-12s  why it fails: %s\n", "", claim->refuted);
        if (found->surprising && claim->refuted) printf("  %-12s  yet it holds here\n", "");
    }
}

void sphv_print_convergence(const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    printf("%s: %s\n%s\n\n", scene->name, scene->title, scene->source);
    print_schemes(result);
    printf("\n  %-12s  RMSE: %zu points agree, %zu disagree, %zu inconclusive\n\n", "theory",
           result->verdicts[SPHV_AGREES], result->verdicts[SPHV_DISAGREES],
           result->verdicts[SPHV_INCONCLUSIVE]);
    if (scene->listed)
        printf("  n as printed at %zu of %zu levels, h within a unit of its last digit at %zu\n\n",
               result->listed_neighbours, scene->level_count, result->listed_h);
    if (scene->table) print_table(result);
    print_claims(result);
    printf("\n%s: %s (%.3f s)\n", scene->name, sphv_verdict_name(result->verdict), result->seconds);
}

sphv_status sphv_write_drawn(sphv_status drawn, char *svg, const sphv_error *reason,
                             const char *directory, const char *name, sphv_error *error)
{
    sphv_output_file file;
    if (drawn != SPHV_OK)
        return sphv_fail(error, drawn, "%.600s; with --no-plot all but the SVG is written",
                         reason->message);
    sphv_status status = sphv_output_open(directory, name, &file, error);
    if (status == SPHV_OK) {
        fputs(svg, file.stream);
        status = sphv_output_commit(&file, error);
    }
    free(svg);
    return status;
}

static sphv_status write_plot(const sphv_convergence_result *result, size_t plot,
                              const char *directory, sphv_error *error)
{
    char name[160], *svg = NULL;
    sphv_error reason;
    sphv_status status = sphv_plot_rates(result, plot, &svg, &reason);
    snprintf(name, sizeof name, "%.64s-%.60s.svg", result->scene->name,
             result->scene->plots[plot].id);
    return sphv_write_drawn(status, svg, &reason, directory, name, error);
}

sphv_status sphv_write_convergence(const sphv_convergence_result *result, const char *directory,
                                   bool plots, sphv_error *error)
{
    char name[96];
    sphv_output_file file;
    snprintf(name, sizeof name, "%.64s.csv", result->scene->name);
    sphv_status status = sphv_output_open(directory, name, &file, error);
    if (status != SPHV_OK) return status;
    sphv_convergence_csv(file.stream, result);
    status = sphv_output_commit(&file, error);
    for (size_t p = 0; plots && status == SPHV_OK && p < result->scene->plot_count; p++)
        status = write_plot(result, p, directory, error);
    return status;
}
