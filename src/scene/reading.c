#include "reading.h"

#include <stdlib.h>
#include <string.h>

#include "core/directory.h"

sphv_status sphv_copy_text(const char *from, char **to, sphv_error *error)
{
    *to = strdup(from ? from : "");
    return *to ? SPHV_OK : sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
}

sphv_status sphv_read_head(const sphv_yaml *yaml, const char *path,
                           const struct sphv_file_head *file, struct sphv_head_texts to,
                           sphv_error *error)
{
    sphv_status status = sphv_copy_text(path, to.path, error);
    if (status == SPHV_OK) status = sphv_copy_text(file->name, to.name, error);
    if (status == SPHV_OK) status = sphv_copy_text(file->title, to.title, error);
    if (status == SPHV_OK) status = sphv_copy_text(file->source, to.source, error);
    if (status == SPHV_OK) status = sphv_copy_text(file->notes, to.notes, error);
    if (status == SPHV_OK && !sphv_plain_name(file->name))
        status = sphv_yaml_fail(yaml, "name", error,
                                "'%s' is not a name; allowed: letters, digits, '-', '_' and '.'",
                                file->name);
    return status;
}

void sphv_free_head(struct sphv_head_texts of)
{
    free(*of.path);
    free(*of.name);
    free(*of.title);
    free(*of.source);
    free(*of.notes);
}

sphv_status sphv_read_claim_texts(const struct sphv_file_stated *file, struct sphv_claim_texts to,
                                  sphv_error *error)
{
    sphv_status status = sphv_copy_text(file->id, to.id, error);
    if (status == SPHV_OK) status = sphv_copy_text(file->statement, to.statement, error);
    if (status == SPHV_OK) status = sphv_copy_text(file->reason, to.reason, error);
    if (status == SPHV_OK && file->refuted)
        status = sphv_copy_text(file->refuted, to.refuted, error);
    return status;
}

void sphv_free_claim_texts(struct sphv_claim_texts of)
{
    free(*of.id);
    free(*of.statement);
    free(*of.reason);
    free(*of.refuted);
}

sphv_status sphv_read_kernel(const sphv_yaml *yaml, const char *place, const char *data_directory,
                             const char *name, sphv_kernel **out, sphv_error *error)
{
    sphv_error reason;
    sphv_status status = sphv_catalogue_find(data_directory, name, out, &reason);
    if (status == SPHV_RESOURCE_FAILURE) return sphv_fail(error, status, "%s", reason.message);
    if (status != SPHV_OK) return sphv_yaml_fail(yaml, place, error, "%s", reason.message);
    return SPHV_OK;
}
