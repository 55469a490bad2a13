#include "directory.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int sphv_plain_name(const char *name)
{
    return strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.") ==
               strlen(name) &&
           name[0] != '.' && name[0] != '-';
}

static int ends_in(const char *text, const char *suffix)
{
    size_t length = strlen(text), tail = strlen(suffix);
    return length > tail && strcmp(text + length - tail, suffix) == 0;
}

static char *join(const char *directory, const char *folder, const char *name, const char *suffix)
{
    size_t size = strlen(directory) + strlen(folder) + strlen(name) + strlen(suffix) + 3;
    char *path = malloc(size);
    if (path) snprintf(path, size, "%s/%s/%s%s", directory, folder, name, suffix);
    return path;
}

/// By name without the ending: `gaussian` before `gaussian-wide`.
static int by_name(const void *a, const void *b)
{
    const char *p = *(char *const *)a, *q = *(char *const *)b;
    size_t i = 0, p_end = (size_t)(strrchr(p, '.') - p), q_end = (size_t)(strrchr(q, '.') - q);
    while (i < p_end && i < q_end && p[i] == q[i]) i++;
    if (i == p_end || i == q_end) return (p_end > q_end) - (p_end < q_end);
    return (unsigned char)p[i] - (unsigned char)q[i];
}

void sphv_file_list_free(sphv_file_list *list)
{
    for (size_t i = 0; i < list->count; i++) free(list->paths[i]);
    free(list->paths);
    *list = (sphv_file_list){0, NULL};
}

static int append(sphv_file_list *list, char *path)
{
    char **larger = realloc(list->paths, (list->count + 1) * sizeof *larger);
    if (larger) list->paths = larger;
    if (!larger || !path) {
        free(path);
        return 0;
    }
    list->paths[list->count++] = path;
    return 1;
}

sphv_status sphv_file_list_read(const char *data_directory, const char *folder, const char *suffix,
                                sphv_file_list *out, sphv_error *error)
{
    *out = (sphv_file_list){0, NULL};
    char *directory = join(data_directory, folder, "", "");
    if (!directory) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    DIR *stream = opendir(directory);
    if (!stream) {
        sphv_status status = sphv_fail(
            error, SPHV_INVALID_INPUT,
            "%s: cannot be read: %s; allowed: a data folder given by --data-dir or SPHVERIFY_DATA",
            directory, strerror(errno));
        free(directory);
        return status;
    }
    sphv_status status = SPHV_OK;
    for (struct dirent *entry; status == SPHV_OK && (entry = readdir(stream));)
        if (ends_in(entry->d_name, suffix) && entry->d_name[0] != '.' &&
            !append(out, join(data_directory, folder, entry->d_name, "")))
            status = sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    closedir(stream);
    free(directory);
    if (status != SPHV_OK)
        sphv_file_list_free(out);
    else if (out->count)
        qsort(out->paths, out->count, sizeof *out->paths, by_name);
    return status;
}

static sphv_status unknown_name(const char *data_directory, const char *folder, const char *suffix,
                                const char *kind, const char *name, sphv_error *error)
{
    sphv_file_list files;
    sphv_status status = sphv_file_list_read(data_directory, folder, suffix, &files, error);
    if (status != SPHV_OK) return status;
    char names[760] = "";
    size_t used = 0;
    for (size_t i = 0; i < files.count && used < sizeof names - 1; i++) {
        const char *base = strrchr(files.paths[i], '/') + 1;
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%.*s", i ? ", " : "",
                                 (int)(strlen(base) - strlen(suffix)), base);
    }
    sphv_file_list_free(&files);
    return sphv_fail(error, SPHV_INVALID_INPUT,
                     "unknown %s '%.60s'; allowed: a path to a %s file, or %s", kind, name, suffix,
                     names);
}

sphv_status sphv_file_find(const char *data_directory, const char *folder, const char *suffix,
                           const char *kind, const char *name_or_path, char **path,
                           sphv_error *error)
{
    int is_path = strchr(name_or_path, '/') || ends_in(name_or_path, suffix);
    *path = is_path ? strdup(name_or_path) : join(data_directory, folder, name_or_path, suffix);
    if (!*path) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    struct stat about;
    if (is_path || stat(*path, &about) == 0) return SPHV_OK;
    free(*path);
    *path = NULL;
    return unknown_name(data_directory, folder, suffix, kind, name_or_path, error);
}
