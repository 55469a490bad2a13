/// The particle sum at one particle against the exhaustive one, and what both refuse.
#include <math.h>
#include <stdio.h>

#include "sphverify/measure.h"
#include "support.h"

static void test_one_particle_stands_for_all(void **state)
{
    (void)state;
    random_start("one particle and all");
    sphv_catalogue catalogue;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_catalogue_load(data_directory(), &catalogue, &error), error);
    for (size_t i = 0; i < catalogue.count; i++) {
        const sphv_profile *profile = sphv_kernel_profile(catalogue.kernels[i], 1);
        for (int l = 0; profile && l < (quick() ? 1 : 4); l++) {
            double h = random_log(5e-3, 0.5);
            // a whole number of particles on a wavelength, so that the average is over whole ones
            double wanted = random_uniform(0.1, 0.5) * profile->support;
            double count = ceil(1 / (h * wanted));
            sphv_number spacing = sphv_number_from_double(1 / (count * h));
            if (count < 3 || spacing.value >= profile->support) continue;
            sphv_measurement one, all;
            assert_ok(sphv_measure_lattice(profile, h, spacing, &one, &error), error);
            assert_ok(
                sphv_measure_lattice_exhaustive(profile, h, spacing, NULL, NULL, &all, &error),
                error);
            assert_close(one.total.value, all.total.value, one.total.bound + all.total.bound);
            assert_close(one.l2.value, all.l2.value, one.l2.bound + all.l2.bound);
            assert_close(one.l2.value, fabs(one.total.value) / sqrt(2), 0x1p-51 * one.l2.value);
            assert_int_equal(one.particles, 1);
            assert_true(fabs((double)all.particles - count) <= 1);
            assert_int_equal(all.neighbours, one.neighbours);
            assert_true(all.pairs >= all.particles && one.seconds >= 0 && all.seconds >= 0);
            // a bound that says nothing would make the comparison empty
            assert_true(one.total.bound < 1e-12 && all.total.bound < 1e-9);
        }
    }
    sphv_catalogue_free(&catalogue);
}

static void count_calls(void *context, double done)
{
    double *last = context;
    assert_true(done > 0 && done <= 1);
    if (done > *last) *last = done;
}

static void test_progress_reaches_the_end(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("quinlan-w8");
    sphv_measurement measurement;
    sphv_error error = {SPHV_OK, ""};
    double last = 0;
    assert_ok(sphv_measure_lattice_exhaustive(sphv_kernel_profile(kernel, 1), 2e-3,
                                              sphv_number_from_ratio(4, 11), count_calls, &last,
                                              &measurement, &error),
              error);
    assert_close(last, 1, 0);
    assert_int_equal(measurement.neighbours, 11);
    sphv_kernel_free(kernel);
}

/// The order of addition is fixed: any number of threads gives the same bits.
static void test_repeatable(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    sphv_measurement first, again;
    sphv_error error = {SPHV_OK, ""};
    sphv_number spacing = sphv_number_from_ratio(4, 11);
    assert_ok(sphv_measure_lattice_exhaustive(profile, 1e-3, spacing, NULL, NULL, &first, &error),
              error);
    for (int i = 0; i < 5; i++) {
        assert_ok(
            sphv_measure_lattice_exhaustive(profile, 1e-3, spacing, NULL, NULL, &again, &error),
            error);
        assert_close(again.total.value, first.total.value, 0);
        assert_close(again.l2.value, first.l2.value, 0);
    }
    sphv_kernel_free(kernel);
}

static void test_refusals(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    sphv_measurement out;
    sphv_error error = {SPHV_OK, ""};
    sphv_number half = sphv_number_from_double(0.5);
    const double bad[] = {0, -1, NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 5; i++) {
        assert_failed(sphv_measure_lattice(profile, bad[i], half, &out, &error), &error,
                      SPHV_INVALID_INPUT, "positive");
        assert_failed(
            sphv_measure_lattice(profile, 0.02, sphv_number_from_double(bad[i]), &out, &error),
            &error, SPHV_INVALID_INPUT, "no neighbour");
        assert_failed(
            sphv_measure_lattice_exhaustive(profile, bad[i], half, NULL, NULL, &out, &error),
            &error, SPHV_INVALID_INPUT, "positive");
    }
    assert_failed(sphv_measure_lattice(profile, 0.02, sphv_number_from_double(2), &out, &error),
                  &error, SPHV_INVALID_INPUT, "no neighbour");
    assert_failed(sphv_measure_lattice(profile, 0.02, sphv_number_from_double(1e-12), &out, &error),
                  &error, SPHV_INVALID_INPUT, "spacing");
    assert_failed(sphv_measure_lattice_exhaustive(profile, 1e-6, sphv_number_from_double(1e-6),
                                                  NULL, NULL, &out, &error),
                  &error, SPHV_INVALID_INPUT, "too many");
    assert_failed(sphv_measure_lattice(sphv_kernel_profile(kernel, 3), 0.02, half, &out, &error),
                  &error, SPHV_NO_CLOSED_FORM, "3 dimensions");
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_particle_stands_for_all),
        cmocka_unit_test(test_progress_reaches_the_end),
        cmocka_unit_test(test_repeatable),
        cmocka_unit_test(test_refusals),
    };
    return run_group(tests);
}
