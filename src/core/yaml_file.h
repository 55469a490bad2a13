/// \file yaml_file.h
/// YAML files checked against a libcyaml schema, with errors that name the line.
#ifndef SPHVERIFY_CORE_YAML_FILE_H
#define SPHVERIFY_CORE_YAML_FILE_H

#include <cyaml/cyaml.h>

#include "sphverify/status.h"

/// A loaded file: libcyaml's data, and libyaml's tree for the line numbers.
typedef struct sphv_yaml sphv_yaml;

/// Loads a file against a schema.
/// \param path    file, at most 1 MiB of UTF-8 without aliases or repeated keys
/// \param schema  libcyaml schema of the top-level mapping (a pointer to a struct)
/// \param out     receives the file, to be released with sphv_yaml_free
/// \param error   receives `file:line: what; what is allowed`
sphv_status sphv_yaml_load(const char *path, const cyaml_schema_value_t *schema, sphv_yaml **out,
                           sphv_error *error) SPHV_MUST_CHECK;

/// A kind of file: the value of its top-level key `kind`, NULL for files without that key.
typedef struct sphv_yaml_kind {
    const char *name;
    const cyaml_schema_value_t *schema;
} sphv_yaml_kind;

/// Loads a file of one of several kinds, which its key `kind` tells.
/// \param kinds  ended by a row without a schema; the first is that of files without the key
/// \param which  receives the index of the kind
sphv_status sphv_yaml_load_kind(const char *path, const sphv_yaml_kind *kinds, int *which,
                                sphv_yaml **out, sphv_error *error) SPHV_MUST_CHECK;
void sphv_yaml_free(sphv_yaml *yaml);

/// The struct that libcyaml filled.
void *sphv_yaml_data(const sphv_yaml *yaml);

/// Line (from 1) of a value such as "pieces.1.coefficients.0"; of the deepest part that exists.
unsigned sphv_yaml_line(const sphv_yaml *yaml, const char *place);

/// Records `file:line: message` for a value of the file.
sphv_status sphv_yaml_fail(const sphv_yaml *yaml, const char *place, sphv_error *error,
                           const char *format, ...) SPHV_PRINTF(4, 5);

#endif
