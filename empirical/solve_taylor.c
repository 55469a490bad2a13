/// Methods that insert Taylor's series of the field into sums with the kernel's derivatives.
#include "solve_pack.h"

static const sphv_exponents one = {0, 0, 0};

/// Value by Shepard's normalisation, gradient from a d × d matrix: CSPM, whose matrix is that of
/// linear fields, and the mixed correction, whose ∇W̃ differentiates the denominator. With
/// W̃ = W/ΣW V the latter is CSPM with s_j and A_b − A_a in ∇W's sums less their weighted means
/// times Σ∇W V, which is also what elimination of the value leaves of FPM's system: both methods
/// have the same gradient.
SPHV_INLINE void corrected(const sphv_solve_task *task, const int d, size_t at, const bool mixed)
{
    sphv_pack pack;
    sphv_pack_make(&pack, task, at);
    sphv_bounded sum = sphv_moment(&pack, d, 0, one), over = sphv_bounded_reciprocal(sum);
    sphv_bounded slope[SPHV_DIMENSIONS];
    sphv_dense matrix;
    SPHV_UNROLL
    for (int i = 0; i < d; i++) {
        sphv_exponents s_i = sphv_coordinate(i);
        if (mixed) slope[i] = sphv_bounded_multiply(sphv_moment(&pack, d, 1, s_i), over);
        SPHV_UNROLL
        for (int j = 0; j < d; j++) {
            sphv_exponents s_j = sphv_coordinate(j);
            sphv_bounded entry = sphv_moment(&pack, d, 1, sphv_times(s_i, s_j));
            if (mixed)
                entry = sphv_bounded_subtract(
                    entry, sphv_bounded_multiply(slope[i], sphv_moment(&pack, d, 0, s_j)));
            matrix.a[i * d + j] = entry;
        }
    }
    sphv_dense_factor(d, &matrix);
    sphv_lanes defect = sum.error * sphv_lanes_abs(over.value);
    sphv_lanes cancellation = sphv_pack_cancellation(&pack, defect);
    sphv_lanes condition = d == 1 ? sphv_pack_cancellation(&pack, matrix.defect) : matrix.condition;
    condition = sphv_dense_raise(condition, cancellation);
    defect = sphv_dense_raise(defect, matrix.defect);
    sphv_pack_judge(&pack, &condition, &defect);
    for (size_t f = 0; f < task->request->field_count; f++) {
        sphv_bounded found[SPHV_QUANTITIES_MAX] = {{{0}, {0}}}, right[SPHV_DIMENSIONS];
        sphv_bounded excess = sphv_field_sum(&pack, d, f, 0, one);
        SPHV_UNROLL
        for (int i = 0; i < d; i++) {
            right[i] = sphv_field_sum(&pack, d, f, 1, sphv_coordinate(i));
            if (mixed)
                right[i] = sphv_bounded_subtract(right[i], sphv_bounded_multiply(slope[i], excess));
        }
        found[0] = sphv_bounded_add(sphv_own_value(&pack, f), sphv_bounded_multiply(excess, over));
        sphv_dense_solve(d, &matrix, right, found + 1);
        sphv_pack_store(&pack, f, found);
    }
    sphv_pack_finish(&pack);
}

/// Σ v (test) s^α with the test W, ∂_kW or ∂_k∂_lW that the monomial `test` names.
SPHV_INLINE sphv_bounded tested_moment(const sphv_pack *pack, const int d, sphv_exponents test,
                                       sphv_exponents a)
{
    int degree = test.x + test.y + test.z;
    sphv_bounded sum = sphv_moment(pack, d, degree, sphv_times(test, a));
    // ∂_k∂_kW = p_1 + p_2 s_k²
    if (degree == 2 && (test.x | test.y | test.z) == 2)
        sum = sphv_bounded_add(sum, sphv_moment(pack, d, 1, a));
    return sum;
}

SPHV_INLINE sphv_bounded tested_field(const sphv_pack *pack, const int d, size_t field,
                                      sphv_exponents test)
{
    int degree = test.x + test.y + test.z;
    sphv_bounded sum = sphv_field_sum(pack, d, field, degree, test);
    if (degree == 2 && (test.x | test.y | test.z) == 2)
        sum = sphv_bounded_add(sum, sphv_field_sum(pack, d, field, 1, one));
    return sum;
}

/// Taylor's series through the degree of the tests: Σ_β c_β Σ v (test) s^β/β! = Σ v (test) δA, c_β
/// the derivatives times h^|β|, the value's relative to the particle's own.
SPHV_INLINE void taylor(const sphv_solve_task *task, const int d, size_t at, const int n)
{
    sphv_pack pack;
    sphv_pack_make(&pack, task, at);
    sphv_dense matrix;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            sphv_exponents b = sphv_low_monomial(d, j);
            double over_factorial = (b.x | b.y | b.z) == 2 ? 0.5 : 1;
            matrix.a[i * n + j] = sphv_bounded_scale(
                tested_moment(&pack, d, sphv_low_monomial(d, i), b), over_factorial);
        }
    }
    sphv_dense_factor(n, &matrix);
    sphv_pack_judge(&pack, &matrix.condition, &matrix.defect);
    for (size_t f = 0; f < task->request->field_count; f++) {
        sphv_bounded found[SPHV_QUANTITIES_MAX] = {{{0}, {0}}}, right[SPHV_UNKNOWNS_MAX];
        for (int i = 0; i < n; i++) right[i] = tested_field(&pack, d, f, sphv_low_monomial(d, i));
        sphv_dense_solve(n, &matrix, right, found);
        found[0] = sphv_bounded_add(sphv_own_value(&pack, f), found[0]);
        sphv_pack_store(&pack, f, found);
    }
    sphv_pack_finish(&pack);
}

void SPHV_SOLVER(bonet_lok)(const sphv_solve_task *task)
{
    SPHV_EACH_PACK(task, corrected(task, 1, at, true), corrected(task, 2, at, true),
                   corrected(task, 3, at, true))
}

void SPHV_SOLVER(cspm)(const sphv_solve_task *task)
{
    SPHV_EACH_PACK(task, corrected(task, 1, at, false), corrected(task, 2, at, false),
                   corrected(task, 3, at, false))
}

void SPHV_SOLVER(fpm)(const sphv_solve_task *task)
{
    SPHV_EACH_PACK(task, taylor(task, 1, at, 2), taylor(task, 2, at, 3), taylor(task, 3, at, 4))
}

void SPHV_SOLVER(msph)(const sphv_solve_task *task)
{
    SPHV_EACH_PACK(task, taylor(task, 1, at, 3), taylor(task, 2, at, 6), taylor(task, 3, at, 10))
}
