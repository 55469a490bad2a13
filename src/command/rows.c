#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command.h"

/// A growing table of texts.
struct table {
    size_t columns, rows;
    char *names[64];
    char **cells; ///< rows × 64
};

static char *cell_text(const json_t *value, const char *number_format)
{
    char text[64];
    if (json_is_string(value)) return strdup(json_string_value(value));
    if (json_is_null(value)) return strdup("");
    if (json_is_boolean(value)) return strdup(json_is_true(value) ? "yes" : "no");
    if (json_is_integer(value)) {
        snprintf(text, sizeof text, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
        return strdup(text);
    }
    if (json_is_array(value)) {
        char joined[512] = "";
        size_t used = 0, i;
        json_t *entry;
        json_array_foreach(value, i, entry)
        {
            char *part = cell_text(entry, number_format);
            if (part && used < sizeof joined)
                used += (size_t)snprintf(joined + used, sizeof joined - used, "%s%s", i ? " " : "",
                                         part);
            free(part);
        }
        return strdup(joined);
    }
    snprintf(text, sizeof text, number_format, json_number_value(value));
    return strdup(text);
}

static size_t column_of(struct table *table, const char *name)
{
    size_t c = 0;
    while (c < table->columns && strcmp(table->names[c], name) != 0) c++;
    if (c == table->columns && c < 64) table->names[table->columns++] = strdup(name);
    return c;
}

static void flatten(struct table *table, size_t row, const char *prefix, const json_t *object,
                    const char *number_format)
{
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)object, key, value)
    {
        char name[128];
        snprintf(name, sizeof name, "%s%s%s", prefix, *prefix ? "." : "", key);
        if (json_is_object(value)) {
            flatten(table, row, name, value, number_format);
            continue;
        }
        size_t column = column_of(table, name);
        if (column < 64) table->cells[row * 64 + column] = cell_text(value, number_format);
    }
}

/// Characters a terminal shows: UTF-8 bytes that are not continuations.
static int width_of(const char *text)
{
    int width = 0;
    for (; *text; text++) width += ((unsigned char)*text & 0xC0) != 0x80;
    return width;
}

static void print_padded(const char *text, int width, bool last)
{
    for (const char *c = text; *c; c++) putchar((unsigned char)*c < 0x20 ? ' ' : *c);
    for (int i = width_of(text); !last && i < width + 2; i++) putchar(' ');
}

static void print_csv_cell(const char *text)
{
    if (!strpbrk(text, ",\"\r\n")) {
        fputs(text, stdout);
        return;
    }
    putchar('"');
    for (; *text; text++) {
        if (*text == '"') putchar('"');
        putchar(*text);
    }
    putchar('"');
}

static void print_markdown_cell(const char *text)
{
    putchar(' ');
    for (; *text; text++) {
        if (strchr("|\\`*_<>[]", *text)) putchar('\\');
        putchar((unsigned char)*text < 0x20 ? ' ' : *text);
    }
    fputs(" |", stdout);
}

static void print_table(const struct table *table, sphv_format format)
{
    int width[64] = {0};
    for (size_t c = 0; c < table->columns; c++) {
        width[c] = width_of(table->names[c]);
        for (size_t r = 0; r < table->rows; r++) {
            const char *text = table->cells[r * 64 + c];
            if (text && width_of(text) > width[c]) width[c] = width_of(text);
        }
    }
    for (size_t r = 0; r <= table->rows; r++) {
        if (format == SPHV_FORMAT_MARKDOWN) putchar('|');
        for (size_t c = 0; c < table->columns; c++) {
            const char *text = r ? table->cells[(r - 1) * 64 + c] : table->names[c];
            if (!text) text = "";
            if (format == SPHV_FORMAT_MARKDOWN) {
                print_markdown_cell(text);
            } else if (format == SPHV_FORMAT_CSV) {
                if (c) putchar(',');
                print_csv_cell(text);
            } else {
                print_padded(text, width[c], c + 1 == table->columns);
            }
        }
        putchar('\n');
        if (r == 0 && format == SPHV_FORMAT_MARKDOWN) {
            putchar('|');
            for (size_t c = 0; c < table->columns; c++) fputs("---|", stdout);
            putchar('\n');
        }
    }
}

void sphv_print_rows(sphv_format format, const json_t *rows)
{
    if (format == SPHV_FORMAT_JSON) {
        sphv_print_json(rows);
        return;
    }
    const char *number_format = format == SPHV_FORMAT_CSV ? "%.17g" : "%.6g";
    struct table table = {0, json_array_size(rows), {NULL}, NULL};
    table.cells = calloc(table.rows * 64 + 1, sizeof *table.cells);
    if (!table.cells) return;
    for (size_t r = 0; r < table.rows; r++)
        flatten(&table, r, "", json_array_get(rows, r), number_format);
    print_table(&table, format);
    for (size_t i = 0; i < table.rows * 64; i++) free(table.cells[i]);
    for (size_t c = 0; c < table.columns; c++) free(table.names[c]);
    free(table.cells);
}
