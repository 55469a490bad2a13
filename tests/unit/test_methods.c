/// The methods from their sums: consistency on polynomials over disordered particles to the proven
/// rounding and no further, bounds against long double evaluations, and what becomes of particles
/// that have no estimate.
#include <float.h>
#include <math.h>

#include "methods_support.h"

/// Integer coefficients: with positions in 2^−8 and h a power of two, the values are exact.
static void draw_polynomial(int d, int degree, double coefficient[SPHV_QUANTITIES_MAX * 4])
{
    for (size_t k = 0; k < sphv_monomial_count(d, degree); k++) {
        bool top = sphv_monomials(d)[k].degree == degree;
        coefficient[k] = (double)(random_integer(1, 7) * (top || random_integer(0, 1) ? 1 : -1));
    }
}

/// Σ c ∂^α x^β at x.
static double polynomial(int d, int degree, const double *coefficient, size_t alpha,
                         const double x[SPHV_DIMENSIONS])
{
    const sphv_monomial *table = sphv_monomials(d), *of = &table[alpha];
    double sum = 0;
    for (size_t k = 0; k < sphv_monomial_count(d, degree); k++) {
        double term = coefficient[k];
        for (int i = 0; i < d; i++) {
            for (int n = 0; n < of->power[i]; n++) term *= table[k].power[i] - n;
            for (int n = of->power[i]; n < table[k].power[i]; n++) term *= x[i];
        }
        sum += term;
    }
    return sum;
}

/// The degree that a quantity must be exact for.
static int claimed(sphv_method method, size_t quantity)
{
    return quantity == 0 ? sphv_methods[method].value_consistency
                         : sphv_methods[method].consistency;
}

static void check_consistency(const sphv_profile *profile, sphv_method method, struct cloud *cloud)
{
    int d = cloud->dimension;
    size_t quantities = sphv_method_quantities(method, d);
    double coefficient[40];
    int exact[SPHV_QUANTITIES_MAX] = {0}, wrong[SPHV_QUANTITIES_MAX] = {0};
    int sound = 0, tried = 0;
    for (int degree = 0; degree <= 3; degree++) {
        draw_polynomial(d, degree, coefficient);
        for (int b = 0; b < cloud->count; b++)
            cloud->field[0][b] = polynomial(d, degree, coefficient, 0, cloud->x[b]);
        sound = tried = 0;
        int step = (d < 3 ? d : 16) * (quick() ? 4 : 1);
        // corners and sides first
        for (int a = 0; a < cloud->count; a += a < 8 ? 1 : step) {
            tried++;
            struct single found;
            estimate_at(profile, method, cloud, a, &found);
            if (found.fault != SPHV_FAULT_NONE) continue;
            sound++;
            for (size_t q = 0; q < quantities; q++) {
                double expected = polynomial(d, degree, coefficient, q, cloud->x[a]);
                double bound = found.rounding[q];
                if (degree <= claimed(method, q)) {
                    if (!is_close(found.estimate[q], expected, bound))
                        fail_msg("%s in %dD: quantity %zu of degree %d is %.17g, not %.17g, bound "
                                 "%.3g, condition %.3g",
                                 sphv_methods[method].name, d, q, degree, found.estimate[q],
                                 expected, bound, found.condition);
                    exact[q] += bound < 1e-6;
                } else if (degree == claimed(method, q) + 1) {
                    wrong[q] += fabs(found.estimate[q] - expected) > 1e3 * bound &&
                                fabs(found.estimate[q] - expected) > 1e-6;
                }
            }
        }
    }
    for (size_t q = 0; q < quantities; q++) {
        assert_true(sound > tried / 2);
        assert_true(exact[q] >= (claimed(method, q) + 1) * (sound / 2));
        assert_true(wrong[q] > sound / 2);
    }
}

/// In 1, 2 and 3 dimensions, at edges and corners too: exact through the claimed degree, and wrong
/// one degree above.
static void test_consistency(void **state)
{
    (void)state;
    random_start("consistency");
    static const char *const kernels[] = {"cubic-spline", "wendland-c4"};
    static struct cloud cloud;
    for (int d = 1; d <= 3; d++)
        for (int method = 0; sphv_methods[method].name; method++) {
            sphv_kernel *kernel = load_kernel(kernels[random_integer(0, 1)]);
            const sphv_profile *profile = sphv_kernel_profile(kernel, d);
            scatter(d, profile->support, &cloud);
            check_consistency(profile, (sphv_method)method, &cloud);
            sphv_kernel_free(kernel);
        }
}

/// Every estimate is within its bound of the same sums and systems in long double, and the bound is
/// no more than what the condition makes of rounding.
static void test_bounds(void **state)
{
    (void)state;
    random_start("bounds");
    static const char *const kernels[] = {"cubic-spline", "wendland-c4", "quinlan-w8"};
    static struct cloud cloud;
    for (int k = 0; k < (quick() ? 1 : 3); k++) {
        sphv_kernel *kernel = load_kernel(kernels[k]);
        for (int d = 1; d <= 3; d++) {
            const sphv_profile *profile = sphv_kernel_profile(kernel, d);
            if (!profile) continue;
            for (int method = 0; sphv_methods[method].name; method++) {
                int compared = 0, tight = 0;
                double largest = 0;
                scatter(d, profile->support, &cloud);
                for (int b = 0; b < cloud.count; b++)
                    cloud.field[0][b] = random_uniform(-1, 1) * random_log(1e-3, 1);
                for (int a = 0; a < cloud.count; a += (d < 3 ? 1 : 5) * (quick() ? 3 : 1)) {
                    struct single found;
                    long double wanted[SPHV_QUANTITIES_MAX];
                    estimate_at(profile, (sphv_method)method, &cloud, a, &found);
                    if (found.fault != SPHV_FAULT_NONE) continue;
                    reference_at(profile, (sphv_method)method, &cloud, a, wanted);
                    for (size_t q = 0; q < sphv_method_quantities((sphv_method)method, d); q++) {
                        double off = fabs((double)(found.estimate[q] - wanted[q]));
                        compared++;
                        if (!(off <= found.rounding[q]))
                            fail_msg(
                                "%s in %dD: quantity %zu is off by %.3g, bound %.3g, condition "
                                "%.3g",
                                sphv_methods[method].name, d, q, off, found.rounding[q],
                                found.condition);
                        largest = fmax(largest, off / found.rounding[q]);
                        tight += found.rounding[q] < 1e-8 * found.condition;
                    }
                }
                print_message("%-12s %-14s %dD: %d estimates off by up to %.2g of their bounds\n",
                              kernels[k], sphv_methods[method].name, d, compared, largest);
                assert_true(compared > 20 && tight > compared / 2);
            }
        }
        sphv_kernel_free(kernel);
    }
}

/// Eliminating the value from FPM's system leaves the mixed correction: same gradient.
static void test_fpm_and_mixed_correction_share_a_gradient(void **state)
{
    (void)state;
    random_start("equal gradients");
    static struct cloud cloud;
    sphv_kernel *kernel = load_kernel("wendland-c4");
    int compared = 0;
    for (int d = 1; d <= 3; d++) {
        const sphv_profile *profile = sphv_kernel_profile(kernel, d);
        scatter(d, profile->support, &cloud);
        for (int b = 0; b < cloud.count; b++) cloud.field[0][b] = random_uniform(-1, 1);
        for (int a = 0; a < cloud.count; a += d) {
            struct single fpm, mixed;
            estimate_at(profile, SPHV_FPM, &cloud, a, &fpm);
            estimate_at(profile, SPHV_BONET_LOK, &cloud, a, &mixed);
            if (fpm.fault != SPHV_FAULT_NONE || mixed.fault != SPHV_FAULT_NONE) continue;
            for (int i = 1; i <= d; i++, compared++)
                assert_close(fpm.estimate[i], mixed.estimate[i],
                             fpm.rounding[i] + mixed.rounding[i]);
        }
    }
    assert_true(compared > 50);
    sphv_kernel_free(kernel);
}

/// A request's level covers its methods; richer sums lead to the same estimates.
static void test_levels(void **state)
{
    (void)state;
    random_start("levels");
    static struct cloud cloud;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    for (int d = 1; d <= 3; d++) {
        const sphv_profile *profile = sphv_kernel_profile(kernel, d);
        scatter(d, profile->support, &cloud);
        for (int b = 0; b < cloud.count; b++) cloud.field[0][b] = random_uniform(-1, 1);
        for (int m = 0; sphv_methods[m].name; m++)
            for (int other = 0; sphv_methods[other].name; other++) {
                sphv_method methods[2] = {(sphv_method)m, (sphv_method)other};
                sphv_request request = {.method_count = 2, .methods = methods};
                struct single own, shared;
                int a = (int)random_integer(0, cloud.count - 1);
                estimate_at(profile, methods[0], &cloud, a, &own);
                estimate_at_level(profile, methods[0], &cloud, a, sphv_request_level(&request),
                                  &shared);
                assert_int_equal(own.fault, shared.fault);
                for (size_t q = 0; q < sphv_method_quantities(methods[0], d); q++)
                    assert_close(own.estimate[q], shared.estimate[q], 0);
            }
    }
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_consistency),
        cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_fpm_and_mixed_correction_share_a_gradient),
        cmocka_unit_test(test_levels),
    };
    return run_group(tests);
}
