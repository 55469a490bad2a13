/// Norms of errors against sums in long double, and who is left out of them.
#include <float.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "sphverify/estimate.h"
#include "support.h"

#define U (DBL_EPSILON / 2)

/// Relative rounding of long double: some checkers compute it as double.
static double long_epsilon(void)
{
    volatile long double above = 1 + LDBL_EPSILON;
    return above > 1 ? (double)LDBL_EPSILON : DBL_EPSILON;
}

/// Estimates of one quantity, made up.
struct made_up {
    sphv_particles particles;
    sphv_estimates estimates;
    sphv_method_estimates method;
    double *array[1], rounding[1], *exact;
};

static void make(struct made_up *made, size_t count)
{
    memset(made, 0, sizeof *made);
    made->particles = (sphv_particles){.dimension = 2, .count = count};
    for (int i = 0; i < 2; i++) made->particles.x[i] = calloc(count, sizeof(double));
    made->array[0] = calloc(count, sizeof(double));
    made->exact = calloc(count, sizeof(double));
    made->method = (sphv_method_estimates){.quantities = 1,
                                           .estimate = made->array,
                                           .fault = calloc(count, 1),
                                           .rounding = made->rounding};
    made->estimates = (sphv_estimates){
        .count = count, .field_count = 1, .method_count = 1, .methods = &made->method};
    for (size_t n = 0; n < count; n++) {
        made->particles.x[0][n] = random_uniform(0, 1);
        made->particles.x[1][n] = random_uniform(0, 1);
    }
}

static void unmake(struct made_up *made)
{
    for (int i = 0; i < 2; i++) free(made->particles.x[i]);
    free(made->array[0]);
    free(made->exact);
    free(made->method.fault);
}

static sphv_norms norms_of(const struct made_up *made, double margin)
{
    return sphv_error_norms(&made->particles, &made->estimates, 0, 0, 0, made->exact, margin);
}

/// Numbers of any size, an offset that cancels in the deviation, sizes round the blocks'.
static void test_against_long_double(void **state)
{
    (void)state;
    random_start("norms");
    static const size_t counts[] = {1, 2, 1023, 1024, 1025, 4099, 40000};
    for (int l = 0; l < (quick() ? 7 : 35); l++) {
        size_t count = counts[l % 7];
        if (quick() && count > 5000) continue;
        double offset = l % 2 ? 0 : 1000, margin = l % 3 ? 0 : 0.2;
        // Sizes whose squares stay in range, overflow and underflow
        double size = l % 5 == 0 ? 1e200 : l % 5 == 1 ? 1e-250 : random_log(1e-6, 1e6);
        struct made_up made;
        make(&made, count);
        for (size_t n = 0; n < count; n++) {
            made.exact[n] = size * random_uniform(-1, 1);
            made.array[0][n] = made.exact[n] + size * (offset + random_uniform(-1, 1));
        }
        made.rounding[0] = l % 4 ? 0 : size * 1e-3;
        sphv_norms got = norms_of(&made, margin);
        long double square = 0, absolute = 0, plain = 0, scatter = 0, largest = 0;
        size_t counted = 0;
        for (int pass = 0; pass < 2; pass++)
            for (size_t n = 0; n < count; n++) {
                bool within = true;
                for (int i = 0; i < 2; i++)
                    within = within && fabs(made.particles.x[i][n] - 0.5) <= 0.5 - margin;
                if (!within) continue;
                // The difference itself is rounded, by u/2 ulp of each: part of the bound
                long double error =
                    ((long double)made.array[0][n] - (long double)made.exact[n]) / size;
                if (pass) {
                    scatter += (error - plain / counted) * (error - plain / counted);
                    continue;
                }
                counted++;
                square += error * error;
                absolute += fabsl(error);
                plain += error;
                largest = fmaxl(largest, fabsl(error));
            }
        assert_int_equal(got.counted, counted);
        if (counted == 0) {
            assert_close(got.rmse, 0, 0);
            unmake(&made);
            continue;
        }
        double rmse = size * (double)sqrtl(square / counted), bound = got.bound - made.rounding[0];
        // What the sums here are off by: nothing, unless long double is computed as double
        double own = (double)(counted + 4) * long_epsilon() * rmse + 2 * U * rmse;
        assert_close(got.rmse, rmse, bound + own);
        assert_true(bound <= 8 * U * rmse + U * got.bound);
        assert_close(got.mae, size * (double)(absolute / counted), 4 * U * rmse + own);
        assert_close(got.maximum, size * (double)largest, 4 * U * size * (double)largest);
        // The mean is off by 3u of the errors' size, and so is each difference from it
        assert_close(got.standard_deviation, size * (double)sqrtl(scatter / counted),
                     8 * U * rmse + own);
        assert_true(got.mean_square == got.rmse * got.rmse);
        unmake(&made);
    }
}

/// Every reason to leave a particle out is counted under its name, and nothing that is left out
/// shows in a norm.
static void test_exclusions(void **state)
{
    (void)state;
    random_start("exclusions");
    enum { COUNT = 5000 };
    struct made_up made;
    make(&made, COUNT);
    size_t excluded[SPHV_FAULTS] = {0}, undefined = 0;
    for (size_t n = 0; n < COUNT; n++) {
        long kind = random_integer(0, 2 * SPHV_FAULTS + 3);
        made.exact[n] = 1;
        made.array[0][n] = 3; // errors of 2
        if (kind < SPHV_FAULTS) {
            made.method.fault[n] = (unsigned char)kind;
            if (kind != SPHV_FAULT_NONE) {
                made.array[0][n] = kind % 2 ? 1e300 : NAN;
                if (kind % 3 == 0) made.exact[n] = NAN; // a fault goes first
                excluded[kind]++;
            }
        } else if (kind == SPHV_FAULTS) {
            made.exact[n] = n % 2 ? NAN : INFINITY;
            undefined++;
        } else if (kind == SPHV_FAULTS + 1) {
            made.array[0][n] = n % 2 ? NAN : -INFINITY; // not to be had; still never a NaN
            excluded[SPHV_FAULT_NOT_FINITE]++;
        } else if (kind == SPHV_FAULTS + 2) {
            made.array[0][n] = DBL_MAX; // the error overflows
            made.exact[n] = -DBL_MAX;
            excluded[SPHV_FAULT_NOT_FINITE]++;
        }
    }
    sphv_norms got = norms_of(&made, 0);
    size_t left = COUNT - undefined;
    for (int f = 0; f < SPHV_FAULTS; f++) {
        assert_int_equal(got.excluded[f], excluded[f]);
        left -= excluded[f];
    }
    assert_int_equal(got.exact_undefined, undefined);
    assert_int_equal(got.counted, left);
    assert_close(got.rmse, 2, 0);
    assert_close(got.mae, 2, 0);
    assert_close(got.maximum, 2, 0);
    assert_close(got.standard_deviation, 0, 0);
    // Nothing left: zeros, and a count that says so.
    memset(made.method.fault, SPHV_FAULT_SINGULAR, COUNT);
    got = norms_of(&made, 0);
    assert_int_equal(got.counted, 0);
    assert_int_equal(got.excluded[SPHV_FAULT_SINGULAR], COUNT);
    for (int i = 0; i < 6; i++) {
        const double all[] = {got.rmse,        got.mae,   got.maximum,
                              got.mean_square, got.bound, got.standard_deviation};
        assert_close(all[i], 0, 0);
    }
    unmake(&made);
}

/// Where exactly the margin's edge is, and estimates without any error.
static void test_edges(void **state)
{
    (void)state;
    random_start("edges of norms");
    struct made_up made;
    make(&made, 5);
    // Rounding does not part what stands on the margin; what is 4e-12 of it beyond does not count.
    static const double x[] = {0.25 - 0x1p-54, 0.75 + 0x1p-53, 0.25 - 1e-12, 0.75 + 1e-12, 0.5};
    for (size_t n = 0; n < 5; n++) {
        made.particles.x[0][n] = x[n];
        made.particles.x[1][n] = 0.5;
    }
    made.rounding[0] = 1e-9;
    sphv_norms got = norms_of(&made, 0.25);
    assert_int_equal(got.counted, 3);
    assert_close(got.rmse, 0, 0);
    assert_close(got.bound, 1e-9, 0);
    assert_int_equal(norms_of(&made, 0.5).counted, 1);
    assert_int_equal(norms_of(&made, 0.51).counted, 0);
    unmake(&made);
}

/// The same bits for any number of threads.
static void test_threads(void **state)
{
    (void)state;
    random_start("threads of norms");
    struct made_up made;
    int before = omp_get_max_threads();
    make(&made, 30000);
    for (size_t n = 0; n < 30000; n++) made.array[0][n] = random_uniform(-1, 1);
    omp_set_num_threads(1);
    sphv_norms one = norms_of(&made, 0);
    for (int threads = 2; threads <= 5; threads++) {
        omp_set_num_threads(threads);
        sphv_norms many = norms_of(&made, 0);
        assert_memory_equal(&one, &many, sizeof one);
    }
    omp_set_num_threads(before);
    unmake(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_long_double),
        cmocka_unit_test(test_exclusions),
        cmocka_unit_test(test_edges),
        cmocka_unit_test(test_threads),
    };
    return run_group(tests);
}
