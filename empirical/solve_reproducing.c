/// Reproducing kernels (eq. 26): moving least squares about the particle, differentiated.
#include "solve_pack.h"

/// −Σ v ∂_k(p_0 s^α): how Σ v p_0 s^α changes with the particle's place.
SPHV_INLINE sphv_bounded moment_slope(const sphv_pack *pack, const int d, sphv_exponents a, int k)
{
    sphv_bounded sum = sphv_moment(pack, d, 1, sphv_times(a, sphv_coordinate(k)));
    int power = sphv_exponent(a, k);
    if (power > 0) {
        sphv_bounded lower = sphv_moment(pack, d, 0, sphv_over(a, k));
        sum = sphv_bounded_add(
            sum, sphv_bounded_multiply(lower, sphv_bounded_exact(sphv_lanes_of(power))));
    }
    return sphv_bounded_scale(sum, -1);
}

SPHV_INLINE sphv_bounded field_slope(const sphv_pack *pack, const int d, size_t f, sphv_exponents a,
                                     int k)
{
    sphv_bounded sum = sphv_field_sum(pack, d, f, 1, sphv_times(a, sphv_coordinate(k)));
    int power = sphv_exponent(a, k);
    if (power > 0) {
        sphv_bounded lower = sphv_field_sum(pack, d, f, 0, sphv_over(a, k));
        sum = sphv_bounded_add(
            sum, sphv_bounded_multiply(lower, sphv_bounded_exact(sphv_lanes_of(power))));
    }
    return sphv_bounded_scale(sum, -1);
}

/// A = c·b with M c = (1, 0, …), M_αβ = Σ v p_0 s^(α+β), b_α = Σ v p_0 s^α δA; with M a = b the
/// derivative is c·∂b − (c·∂M) a.
SPHV_INLINE void reproducing(const sphv_solve_task *task, const int d, size_t at, const int n)
{
    sphv_pack pack;
    sphv_pack_make(&pack, task, at);
    sphv_dense matrix;
    sphv_bounded c[SPHV_UNKNOWNS_MAX], moved[SPHV_DIMENSIONS][SPHV_UNKNOWNS_MAX];
    for (int i = 0; i < n; i++) {
        c[i] = sphv_bounded_exact(sphv_lanes_of(i == 0));
        for (int j = 0; j < n; j++)
            matrix.a[i * n + j] = sphv_moment(
                &pack, d, 0, sphv_times(sphv_low_monomial(d, i), sphv_low_monomial(d, j)));
    }
    sphv_dense_factor(n, &matrix);
    sphv_pack_judge(&pack, &matrix.condition, &matrix.defect);
    sphv_bounded first[SPHV_UNKNOWNS_MAX];
    for (int i = 0; i < n; i++) first[i] = c[i];
    sphv_dense_solve(n, &matrix, first, c);
    for (int k = 0; k < d; k++)
        for (int j = 0; j < n; j++) {
            moved[k][j] = sphv_bounded_exact(sphv_lanes_of(0));
            for (int i = 0; i < n; i++) {
                sphv_exponents a = sphv_times(sphv_low_monomial(d, i), sphv_low_monomial(d, j));
                moved[k][j] = sphv_bounded_add(
                    moved[k][j], sphv_bounded_multiply(c[i], moment_slope(&pack, d, a, k)));
            }
        }
    for (size_t f = 0; f < task->request->field_count; f++) {
        sphv_bounded found[SPHV_QUANTITIES_MAX] = {{{0}, {0}}};
        sphv_bounded right[SPHV_UNKNOWNS_MAX], a[SPHV_UNKNOWNS_MAX];
        for (int i = 0; i < n; i++)
            right[i] = sphv_field_sum(&pack, d, f, 0, sphv_low_monomial(d, i));
        sphv_dense_solve(n, &matrix, right, a);
        found[0] = sphv_bounded_add(sphv_own_value(&pack, f), a[0]);
        for (int k = 0; k < d; k++) {
            sphv_bounded slope = sphv_bounded_exact(sphv_lanes_of(0));
            for (int i = 0; i < n; i++) {
                sphv_bounded change = field_slope(&pack, d, f, sphv_low_monomial(d, i), k);
                slope = sphv_bounded_add(slope, sphv_bounded_multiply(c[i], change));
                slope = sphv_bounded_subtract(slope, sphv_bounded_multiply(moved[k][i], a[i]));
            }
            found[1 + k] = slope;
        }
        sphv_pack_store(&pack, f, found);
    }
    sphv_pack_finish(&pack);
}

void SPHV_SOLVER(rkpm_1)(const sphv_solve_task *task)
{
    SPHV_EACH_PACK(task, reproducing(task, 1, at, 2), reproducing(task, 2, at, 3),
                   reproducing(task, 3, at, 4))
}

void SPHV_SOLVER(rkpm_2)(const sphv_solve_task *task)
{
    SPHV_EACH_PACK(task, reproducing(task, 1, at, 3), reproducing(task, 2, at, 6),
                   reproducing(task, 3, at, 10))
}
