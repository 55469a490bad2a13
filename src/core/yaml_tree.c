#include "yaml_tree.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PIPE_PATIENCE = 3000, FILE_LIMIT = 1 << 20 };

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

static sphv_status read_file(sphv_yaml_tree *tree, sphv_error *error)
{
    FILE *file = open_file(tree->path);
    if (!file)
        return sphv_fail(error, SPHV_INVALID_INPUT, "%s: cannot be opened: %s", tree->path,
                         strerror(errno));
    struct stat about;
    if (fstat(fileno(file), &about) == 0 && S_ISDIR(about.st_mode)) {
        fclose(file);
        return sphv_fail(error, SPHV_INVALID_INPUT, "%s: is a folder; allowed: a YAML file",
                         tree->path);
    }
    tree->text = malloc(FILE_LIMIT + 1);
    if (!tree->text) {
        fclose(file);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    tree->size = fread(tree->text, 1, FILE_LIMIT + 1, file);
    int failed = ferror(file);
    fclose(file);
    if (failed) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "%s: cannot be read", tree->path);
    if (tree->size == 0)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%s:1: the file is empty; allowed: a YAML mapping", tree->path);
    if (tree->size > FILE_LIMIT)
        return sphv_fail(error, SPHV_INVALID_INPUT, "%s:1: the file is too large; allowed: 1 MiB",
                         tree->path);
    const unsigned char *zero = memchr(tree->text, 0, tree->size);
    if (zero) {
        unsigned line = 1;
        for (const unsigned char *c = tree->text; c < zero; c++) line += *c == '\n';
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%s:%u: the file holds binary data; allowed: UTF-8 text", tree->path,
                         line);
    }
    return SPHV_OK;
}

static sphv_status not_yaml(const sphv_yaml_tree *tree, const yaml_parser_t *parser,
                            sphv_error *error)
{
    size_t line = parser->problem_mark.line;
    if (parser->error == YAML_READER_ERROR) {
        line = 0;
        for (size_t i = 0; i < parser->problem_offset && i < tree->size; i++)
            line += tree->text[i] == '\n';
    }
    return sphv_fail(
        error, parser->error == YAML_MEMORY_ERROR ? SPHV_RESOURCE_FAILURE : SPHV_INVALID_INPUT,
        "%s:%zu: not YAML: %s; allowed: UTF-8 YAML", tree->path, line + 1,
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
        return ++*depth > SPHV_YAML_DEPTH ? "too deeply nested; allowed: 16 levels" : NULL;
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
static sphv_status scan_events(const sphv_yaml_tree *tree, sphv_error *error)
{
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser))
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    yaml_parser_set_input_string(&parser, tree->text, tree->size);
    sphv_status status = SPHV_OK;
    int depth = 0, documents = 0, ended = 0;
    while (status == SPHV_OK && !ended) {
        yaml_event_t event;
        if (!yaml_parser_parse(&parser, &event)) {
            status = not_yaml(tree, &parser, error);
            break;
        }
        const char *refused = refusal(&event, &depth, &documents);
        if (refused)
            status = sphv_fail(error, SPHV_INVALID_INPUT, "%s:%zu: %s", tree->path,
                               event.start_mark.line + 1, refused);
        ended = event.type == YAML_STREAM_END_EVENT;
        yaml_event_delete(&event);
    }
    yaml_parser_delete(&parser);
    return status;
}

static sphv_status parse_document(sphv_yaml_tree *tree, sphv_error *error)
{
    sphv_status status = scan_events(tree, error);
    if (status != SPHV_OK) return status;
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser))
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    yaml_parser_set_input_string(&parser, tree->text, tree->size);
    tree->has_document = yaml_parser_load(&parser, &tree->document);
    if (!tree->has_document) status = not_yaml(tree, &parser, error);
    yaml_parser_delete(&parser);
    return status;
}

sphv_status sphv_yaml_tree_read(const char *path, sphv_yaml_tree *tree, sphv_error *error)
{
    *tree = (sphv_yaml_tree){.path = strdup(path)};
    if (!tree->path) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    sphv_status status = read_file(tree, error);
    if (status == SPHV_OK) status = parse_document(tree, error);
    if (status == SPHV_OK && !yaml_document_get_root_node(&tree->document))
        status = sphv_fail(error, SPHV_INVALID_INPUT,
                           "%s:1: the file holds no document; allowed: a YAML mapping", tree->path);
    return status;
}

void sphv_yaml_tree_free(sphv_yaml_tree *tree)
{
    if (tree->has_document) yaml_document_delete(&tree->document);
    free(tree->text);
    free(tree->path);
}

unsigned sphv_yaml_node_line(const yaml_node_t *node)
{
    return (unsigned)node->start_mark.line + 1;
}

const yaml_node_t *sphv_yaml_child(sphv_yaml_tree *tree, const yaml_node_t *node, const char *part,
                                   size_t length)
{
    if (node->type == YAML_MAPPING_NODE) {
        for (yaml_node_pair_t *pair = node->data.mapping.pairs.start;
             pair < node->data.mapping.pairs.top; pair++) {
            const yaml_node_t *key = yaml_document_get_node(&tree->document, pair->key);
            if (key->type == YAML_SCALAR_NODE && key->data.scalar.length == length &&
                memcmp(key->data.scalar.value, part, length) == 0)
                return yaml_document_get_node(&tree->document, pair->value);
        }
    } else if (node->type == YAML_SEQUENCE_NODE) {
        long index = strtol(part, NULL, 10);
        if (index < node->data.sequence.items.top - node->data.sequence.items.start)
            return yaml_document_get_node(&tree->document, node->data.sequence.items.start[index]);
    }
    return NULL;
}
