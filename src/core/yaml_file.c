#include "yaml_file.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <yaml.h>

enum { PIPE_PATIENCE = 3000, FILE_LIMIT = 1 << 20, DEPTH_LIMIT = 16 };

struct sphv_yaml {
    char *path;
    unsigned char *text;
    size_t size;
    yaml_document_t document;
    int has_document;
    const cyaml_schema_value_t *schema;
    void *data;
};

static void keep_first_message(cyaml_log_t level, void *context, const char *format, va_list list)
{
    char *message = context;
    if (level >= CYAML_LOG_ERROR && message[0] == '\0') vsnprintf(message, 256, format, list);
}

static void cyaml_settings(cyaml_config_t *config, char *message)
{
    *config = (cyaml_config_t){.log_fn = keep_first_message,
                               .log_ctx = message,
                               .mem_fn = cyaml_mem,
                               .log_level = CYAML_LOG_ERROR,
                               .flags = CYAML_CFG_NO_ALIAS};
}

/// Opens without waiting for a writer; a pipe must have something to say within some seconds.
static FILE *open_file(const char *path)
{
    struct stat about;
    int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) return NULL;
    if (fstat(descriptor, &about) == 0 && S_ISFIFO(about.st_mode)) {
        struct pollfd pipe = {descriptor, POLLIN, 0};
        if (poll(&pipe, 1, PIPE_PATIENCE) <= 0) {
            close(descriptor);
            errno = ETIMEDOUT;
            return NULL;
        }
    }
    fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) & ~O_NONBLOCK);
    FILE *file = fdopen(descriptor, "rb");
    if (!file) close(descriptor);
    return file;
}

static sphv_status read_file(sphv_yaml *yaml, sphv_error *error)
{
    FILE *file = open_file(yaml->path);
    if (!file)
        return sphv_fail(error, SPHV_INVALID_INPUT, "%s: cannot be opened: %s", yaml->path,
                         strerror(errno));
    struct stat about;
    if (fstat(fileno(file), &about) == 0 && S_ISDIR(about.st_mode)) {
        fclose(file);
        return sphv_fail(error, SPHV_INVALID_INPUT, "%s: is a folder; allowed: a YAML file",
                         yaml->path);
    }
    yaml->text = malloc(FILE_LIMIT + 1);
    if (!yaml->text) {
        fclose(file);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    yaml->size = fread(yaml->text, 1, FILE_LIMIT + 1, file);
    int failed = ferror(file);
    fclose(file);
    if (failed) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "%s: cannot be read", yaml->path);
    if (yaml->size == 0)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%s:1: the file is empty; allowed: a YAML mapping", yaml->path);
    if (yaml->size > FILE_LIMIT)
        return sphv_fail(error, SPHV_INVALID_INPUT, "%s:1: the file is too large; allowed: 1 MiB",
                         yaml->path);
    const unsigned char *zero = memchr(yaml->text, 0, yaml->size);
    if (zero) {
        unsigned line = 1;
        for (const unsigned char *c = yaml->text; c < zero; c++) line += *c == '\n';
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%s:%u: the file holds binary data; allowed: UTF-8 text", yaml->path,
                         line);
    }
    return SPHV_OK;
}

static sphv_status not_yaml(const sphv_yaml *yaml, const yaml_parser_t *parser, sphv_error *error)
{
    size_t line = parser->problem_mark.line;
    if (parser->error == YAML_READER_ERROR) {
        line = 0;
        for (size_t i = 0; i < parser->problem_offset && i < yaml->size; i++)
            line += yaml->text[i] == '\n';
    }
    return sphv_fail(
        error, parser->error == YAML_MEMORY_ERROR ? SPHV_RESOURCE_FAILURE : SPHV_INVALID_INPUT,
        "%s:%zu: not YAML: %s; allowed: UTF-8 YAML", yaml->path, line + 1,
        parser->problem ? parser->problem : "unreadable");
}

/// What an event of the file is refused for, or NULL.
static const char *refusal(const yaml_event_t *event, int *depth, int *documents)
{
    switch (event->type) {
    case YAML_DOCUMENT_START_EVENT:
        return ++*documents > 1 ? "a second document begins; allowed: one" : NULL;
    case YAML_ALIAS_EVENT:
        return "an alias; allowed: plain values";
    case YAML_MAPPING_START_EVENT:
    case YAML_SEQUENCE_START_EVENT:
        return ++*depth > DEPTH_LIMIT ? "too deeply nested; allowed: 16 levels" : NULL;
    case YAML_MAPPING_END_EVENT:
    case YAML_SEQUENCE_END_EVENT:
        --*depth;
        return NULL;
    default:
        return NULL;
    }
}

/// Reads the whole file event by event before a tree is built of it: what would make the tree
/// large or slow (aliases, deep nesting) or be overlooked (a second document) ends it here.
static sphv_status scan_events(const sphv_yaml *yaml, sphv_error *error)
{
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser))
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    yaml_parser_set_input_string(&parser, yaml->text, yaml->size);
    sphv_status status = SPHV_OK;
    int depth = 0, documents = 0, ended = 0;
    while (status == SPHV_OK && !ended) {
        yaml_event_t event;
        if (!yaml_parser_parse(&parser, &event)) {
            status = not_yaml(yaml, &parser, error);
            break;
        }
        const char *refused = refusal(&event, &depth, &documents);
        if (refused)
            status = sphv_fail(error, SPHV_INVALID_INPUT, "%s:%zu: %s", yaml->path,
                               event.start_mark.line + 1, refused);
        ended = event.type == YAML_STREAM_END_EVENT;
        yaml_event_delete(&event);
    }
    yaml_parser_delete(&parser);
    return status;
}

static sphv_status parse_document(sphv_yaml *yaml, sphv_error *error)
{
    sphv_status status = scan_events(yaml, error);
    if (status != SPHV_OK) return status;
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser))
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    yaml_parser_set_input_string(&parser, yaml->text, yaml->size);
    yaml->has_document = yaml_parser_load(&parser, &yaml->document);
    if (!yaml->has_document) status = not_yaml(yaml, &parser, error);
    yaml_parser_delete(&parser);
    return status;
}

static unsigned line_of(const yaml_node_t *node)
{
    return (unsigned)node->start_mark.line + 1;
}

static const cyaml_schema_field_t *find_field(const cyaml_schema_field_t *fields, const char *key)
{
    for (; fields->key; fields++)
        if (strcmp(fields->key, key) == 0) return fields;
    return NULL;
}

static void list_keys(const cyaml_schema_field_t *fields, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (const cyaml_schema_field_t *f = fields; f->key && used < size; f++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "", f->key);
}

static sphv_status check_node(sphv_yaml *yaml, const yaml_node_t *node,
                              const cyaml_schema_value_t *schema, const char *name, int depth,
                              sphv_error *error);

static sphv_status check_mapping(sphv_yaml *yaml, const yaml_node_t *node,
                                 const cyaml_schema_value_t *schema, const char *name, int depth,
                                 sphv_error *error)
{
    const cyaml_schema_field_t *fields = schema->mapping.fields;
    char keys[512];
    list_keys(fields, keys, sizeof keys);
    for (yaml_node_pair_t *pair = node->data.mapping.pairs.start;
         pair < node->data.mapping.pairs.top; pair++) {
        const yaml_node_t *key = yaml_document_get_node(&yaml->document, pair->key);
        const yaml_node_t *value = yaml_document_get_node(&yaml->document, pair->value);
        const char *text =
            key->type == YAML_SCALAR_NODE ? (const char *)key->data.scalar.value : "(not text)";
        const cyaml_schema_field_t *field = find_field(fields, text);
        if (!field)
            return sphv_fail(error, SPHV_INVALID_INPUT, "%s:%u: unknown key '%.60s'; allowed: %s",
                             yaml->path, line_of(key), text, keys);
        for (yaml_node_pair_t *other = node->data.mapping.pairs.start; other < pair; other++) {
            const yaml_node_t *seen = yaml_document_get_node(&yaml->document, other->key);
            if (strcmp((const char *)seen->data.scalar.value, text) == 0)
                return sphv_fail(error, SPHV_INVALID_INPUT,
                                 "%s:%u: key '%s' again; allowed: each key once", yaml->path,
                                 line_of(key), text);
        }
        sphv_status status = check_node(yaml, value, &field->value, text, depth + 1, error);
        if (status != SPHV_OK) return status;
    }
    for (const cyaml_schema_field_t *field = fields; field->key; field++) {
        if (field->value.flags & CYAML_FLAG_OPTIONAL) continue;
        int found = 0;
        for (yaml_node_pair_t *pair = node->data.mapping.pairs.start;
             pair < node->data.mapping.pairs.top; pair++)
            found |= strcmp((const char *)yaml_document_get_node(&yaml->document, pair->key)
                                ->data.scalar.value,
                            field->key) == 0;
        if (!found)
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "%s:%u: '%s' lacks the key '%s'; allowed: %s", yaml->path,
                             line_of(node), name, field->key, keys);
    }
    return SPHV_OK;
}

static sphv_status check_sequence(sphv_yaml *yaml, const yaml_node_t *node,
                                  const cyaml_schema_value_t *schema, const char *name, int depth,
                                  sphv_error *error)
{
    long count = node->data.sequence.items.top - node->data.sequence.items.start;
    if (count < schema->sequence.min || count > schema->sequence.max)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%s:%u: '%s' has %ld entries; allowed: %u to %u", yaml->path,
                         line_of(node), name, count, schema->sequence.min, schema->sequence.max);
    for (yaml_node_item_t *item = node->data.sequence.items.start;
         item < node->data.sequence.items.top; item++) {
        sphv_status status = check_node(yaml, yaml_document_get_node(&yaml->document, *item),
                                        schema->sequence.entry, name, depth + 1, error);
        if (status != SPHV_OK) return status;
    }
    return SPHV_OK;
}

static sphv_status check_scalar(sphv_yaml *yaml, const yaml_node_t *node,
                                const cyaml_schema_value_t *schema, const char *name,
                                sphv_error *error)
{
    const char *text = (const char *)node->data.scalar.value;
    char *end;
    if (schema->type == CYAML_INT || schema->type == CYAML_UINT) {
        errno = 0;
        long value = strtol(text, &end, 10);
        if (end == text || *end || errno || value > 1000000 || value < -1000000 ||
            (schema->type == CYAML_UINT && value < 0))
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "%s:%u: '%s' is '%.40s'; allowed: an integer of up to 1000000",
                             yaml->path, line_of(node), name, text);
    } else if (schema->type == CYAML_BOOL) {
        if (strcmp(text, "true") != 0 && strcmp(text, "false") != 0)
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "%s:%u: '%s' is '%.40s'; allowed: true, false", yaml->path,
                             line_of(node), name, text);
    } else if (schema->type == CYAML_ENUM) {
        char names[512] = "";
        size_t used = 0;
        for (uint32_t i = 0; i < schema->enumeration.count; i++) {
            if (strcmp(schema->enumeration.strings[i].str, text) == 0) return SPHV_OK;
            used += (size_t)snprintf(names + used, used < sizeof names ? sizeof names - used : 0,
                                     "%s%s", used ? ", " : "", schema->enumeration.strings[i].str);
        }
        return sphv_fail(error, SPHV_INVALID_INPUT, "%s:%u: '%s' is '%.40s'; allowed: %s",
                         yaml->path, line_of(node), name, text, names);
    } else if (strlen(text) < schema->string.min || strlen(text) > schema->string.max) {
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%s:%u: '%s' has %zu characters; allowed: %u to %u", yaml->path,
                         line_of(node), name, strlen(text), schema->string.min, schema->string.max);
    }
    return SPHV_OK;
}

static sphv_status check_node(sphv_yaml *yaml, const yaml_node_t *node,
                              const cyaml_schema_value_t *schema, const char *name, int depth,
                              sphv_error *error)
{
    yaml_node_type_t wanted = schema->type == CYAML_MAPPING    ? YAML_MAPPING_NODE
                              : schema->type == CYAML_SEQUENCE ? YAML_SEQUENCE_NODE
                                                               : YAML_SCALAR_NODE;
    static const char *const kinds[] = {"nothing", "a single value", "a list", "a mapping"};
    if (depth > DEPTH_LIMIT || node->type != wanted)
        return sphv_fail(error, SPHV_INVALID_INPUT, "%s:%u: '%s' is %s; allowed: %s", yaml->path,
                         line_of(node), name, kinds[node->type], kinds[wanted]);
    switch (schema->type) {
    case CYAML_MAPPING:
        return check_mapping(yaml, node, schema, name, depth, error);
    case CYAML_SEQUENCE:
        return check_sequence(yaml, node, schema, name, depth, error);
    default:
        return check_scalar(yaml, node, schema, name, error);
    }
}

static const yaml_node_t *child_of(yaml_document_t *document, const yaml_node_t *node,
                                   const char *part, size_t length)
{
    if (node->type == YAML_MAPPING_NODE) {
        for (yaml_node_pair_t *pair = node->data.mapping.pairs.start;
             pair < node->data.mapping.pairs.top; pair++) {
            const yaml_node_t *key = yaml_document_get_node(document, pair->key);
            if (key->type == YAML_SCALAR_NODE && key->data.scalar.length == length &&
                memcmp(key->data.scalar.value, part, length) == 0)
                return yaml_document_get_node(document, pair->value);
        }
    } else if (node->type == YAML_SEQUENCE_NODE) {
        long index = strtol(part, NULL, 10);
        if (index < node->data.sequence.items.top - node->data.sequence.items.start)
            return yaml_document_get_node(document, node->data.sequence.items.start[index]);
    }
    return NULL;
}

/// The schema of the kind that the file says it is.
static sphv_status choose_kind(sphv_yaml *yaml, const sphv_yaml_kind *kinds, int *which,
                               sphv_error *error)
{
    const yaml_node_t *root = yaml_document_get_root_node(&yaml->document);
    const yaml_node_t *kind =
        root->type == YAML_MAPPING_NODE ? child_of(&yaml->document, root, "kind", 4) : NULL;
    char allowed[200] = "";
    size_t used = 0;
    *which = 0;
    yaml->schema = kinds[0].schema;
    if (!kind || !kinds[1].schema) return SPHV_OK;
    for (int i = 1; kinds[i].schema; i++) {
        if (kind->type == YAML_SCALAR_NODE &&
            strcmp((const char *)kind->data.scalar.value, kinds[i].name) == 0) {
            *which = i;
            yaml->schema = kinds[i].schema;
            return SPHV_OK;
        }
        if (used < sizeof allowed)
            used += (size_t)snprintf(allowed + used, sizeof allowed - used, "%s, ", kinds[i].name);
    }
    return sphv_fail(error, SPHV_INVALID_INPUT, "%s:%u: unknown kind; allowed: %sor none",
                     yaml->path, line_of(kind), allowed);
}

static sphv_status load(sphv_yaml *yaml, const sphv_yaml_kind *kinds, int *which, sphv_error *error)
{
    sphv_status status = read_file(yaml, error);
    if (status == SPHV_OK) status = parse_document(yaml, error);
    if (status != SPHV_OK) return status;
    const yaml_node_t *root = yaml_document_get_root_node(&yaml->document);
    if (!root)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%s:1: the file holds no document; allowed: a YAML mapping", yaml->path);
    status = choose_kind(yaml, kinds, which, error);
    if (status == SPHV_OK) status = check_node(yaml, root, yaml->schema, "the file", 0, error);
    if (status != SPHV_OK) return status;
    char message[256] = "";
    cyaml_config_t config;
    cyaml_settings(&config, message);
    cyaml_err_t outcome =
        cyaml_load_data(yaml->text, yaml->size, &config, yaml->schema, &yaml->data, NULL);
    if (outcome != CYAML_OK)
        return sphv_fail(error,
                         outcome == CYAML_ERR_OOM ? SPHV_RESOURCE_FAILURE : SPHV_INVALID_INPUT,
                         "%s:1: %s; allowed: one YAML document of plain values", yaml->path,
                         message[0] ? message : cyaml_strerror(outcome));
    return SPHV_OK;
}

sphv_status sphv_yaml_load(const char *path, const cyaml_schema_value_t *schema, sphv_yaml **out,
                           sphv_error *error)
{
    const sphv_yaml_kind only[] = {{NULL, schema}, {NULL, NULL}};
    int which;
    return sphv_yaml_load_kind(path, only, &which, out, error);
}

sphv_status sphv_yaml_load_kind(const char *path, const sphv_yaml_kind *kinds, int *which,
                                sphv_yaml **out, sphv_error *error)
{
    sphv_yaml *yaml = calloc(1, sizeof *yaml);
    if (yaml) yaml->path = strdup(path);
    if (!yaml || !yaml->path) {
        free(yaml);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    sphv_status status = load(yaml, kinds, which, error);
    if (status == SPHV_OK)
        *out = yaml;
    else
        sphv_yaml_free(yaml);
    return status;
}

void sphv_yaml_free(sphv_yaml *yaml)
{
    if (!yaml) return;
    if (yaml->data) {
        char message[256] = "";
        cyaml_config_t config;
        cyaml_settings(&config, message);
        cyaml_free(&config, yaml->schema, yaml->data, 0);
    }
    if (yaml->has_document) yaml_document_delete(&yaml->document);
    free(yaml->text);
    free(yaml->path);
    free(yaml);
}

void *sphv_yaml_data(const sphv_yaml *yaml)
{
    return yaml->data;
}

unsigned sphv_yaml_line(const sphv_yaml *yaml, const char *place)
{
    yaml_document_t *document = (yaml_document_t *)&yaml->document;
    const yaml_node_t *node = yaml_document_get_root_node(document);
    while (node && *place) {
        size_t length = strcspn(place, ".");
        const yaml_node_t *child = child_of(document, node, place, length);
        if (!child) break;
        node = child;
        place += length + (place[length] == '.');
    }
    return node ? line_of(node) : 1;
}

sphv_status sphv_yaml_fail(const sphv_yaml *yaml, const char *place, sphv_error *error,
                           const char *format, ...)
{
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return sphv_fail(error, SPHV_INVALID_INPUT, "%s:%u: %s", yaml->path,
                     sphv_yaml_line(yaml, place), message);
}
