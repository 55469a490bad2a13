/// \file solve_pack.h
/// What becomes of a pack's solution: faults, estimates and their bounds.
#ifndef SPHVERIFY_EMPIRICAL_SOLVE_PACK_H
#define SPHVERIFY_EMPIRICAL_SOLVE_PACK_H

#include <limits.h>

#include "solve.h"

/// Whether the pack is full, and all its particles have estimates beyond doubt.
SPHV_INLINE bool sphv_pack_all_sound(const sphv_pack *pack, sphv_lane_mask fine)
{
    size_t fewest = pack->task->least < 2 ? 2 : pack->task->least;
    unsigned least = UINT_MAX;
    if (pack->have < SPHV_LANES || sphv_lanes_any(~fine)) return false;
    for (int l = 0; l < SPHV_LANES; l++) {
        unsigned neighbours = pack->block->neighbours[pack->at + (size_t)l];
        least = neighbours < least ? neighbours : least;
    }
    return least >= fewest;
}

SPHV_INLINE sphv_fault sphv_pack_fault_of(unsigned neighbours, size_t least, bool fine, bool finite)
{
    if (neighbours <= 1) return SPHV_FAULT_ISOLATED;
    if (neighbours < least) return SPHV_FAULT_TOO_FEW;
    if (fine) return SPHV_FAULT_NONE;
    return finite ? SPHV_FAULT_ILL_CONDITIONED : SPHV_FAULT_SINGULAR;
}

/// Finds the faults of a pack from the condition number and the defect of its moment matrix.
SPHV_INLINE void sphv_pack_judge(sphv_pack *pack, const sphv_lanes *condition,
                                 const sphv_lanes *defect)
{
    static const double most = 0x1p26; // 1/√ε
    sphv_lane_mask fine = (*condition <= most) & (*defect < 0.5), finite = *condition < INFINITY;
    sphv_lanes known = sphv_lanes_choose(finite, *condition, sphv_lanes_of(INFINITY));
    const size_t *particle = pack->block->particle + pack->at;
    double *to = pack->task->out->condition;
    for (size_t l = 0; l < pack->have; l++) to[particle[l]] = known[l];
    pack->all = sphv_pack_all_sound(pack, fine);
    pack->kept = pack->sound = ~(sphv_lane_mask){0};
    memset(pack->fault, SPHV_FAULT_NONE, sizeof pack->fault);
    if (pack->all) return;
    for (size_t l = 0; l < pack->have; l++) {
        sphv_fault fault = sphv_pack_fault_of(pack->block->neighbours[pack->at + l],
                                              pack->task->least, fine[l], finite[l]);
        bool kept = fault == SPHV_FAULT_NONE || fault == SPHV_FAULT_ILL_CONDITIONED ||
                    (fault == SPHV_FAULT_ISOLATED && pack->task->least == 1 && fine[l]);
        pack->fault[l] = (unsigned char)fault;
        pack->kept[l] = -(long long)kept;
        pack->sound[l] = -(long long)(fault == SPHV_FAULT_NONE);
    }
}

/// Marks estimates that overflow, clears those that are not kept, and raises the largest bounds to
/// those of the sound lanes.
static __attribute__((noinline)) void sphv_pack_settle(sphv_pack *pack, size_t quantities,
                                                       sphv_lanes *value, const sphv_lanes *bound,
                                                       double *rounding)
{
    for (size_t i = 0; i < quantities; i++)
        for (size_t l = 0; l < pack->have; l++) {
            bool finite = isfinite(value[i][l]);
            if (pack->kept[l] && !finite) pack->fault[l] = SPHV_FAULT_NOT_FINITE;
            if (!pack->kept[l] || !finite) value[i][l] = 0;
            if (pack->sound[l] && finite && !(bound[i][l] <= rounding[i]))
                rounding[i] = bound[i][l];
        }
}

/// Writes the estimates of one field, found in units of h.
SPHV_INLINE void sphv_pack_store(sphv_pack *pack, size_t field, const sphv_bounded *found)
{
    const sphv_solve_task *task = pack->task;
    size_t quantities = task->out->quantities, d = (size_t)pack->block->layout->dimension;
    double **estimate = task->out->estimate + field * quantities;
    double *rounding = task->out->rounding + field * quantities;
    const size_t *particle = pack->block->particle + pack->at;
    sphv_lanes value[SPHV_QUANTITIES_MAX], bound[SPHV_QUANTITIES_MAX];
    sphv_lane_mask plain = ~(sphv_lane_mask){0}; // finite, and no larger bounds than before
    for (size_t i = 0; i < quantities; i++) {
        double scale = task->scale[i == 0 ? 0 : i <= d ? 1 : 2];
        value[i] = found[i].value * scale;
        bound[i] =
            (found[i].error * scale + 4 * SPHV_U * sphv_lanes_abs(value[i])) * SPHV_BOUND_SLACK;
        plain &= sphv_lanes_finite(value[i]) & (bound[i] <= rounding[i]);
    }
    if (!pack->all || sphv_lanes_any(~plain))
        sphv_pack_settle(pack, quantities, value, bound, rounding);
    for (size_t i = 0; i < quantities; i++)
        for (size_t l = 0; l < pack->have; l++) estimate[i][particle[l]] = value[i][l];
}

/// Writes the faults, once all fields are stored.
SPHV_INLINE void sphv_pack_finish(const sphv_pack *pack)
{
    for (size_t l = 0; l < pack->have; l++)
        pack->task->out->fault[pack->block->particle[pack->at + l]] = pack->fault[l];
}

#endif
