#include <stdlib.h>

#include "directory.h"
#include "sphverify/kernel.h"

void sphv_catalogue_free(sphv_catalogue *catalogue)
{
    for (size_t i = 0; i < catalogue->count; i++) sphv_kernel_free(catalogue->kernels[i]);
    free(catalogue->kernels);
    *catalogue = (sphv_catalogue){0, NULL};
}

sphv_status sphv_catalogue_load(const char *data_directory, sphv_catalogue *out, sphv_error *error)
{
    *out = (sphv_catalogue){0, NULL};
    sphv_file_list files;
    sphv_status status = sphv_file_list_read(data_directory, "kernels", ".yaml", &files, error);
    if (status != SPHV_OK) return status;
    out->kernels = calloc(files.count + 1, sizeof(sphv_kernel *));
    if (!out->kernels) status = sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    for (size_t i = 0; status == SPHV_OK && i < files.count; i++) {
        status = sphv_kernel_load(files.paths[i], &out->kernels[i], error);
        if (status == SPHV_OK) out->count++;
    }
    sphv_file_list_free(&files);
    if (status != SPHV_OK) sphv_catalogue_free(out);
    return status;
}

sphv_status sphv_catalogue_find(const char *data_directory, const char *name_or_path,
                                sphv_kernel **out, sphv_error *error)
{
    char *path;
    sphv_status status =
        sphv_file_find(data_directory, "kernels", ".yaml", "kernel", name_or_path, &path, error);
    if (status != SPHV_OK) return status;
    status = sphv_kernel_load(path, out, error);
    free(path);
    return status;
}
