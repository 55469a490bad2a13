/// Scene files: any bytes are refused in one line, or are a scene.
#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sphverify/convergence.h"
#include "target.h"

static void check_curves(const sphv_scene *scene)
{
    FUZZ_REQUIRE(isfinite(scene->from) && isfinite(scene->to) && scene->curve_count > 0);
    for (size_t i = 0; i < scene->claim_count; i++) {
        FUZZ_REQUIRE(scene->claims[i].curve < scene->curve_count);
        FUZZ_REQUIRE(!scene->claims[i].has_reference ||
                     scene->claims[i].reference < scene->curve_count);
        FUZZ_REQUIRE(isfinite(scene->claims[i].tolerance));
    }
}

static void check_series(const sphv_convergence *scene, const sphv_series *series)
{
    FUZZ_REQUIRE(series->scheme < scene->scheme_count);
    FUZZ_REQUIRE(series->metric > SPHV_METRIC_STANDARD_DEVIATION ||
                 series->target < scene->target_count);
    FUZZ_REQUIRE(series->count > 0 && series->first + series->count <= scene->level_count);
}

static void check_convergence(const sphv_convergence *scene)
{
    const sphv_rate_table *table = scene->table;
    FUZZ_REQUIRE(scene->level_count > 0 && scene->scheme_count > 0);
    for (size_t s = 0; s < scene->scheme_count; s++)
        for (size_t l = 0; l < scene->level_count; l++) {
            double h = sphv_scheme_h(scene, &scene->schemes[s], l);
            FUZZ_REQUIRE(isfinite(h) && h > 0 && scene->schemes[s].pass <= s);
        }
    for (size_t i = 0; i < scene->claim_count; i++) check_series(scene, &scene->claims[i].series);
    for (size_t i = 0; i < scene->plot_count; i++) check_series(scene, &scene->plots[i].series);
    for (size_t i = 0; table && i < table->row_count * table->column_count; i++)
        for (size_t e = 0; e < table->cells[i].evidence_count; e++)
            check_series(scene, &table->cells[i].evidence[e].series);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    gsl_set_error_handler_off();
    const char *directory = getenv("SPHVERIFY_DATA");
    sphv_any_scene any;
    sphv_error error = {SPHV_OK, ""};
    sphv_status status =
        sphv_any_scene_load(directory ? directory : "data", fuzz_file(data, size), &any, &error);
    if (status != SPHV_OK) {
        FUZZ_REQUIRE(any.scene == NULL && any.convergence == NULL && error.status == status);
        FUZZ_REQUIRE(error.message[0] != '\0' && !strpbrk(error.message, "\n\r\033"));
        return 0;
    }
    if (any.convergence)
        check_convergence(any.convergence);
    else
        check_curves(any.scene);
    sphv_any_scene_free(&any);
    return 0;
}
