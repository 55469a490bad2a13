#include <gsl/gsl_linalg.h>
#include <gsl/gsl_math.h>
#include <string.h>

#include "boundary_internal.h"

// Every method is linear in the field: its estimate is a sum over neighbours with a shape function
// Σ weight p_k s^α, whose coefficients follow from the moments of the support as it is cut.

enum { N = SPHV_QUANTITIES_MAX };

static size_t unit(int dimension, int i)
{
    int power[SPHV_DIMENSIONS] = {0};
    power[i] = 1;
    return sphv_monomial_index(dimension, power);
}

/// Place of the product of two monomials, and of a monomial times s_i.
static size_t product(int dimension, size_t a, size_t b)
{
    const sphv_monomial *table = sphv_monomials(dimension);
    int power[SPHV_DIMENSIONS];
    for (int i = 0; i < SPHV_DIMENSIONS; i++) power[i] = table[a].power[i] + table[b].power[i];
    return sphv_monomial_index(dimension, power);
}

/// Inverts a matrix; returns its 1-norm condition number, ∞ when it is singular.
static double invert(size_t n, const double matrix[N][N], double inverse[N][N])
{
    double lu_data[N * N] = {0}, inverse_data[N * N] = {0}, norm = 0, inverse_norm = 0;
    size_t order[N] = {0};
    int sign;
    gsl_matrix_view lu = gsl_matrix_view_array(lu_data, n, n);
    gsl_matrix_view result = gsl_matrix_view_array(inverse_data, n, n);
    gsl_permutation permutation = {n, order};
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) gsl_matrix_set(&lu.matrix, i, j, matrix[i][j]);
    if (gsl_linalg_LU_decomp(&lu.matrix, &permutation, &sign) ||
        gsl_linalg_LU_invert(&lu.matrix, &permutation, &result.matrix))
        return INFINITY;
    for (size_t j = 0; j < n; j++) {
        double column = 0, inverse_column = 0;
        for (size_t i = 0; i < n; i++) {
            inverse[i][j] = gsl_matrix_get(&result.matrix, i, j);
            column += fabs(matrix[i][j]);
            inverse_column += fabs(inverse[i][j]);
        }
        norm = fmax(norm, column);
        inverse_norm = fmax(inverse_norm, inverse_column);
    }
    double condition = norm * inverse_norm;
    return isfinite(condition) ? condition : INFINITY;
}

int sphv_shape_degree(sphv_method method)
{
    switch (method) {
    case SPHV_RKPM:
    case SPHV_MSPH:
        return 2;
    case SPHV_RKPM_2:
        return 3;
    default:
        return 1;
    }
}

int sphv_shape_exactness(sphv_method method, int degree_of_quantity)
{
    if (method == SPHV_SPH_DIFFERENCE) return degree_of_quantity == 0 ? -1 : 0;
    const sphv_method_row *row = &sphv_methods[method];
    return degree_of_quantity == 0 ? row->value_consistency : row->consistency;
}

static void shepard(int d, const double *const moment[SPHV_RADIALS], sphv_shape *out)
{
    double sum = moment[0][0];
    out->weight[0][0][0] = 1 / sum;
    for (int i = 0; i < d; i++) {
        size_t e = unit(d, i);
        out->weight[1 + i][1][e] = -1 / sum;
        out->weight[1 + i][0][0] = moment[1][e] / (sum * sum);
    }
    out->condition = sum == 0 ? INFINITY : 1;
}

static void standard(int d, sphv_shape *out)
{
    out->weight[0][0][0] = 1;
    for (int i = 0; i < d; i++) out->weight[1 + i][1][unit(d, i)] = -1;
    out->condition = 1;
}

/// What a shape function gives for the field s^α.
static double response(const sphv_shape *shape, int quantity,
                       const double *const moment[SPHV_RADIALS], size_t alpha)
{
    double sum = alpha == 0 ? -shape->self[quantity] : 0;
    for (int k = 0; k < SPHV_RADIALS; k++)
        for (size_t m = 0; m < SPHV_SHAPE_TERMS; m++)
            if (shape->weight[quantity][k][m] != 0)
                sum +=
                    shape->weight[quantity][k][m] * moment[k][product(shape->dimension, m, alpha)];
    return sum;
}

/// Replaces the gradient's shape functions by those combinations that are right for the field s.
static void correct_gradient(int d, const double *const moment[SPHV_RADIALS], sphv_shape *out)
{
    double matrix[N][N] = {{0}}, inverse[N][N] = {{0}};
    sphv_shape old = *out;
    for (int i = 0; i < d; i++)
        for (int j = 0; j < d; j++) matrix[i][j] = response(&old, 1 + i, moment, unit(d, j));
    out->condition = invert((size_t)d, (const double(*)[N])matrix, inverse);
    if (!isfinite(out->condition)) return;
    for (int i = 0; i < d; i++) {
        memset(out->weight[1 + i], 0, sizeof out->weight[1 + i]);
        out->self[1 + i] = 0;
        for (int j = 0; j < d; j++) {
            for (int k = 0; k < SPHV_RADIALS; k++)
                for (size_t m = 0; m < SPHV_SHAPE_TERMS; m++)
                    out->weight[1 + i][k][m] += inverse[i][j] * old.weight[1 + j][k][m];
            out->self[1 + i] += inverse[i][j] * old.self[1 + j];
        }
    }
}

/// Takes out of every gradient what it makes of a constant: that of the field A_b − A_a.
static void use_differences(int d, const double *const moment[SPHV_RADIALS], sphv_shape *out)
{
    for (int i = 0; i < d; i++) out->self[1 + i] = response(out, 1 + i, moment, 0);
}

/// Unknowns h^|β| ∂^βA from the test functions p_0, ∂p_0 and, for msph, ∂∂p_0.
static void collocate(int d, int order, const double *const moment[SPHV_RADIALS], sphv_shape *out)
{
    const sphv_monomial *table = sphv_monomials(d);
    size_t n = sphv_monomial_count(d, order);
    sphv_shape tests = {.dimension = d};
    double matrix[N][N] = {{0}}, inverse[N][N] = {{0}};
    for (size_t j = 0; j < n; j++) {
        int first = 0, second = d;
        while (first < d && !table[j].power[first]) first++;
        for (int i = d; i-- > 0 && second == d;)
            if (table[j].power[i]) second = i;
        if (table[j].degree == 0) {
            tests.weight[j][0][0] = 1;
        } else if (table[j].degree == 1) {
            tests.weight[j][1][j] = 1;
        } else {
            tests.weight[j][2][j] = 1;
            if (first == second) tests.weight[j][1][0] = 1;
        }
        for (size_t k = 0; k < n; k++)
            matrix[j][k] = response(&tests, (int)j, moment, k) / table[k].factorial;
    }
    out->condition = invert(n, (const double(*)[N])matrix, inverse);
    if (!isfinite(out->condition)) return;
    for (size_t q = 0; q < n; q++)
        for (size_t j = 0; j < n; j++)
            for (int k = 0; k < SPHV_RADIALS; k++)
                for (size_t m = 0; m < SPHV_SHAPE_TERMS; m++)
                    out->weight[q][k][m] += inverse[q][j] * tests.weight[j][k][m];
}

/// Eq. 26 of Quinlan in general order: P(0)ᵀ M⁻¹ Σ p_0 P A, and its derivative with M and the sum
/// differentiated. h∂_i of a function of s is −∂/∂s_i.
static void reproduce(int d, int order, const double *const moment[SPHV_RADIALS], sphv_shape *out)
{
    const sphv_monomial *table = sphv_monomials(d);
    size_t n = sphv_monomial_count(d, order);
    double matrix[N][N] = {{0}}, inverse[N][N] = {{0}};
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < n; b++) matrix[a][b] = moment[0][product(d, a, b)];
    out->condition = invert(n, (const double(*)[N])matrix, inverse);
    if (!isfinite(out->condition)) return;
    for (size_t a = 0; a < n; a++) out->weight[0][0][a] = inverse[a][0];
    for (int i = 0; i < d; i++) {
        size_t e = unit(d, i);
        double right[N] = {0};
        for (size_t a = 0; a < n; a++)
            for (size_t b = 0; b < n; b++) {
                size_t both = product(d, a, b);
                double slope = moment[1][product(d, both, e)];
                int times = table[both].power[i];
                int power[SPHV_DIMENSIONS];
                memcpy(power, table[both].power, sizeof power);
                power[i]--;
                if (times > 0) slope += times * moment[0][sphv_monomial_index(d, power)];
                right[a] += slope * inverse[b][0];
            }
        for (size_t a = 0; a < n; a++) {
            int power[SPHV_DIMENSIONS];
            memcpy(power, table[a].power, sizeof power);
            power[i]--;
            out->weight[1 + i][1][product(d, a, e)] -= inverse[a][0];
            if (power[i] >= 0)
                out->weight[1 + i][0][sphv_monomial_index(d, power)] -=
                    table[a].power[i] * inverse[a][0];
            for (size_t b = 0; b < n; b++) out->weight[1 + i][0][a] += inverse[a][b] * right[b];
        }
    }
}

void sphv_shape_make(sphv_method method, int dimension, const double *const moment[SPHV_RADIALS],
                     sphv_shape *out)
{
    memset(out, 0, sizeof *out);
    out->dimension = dimension;
    out->quantities = (int)sphv_method_quantities(method, dimension);
    switch (method) {
    case SPHV_SPH:
        standard(dimension, out);
        break;
    case SPHV_SPH_DIFFERENCE:
        standard(dimension, out);
        use_differences(dimension, moment, out);
        break;
    case SPHV_SHEPARD:
    case SPHV_RKPM_0:
        shepard(dimension, moment, out);
        break;
    case SPHV_BONET_LOK:
        shepard(dimension, moment, out);
        correct_gradient(dimension, moment, out);
        break;
    case SPHV_CSPM: {
        sphv_shape value = {.dimension = dimension};
        shepard(dimension, moment, &value);
        standard(dimension, out);
        use_differences(dimension, moment, out);
        correct_gradient(dimension, moment, out);
        memcpy(out->weight[0], value.weight[0], sizeof out->weight[0]);
        break;
    }
    case SPHV_FPM:
        collocate(dimension, 1, moment, out);
        break;
    case SPHV_MSPH:
        collocate(dimension, 2, moment, out);
        break;
    case SPHV_RKPM:
        reproduce(dimension, 1, moment, out);
        break;
    case SPHV_RKPM_2:
        reproduce(dimension, 2, moment, out);
        break;
    }
}
