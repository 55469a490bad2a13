#include "command.h"
#include "sphverify/kernel.h"

static int run(const sphv_arguments *arguments)
{
    sphv_error error;
    sphv_catalogue catalogue;
    if (sphv_catalogue_load(arguments->data_directory, &catalogue, &error) != SPHV_OK)
        return sphv_report_failure(arguments, &error);
    json_t *rows = json_array();
    for (size_t i = 0; i < catalogue.count; i++) {
        const sphv_kernel *kernel = catalogue.kernels[i];
        const sphv_profile *profile = NULL;
        json_t *dimensions = json_array();
        for (int d = SPHV_DIMENSIONS; d >= 1; d--)
            if (sphv_kernel_profile(kernel, d)) {
                profile = sphv_kernel_profile(kernel, d);
                json_array_insert_new(dimensions, 0, json_integer(d));
            }
        json_array_append_new(rows, json_pack("{s:s, s:s, s:o, s:i, s:o, s:s}", "name",
                                              sphv_kernel_name(kernel), "title",
                                              sphv_kernel_title(kernel), "support",
                                              sphv_json_number(profile->support), "beta",
                                              profile->boundary_smoothness, "dimensions",
                                              dimensions, "source", sphv_kernel_source(kernel)));
    }
    sphv_print_rows(arguments->format, rows);
    json_decref(rows);
    sphv_catalogue_free(&catalogue);
    return 0;
}

static const sphv_option options[] = {{NULL, 0, NULL, NULL}};

const sphv_command sphv_command_kernels = {
    "kernels",
    "",
    "List the catalogue of kernels",
    "Columns: name, title, support radius in units of h, boundary smoothness beta (found, not\n"
    "declared; -1: the value itself jumps at the edge), legal dimensions, source.\n\n"
    "Example:\n"
    "  sphverify kernels --format csv | cut -d, -f1,4\n",
    0,
    0,
    options,
    run};
