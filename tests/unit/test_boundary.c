/// Moments over supports cut by the sides of a box, and the consistency measures of lattices.
#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "sphverify/boundary.h"
#include "support.h"

enum { MONOMIALS = 35 }; ///< degree <= 4 in three dimensions

struct moments {
    sphv_result of[3][MONOMIALS];
};

static struct moments cut(const sphv_profile *profile, const double *below, const double *above,
                          int degree)
{
    struct moments moments;
    sphv_error error;
    sphv_result *out[3] = {moments.of[0], moments.of[1], moments.of[2]};
    assert_ok(sphv_truncated_moments(profile, below, above, degree, out, &error), error);
    return moments;
}

static size_t index_of(int d, int x, int y, int z)
{
    return sphv_monomial_index(d, (int[SPHV_DIMENSIONS]){x, y, z});
}

static const char *const kernels[] = {"cubic-spline", "wendland-c4", "quinlan-w10", "gaussian"};
static const double far[SPHV_DIMENSIONS] = {1e3, 1e3, 1e3}, near_[SPHV_DIMENSIONS] = {0, 0, 0};

/// Without a cut they are the profile's own: ∫Ŵ, Σ∫s_i²Ŵ = μ_2, and −∫s_i ∂_iŴ.
static void test_uncut(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++) {
        sphv_kernel *kernel = load_kernel(kernels[i]);
        for (int d = 1; d <= 3; d++) {
            const sphv_profile *profile = sphv_kernel_profile(kernel, d);
            if (!profile) continue;
            struct moments m = cut(profile, far, far, 4);
            sphv_result second = {0, 0};
            for (int j = 0; j < d; j++) {
                size_t square = index_of(d, 2 * (j == 0), 2 * (j == 1), 2 * (j == 2));
                second.value += m.of[0][square].value;
                second.bound += m.of[0][square].bound;
                assert_close(-m.of[1][square].value, profile->slope_moment[0].value,
                             m.of[1][square].bound + profile->slope_moment[0].bound);
            }
            assert_close(m.of[0][0].value, profile->moment[0].value,
                         m.of[0][0].bound + profile->moment[0].bound);
            assert_close(second.value, profile->moment[2].value,
                         second.bound + profile->moment[2].bound);
            assert_within_bounds(m.of[0][index_of(d, 1, 0, 0)], 0);
            // A bound that says nothing must not pass for a proof.
            assert_true(m.of[0][0].bound < 1e-11 && second.bound < 1e-11);
        }
        sphv_kernel_free(kernel);
    }
}

/// ∫s_1²/2 ∂_1²Ŵ = 1 by parts, for a kernel with β >= 1; ∂_1²Ŵ = p_1 + p_2 s_1².
static void test_second_derivative(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("wendland-c4");
    for (int d = 2; d <= 3; d++) {
        struct moments m = cut(sphv_kernel_profile(kernel, d), far, far, 4);
        sphv_result one = m.of[1][index_of(d, 2, 0, 0)], two = m.of[2][index_of(d, 4, 0, 0)];
        assert_close(0.5 * (one.value + two.value), 1, one.bound + two.bound);
    }
    sphv_kernel_free(kernel);
}

/// On an edge half of every even moment is left, in a corner a quarter, an eighth.
static void test_halves(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    for (int d = 1; d <= 3; d++) {
        const sphv_profile *profile = sphv_kernel_profile(kernel, d);
        struct moments whole = cut(profile, far, far, 4);
        for (int edges = 1; edges <= d; edges++) {
            double below[SPHV_DIMENSIONS] = {1e3, 1e3, 1e3};
            for (int i = 0; i < edges; i++) below[i] = 0;
            struct moments part = cut(profile, below, far, 4);
            for (size_t m = 0; m < sphv_monomial_count(d, 4); m++) {
                const int *power = sphv_monomials(d)[m].power;
                if (power[0] % 2 || power[1] % 2 || power[2] % 2) continue;
                for (int k = 0; k < 3; k++)
                    if (isfinite(whole.of[k][m].bound))
                        assert_close(gsl_pow_int(2, edges) * part.of[k][m].value,
                                     whole.of[k][m].value,
                                     8 * part.of[k][m].bound + whole.of[k][m].bound);
            }
        }
    }
    sphv_kernel_free(kernel);
}

/// The octants of a support make up the whole.
static void test_complements(void **state)
{
    (void)state;
    random_start("complements");
    sphv_kernel *kernel = load_kernel("wendland-c4");
    for (int round = 0; round < (quick() ? 2 : 6); round++) {
        int d = round % 3 + 1;
        const sphv_profile *profile = sphv_kernel_profile(kernel, d);
        double below[SPHV_DIMENSIONS], above[SPHV_DIMENSIONS];
        for (int i = 0; i < SPHV_DIMENSIONS; i++) {
            below[i] = random_uniform(0, 1.3 * profile->support);
            above[i] = random_uniform(0, 1.3 * profile->support);
        }
        struct moments whole = cut(profile, below, above, 4), sum = {0};
        for (int octant = 0; octant < 1 << d; octant++) {
            double low[SPHV_DIMENSIONS] = {0}, high[SPHV_DIMENSIONS] = {0};
            for (int i = 0; i < d; i++)
                if (octant >> i & 1)
                    low[i] = below[i];
                else
                    high[i] = above[i];
            struct moments part = cut(profile, low, high, 4);
            for (int k = 0; k < 3; k++)
                for (size_t m = 0; m < sphv_monomial_count(d, 4); m++) {
                    sum.of[k][m].value += part.of[k][m].value;
                    sum.of[k][m].bound += part.of[k][m].bound;
                }
        }
        for (int k = 0; k < 3; k++)
            for (size_t m = 0; m < sphv_monomial_count(d, 4); m++)
                if (isfinite(sum.of[k][m].bound))
                    assert_close(sum.of[k][m].value, whole.of[k][m].value,
                                 sum.of[k][m].bound + whole.of[k][m].bound);
    }
    sphv_kernel_free(kernel);
}

/// An independent route: GSL's adaptive quadrature, coordinate by coordinate.
struct slice {
    const sphv_profile *profile;
    const double *below, *above;
    const int *power;
    int k, axis;
    double s[SPHV_DIMENSIONS];
    gsl_integration_workspace *work[SPHV_DIMENSIONS];
};

static double slice_integral(double s, void *context)
{
    struct slice *of = context;
    int axis = of->axis;
    double square = 0, result = 0, error;
    of->s[axis] = s;
    for (int i = 0; i <= axis; i++) square += of->s[i] * of->s[i];
    if (axis + 1 == of->profile->dimension) {
        double q = sqrt(square), value = 1;
        if (q >= of->profile->support || q == 0) return 0;
        sphv_result w[3];
        sphv_profile_values(of->profile, q, w);
        double p[3] = {w[0].value, w[1].value / q, (w[2].value - w[1].value / q) / (q * q)};
        for (int i = 0; i <= axis; i++) value *= gsl_pow_int(of->s[i], of->power[i]);
        return value * p[of->k];
    }
    double half = sqrt(fmax(0, gsl_pow_2(of->profile->support) - square));
    of->axis = axis + 1;
    double from = -fmin(half, of->below[axis + 1]), to = fmin(half, of->above[axis + 1]);
    double middle[3] = {from, 0, to};
    gsl_function f = {slice_integral, of};
    gsl_integration_qagp(&f, middle, 3, 1e-10, 1e-8, 200, of->work[axis + 1], &result, &error);
    of->axis = axis;
    return result;
}

static void test_adaptive_quadrature(void **state)
{
    (void)state;
    random_start("adaptive quadrature");
    for (int round = 0; round < (quick() ? 1 : 3); round++) {
        sphv_kernel *kernel = load_kernel(round % 2 ? "cubic-spline" : "wendland-c4");
        const sphv_profile *profile = sphv_kernel_profile(kernel, 2);
        double below[SPHV_DIMENSIONS] = {0}, above[SPHV_DIMENSIONS] = {0};
        for (int i = 0; i < 2; i++) {
            below[i] = random_uniform(0.01, profile->support);
            above[i] = random_uniform(0.01, profile->support);
        }
        struct moments moments = cut(profile, below, above, 4);
        struct slice of = {.profile = profile, .below = below, .above = above};
        for (int i = 0; i < 2; i++) of.work[i] = gsl_integration_workspace_alloc(200);
        for (int sample = 0; sample < 4; sample++) {
            double result, error, middle[3] = {-below[0], 0, above[0]};
            of.k = sample % 3;
            size_t m = (size_t)random_integer(of.k == 2 ? 3 : 0, 14);
            of.power = sphv_monomials(2)[m].power;
            of.axis = 0;
            gsl_function f = {slice_integral, &of};
            gsl_integration_qagp(&f, middle, 3, 1e-8, 1e-7, 200, of.work[0], &result, &error);
            // GSL's own estimate, and what the inner integrals were asked for over the whole width.
            assert_close(moments.of[of.k][m].value, result,
                         moments.of[of.k][m].bound + error + 1e-7 * (1 + fabs(result)));
        }
        for (int i = 0; i < 2; i++) gsl_integration_workspace_free(of.work[i]);
        sphv_kernel_free(kernel);
    }
}

static void test_refusals(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("spiky");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    struct moments moments;
    sphv_error error;
    sphv_result *out[3] = {moments.of[0], moments.of[1], moments.of[2]};
    double bad[SPHV_DIMENSIONS] = {-1, NAN, 0};
    assert_failed(sphv_truncated_moments(profile, bad, far, 4, out, &error), &error,
                  SPHV_INVALID_INPUT, "outside its box");
    assert_failed(sphv_truncated_moments(profile, far, bad + 1, 4, out, &error), &error,
                  SPHV_INVALID_INPUT, "outside its box");
    assert_failed(sphv_truncated_moments(profile, far, far, 17, out, &error), &error,
                  SPHV_INVALID_INPUT, "0 to 16");
    // A tip makes p_1 like 1/q: its integral in one dimension does not exist, and says so.
    moments = cut(profile, near_, far, 2);
    assert_true(isinf(moments.of[1][0].bound) && isfinite(moments.of[1][1].bound));
    sphv_consistency consistency;
    assert_failed(
        sphv_predict_consistency(profile, NAN, SPHV_JITTER_UNIFORM, 0, &consistency, &error),
        &error, SPHV_INVALID_INPUT, "spacing");
    assert_failed(sphv_predict_consistency(profile, 0.3 * profile->support, SPHV_JITTER_UNIFORM, -1,
                                           &consistency, &error),
                  &error, SPHV_INVALID_INPUT, "amplitude");
    sphv_kernel_free(kernel);
}

/// Poisson's formula against the lattice's sums; symmetry; and that the noise falls like
/// n_nb^−(1/2 + 1/d).
static void test_consistency(void **state)
{
    (void)state;
    static const char *const smooth[] = {"wendland-c4", "quinlan-w10", "cubic-spline"};
    sphv_error error;
    for (size_t i = 0; i < sizeof smooth / sizeof *smooth; i++) {
        sphv_kernel *kernel = load_kernel(smooth[i]);
        for (int d = 1; d <= (quick() ? 1 : 3); d++) {
            const sphv_profile *profile = sphv_kernel_profile(kernel, d);
            if (!profile) continue;
            // In two dimensions the aliases of a rough kernel are many, and of no other kind.
            bool coarse = d == 3 || (d == 2 && profile->boundary_smoothness < 3);
            for (double reach = 1.9; reach < (coarse ? 3 : 9); reach *= 2.1) {
                sphv_consistency c;
                assert_ok(sphv_predict_consistency(profile, profile->support / reach,
                                                   SPHV_JITTER_UNIFORM, 0, &c, &error),
                          error);
                for (int m = 0; m < SPHV_CONSISTENCY_MEASURES; m++)
                    assert_close(c.lattice[m].value, c.aliases[m].value,
                                 c.lattice[m].bound + c.aliases[m].bound);
                assert_true(c.lattice[SPHV_NORMALISATION].bound < 1e-12);
            }
        }
        sphv_kernel_free(kernel);
    }
}

/// The deviation tends to its leading order, which falls like n_nb^−(1/2 + 1/d).
static void test_noise(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("wendland-c4");
    sphv_error error;
    for (int d = 1; d <= (quick() ? 1 : 2); d++) {
        const sphv_profile *profile = sphv_kernel_profile(kernel, d);
        for (int m = 0; m < SPHV_CONSISTENCY_MEASURES; m++) {
            double off[2];
            for (int i = 0; i < 2; i++) {
                sphv_consistency c;
                double spacing = profile->support / (i ? 10.2 : 5.1);
                assert_ok(sphv_predict_consistency(profile, spacing, SPHV_JITTER_UNIFORM, 0.1, &c,
                                                   &error),
                          error);
                if (m == SPHV_SHEAR && d == 1)
                    off[i] = i ? 0 : 1;
                else
                    off[i] = fabs(c.deviation[m].value / c.leading_deviation[m] - 1);
                // Next order: the particle's own share, Δs^d, and the curvature, (amplitude Δs)².
                assert_true(off[i] < 3 * pow(spacing, fmin(d, 2)));
            }
            assert_true(off[1] < off[0]);
        }
    }
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_uncut),
        cmocka_unit_test(test_second_derivative),
        cmocka_unit_test(test_halves),
        cmocka_unit_test(test_complements),
        cmocka_unit_test(test_adaptive_quadrature),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_consistency),
        cmocka_unit_test(test_noise),
    };
    return run_group(tests);
}
