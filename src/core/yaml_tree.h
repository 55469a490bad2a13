/// \file yaml_tree.h
/// A YAML file as libyaml's tree, read within limits that keep any bytes from doing harm.
#ifndef SPHVERIFY_CORE_YAML_TREE_H
#define SPHVERIFY_CORE_YAML_TREE_H

#include <cyaml/cyaml.h>
#include <yaml.h>

#include "sphverify/status.h"

enum { SPHV_YAML_DEPTH = 16 }; ///< of nested lists and mappings, at most

typedef struct sphv_yaml_tree {
    char *path;
    unsigned char *text;
    size_t size;
    yaml_document_t document;
    int has_document;
} sphv_yaml_tree;

/// Reads a file: at most 1 MiB of UTF-8 without binary zeros, aliases or a second document.
/// \param tree  to be released with sphv_yaml_tree_free, whatever the status
sphv_status sphv_yaml_tree_read(const char *path, sphv_yaml_tree *tree,
                                sphv_error *error) SPHV_MUST_CHECK;
void sphv_yaml_tree_free(sphv_yaml_tree *tree);

/// Checks the whole tree against a schema: keys, kinds of values, numbers of entries and
/// characters.
sphv_status sphv_yaml_tree_check(sphv_yaml_tree *tree, const cyaml_schema_value_t *schema,
                                 sphv_error *error) SPHV_MUST_CHECK;

/// Line of a node, from 1.
unsigned sphv_yaml_node_line(const yaml_node_t *node);

/// The value of a key of a mapping, or the entry of a list whose number `part` begins with; NULL
/// where there is none.
const yaml_node_t *sphv_yaml_child(sphv_yaml_tree *tree, const yaml_node_t *node, const char *part,
                                   size_t length);

#endif
