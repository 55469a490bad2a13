#include <math.h>
#include <stdlib.h>

#include "estimate.h"
#include "internal.h"

sphv_status sphv_observe(const sphv_experiment *experiment, int realisation, long index,
                         sphv_observation *out, sphv_error *error)
{
    sphv_cloud cloud;
    sphv_neighbourhood around = {0};
    *out = (sphv_observation){.error = {NAN, NAN}};
    sphv_status status = sphv_cloud_make(&cloud, experiment, realisation, error);
    if (status != SPHV_OK) return status;
    if (cloud.x && (index < 0 || index >= cloud.particles))
        status = sphv_fail(error, SPHV_INVALID_INPUT, "no particle %ld; allowed: 0 to %ld", index,
                           cloud.particles - 1);
    if (status == SPHV_OK) {
        status = sphv_cloud_neighbourhood(&cloud, index, &around);
        double *field = status == SPHV_OK ? malloc((size_t)around.count * 5 * sizeof *field) : NULL;
        if (!field) {
            status = sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
        } else {
            double *s = field + 2 * around.count, *centroid = s + around.count;
            double *volume = centroid + around.count;
            for (int b = 0; b < around.count; b++) {
                s[b] = around.s[b];
                centroid[b] = around.centroid[b];
                volume[b] = around.volume[b];
            }
            sphv_estimate estimate = sphv_phase_errors(experiment, &around, field, out->error);
            if (!estimate.usable) out->error[0] = out->error[1] = NAN;
            out->cells = (sphv_cells){around.count, around.self, s, centroid, volume};
            out->memory = field;
        }
    }
    sphv_neighbourhood_free(&around);
    sphv_cloud_free(&cloud);
    return status;
}

void sphv_observation_free(sphv_observation *observation)
{
    free(observation->memory);
    *observation = (sphv_observation){.memory = NULL};
}
