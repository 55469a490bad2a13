/// A tree against a libcyaml schema, with the line of what does not fit: libcyaml's own messages
/// have none.
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "yaml_tree.h"

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

static sphv_status check_node(sphv_yaml_tree *of, const yaml_node_t *node,
                              const cyaml_schema_value_t *schema, const char *name, int depth,
                              sphv_error *error);

static sphv_status check_mapping(sphv_yaml_tree *of, const yaml_node_t *node,
                                 const cyaml_schema_value_t *schema, const char *name, int depth,
                                 sphv_error *error)
{
    const cyaml_schema_field_t *fields = schema->mapping.fields;
    char keys[512];
    list_keys(fields, keys, sizeof keys);
    for (yaml_node_pair_t *pair = node->data.mapping.pairs.start;
         pair < node->data.mapping.pairs.top; pair++) {
        const yaml_node_t *key = yaml_document_get_node(&of->document, pair->key);
        const yaml_node_t *value = yaml_document_get_node(&of->document, pair->value);
        const char *text =
            key->type == YAML_SCALAR_NODE ? (const char *)key->data.scalar.value : "(not text)";
        const cyaml_schema_field_t *field = find_field(fields, text);
        if (!field)
            return sphv_fail(error, SPHV_INVALID_INPUT, "%s:%u: unknown key '%.60s'; allowed: %s",
                             of->path, sphv_yaml_node_line(key), text, keys);
        for (yaml_node_pair_t *other = node->data.mapping.pairs.start; other < pair; other++) {
            const yaml_node_t *seen = yaml_document_get_node(&of->document, other->key);
            if (strcmp((const char *)seen->data.scalar.value, text) == 0)
                return sphv_fail(error, SPHV_INVALID_INPUT,
                                 "%s:%u: key '%s' again; allowed: each key once", of->path,
                                 sphv_yaml_node_line(key), text);
        }
        sphv_status status = check_node(of, value, &field->value, text, depth + 1, error);
        if (status != SPHV_OK) return status;
    }
    for (const cyaml_schema_field_t *field = fields; field->key; field++) {
        if (field->value.flags & CYAML_FLAG_OPTIONAL) continue;
        int found = 0;
        for (yaml_node_pair_t *pair = node->data.mapping.pairs.start;
             pair < node->data.mapping.pairs.top; pair++)
            found |= strcmp((const char *)yaml_document_get_node(&of->document, pair->key)
                                ->data.scalar.value,
                            field->key) == 0;
        if (!found)
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "%s:%u: '%s' lacks the key '%s'; allowed: %s", of->path,
                             sphv_yaml_node_line(node), name, field->key, keys);
    }
    return SPHV_OK;
}

static sphv_status check_sequence(sphv_yaml_tree *of, const yaml_node_t *node,
                                  const cyaml_schema_value_t *schema, const char *name, int depth,
                                  sphv_error *error)
{
    long count = node->data.sequence.items.top - node->data.sequence.items.start;
    if (count < schema->sequence.min || count > schema->sequence.max)
        return sphv_fail(
            error, SPHV_INVALID_INPUT, "%s:%u: '%s' has %ld entries; allowed: %u to %u", of->path,
            sphv_yaml_node_line(node), name, count, schema->sequence.min, schema->sequence.max);
    for (yaml_node_item_t *item = node->data.sequence.items.start;
         item < node->data.sequence.items.top; item++) {
        sphv_status status = check_node(of, yaml_document_get_node(&of->document, *item),
                                        schema->sequence.entry, name, depth + 1, error);
        if (status != SPHV_OK) return status;
    }
    return SPHV_OK;
}

static sphv_status check_scalar(sphv_yaml_tree *of, const yaml_node_t *node,
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
                             of->path, sphv_yaml_node_line(node), name, text);
    } else if (schema->type == CYAML_BOOL) {
        if (strcmp(text, "true") != 0 && strcmp(text, "false") != 0)
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "%s:%u: '%s' is '%.40s'; allowed: true, false", of->path,
                             sphv_yaml_node_line(node), name, text);
    } else if (schema->type == CYAML_ENUM) {
        char names[512] = "";
        size_t used = 0;
        for (uint32_t i = 0; i < schema->enumeration.count; i++) {
            if (strcmp(schema->enumeration.strings[i].str, text) == 0) return SPHV_OK;
            used += (size_t)snprintf(names + used, used < sizeof names ? sizeof names - used : 0,
                                     "%s%s", used ? ", " : "", schema->enumeration.strings[i].str);
        }
        return sphv_fail(error, SPHV_INVALID_INPUT, "%s:%u: '%s' is '%.40s'; allowed: %s", of->path,
                         sphv_yaml_node_line(node), name, text, names);
    } else if (strlen(text) < schema->string.min || strlen(text) > schema->string.max) {
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%s:%u: '%s' has %zu characters; allowed: %u to %u", of->path,
                         sphv_yaml_node_line(node), name, strlen(text), schema->string.min,
                         schema->string.max);
    }
    return SPHV_OK;
}

static sphv_status check_node(sphv_yaml_tree *of, const yaml_node_t *node,
                              const cyaml_schema_value_t *schema, const char *name, int depth,
                              sphv_error *error)
{
    yaml_node_type_t wanted = schema->type == CYAML_MAPPING    ? YAML_MAPPING_NODE
                              : schema->type == CYAML_SEQUENCE ? YAML_SEQUENCE_NODE
                                                               : YAML_SCALAR_NODE;
    static const char *const kinds[] = {"nothing", "a single value", "a list", "a mapping"};
    if (depth > SPHV_YAML_DEPTH || node->type != wanted)
        return sphv_fail(error, SPHV_INVALID_INPUT, "%s:%u: '%s' is %s; allowed: %s", of->path,
                         sphv_yaml_node_line(node), name, kinds[node->type], kinds[wanted]);
    switch (schema->type) {
    case CYAML_MAPPING:
        return check_mapping(of, node, schema, name, depth, error);
    case CYAML_SEQUENCE:
        return check_sequence(of, node, schema, name, depth, error);
    default:
        return check_scalar(of, node, schema, name, error);
    }
}

sphv_status sphv_yaml_tree_check(sphv_yaml_tree *tree, const cyaml_schema_value_t *schema,
                                 sphv_error *error)
{
    return check_node(tree, yaml_document_get_root_node(&tree->document), schema, "the file", 0,
                      error);
}
