/// The oracle's own reading of a kernel file.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

#include "oracle_internal.h"

bool oracle_rational(const char *text, mpq_t out)
{
    char digits[256] = "";
    size_t used = 0;
    long scale = 0;
    bool point = false;
    const char *c = text;
    if (*c == '-' || *c == '+') {
        if (*c == '-') digits[used++] = '-';
        c++;
    }
    for (; *c && *c != '/' && *c != 'e' && *c != 'E'; c++) {
        if (*c == '.' && !point) {
            point = true;
            continue;
        }
        if (*c < '0' || *c > '9' || used > 200) return false;
        digits[used++] = *c;
        scale -= point;
    }
    if (*c == 'e' || *c == 'E') scale += strtol(c + 1, (char **)&c, 10);
    digits[used] = '\0';
    mpq_t unit;
    mpq_init(unit);
    bool good = mpq_set_str(out, digits, 10) == 0;
    mpz_ui_pow_ui(scale < 0 ? mpq_denref(unit) : mpq_numref(unit), 10, (unsigned long)labs(scale));
    if (scale < 0) mpz_set_ui(mpq_numref(unit), 1);
    mpq_mul(out, out, unit);
    if (good && *c == '/') {
        good = oracle_rational(c + 1, unit) && mpq_sgn(unit) != 0;
        if (good) mpq_div(out, out, unit);
    } else if (*c) {
        good = false;
    }
    mpq_clear(unit);
    return good;
}

static const yaml_node_t *entry(yaml_document_t *file, const yaml_node_t *map, const char *key)
{
    if (!map || map->type != YAML_MAPPING_NODE) return NULL;
    for (yaml_node_pair_t *p = map->data.mapping.pairs.start; p < map->data.mapping.pairs.top; p++)
        if (strcmp((char *)yaml_document_get_node(file, p->key)->data.scalar.value, key) == 0)
            return yaml_document_get_node(file, p->value);
    return NULL;
}

static const char *text_of(const yaml_node_t *node)
{
    return node && node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : "";
}

static bool read_pieces(oracle *kernel, yaml_document_t *file, const yaml_node_t *list)
{
    for (yaml_node_item_t *item = list->data.sequence.items.start;
         item < list->data.sequence.items.top; item++) {
        const yaml_node_t *piece = yaml_document_get_node(file, *item),
                          *numbers = entry(file, piece, "coefficients");
        int i = kernel->pieces++, degree = -1;
        if (i >= PIECES || !numbers || numbers->type != YAML_SEQUENCE_NODE ||
            !oracle_rational(text_of(entry(file, piece, "until")), kernel->until[i]))
            return false;
        for (yaml_node_item_t *number = numbers->data.sequence.items.start;
             number < numbers->data.sequence.items.top; number++)
            if (++degree > DEGREE ||
                !oracle_rational(text_of(yaml_document_get_node(file, *number)),
                                 kernel->coefficient[i][degree]))
                return false;
        kernel->degree[i] = degree;
    }
    return kernel->pieces > 0 && mpq_equal(kernel->until[kernel->pieces - 1], kernel->support);
}

static const char *read_kernel(oracle *kernel, yaml_document_t *file)
{
    const yaml_node_t *root = yaml_document_get_root_node(file), *pieces;
    if (!root || root->type != YAML_MAPPING_NODE) return "not a mapping";
    snprintf(kernel->name, sizeof kernel->name, "%s", text_of(entry(file, root, "name")));
    if (!oracle_rational(text_of(entry(file, root, "support")), kernel->support))
        return "no support";
    const char *transform = text_of(entry(file, root, "transform"));
    kernel->transformed = *transform;
    if (*transform && strcmp(transform, "fourth-order") != 0) return "unknown transform";
    const char *family = text_of(entry(file, root, "family"));
    kernel->exponent = atoi(text_of(entry(file, root, "exponent")));
    if ((pieces = entry(file, root, "pieces")) != NULL) {
        kernel->shape = PIECEWISE;
        if (pieces->type != YAML_SEQUENCE_NODE || !read_pieces(kernel, file, pieces))
            return "pieces not understood";
    } else if (strcmp(family, "gaussian") == 0) {
        kernel->shape = GAUSSIAN;
    } else if (strcmp(family, "super-gaussian") == 0) {
        kernel->shape = SUPER_GAUSSIAN;
    } else if (strcmp(family, "double-cosine") == 0) {
        kernel->shape = DOUBLE_COSINE;
    } else if (strcmp(family, "sinc") == 0 && kernel->exponent >= 1 && kernel->exponent <= 12) {
        kernel->shape = SINC;
        oracle_sinc_series(kernel);
    } else {
        return "a family that the oracle does not know";
    }
    return oracle_normalise(kernel) ? NULL : "not normalisable in one dimension";
}

oracle *oracle_load(const char *path, const char **reason)
{
    static const char *unused;
    if (!reason) reason = &unused;
    oracle *kernel = calloc(1, sizeof *kernel);
    FILE *stream = fopen(path, "rb");
    yaml_parser_t parser;
    yaml_document_t file;
    *reason = "cannot be read";
    if (!kernel || !stream || !yaml_parser_initialize(&parser)) {
        if (stream) fclose(stream);
        free(kernel);
        return NULL;
    }
    mpq_inits(kernel->support, kernel->spacing, NULL);
    mpfr_inits2(BITS, kernel->constant, kernel->transform, (mpfr_ptr)NULL);
    for (int k = 0; k < SERIES; k++) mpfr_init2(kernel->series[k], BITS);
    for (int i = 0; i < PIECES; i++) {
        mpq_init(kernel->until[i]);
        for (int k = 0; k <= DEGREE; k++) mpq_init(kernel->coefficient[i][k]);
    }
    yaml_parser_set_input_file(&parser, stream);
    if (yaml_parser_load(&parser, &file)) {
        *reason = read_kernel(kernel, &file);
        yaml_document_delete(&file);
    }
    yaml_parser_delete(&parser);
    fclose(stream);
    if (!*reason) return kernel;
    oracle_free(kernel);
    return NULL;
}

void oracle_free(oracle *kernel)
{
    if (!kernel) return;
    oracle_forget_slopes(kernel);
    mpq_clears(kernel->support, kernel->spacing, NULL);
    mpfr_clears(kernel->constant, kernel->transform, (mpfr_ptr)NULL);
    for (int k = 0; k < SERIES; k++) mpfr_clear(kernel->series[k]);
    for (int i = 0; i < PIECES; i++) {
        mpq_clear(kernel->until[i]);
        for (int k = 0; k <= DEGREE; k++) mpq_clear(kernel->coefficient[i][k]);
    }
    free(kernel);
}

const char *oracle_name(const oracle *kernel)
{
    return kernel->name;
}

void oracle_support(const oracle *kernel, mpq_t support)
{
    mpq_set(support, kernel->support);
}

double oracle_constant(const oracle *kernel)
{
    return mpfr_get_d(kernel->constant, MPFR_RNDN);
}
