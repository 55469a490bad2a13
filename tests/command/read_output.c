/// Reads what the program printed, strictly, for the command tests.
///
///     read_output json FILE PATH…   parse (no repeated keys), and print the value at each path,
///                                   such as analytic.total or checks.0.id; `-` where there is none
///     read_output csv FILE          parse RFC 4180, every row as long as the header; print
///                                   `rows columns`
///     read_output finite FILE NAME… every value of these columns is a finite number; with none
///                                   named, every value that looks like a number is finite
///     read_output column FILE NAME  print the column
///     read_output math A OP B       exit 0 when A OP B holds for numbers; OP is lt, le or eq
#include <jansson.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        perror(path);
        exit(2);
    }
    size_t capacity = (size_t)1 << 26;
    char *text = malloc(capacity);
    *size = fread(text, 1, capacity - 1, file);
    text[*size] = '\0';
    fclose(file);
    return text;
}

static const json_t *step_into(const json_t *at, const char *name)
{
    return json_is_array(at) ? json_array_get(at, (size_t)strtoul(name, NULL, 10))
                             : json_object_get(at, name);
}

static void print_value(const json_t *value)
{
    if (!value)
        puts("-");
    else if (json_is_string(value))
        puts(json_string_value(value));
    else if (json_is_real(value))
        printf("%.17g\n", json_real_value(value));
    else if (json_is_array(value) || json_is_object(value))
        printf("%zu\n", json_is_array(value) ? json_array_size(value) : json_object_size(value));
    else
        json_dumpf(value, stdout, JSON_ENCODE_ANY), putchar('\n');
}

static int read_json(int count, char **paths, const char *file)
{
    json_error_t error;
    json_t *root = json_load_file(file, JSON_REJECT_DUPLICATES, &error);
    if (!root) {
        fprintf(stderr, "%s:%d: %s\n", file, error.line, error.text);
        return 1;
    }
    for (int i = 0; i < count; i++) {
        const json_t *at = root;
        char *copy = strdup(paths[i]);
        for (char *rest = copy, *name; at && (name = strsep(&rest, "."));) at = step_into(at, name);
        free(copy);
        print_value(at);
    }
    json_decref(root);
    return 0;
}

/// A parsed table: `columns` fields a row, `rows` rows with the header.
struct table {
    char **field;
    size_t columns, rows;
};

/// Unquotes one field in place; NULL when it is not RFC 4180.
static char *next_field(char **at, char *end)
{
    char *from = *at, *field, *to;
    if (*from != '"') {
        size_t length = strcspn(from, ",\n");
        if (memchr(from, '"', length)) return NULL;
        *end = from[length];
        from[length] = '\0';
        *at = from + length + (*end != '\0');
        return from;
    }
    for (field = to = ++from; *from != '"' || from[1] == '"'; from++) {
        if (*from == '\0') return NULL;
        if (*from == '"') from++;
        *to++ = *from;
    }
    *end = from[1];
    *to = '\0';
    if (*end != ',' && *end != '\n' && *end != '\0') return NULL;
    *at = from + 1 + (*end != '\0');
    return field;
}

static bool parse(char *text, size_t size, struct table *table)
{
    size_t capacity = size + 2, used = 0, in_row = 0;
    *table = (struct table){malloc(capacity * sizeof(char *)), 0, 0};
    if (size == 0 || text[size - 1] != '\n' || strlen(text) != size) return false;
    for (char *at = text; at < text + size;) {
        char end;
        char *field = next_field(&at, &end);
        if (!field) return false;
        table->field[used++] = field;
        in_row++;
        if (end == ',') continue;
        if (table->rows == 0) table->columns = in_row;
        if (in_row != table->columns) {
            fprintf(stderr, "row %zu has %zu fields, the header %zu\n", table->rows + 1, in_row,
                    table->columns);
            return false;
        }
        table->rows++;
        in_row = 0;
    }
    return in_row == 0 && table->rows > 0;
}

static bool is_finite_text(const char *text)
{
    char *end;
    double value = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(value);
}

static int find_column(const struct table *table, const char *name)
{
    for (size_t c = 0; c < table->columns; c++)
        if (strcmp(table->field[c], name) == 0) return (int)c;
    fprintf(stderr, "no column '%s'\n", name);
    return -1;
}

/// Whether the words nan or inf stand where numbers do.
static bool is_bad_number(const char *text)
{
    char *end;
    double value = strtod(text, &end);
    return end != text && *end == '\0' && !isfinite(value);
}

static int check_finite(const struct table *table, int count, char **names)
{
    for (size_t r = 1; r < table->rows; r++) {
        for (int i = 0; i < count; i++) {
            int c = find_column(table, names[i]);
            if (c < 0) return 1;
            const char *text = table->field[r * table->columns + (size_t)c];
            if (is_finite_text(text)) continue;
            fprintf(stderr, "row %zu, column %s: '%s' is not a finite number\n", r, names[i], text);
            return 1;
        }
        for (size_t c = 0; c < table->columns; c++)
            if (is_bad_number(table->field[r * table->columns + c])) {
                fprintf(stderr, "row %zu, column %s: '%s'\n", r, table->field[c],
                        table->field[r * table->columns + c]);
                return 1;
            }
    }
    return table->rows > 1 ? 0 : 1;
}

static int read_csv(const char *mode, int count, char **names, const char *file)
{
    size_t size;
    char *text = read_file(file, &size);
    struct table table;
    int status = 0;
    if (!parse(text, size, &table)) {
        fprintf(stderr, "%s is not CSV\n", file);
        status = 1;
    } else if (strcmp(mode, "csv") == 0) {
        printf("%zu %zu\n", table.rows - 1, table.columns);
    } else if (strcmp(mode, "finite") == 0) {
        status = check_finite(&table, count, names);
    } else {
        int c = count ? find_column(&table, names[0]) : -1;
        status = c < 0;
        for (size_t r = 1; r < table.rows && c >= 0; r++)
            puts(table.field[r * table.columns + (size_t)c]);
    }
    free(table.field);
    free(text);
    return status;
}

static int compare(const char *a, const char *operator, const char * b)
{
    if (!is_finite_text(a) || !is_finite_text(b)) return 1;
    double x = strtod(a, NULL), y = strtod(b, NULL);
    if (strcmp(operator, "lt") == 0) return !(x < y);
    if (strcmp(operator, "le") == 0) return !(x <= y);
    if (strcmp(operator, "eq") == 0) return !(x <= y && x >= y);
    return 2;
}

int main(int argc, char **argv)
{
    if (argc >= 3 && strcmp(argv[1], "json") == 0) return read_json(argc - 3, argv + 3, argv[2]);
    if (argc == 5 && strcmp(argv[1], "math") == 0) return compare(argv[2], argv[3], argv[4]);
    if (argc >= 3 && (strcmp(argv[1], "csv") == 0 || strcmp(argv[1], "finite") == 0 ||
                      strcmp(argv[1], "column") == 0))
        return read_csv(argv[1], argc - 3, argv + 3, argv[2]);
    fputs("read_output: json|csv|finite|column FILE …, or math A OP B\n", stderr);
    return 2;
}
