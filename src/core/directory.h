/// \file directory.h
/// Finding data files: by name in the data directory, or by path.
#ifndef SPHVERIFY_CORE_DIRECTORY_H
#define SPHVERIFY_CORE_DIRECTORY_H

#include <stddef.h>

#include "sphverify/status.h"

typedef struct sphv_file_list {
    size_t count;
    char **paths;
} sphv_file_list;

/// Lists the files of data_directory/folder that end in `suffix`, sorted by name.
sphv_status sphv_file_list_read(const char *data_directory, const char *folder, const char *suffix,
                                sphv_file_list *out, sphv_error *error) SPHV_MUST_CHECK;
void sphv_file_list_free(sphv_file_list *list);

/// The path of a data file given by name or, when the text holds a `/` or ends in `suffix`, by
/// path. An unknown name is an error that lists the known ones.
/// \param kind  what the file is, for the message: "kernel", "scene"
/// \param path  receives memory for the caller to free
sphv_status sphv_file_find(const char *data_directory, const char *folder, const char *suffix,
                           const char *kind, const char *name_or_path, char **path,
                           sphv_error *error) SPHV_MUST_CHECK;

/// Whether a text can be a kernel's or scene's name, and so a part of a file name: letters, digits,
/// '-', '_' and '.', not beginning with '.' or '-'.
int sphv_plain_name(const char *name);

#endif
