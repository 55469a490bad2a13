/// The methods on disordered particles in one dimension: each estimate by a second route, the
/// derivative of the interpolant by finite differences, condition numbers, and particles without an
/// estimate. (Consistency is tested in every dimension by test_methods.c.)
#include "../../empirical/estimate.h"

#include <float.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_multifit.h>
#include <math.h>
#include <stdlib.h>

#include "support.h"

#define U (DBL_EPSILON / 2)

enum { MOST = 400, DEGREES = 5 };

/// Particles at random, the particle itself among them, with random volumes: consistency is a
/// property of the formula, not of a volume rule.
struct particles {
    double s[MOST], volume[MOST], field[MOST];
    sphv_neighbourhood around;
};

static void scatter(struct particles *p, int count, double support, double volume)
{
    p->around = (sphv_neighbourhood){.count = count, .s = p->s, .volume = p->volume};
    for (int b = 0; b < count; b++) {
        p->s[b] = b ? support * random_uniform(-1, 1) : 0;
        p->volume[b] = volume * random_log(0.5, 2);
    }
    for (int b = 1; b < count; b++) // by insertion: positions ascend
        for (int j = b; j > 0 && p->s[j - 1] > p->s[j]; j--) {
            double swap = p->s[j];
            p->s[j] = p->s[j - 1];
            p->s[j - 1] = swap;
        }
    for (int b = 0; b < count; b++)
        if (p->s[b] == 0) p->around.self = b;
}

static int order_of(sphv_method method)
{
    return method == SPHV_RKPM ? 1 : method == SPHV_RKPM_2 ? 2 : 0;
}

/// Least squares' moment matrix by GSL: 1-norms of it and of its inverse.
struct moments {
    double inverse_norm, norm;
};

static struct moments moments_of(int order, const sphv_profile *profile, const struct particles *p)
{
    size_t n = (size_t)order + 1;
    double of[9] = {0};
    for (int b = 0; b < p->around.count; b++) {
        double w = sphv_profile_derivative(profile, 0, fabs(p->s[b])).value * p->volume[b];
        for (size_t i = 0; i < n * n; i++) of[i] += w * gsl_pow_int(p->s[b], (int)(i / n + i % n));
    }
    gsl_matrix_view matrix = gsl_matrix_view_array(of, n, n);
    double copy[9], inverse[9];
    for (size_t i = 0; i < n * n; i++) copy[i] = of[i];
    gsl_permutation *order_of_rows = gsl_permutation_alloc(n);
    gsl_matrix_view to = gsl_matrix_view_array(inverse, n, n);
    int sign;
    struct moments out = {INFINITY, 0};
    if (gsl_linalg_LU_decomp(&matrix.matrix, order_of_rows, &sign) == 0 &&
        gsl_linalg_LU_invert(&matrix.matrix, order_of_rows, &to.matrix) == 0)
        out.inverse_norm = 0;
    for (size_t j = 0; j < n; j++) {
        double column = 0, inverse_column = 0;
        for (size_t i = 0; i < n; i++) {
            column += fabs(copy[i * n + j]);
            inverse_column += fabs(inverse[i * n + j]);
        }
        out.norm = fmax(out.norm, column);
        out.inverse_norm = fmax(out.inverse_norm, inverse_column);
    }
    gsl_permutation_free(order_of_rows);
    return out;
}

static sphv_estimate estimate_of(sphv_method method, const sphv_profile *profile,
                                 const struct particles *p)
{
    const double *const field[1] = {p->field};
    return sphv_estimate_gradient(method, profile, &p->around, 1, field);
}

/// A polynomial of a degree in s whose slope at 0 is known exactly.
static double polynomial(struct particles *p, int degree)
{
    double coefficient[DEGREES + 1];
    for (int k = 0; k <= degree; k++) coefficient[k] = random_uniform(0.5, 1.5);
    for (int b = 0; b < p->around.count; b++) {
        double sum = 0;
        for (int k = degree; k >= 0; k--) sum = sum * p->s[b] + coefficient[k];
        p->field[b] = sum;
    }
    return degree > 0 ? coefficient[1] : 0;
}

/// The interpolant ΣA_b ψ_b at x: Shepard's, or weighted least squares by GSL's own routine.
static double interpolant(int order, const sphv_profile *profile, const struct particles *p,
                          const double *values, double x)
{
    size_t n = (size_t)order + 1, count = (size_t)p->around.count;
    gsl_matrix *powers = gsl_matrix_alloc(count, n);
    gsl_vector *weights = gsl_vector_alloc(count), *y = gsl_vector_alloc(count);
    for (size_t b = 0; b < count; b++) {
        double w = sphv_profile_derivative(profile, 0, fabs(p->s[b] - x)).value;
        gsl_vector_set(weights, b, w * p->volume[b]);
        gsl_vector_set(y, b, values[b]);
        for (size_t k = 0; k < n; k++)
            gsl_matrix_set(powers, b, k, gsl_pow_int(p->s[b] - x, (int)k));
    }
    gsl_vector *c = gsl_vector_alloc(n);
    gsl_matrix *covariance = gsl_matrix_alloc(n, n);
    gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(count, n);
    double chi;
    assert_int_equal(gsl_multifit_wlinear(powers, weights, y, c, covariance, &chi, work), 0);
    double value = gsl_vector_get(c, 0);
    gsl_multifit_linear_free(work);
    gsl_matrix_free(covariance);
    gsl_matrix_free(powers);
    gsl_vector_free(c);
    gsl_vector_free(y);
    gsl_vector_free(weights);
    return value;
}

/// Σ(A_b − reference) W(x_b − x) V_b.
static double plain_sum(const sphv_profile *profile, const struct particles *p,
                        const double *values, double reference, double x)
{
    double sum = 0;
    for (int b = 0; b < p->around.count; b++)
        sum += (values[b] - reference) * p->volume[b] *
               sphv_profile_derivative(profile, 0, fabs(p->s[b] - x)).value;
    return sum;
}

/// The function of the particle's place whose derivative the method's gradient is made of.
static double route(sphv_method method, const sphv_profile *profile, const struct particles *p,
                    const double *values, double x)
{
    switch (method) {
    case SPHV_SPH:
        return plain_sum(profile, p, values, 0, x);
    case SPHV_SPH_DIFFERENCE:
    case SPHV_CSPM:
        return plain_sum(profile, p, values, values[p->around.self], x);
    default:
        return interpolant(order_of(method), profile, p, values, x);
    }
}

/// Central difference of order 4.
static double difference(sphv_method method, const sphv_profile *profile, const struct particles *p,
                         const double *values, double step)
{
    double f[2], sum = 0;
    for (int k = 1; k <= 2; k++) {
        f[0] = route(method, profile, p, values, k * step);
        f[1] = route(method, profile, p, values, -k * step);
        sum += (k == 1 ? 8 : -1) * (f[0] - f[1]) / (12 * step);
    }
    return sum;
}

/// Each gradient is the derivative of its interpolant; Bonet and Lok's, and so FPM's, is that of
/// Shepard's interpolant of the field over that of the positions (their L is the latter's inverse),
/// CSPM's the same of plain sums of differences. With step ε the difference is off by about
/// (D(2ε) − D(ε))/15 and by rounding, condition·u/ε. MSPH's gradient is no such derivative.
static void test_second_route(void **state)
{
    (void)state;
    random_start("second route");
    static struct particles p;
    static const char *const kernels[] = {"quinlan-w10", "wendland-c6"};
    sphv_kernel *loaded[2];
    for (int i = 0; i < 2; i++) loaded[i] = load_kernel(kernels[i]);
    for (int method = 0; sphv_methods[method].name; method++) {
        int compared = 0, rounds = quick() ? 5 : 60;
        if (method == SPHV_MSPH) continue;
        double worst = 0;
        for (int l = 0; l < rounds; l++) {
            const sphv_profile *profile = sphv_kernel_profile(loaded[l % 2], 1);
            int count = (int)random_integer(6, 30);
            scatter(&p, count, profile->support, 2 * profile->support / count);
            double K = random_uniform(0.1, 2), phase = random_uniform(0, 6);
            for (int b = 0; b < count; b++) p.field[b] = sin(K * p.s[b] + phase);
            sphv_estimate estimate = estimate_of((sphv_method)method, profile, &p);
            double step = 1e-3, by[2];
            for (int k = 0; k < 2; k++) {
                by[k] = difference((sphv_method)method, profile, &p, p.field, step * (k + 1));
                if (method == SPHV_BONET_LOK || method == SPHV_FPM || method == SPHV_CSPM)
                    by[k] /= difference((sphv_method)method, profile, &p, p.s, step * (k + 1));
            }
            double bound = fabs(by[1] - by[0]) +
                           16 * (count + 12) * U * estimate.condition * estimate.condition / step;
            if (estimate.fault != SPHV_FAULT_NONE || !(bound < 1e-5)) continue;
            compared++;
            worst = fmax(worst, bound);
            if (!is_close(estimate.gradient[0], by[0], bound))
                fail_msg("%s with %d particles: %.17g, by differences %.17g, bound %.3g",
                         sphv_methods[method].name, count, estimate.gradient[0], by[0], bound);
        }
        print_message("%-10s equals the derivative of its interpolant in %d layouts, bounds up to "
                      "%.1g\n",
                      sphv_methods[method].name, compared, worst);
        assert_true(compared >= rounds / 4);
    }
    for (int i = 0; i < 2; i++) sphv_kernel_free(loaded[i]);
}

/// The condition number that is reported is that of the matrix GSL inverts.
static void test_condition_numbers(void **state)
{
    (void)state;
    random_start("condition numbers");
    static struct particles p;
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    for (int method = SPHV_RKPM; method <= SPHV_RKPM_2; method++)
        for (int l = 0; l < 200; l++) {
            int count = (int)random_integer(3, 20);
            scatter(&p, count, 2, 4.0 / count);
            (void)polynomial(&p, 2);
            sphv_estimate estimate = estimate_of((sphv_method)method, profile, &p);
            struct moments m = moments_of(order_of((sphv_method)method), profile, &p);
            double wanted = m.inverse_norm * m.norm;
            assert_true(estimate.condition >= 1 - 16 * U);
            // an inverse is off by a multiple of u times the condition number
            if (wanted < 1e6)
                assert_close(estimate.condition, wanted, 1000 * (count + 12) * U * wanted * wanted);
            else
                assert_true(estimate.condition > 1e5);
            assert_true((estimate.fault != SPHV_FAULT_NONE) ==
                        !(estimate.condition <= 1 / sqrt(DBL_EPSILON)));
        }
    sphv_kernel_free(kernel);
}

/// Fewer neighbours than unknowns, coinciding particles, and particles at the very edge: what is
/// not found out as a fault is a finite number.
static void test_too_few_neighbours(void **state)
{
    (void)state;
    random_start("too few neighbours");
    static struct particles p;
    static const char *const kernels[] = {"quinlan-w10", "cubic-spline", "gaussian",
                                          "monaghan-m4-prime", "octic-spline"};
    sphv_kernel *loaded[5];
    for (int i = 0; i < 5; i++) loaded[i] = load_kernel(kernels[i]);
    for (int l = 0; l < (quick() ? 100 : 4000); l++) {
        const sphv_profile *profile = sphv_kernel_profile(loaded[l % 5], 1);
        int count = (int)random_integer(1, 4), kind = (int)random_integer(0, 3);
        scatter(&p, count, profile->support, 1);
        for (int b = 0; b < count; b++) {
            if (b == p.around.self) continue;
            double sign = b < p.around.self ? -1 : 1;
            if (kind == 1) p.s[b] = 0; // all in one place
            if (kind == 2) p.s[b] = sign * profile->support * (1 - random_log(1e-16, 1e-3));
            if (kind == 3) p.s[b] = sign * random_log(1e-300, 1e-6);
        }
        (void)polynomial(&p, 3);
        for (int method = 0; sphv_methods[method].name; method++) {
            sphv_estimate estimate = estimate_of((sphv_method)method, profile, &p);
            assert_false(isnan(estimate.condition));
            if (estimate.fault == SPHV_FAULT_NONE) {
                assert_true(isfinite(estimate.gradient[0]) && isfinite(estimate.condition));
                assert_true(estimate.condition <= 1 / sqrt(DBL_EPSILON));
            }
            // fewer particles, or all of them in one place, than unknowns leave no estimate
            int least = (int)sphv_method_least((sphv_method)method, 1);
            if (least > 1 && (count < least || kind == 1))
                assert_true(estimate.fault != SPHV_FAULT_NONE);
        }
    }
    for (int i = 0; i < 5; i++) sphv_kernel_free(loaded[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_second_route),
        cmocka_unit_test(test_condition_numbers),
        cmocka_unit_test(test_too_few_neighbours),
    };
    return run_group(tests);
}
