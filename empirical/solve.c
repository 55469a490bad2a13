#include "solve.h"

const sphv_name_row sphv_faults[] = {
    {"none", "sound"},
    {"isolated", "no neighbour within the support"},
    {"too-few", "fewer particles within the support than the method needs"},
    {"singular", "the moment matrix has no finite condition number"},
    {"ill-conditioned", "condition number of the moment matrix above 1/sqrt(epsilon) = 6.7e7"},
    {"not-finite", "the estimate overflows"},
    {NULL, NULL},
};

SPHV_CLONES void sphv_pack_judge(sphv_pack *pack, const sphv_lanes *condition,
                                 const sphv_lanes *defect)
{
    static const double most = 0x1p26; // 1/√ε
    sphv_lane_mask fine = (*condition <= most) & (*defect < 0.5), finite = *condition < INFINITY;
    size_t least = pack->task->least;
    sphv_lanes known = sphv_lanes_choose(finite, *condition, sphv_lanes_of(INFINITY));
    for (size_t l = 0; l < pack->have; l++) {
        unsigned neighbours = pack->block->neighbours[pack->at + l];
        sphv_fault fault = SPHV_FAULT_NONE;
        bool kept = true;
        if (neighbours <= 1 || neighbours < least) {
            fault = neighbours <= 1 ? SPHV_FAULT_ISOLATED : SPHV_FAULT_TOO_FEW;
            kept = least == 1 && fine[l];
        } else if (!fine[l]) {
            fault = finite[l] ? SPHV_FAULT_ILL_CONDITIONED : SPHV_FAULT_SINGULAR;
            kept = finite[l];
        }
        pack->fault[l] = (unsigned char)fault;
        pack->kept[l] = -(long long)kept;
        pack->sound[l] = -(long long)(fault == SPHV_FAULT_NONE);
        pack->task->out->condition[pack->block->particle[pack->at + l]] = known[l];
    }
}

SPHV_CLONES void sphv_pack_store(sphv_pack *pack, size_t field, const sphv_bounded *found)
{
    const sphv_solve_task *task = pack->task;
    size_t quantities = task->out->quantities, d = (size_t)pack->block->layout->dimension;
    double **estimate = task->out->estimate + field * quantities;
    double *rounding = task->out->rounding + field * quantities;
    const size_t *particle = pack->block->particle + pack->at;
    for (size_t i = 0; i < quantities; i++) {
        double scale = task->scale[i == 0 ? 0 : i <= d ? 1 : 2];
        sphv_lanes value = found[i].value * scale;
        sphv_lanes bound =
            (found[i].error * scale + 4 * SPHV_U * sphv_lanes_abs(value)) * SPHV_BOUND_SLACK;
        sphv_lane_mask finite = sphv_lanes_finite(value);
        for (size_t l = 0; l < pack->have; l++) {
            estimate[i][particle[l]] = pack->kept[l] & finite[l] ? value[l] : 0;
            if (pack->kept[l] & ~finite[l]) pack->fault[l] = SPHV_FAULT_NOT_FINITE;
            if (pack->sound[l] & finite[l] && !(bound[l] <= rounding[i])) rounding[i] = bound[l];
        }
    }
}

void sphv_pack_finish(const sphv_pack *pack)
{
    for (size_t l = 0; l < pack->have; l++)
        pack->task->out->fault[pack->block->particle[pack->at + l]] = pack->fault[l];
}

void sphv_solve_block(const sphv_sum_block *block, const sphv_request *request,
                      const double *values, sphv_method_estimates *out)
{
    sphv_solve_task task = {.block = block,
                            .request = request,
                            .values = values,
                            .out = out,
                            .least = sphv_method_least(out->method, block->layout->dimension),
                            .scale = {1, 1 / request->h, 1 / request->h / request->h}};
    task.reach[0] = 1;
    for (int i = 1; i <= SPHV_SUM_DEGREE_MAX; i++)
        task.reach[i] = task.reach[i - 1] * request->profile->support;
    switch (out->method) {
    case SPHV_SPH:
        sphv_solve_standard(&task);
        break;
    case SPHV_SPH_DIFFERENCE:
        sphv_solve_difference(&task);
        break;
    case SPHV_SHEPARD:
    case SPHV_RKPM_0:
        sphv_solve_shepard(&task);
        break;
    case SPHV_BONET_LOK:
        sphv_solve_bonet_lok(&task);
        break;
    case SPHV_CSPM:
        sphv_solve_cspm(&task);
        break;
    case SPHV_FPM:
        sphv_solve_fpm(&task);
        break;
    case SPHV_MSPH:
        sphv_solve_msph(&task);
        break;
    case SPHV_RKPM:
        sphv_solve_rkpm_1(&task);
        break;
    case SPHV_RKPM_2:
        sphv_solve_rkpm_2(&task);
        break;
    }
}
