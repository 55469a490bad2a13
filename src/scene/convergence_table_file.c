#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "convergence_reader.h"
#include "core/directory.h"

/// What stands where the paper prints nothing.
static const char blank[] = "none";

static sphv_status no_memory(sphv_error *error)
{
    return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
}

static sphv_status read_columns(const struct sphv_rates_reader *of, sphv_rate_table *table)
{
    const struct sphv_rates_table *file = of->file->table;
    table->columns = calloc(file->columns_count, sizeof *table->columns);
    table->group = calloc(file->columns_count, sizeof *table->group);
    if (!table->columns || !table->group) return no_memory(of->error);
    sphv_status status = SPHV_OK;
    for (unsigned i = 0; status == SPHV_OK && i < file->columns_count; i++) {
        char place[64];
        snprintf(place, sizeof place, "table.columns.%u", i);
        status = sphv_rates_find_scheme(of, place, file->columns[i], &table->columns[i]);
        if (status == SPHV_OK && !of->scene->schemes[table->columns[i]].has_method)
            status = SPHV_RATES_FAIL(of, place, "scheme '%s' has no method", file->columns[i]);
        table->column_count = i + 1;
    }
    return status;
}

static size_t find_column(const struct sphv_rates_reader *of, const char *id)
{
    const sphv_rate_table *table = of->scene->table;
    size_t c = 0;
    while (c < table->column_count && strcmp(of->scene->schemes[table->columns[c]].id, id) != 0)
        c++;
    return c;
}

static sphv_status read_group(const struct sphv_rates_reader *of, unsigned index)
{
    const struct sphv_rates_group *file = &of->file->table->groups[index];
    sphv_rate_table *table = of->scene->table;
    sphv_column_group *group = &table->groups[index];
    char place[64];
    snprintf(place, sizeof place, "table.groups.%u", index);
    sphv_status status = sphv_copy_text(file->label, &group->label, of->error);
    if (status == SPHV_OK) status = sphv_copy_text(file->reason, &group->reason, of->error);
    if (status == SPHV_OK)
        status = sphv_rates_number(of, place, file->tolerance, 0, &group->tolerance);
    if (status == SPHV_OK) status = sphv_rates_number(of, place, file->rms, INFINITY, &group->rms);
    if (status != SPHV_OK) return status;
    group->expected = file->per_neighbour && *file->per_neighbour ? SPHV_CELL_PER_NEIGHBOUR
                                                                  : SPHV_CELL_REPRODUCED;
    if (!(group->tolerance > 0 && group->rms > 0))
        return SPHV_RATES_FAIL(of, place, "a tolerance that is not positive");
    for (unsigned i = 0; i < file->columns_count; i++) {
        size_t column = find_column(of, file->columns[i]);
        if (column == table->column_count || table->group[column] != SIZE_MAX)
            return SPHV_RATES_FAIL(of, place, "'%s' is no column, or in two groups",
                                   file->columns[i]);
        table->group[column] = index;
    }
    return SPHV_OK;
}

static sphv_status read_groups(const struct sphv_rates_reader *of)
{
    const struct sphv_rates_table *file = of->file->table;
    sphv_rate_table *table = of->scene->table;
    table->groups = calloc(file->groups_count, sizeof *table->groups);
    if (!table->groups) return no_memory(of->error);
    for (size_t c = 0; c < table->column_count; c++) table->group[c] = SIZE_MAX;
    sphv_status status = SPHV_OK;
    for (unsigned i = 0; status == SPHV_OK && i < file->groups_count; i++) {
        table->group_count = i + 1;
        status = read_group(of, i);
    }
    for (size_t c = 0; status == SPHV_OK && c < table->column_count; c++)
        if (table->group[c] == SIZE_MAX)
            status = SPHV_RATES_FAIL(of, "table.groups", "column '%s' is in no group",
                                     of->scene->schemes[table->columns[c]].id);
    return status;
}

static sphv_status read_cell(const struct sphv_rates_reader *of, const char *place,
                             const char *printed, const char *limit, sphv_cell *cell)
{
    cell->there = strcmp(printed, blank) != 0;
    cell->limit = NAN;
    if (!cell->there) return SPHV_OK;
    sphv_status status = sphv_copy_text(printed, &cell->text, of->error);
    // The paper prints a plus sign, which is no part of a number here.
    if (status == SPHV_OK)
        status = sphv_rates_number(of, place, printed + (printed[0] == '+'), 0, &cell->printed);
    if (status == SPHV_OK && limit && strcmp(limit, blank) != 0)
        status = sphv_rates_number(of, place, limit + (limit[0] == '+'), 0, &cell->limit);
    return status;
}

static sphv_status read_rows(const struct sphv_rates_reader *of)
{
    const struct sphv_rates_table *file = of->file->table;
    sphv_rate_table *table = of->scene->table;
    size_t columns = table->column_count;
    table->rows = calloc(file->rows_count, sizeof *table->rows);
    table->cells = calloc(file->rows_count * columns, sizeof *table->cells);
    if (!table->rows || !table->cells) return no_memory(of->error);
    sphv_status status = SPHV_OK;
    for (unsigned i = 0; status == SPHV_OK && i < file->rows_count; i++) {
        const struct sphv_rates_row *row = &file->rows[i];
        char place[64];
        snprintf(place, sizeof place, "table.rows.%u", i);
        table->row_count = i + 1;
        if (row->printed_count != columns || (row->limits_count && row->limits_count != columns))
            return SPHV_RATES_FAIL(of, place, "%u printed and %u limits; allowed: one a column",
                                   row->printed_count, row->limits_count);
        status = sphv_rates_find_target(of, place, row->quantity, &table->rows[i]);
        for (unsigned c = 0; status == SPHV_OK && c < columns; c++) {
            sphv_cell *cell = &table->cells[i * columns + c];
            status = read_cell(of, place, row->printed[c],
                               row->limits_count ? row->limits[c] : NULL, cell);
            cell->expected = table->groups[table->group[c]].expected;
        }
    }
    return status;
}

static sphv_status read_evidence(const struct sphv_rates_reader *of, const char *place,
                                 const struct sphv_rates_evidence *file, sphv_series series,
                                 sphv_evidence *evidence)
{
    int metric = 0;
    evidence->series = series;
    evidence->matches = !file->matches || *file->matches;
    sphv_status status = sphv_copy_text(file->statement, &evidence->statement, of->error);
    if (status == SPHV_OK)
        status = sphv_rates_name(of, place, file->metric, sphv_metrics, SPHV_METRIC_RMSE, &metric);
    if (status == SPHV_OK && file->scheme)
        status = sphv_rates_find_scheme(of, place, file->scheme, &evidence->series.scheme);
    if (status == SPHV_OK)
        status = sphv_rates_levels(of, place, file->first, file->last, &evidence->series);
    if (status == SPHV_OK && file->without_count)
        status = sphv_rates_add_altered(of, place, series.target, file, &evidence->series.target);
    if (status == SPHV_OK && metric > SPHV_METRIC_STANDARD_DEVIATION)
        status = SPHV_RATES_FAIL(of, place, "metric '%s'; allowed: those of errors", file->metric);
    evidence->series.metric = (sphv_metric)metric;
    evidence->series.per_neighbour = file->per_neighbour && *file->per_neighbour;
    evidence->series.interior = file->interior && *file->interior;
    return status;
}

static sphv_status read_exception(const struct sphv_rates_reader *of, unsigned index)
{
    const struct sphv_rates_exception *file = &of->file->table->exceptions[index];
    sphv_rate_table *table = of->scene->table;
    char place[64];
    size_t target, row = 0, column = find_column(of, file->scheme);
    snprintf(place, sizeof place, "table.exceptions.%u", index);
    sphv_status status = sphv_rates_find_target(of, place, file->quantity, &target);
    if (status != SPHV_OK) return status;
    while (row < table->row_count && table->rows[row] != target) row++;
    sphv_cell *cell = row < table->row_count && column < table->column_count
                          ? &table->cells[row * table->column_count + column]
                          : NULL;
    if (!cell || !cell->there || cell->why)
        return SPHV_RATES_FAIL(of, place, "%s by %s is no printed cell, or named twice",
                               file->quantity, file->scheme);
    cell->expected = SPHV_CELL_NOT_REPRODUCED;
    status = sphv_copy_text(file->why, &cell->why, of->error);
    cell->evidence = calloc(file->evidence_count + 1, sizeof *cell->evidence);
    if (!cell->evidence) return no_memory(of->error);
    sphv_series series = {.scheme = table->columns[column], .target = target};
    for (unsigned i = 0; status == SPHV_OK && i < file->evidence_count; i++) {
        char where[96];
        snprintf(where, sizeof where, "%s.evidence.%u", place, i);
        cell->evidence_count = i + 1;
        status = read_evidence(of, where, &file->evidence[i], series, &cell->evidence[i]);
    }
    return status;
}

static sphv_status read_listed(const struct sphv_rates_reader *of)
{
    const struct sphv_rates_listed *file = of->file->listed;
    sphv_convergence *scene = of->scene;
    sphv_level_list *list = scene->listed = calloc(1, sizeof *scene->listed);
    if (!list) return no_memory(of->error);
    list->neighbours = calloc(scene->level_count, sizeof *list->neighbours);
    list->h = calloc(scene->level_count, sizeof *list->h);
    if (!list->neighbours || !list->h) return no_memory(of->error);
    if (file->neighbours_count != scene->level_count || file->h_count != scene->level_count)
        return SPHV_RATES_FAIL(of, "printed_levels",
                               "%u neighbours and %u h; allowed: %zu, one a "
                               "level",
                               file->neighbours_count, file->h_count, scene->level_count);
    sphv_status status = sphv_rates_find_scheme(of, "printed_levels", file->scheme, &list->scheme);
    for (size_t i = 0; status == SPHV_OK && i < scene->level_count; i++) {
        double number;
        status = sphv_copy_text(file->neighbours[i], &list->neighbours[i], of->error);
        if (status == SPHV_OK) status = sphv_copy_text(file->h[i], &list->h[i], of->error);
        if (status == SPHV_OK)
            status = sphv_rates_number(of, "printed_levels", list->neighbours[i], 0, &number);
        if (status == SPHV_OK)
            status = sphv_rates_number(of, "printed_levels", list->h[i], 0, &number);
    }
    return status;
}

sphv_status sphv_rates_read_table(const struct sphv_rates_reader *of)
{
    sphv_status status = of->file->listed ? read_listed(of) : SPHV_OK;
    if (status != SPHV_OK || !of->file->table) return status;
    of->scene->table = calloc(1, sizeof *of->scene->table);
    if (!of->scene->table) return no_memory(of->error);
    status = read_columns(of, of->scene->table);
    if (status == SPHV_OK) status = read_groups(of);
    if (status == SPHV_OK) status = read_rows(of);
    for (unsigned i = 0; status == SPHV_OK && i < of->file->table->exceptions_count; i++)
        status = read_exception(of, i);
    return status;
}

static sphv_status read_claim(const struct sphv_rates_reader *of, unsigned index)
{
    const struct sphv_rates_claim *file = &of->file->claims[index];
    sphv_rate_claim *claim = &of->scene->claims[index];
    char place[64];
    int measure = 0;
    snprintf(place, sizeof place, "claims.%u", index);
    for (unsigned i = 0; i < index; i++)
        if (strcmp(of->file->claims[i].stated.id, file->stated.id) == 0)
            return SPHV_RATES_FAIL(of, place, "claim '%s' again; allowed: each id once",
                                   file->stated.id);
    sphv_status status = sphv_read_claim_texts(&file->stated, SPHV_TEXTS_OF(claim), of->error);
    if (status == SPHV_OK)
        status = sphv_rates_name(of, place, file->measure, sphv_rate_measures, 0, &measure);
    claim->measure = (sphv_rate_measure)measure;
    if (status == SPHV_OK)
        status = sphv_rates_series(of, place, &file->series, false, &claim->series);
    if (status == SPHV_OK)
        status = sphv_rates_number(of, place, file->stated.expected, 0, &claim->expected);
    if (status == SPHV_OK)
        status = sphv_rates_number(of, place, file->stated.tolerance, 0, &claim->tolerance);
    if (status == SPHV_OK && claim->tolerance < 0)
        status = SPHV_RATES_FAIL(of, place, "tolerance %s; allowed: zero or positive",
                                 file->stated.tolerance);
    return status;
}

sphv_status sphv_rates_read_claims(const struct sphv_rates_reader *of)
{
    sphv_convergence *scene = of->scene;
    scene->claims = calloc(of->file->claims_count + 1, sizeof *scene->claims);
    if (!scene->claims) return no_memory(of->error);
    sphv_status status = SPHV_OK;
    for (unsigned i = 0; status == SPHV_OK && i < of->file->claims_count; i++) {
        scene->claim_count = i + 1;
        status = read_claim(of, i);
    }
    return status;
}

static sphv_status read_plot_schemes(const struct sphv_rates_reader *of, const char *place,
                                     const struct sphv_rates_plot *file, sphv_rate_plot *plot)
{
    const sphv_rate_table *table = of->scene->table;
    size_t columns = table ? table->column_count : 0;
    plot->schemes = calloc(file->schemes_count + columns + 1, sizeof *plot->schemes);
    if (!plot->schemes) return no_memory(of->error);
    if (file->schemes_count + columns == 0 || (plot->picture && file->schemes_count != 1))
        return SPHV_RATES_FAIL(of, place, "plot '%s' needs 'schemes'%s", file->id,
                               plot->picture ? ", one, whose box is drawn" : "");
    sphv_status status = SPHV_OK;
    for (unsigned i = 0; status == SPHV_OK && i < file->schemes_count; i++)
        status = sphv_rates_find_scheme(of, place, file->schemes[i],
                                        &plot->schemes[plot->scheme_count++]);
    for (size_t c = 0; !file->schemes_count && c < columns; c++)
        plot->schemes[plot->scheme_count++] = table->columns[c];
    return status;
}

static sphv_status read_plot(const struct sphv_rates_reader *of, unsigned index)
{
    const struct sphv_rates_plot *file = &of->file->plots[index];
    sphv_rate_plot *plot = &of->scene->plots[index];
    struct sphv_rates_series series = file->series;
    static char h[] = "h"; // a metric without a quantity: a picture has neither
    char place[64];
    snprintf(place, sizeof place, "plots.%u", index);
    for (unsigned i = 0; i < index; i++)
        if (strcmp(of->file->plots[i].id, file->id) == 0)
            return SPHV_RATES_FAIL(of, place, "plot '%s' again; allowed: each id once", file->id);
    if (!sphv_plain_name(file->id))
        return SPHV_RATES_FAIL(of, place,
                               "'%s' is not a name; allowed: letters, digits, '-', '_' "
                               "and '.'",
                               file->id);
    plot->picture = file->picture && *file->picture;
    if (plot->picture && !series.metric) series.metric = h;
    sphv_status status = sphv_copy_text(file->id, &plot->id, of->error);
    if (status == SPHV_OK) status = sphv_copy_text(file->title, &plot->title, of->error);
    if (status == SPHV_OK) status = sphv_rates_series(of, place, &series, true, &plot->series);
    if (status == SPHV_OK && plot->picture && of->scene->dimension != 2)
        status = SPHV_RATES_FAIL(of, place, "a picture in %d dimensions; allowed: 2",
                                 of->scene->dimension);
    if (status == SPHV_OK) status = read_plot_schemes(of, place, file, plot);
    for (unsigned i = 0; status == SPHV_OK && i < file->trends_count; i++)
        status =
            sphv_rates_number(of, place, file->trends[i], 0, &plot->trends[plot->trend_count++]);
    return status;
}

sphv_status sphv_rates_read_plots(const struct sphv_rates_reader *of)
{
    sphv_convergence *scene = of->scene;
    scene->plots = calloc(of->file->plots_count + 1, sizeof *scene->plots);
    if (!scene->plots) return no_memory(of->error);
    sphv_status status = SPHV_OK;
    for (unsigned i = 0; status == SPHV_OK && i < of->file->plots_count; i++) {
        scene->plot_count = i + 1;
        status = read_plot(of, i);
    }
    return status;
}
