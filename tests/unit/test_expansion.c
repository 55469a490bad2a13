/// Polynomial pieces about several centres, and the moments of closed forms: bounds that hold, and
/// that are narrow enough to be of use.
#include <gsl/gsl_math.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/expansion.h"
#include "core/quadrature.h"
#include "support.h"

/// Value, slope and bend at q against exact arithmetic. \return the largest bound of each
static void check_values(const sphv_kernel *kernel, const sphv_profile *profile, double q,
                         double bound[3])
{
    sphv_result values[3];
    sphv_profile_values(profile, q, values);
    for (int n = 0; n < 3; n++) {
        double exact;
        assert_true(sphv_kernel_exact_value(kernel, profile->dimension, n, q, &exact));
        bound[n] = fmax(bound[n], values[n].bound);
        sphv_result value = values[n];
        value.bound += 3 * 0x1p-53 * fabs(exact); // the reference is rounded twice, once by π
        assert_within_bounds(value, exact);
    }
}

/// Σ of one-particle errors must stay far below 1e-14: so must each bound, relative to the largest
/// value of what it bounds. That largest value is at least that at the places looked at.
static void test_bounds_hold_and_are_narrow(void **state)
{
    (void)state;
    random_start("expansion");
    sphv_catalogue catalogue;
    sphv_error error;
    assert_ok(sphv_catalogue_load(data_directory(), &catalogue, &error), error);
    for (size_t i = 0; i < catalogue.count; i++)
        for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
            const sphv_profile *profile = sphv_kernel_profile(catalogue.kernels[i], d);
            if (!profile || profile->form) continue;
            double bound[3] = {0, 0, 0}, size[3] = {0, 0, 0};
            for (int k = 0; k < (quick() ? 10 : 120); k++) {
                double q = k % 3 ? random_uniform(0, profile->support)
                                 : profile->support * (1 - random_log(1e-12, 1));
                check_values(catalogue.kernels[i], profile, q, bound);
            }
            for (int k = 0; k < 100; k++)
                for (int n = 0; n < 3; n++)
                    size[n] = fmax(
                        size[n],
                        fabs(
                            sphv_profile_derivative(profile, n, profile->support * k / 100).value));
            for (int n = 0; n < 2; n++) assert_true(bound[n] <= 1e-14 * size[n]);
        }
    sphv_catalogue_free(&catalogue);
}

/// Where a kernel vanishes to a high order, what is left of it near the edge keeps its digits.
static void test_relative_accuracy_at_the_edge(void **state)
{
    (void)state;
    static const char *const names[] = {"quinlan-w10", "wendland-c8", "nonic-spline",
                                        "sigalotti-wendland-c4"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        sphv_kernel *kernel = load_kernel(names[i]);
        const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
        for (int k = 1; k <= 200; k++) {
            double q = profile->support * (1 - ldexp(1, -(k % 40)) / (1 + 0.02 * k)), exact;
            if (!(q > 0.5 * profile->support && q < profile->support)) continue;
            sphv_result value = sphv_profile_derivative(profile, 0, q);
            assert_true(sphv_kernel_exact_value(kernel, 1, 0, q, &exact));
            // The offset from κ is known to 2 roundings, which the power β + 1 multiplies.
            assert_true(value.bound <= 1e-12 * exact);
            assert_close(value.value, exact, value.bound + 0x1p-52 * exact);
        }
        sphv_kernel_free(kernel);
    }
}

static void random_coefficient(char *text, size_t size)
{
    switch (random_integer(0, 3)) {
    case 0:
        snprintf(text, size, "%ld/%ld", random_integer(-9, 9), random_integer(1, 9));
        break;
    case 1:
        snprintf(text, size, "%.17g", random_uniform(-1, 1));
        break;
    case 2:
        snprintf(text, size, "%lde%ld", random_integer(-9, 9), random_integer(-40, 6));
        break;
    default:
        snprintf(text, size, "%ld", random_integer(-5, 5));
        break;
    }
}

/// A kernel of 1 to 32 pieces with ends that are no doubles, slivers of pieces among them, and any
/// degree: discontinuous, huge, whatever.
static sphv_kernel *random_kernel(void)
{
    static char text[1 << 20];
    long count = random_integer(0, 2) ? random_integer(1, 4) : SPHV_PIECES_MAX;
    int used = snprintf(text, sizeof text,
                        "name: any\ntitle: any\nsupport: 7/3\ndimensions: [1, 2, 3]\npieces:\n");
    bool sliver = random_integer(0, 3) == 0;
    for (long i = 1; i <= count; i++) {
        // Equal steps of 7/(3·count); the first end may be next to nothing instead.
        const char *end = i == 1 && sliver && count > 1 ? "1e-25" : NULL;
        used += end ? snprintf(text + used, sizeof text - (size_t)used, "  - {until: %s, ", end)
                    : snprintf(text + used, sizeof text - (size_t)used, "  - {until: %ld/%ld, ",
                               7 * i, 3 * count);
        used += snprintf(text + used, sizeof text - (size_t)used, "coefficients: [\"100\"");
        long degree = random_integer(0, random_integer(0, 3) ? 6 : SPHV_DEGREE_MAX);
        for (long k = 1; k <= degree; k++) {
            char coefficient[40];
            random_coefficient(coefficient, sizeof coefficient);
            used += snprintf(text + used, sizeof text - (size_t)used, ", \"%s\"", coefficient);
        }
        used += snprintf(text + used, sizeof text - (size_t)used, "]}\n");
    }
    sphv_kernel *kernel = NULL;
    sphv_error error;
    return kernel_from_text(text, &kernel, &error) == SPHV_OK ? kernel : NULL;
}

static void test_any_pieces(void **state)
{
    (void)state;
    random_start("any pieces");
    int made = 0, wanted = quick() ? 6 : 60;
    // Some draws are refused (an integral that vanishes, fractions that grow too long): a draw is
    // accepted in more than a third of cases, so 40 draws for each wanted profile suffice.
    for (int i = 0; made < wanted && i < 40 * wanted; i++) {
        sphv_kernel *kernel = random_kernel();
        if (!kernel) continue;
        for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
            const sphv_profile *profile = sphv_kernel_profile(kernel, d);
            if (!profile) continue;
            made++;
            for (int k = 0; k < 60; k++) {
                double q = k % 3 ? random_uniform(0, profile->support) : random_log(1e-30, 1);
                double unused[3] = {0, 0, 0};
                bool on_end = false; // which side an end that is no double falls on is open
                for (int p = 0; p < profile->piece_count; p++)
                    on_end = on_end || q == profile->pieces[p].outer;
                if (!on_end) check_values(kernel, profile, q, unused);
            }
        }
        sphv_kernel_free(kernel);
    }
    assert_true(made >= wanted);
}

/// Fractions that have nothing in common are refused at once: exact arithmetic would take hours.
static void test_unmanageable_fractions(void **state)
{
    (void)state;
    static char text[1 << 17];
    int used = snprintf(text, sizeof text,
                        "name: any\ntitle: any\nsupport: 32\ndimensions: [1]\npieces:\n");
    for (int i = 1; i <= SPHV_PIECES_MAX; i++) {
        used += snprintf(text + used, sizeof text - (size_t)used,
                         "  - {until: %d, coefficients: [\"1\"", i);
        for (int k = 1; k <= SPHV_DEGREE_MAX; k++) // odd numbers of 37 digits, as good as coprime
            used += snprintf(text + used, sizeof text - (size_t)used, ", \"1/1%012d%012d%012d1\"",
                             i * 7919 * k, k * k * 104729, i * i * 1299709 + k);
        used += snprintf(text + used, sizeof text - (size_t)used, "]}\n");
    }
    sphv_kernel *kernel = NULL;
    sphv_error error;
    assert_failed(kernel_from_text(text, &kernel, &error), &error, SPHV_INVALID_INPUT,
                  "common denominator");
}

static void test_rounding_over_pi(void **state)
{
    (void)state;
    static const struct {
        long numerator;
        unsigned long denominator;
        bool over_pi;
        double nearest;
    } cases[] = {
        {1, 3, false, 1. / 3},
        {2, 1, false, 2},
        {-1, 10, false, -0.1},
        {1, 1, true, 0.31830988618379067154},     // 1/π
        {10, 7, true, 0.45472840883398667363},    // 10/(7π)
        {-9, 1, true, -2.8647889756541160438},    // −9/π
        {7, 478, true, 0.0046614418478797797087}, // 7/(478π)
    };
    mpq_t value;
    mpq_init(value);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        mpq_set_si(value, cases[i].numerator, cases[i].denominator);
        mpq_canonicalize(value);
        assert_close(sphv_rational_over_pi(value, cases[i].over_pi), cases[i].nearest, 0);
    }
    mpq_clear(value);
}

static void exponential(const void *unused, double q, sphv_result out[3])
{
    (void)unused;
    double w = exp(-q);
    out[0] = (sphv_result){w, 0x1p-52 * w};
    out[1] = (sphv_result){-w, 0x1p-52 * w};
    out[2] = out[0];
}

/// ∫_0^1 q^n e^{−q} dq = n! (1 − e^{−1} Σ_{k≤n} 1/k!) = e^{−1} Σ_{k>n} n!/k!, a sum without
/// cancellation.
static void test_moments_of_an_exponential(void **state)
{
    (void)state;
    sphv_result moments[SPHV_MOMENT_MAX + 1];
    assert_int_equal(
        sphv_quadrature_moments(exponential, NULL, 0, 1, 0.25, 0, SPHV_MOMENT_MAX + 1, moments),
        SPHV_OK);
    for (int n = 0; n <= SPHV_MOMENT_MAX; n++) {
        double sum = 0, term = 1;
        for (int k = n + 1; k < n + 40; k++) sum += term /= k;
        sphv_result moment = moments[n];
        moment.bound += 48 * 0x1p-53 * moment.value; // the reference's own roundings
        assert_within_bounds(moment, exp(-1) * sum);
        assert_true(moments[n].bound <= 1e-13 * moments[n].value);
    }
    // The same from n = 5 on, over another range and split otherwise.
    sphv_result some[4], rest[4];
    assert_int_equal(sphv_quadrature_moments(exponential, NULL, 0, 0.3, 1, 5, 4, some), SPHV_OK);
    assert_int_equal(sphv_quadrature_moments(exponential, NULL, 0.3, 1, 0.1, 5, 4, rest), SPHV_OK);
    for (int j = 0; j < 4; j++)
        assert_close(some[j].value + rest[j].value, moments[5 + j].value,
                     some[j].bound + rest[j].bound + moments[5 + j].bound);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bounds_hold_and_are_narrow),
        cmocka_unit_test(test_relative_accuracy_at_the_edge),
        cmocka_unit_test(test_any_pieces),
        cmocka_unit_test(test_unmanageable_fractions),
        cmocka_unit_test(test_rounding_over_pi),
        cmocka_unit_test(test_moments_of_an_exponential),
    };
    return run_group(tests);
}
