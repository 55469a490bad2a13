/// Scene files: any bytes are refused in one line, or are a scene.
#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sphverify/scene.h"
#include "target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    gsl_set_error_handler_off();
    const char *directory = getenv("SPHVERIFY_DATA");
    sphv_scene *scene = NULL;
    sphv_error error = {SPHV_OK, ""};
    sphv_status status =
        sphv_scene_load(directory ? directory : "data", fuzz_file(data, size), &scene, &error);
    if (status != SPHV_OK) {
        FUZZ_REQUIRE(scene == NULL && error.status == status);
        FUZZ_REQUIRE(error.message[0] != '\0' && !strpbrk(error.message, "\n\r\033"));
        return 0;
    }
    FUZZ_REQUIRE(isfinite(scene->from) && isfinite(scene->to) && scene->curve_count > 0);
    for (size_t i = 0; i < scene->claim_count; i++) {
        FUZZ_REQUIRE(scene->claims[i].curve < scene->curve_count);
        FUZZ_REQUIRE(!scene->claims[i].has_reference ||
                     scene->claims[i].reference < scene->curve_count);
        FUZZ_REQUIRE(isfinite(scene->claims[i].tolerance));
    }
    sphv_scene_free(scene);
    return 0;
}
