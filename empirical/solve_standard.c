/// Standard SPH and Shepard's normalisation: no matrix, or a single number.
#include "solve_pack.h"

static const sphv_exponents one = {0, 0, 0};

/// Eq. 1 and its difference form: A = Σ A_b W V_b, ∇A = −Σ A_b ∇W V_b or −Σ (A_b − A_a) ∇W V_b.
/// Sums of the level PLAIN are these already.
SPHV_INLINE void standard(const sphv_solve_task *task, const int d, size_t at,
                          const bool difference)
{
    sphv_pack pack;
    sphv_pack_make(&pack, task, at);
    sphv_lanes condition = sphv_lanes_of(1), defect = sphv_lanes_of(0);
    const bool plain = task->block->layout->level == SPHV_SUMS_PLAIN;
    sphv_pack_judge(&pack, &condition, &defect);
    for (size_t f = 0; f < task->request->field_count; f++) {
        sphv_bounded found[SPHV_QUANTITIES_MAX] = {{{0}, {0}}}, own = sphv_own_value(&pack, f);
        found[0] = sphv_field_sum(&pack, d, f, 0, one);
        if (!plain)
            found[0] = sphv_bounded_add(sphv_bounded_multiply(own, sphv_moment(&pack, d, 0, one)),
                                        found[0]);
        SPHV_UNROLL
        for (int i = 0; i < d; i++) {
            sphv_exponents s_i = sphv_coordinate(i);
            sphv_bounded sum = sphv_field_sum(&pack, d, f, 1, s_i);
            if (!difference && !plain)
                sum = sphv_bounded_add(sum,
                                       sphv_bounded_multiply(own, sphv_moment(&pack, d, 1, s_i)));
            found[1 + i] = sphv_bounded_scale(sum, -1);
        }
        sphv_pack_store(&pack, f, found);
    }
    sphv_pack_finish(&pack);
}

/// A = ΣA_b W V_b/ΣW V_b and its derivative, with the field relative to the particle's own value.
SPHV_INLINE void shepard(const sphv_solve_task *task, const int d, size_t at)
{
    sphv_pack pack;
    sphv_pack_make(&pack, task, at);
    sphv_bounded sum = sphv_moment(&pack, d, 0, one), over = sphv_bounded_reciprocal(sum);
    sphv_lanes defect = sum.error * sphv_lanes_abs(over.value);
    sphv_lanes condition = sphv_pack_cancellation(&pack, defect);
    sphv_pack_judge(&pack, &condition, &defect);
    for (size_t f = 0; f < task->request->field_count; f++) {
        sphv_bounded found[SPHV_QUANTITIES_MAX] = {{{0}, {0}}};
        sphv_bounded excess = sphv_bounded_multiply(sphv_field_sum(&pack, d, f, 0, one), over);
        found[0] = sphv_bounded_add(sphv_own_value(&pack, f), excess);
        SPHV_UNROLL
        for (int i = 0; i < d; i++) {
            sphv_exponents s_i = sphv_coordinate(i);
            sphv_bounded moved = sphv_bounded_multiply(excess, sphv_moment(&pack, d, 1, s_i));
            found[1 + i] = sphv_bounded_multiply(
                sphv_bounded_subtract(moved, sphv_field_sum(&pack, d, f, 1, s_i)), over);
        }
        sphv_pack_store(&pack, f, found);
    }
    sphv_pack_finish(&pack);
}

void SPHV_SOLVER(standard)(const sphv_solve_task *task)
{
    SPHV_EACH_PACK(task, standard(task, 1, at, false), standard(task, 2, at, false),
                   standard(task, 3, at, false))
}

void SPHV_SOLVER(difference)(const sphv_solve_task *task)
{
    SPHV_EACH_PACK(task, standard(task, 1, at, true), standard(task, 2, at, true),
                   standard(task, 3, at, true))
}

void SPHV_SOLVER(shepard)(const sphv_solve_task *task)
{
    SPHV_EACH_PACK(task, shepard(task, 1, at), shepard(task, 2, at), shepard(task, 3, at))
}
