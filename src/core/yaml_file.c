#include "yaml_file.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "yaml_tree.h"

struct sphv_yaml {
    sphv_yaml_tree tree;
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

/// The schema of the kind that the file says it is.
static sphv_status choose_kind(sphv_yaml *yaml, const sphv_yaml_kind *kinds, int *which,
                               sphv_error *error)
{
    const yaml_node_t *root = yaml_document_get_root_node(&yaml->tree.document);
    const yaml_node_t *kind =
        root->type == YAML_MAPPING_NODE ? sphv_yaml_child(&yaml->tree, root, "kind", 4) : NULL;
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
                     yaml->tree.path, sphv_yaml_node_line(kind), allowed);
}

static sphv_status load(sphv_yaml *yaml, const char *path, const sphv_yaml_kind *kinds, int *which,
                        sphv_error *error)
{
    sphv_status status = sphv_yaml_tree_read(path, &yaml->tree, error);
    if (status == SPHV_OK) status = choose_kind(yaml, kinds, which, error);
    if (status == SPHV_OK) status = sphv_yaml_tree_check(&yaml->tree, yaml->schema, error);
    if (status != SPHV_OK) return status;
    char message[256] = "";
    cyaml_config_t config;
    cyaml_settings(&config, message);
    cyaml_err_t outcome =
        cyaml_load_data(yaml->tree.text, yaml->tree.size, &config, yaml->schema, &yaml->data, NULL);
    if (outcome != CYAML_OK)
        return sphv_fail(error,
                         outcome == CYAML_ERR_OOM ? SPHV_RESOURCE_FAILURE : SPHV_INVALID_INPUT,
                         "%s:1: %s; allowed: one YAML document of plain values", yaml->tree.path,
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
    if (!yaml) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    sphv_status status = load(yaml, path, kinds, which, error);
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
    sphv_yaml_tree_free(&yaml->tree);
    free(yaml);
}

void *sphv_yaml_data(const sphv_yaml *yaml)
{
    return yaml->data;
}

unsigned sphv_yaml_line(const sphv_yaml *yaml, const char *place)
{
    sphv_yaml_tree *tree = (sphv_yaml_tree *)&yaml->tree; // libyaml only reads
    const yaml_node_t *node = yaml_document_get_root_node(&tree->document);
    while (node && *place) {
        size_t length = strcspn(place, ".");
        const yaml_node_t *child = sphv_yaml_child(tree, node, place, length);
        if (!child) break;
        node = child;
        place += length + (place[length] == '.');
    }
    return node ? sphv_yaml_node_line(node) : 1;
}

sphv_status sphv_yaml_fail(const sphv_yaml *yaml, const char *place, sphv_error *error,
                           const char *format, ...)
{
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return sphv_fail(error, SPHV_INVALID_INPUT, "%s:%u: %s", yaml->tree.path,
                     sphv_yaml_line(yaml, place), message);
}
