/// The batched solver: inverses and condition numbers against GSL's, solutions against systems
/// whose solution is known, and bounds that hold for matrices of every condition.
#include "../../empirical/dense.h"

#include <float.h>
#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>

#include "support.h"

#define U (DBL_EPSILON / 2)

/// One system in every lane.
struct systems {
    sphv_dense matrix;
    sphv_bounded right[SPHV_UNKNOWNS_MAX], found[SPHV_UNKNOWNS_MAX];
    double solution[SPHV_LANES][SPHV_UNKNOWNS_MAX];
};

/// Compiled for each size that the methods use.
static void solve(int n, struct systems *of)
{
    switch (n) {
    case 1:
        sphv_dense_factor(1, &of->matrix);
        sphv_dense_solve(1, &of->matrix, of->right, of->found);
        break;
    case 2:
        sphv_dense_factor(2, &of->matrix);
        sphv_dense_solve(2, &of->matrix, of->right, of->found);
        break;
    case 3:
        sphv_dense_factor(3, &of->matrix);
        sphv_dense_solve(3, &of->matrix, of->right, of->found);
        break;
    default:
        sphv_dense_factor(n, &of->matrix);
        sphv_dense_solve(n, &of->matrix, of->right, of->found);
    }
}

/// Integers, so that right sides are exact. In every other system the last row is the first but for
/// a small difference: the larger the entries, the worse the condition.
/// \param uncertainty of every entry, relative
static void draw(int n, double uncertainty, struct systems *of)
{
    memset(of, 0, sizeof *of);
    for (int l = 0; l < SPHV_LANES; l++) {
        double scale = ldexp(1, (int)random_integer(0, 18));
        bool dependent = random_integer(0, 1);
        for (int i = 0; i < n; i++) of->solution[l][i] = (double)random_integer(-9, 9);
        for (int i = 0; i < n; i++) {
            double right = 0;
            for (int j = 0; j < n; j++) {
                double entry = scale * (double)random_integer(-9, 9);
                if (dependent && i == n - 1 && i > 0)
                    entry = of->matrix.a[j].value[l] + (double)random_integer(-9, 9);
                of->matrix.a[i * n + j].value[l] = entry;
                of->matrix.a[i * n + j].error[l] = uncertainty * fabs(entry);
                right += entry * of->solution[l][j];
            }
            of->right[i].value[l] = right;
            of->right[i].error[l] = 0;
        }
    }
}

/// ‖A‖₁‖A⁻¹‖₁ by GSL; infinite when its LU meets a zero pivot.
static double condition_by_gsl(int n, const struct systems *of, int lane)
{
    size_t size = (size_t)n;
    gsl_matrix *a = gsl_matrix_alloc(size, size), *inverse = gsl_matrix_alloc(size, size);
    gsl_permutation *order = gsl_permutation_alloc(size);
    double norm = 0, inverse_norm = 0;
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j < size; j++)
            gsl_matrix_set(a, i, j, of->matrix.a[i * size + j].value[lane]);
    for (size_t j = 0; j < size; j++) {
        gsl_vector_view column = gsl_matrix_column(a, j);
        norm = fmax(norm, gsl_blas_dasum(&column.vector));
    }
    int sign;
    bool regular =
        gsl_linalg_LU_decomp(a, order, &sign) == 0 && gsl_linalg_LU_invert(a, order, inverse) == 0;
    for (size_t j = 0; regular && j < size; j++) {
        gsl_vector_view column = gsl_matrix_column(inverse, j);
        inverse_norm = fmax(inverse_norm, gsl_blas_dasum(&column.vector));
    }
    gsl_permutation_free(order);
    gsl_matrix_free(inverse);
    gsl_matrix_free(a);
    return regular ? norm * inverse_norm : INFINITY;
}

/// Each solution is within its bound of the exact one, whatever the condition, and the bound is of
/// the order of condition × rounding.
static void test_solutions_and_conditions(void **state)
{
    (void)state;
    random_start("dense systems");
    struct systems of;
    int proven = 0, tight = 0, all = 0;
    for (int round = 0; round < (quick() ? 20 : 400); round++) {
        int n = 1 + round % SPHV_UNKNOWNS_MAX;
        draw(n, 0, &of);
        solve(n, &of);
        for (int l = 0; l < SPHV_LANES; l++, all++) {
            double condition = of.matrix.condition[l], wanted = condition_by_gsl(n, &of, l);
            double defect = of.matrix.defect[l], largest = 0, widest = 0;
            // both inverses err by a multiple of u times the condition, in relation
            double off = 100 * n * n * U * wanted;
            if (off < 0.1)
                assert_close(condition, wanted, off * wanted);
            else
                assert_true(!(condition < 1e-3 / (n * n * U)));
            if (!(defect <= 0.5)) {
                assert_true(!(condition < 1e-4 / (n * n * U)));
                continue;
            }
            // one step of refinement leaves rounding times 1 + ‖I − AX‖, at most 8n³u‖A‖‖A⁻¹‖
            bool small = 8 * n * n * n * U * wanted < 0.1;
            proven += small;
            for (int i = 0; i < n; i++) {
                double error = of.found[i].error[l];
                assert_close(of.found[i].value[l], of.solution[l][i], error);
                widest = fmax(widest, error);
                largest = fmax(largest, fabs(of.solution[l][i]));
            }
            tight += small && widest <= 50 * n * n * U * condition * fmax(largest, 1e-300);
        }
    }
    print_message("%d of %d systems proven regular, bounds tight in %d\n", proven, all, tight);
    assert_true(proven > all / 2 && tight == proven);
}

/// With uncertain entries the solutions of every system within the uncertainty are enclosed.
static void test_uncertain_systems(void **state)
{
    (void)state;
    random_start("uncertain systems");
    struct systems of, moved;
    int enclosed = 0;
    for (int round = 0; round < (quick() ? 20 : 400); round++) {
        int n = 1 + round % SPHV_UNKNOWNS_MAX;
        draw(n, 1e-9, &of);
        solve(n, &of);
        moved = of;
        for (int k = 0; k < n * n; k++)
            for (int l = 0; l < SPHV_LANES; l++)
                moved.matrix.a[k].value[l] +=
                    (1 - 2 * (double)random_integer(0, 1)) * of.matrix.a[k].error[l] * 0.999999;
        solve(n, &moved);
        for (int l = 0; l < SPHV_LANES; l++) {
            if (!(of.matrix.defect[l] < 0.5 && moved.matrix.defect[l] < 0.5)) continue;
            enclosed++;
            for (int i = 0; i < n; i++) {
                // the moved system's own rounding, far below what was moved
                double slack = 100 * n * n * U * moved.matrix.condition[l] * 9;
                assert_close(moved.found[i].value[l], of.found[i].value[l],
                             of.found[i].error[l] + slack);
            }
        }
    }
    assert_true(enclosed > 50);
}

/// Singular to the last bit: no finite condition number, or none that is not beyond 1/ε.
static void test_singular_matrices(void **state)
{
    (void)state;
    random_start("singular matrices");
    struct systems of;
    for (int round = 0; round < 100; round++) {
        int n = 1 + round % SPHV_UNKNOWNS_MAX;
        draw(n, 0, &of);
        int from = (int)random_integer(0, n - 1), to = (int)random_integer(0, n - 1);
        for (int j = 0; j < n; j++)
            of.matrix.a[to * n + j].value =
                n == 1 || from == to ? sphv_lanes_of(0) : of.matrix.a[from * n + j].value;
        solve(n, &of);
        for (int l = 0; l < SPHV_LANES; l++) {
            assert_true(!(of.matrix.condition[l] < 1e-2 / DBL_EPSILON));
            assert_true(!(of.matrix.defect[l] < 1) || !(of.matrix.condition[l] < INFINITY));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solutions_and_conditions),
        cmocka_unit_test(test_uncertain_systems),
        cmocka_unit_test(test_singular_matrices),
    };
    return run_group(tests);
}
