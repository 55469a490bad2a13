/// The direct route of the sums against every pair of particles, within the bounds of both: each
/// sum of each level, for random and awkward particles and every shipped kernel.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../empirical/sums/evaluation.h"
#include "../../empirical/sums/pass.h"
#include "support.h"

#ifdef _OPENMP
#include <omp.h>
#endif

enum { COUNT_MAX = 4096, FIELDS = 3 };

static sphv_catalogue catalogue;

/// Particles with fields, made for a test.
struct cloud {
    sphv_particles particles;
    double x[SPHV_DIMENSIONS][COUNT_MAX], volume[COUNT_MAX], field[FIELDS][COUNT_MAX];
    const double *fields[FIELDS];
};

static struct cloud *cloud_make(int dimension, size_t count)
{
    struct cloud *cloud = calloc(1, sizeof *cloud);
    assert_non_null(cloud);
    assert_true(count <= COUNT_MAX);
    cloud->particles = (sphv_particles){.dimension = dimension, .count = count};
    for (int i = 0; i < dimension; i++) cloud->particles.x[i] = cloud->x[i];
    cloud->particles.volume = cloud->volume;
    for (size_t b = 0; b < count; b++) {
        for (int i = 0; i < dimension; i++) cloud->x[i][b] = random_uniform(0, 1);
        cloud->volume[b] = random_uniform(0.5, 1.5) / (double)count;
        for (int f = 0; f < FIELDS; f++) cloud->field[f][b] = random_uniform(-1, 3);
    }
    for (int f = 0; f < FIELDS; f++) cloud->fields[f] = cloud->field[f];
    return cloud;
}

/// All sums of all particles.
struct sums {
    sphv_sum_layout layout;
    double *sum; ///< [particle * layout.count + sum]
    double rounding[COUNT_MAX];
    unsigned neighbours[COUNT_MAX];
    double spread[FIELDS], pairs, tested;
};

static void keep(void *watcher, const sphv_sum_block *block)
{
    struct sums *into = watcher;
    for (size_t i = 0; i < block->count; i++) {
        size_t a = block->particle[i];
        into->rounding[a] = block->rounding[i];
        into->neighbours[a] = block->neighbours[i];
        for (int k = 0; k < into->layout.count; k++)
            into->sum[a * (size_t)into->layout.count + (size_t)k] =
                block->sums[(size_t)k * block->stride + i];
    }
}

static struct sums *sum(const struct cloud *cloud, const sphv_profile *profile, double h,
                        sphv_sum_level level, int fields, sphv_route route,
                        const sphv_pass_set *passes)
{
    const sphv_particles *particles = &cloud->particles;
    struct sums *sums = calloc(1, sizeof *sums);
    assert_non_null(sums);
    unsigned *neighbours = calloc(particles->count + 1, sizeof *neighbours);
    sums->layout = sphv_sum_layout_make(particles->dimension, level, fields);
    sums->sum = calloc(particles->count * (size_t)sums->layout.count + 1, sizeof(double));
    assert_non_null(sums->sum);
    sphv_request request = {.profile = profile,
                            .h = h,
                            .field_count = (size_t)fields,
                            .fields = cloud->fields,
                            .route = route};
    sphv_estimates out = {
        .count = particles->count, .field_count = (size_t)fields, .neighbours = neighbours};
    for (int f = 0; f < FIELDS; f++) {
        sums->spread[f] = 0;
        for (size_t a = 0; a < particles->count; a++)
            sums->spread[f] = fmax(sums->spread[f], 2 * fabs(cloud->field[f][a]));
    }
    sphv_evaluation evaluation = {.particles = particles,
                                  .request = &request,
                                  .layout = sums->layout,
                                  .spread = sums->spread,
                                  .out = &out,
                                  .watch = keep,
                                  .watcher = sums,
                                  .passes = passes};
    sphv_error error;
    if (route == SPHV_ROUTE_BRUTE_FORCE)
        assert_ok(sphv_evaluate_brute_force(&evaluation, &error), error);
    else
        assert_ok(sphv_evaluate_direct(&evaluation, &error), error);
    sums->pairs = out.pairs;
    sums->tested = out.tested;
    assert_memory_equal(neighbours, sums->neighbours, particles->count * sizeof *neighbours);
    free(neighbours);
    return sums;
}

static void sums_free(struct sums *sums)
{
    free(sums->sum);
    free(sums);
}

/// Compares sums Σ v p_k s^α (δA) with their bounds: |s^α/q^m| <= κ^(|α| − m).
static void compare_degrees(const struct sums *found, const struct sums *expected, size_t a, int k,
                            sphv_degrees degrees, int field, double support, const char *what)
{
    const sphv_sum_layout *layout = &found->layout;
    const sphv_monomial *monomials = sphv_monomials(layout->dimension);
    const double *got = found->sum + a * (size_t)layout->count;
    const double *want = expected->sum + a * (size_t)layout->count;
    int lowest = sphv_sum_sets[layout->level].moment[k].from;
    double size = found->rounding[a] * got[layout->size_at + k] +
                  expected->rounding[a] * want[layout->size_at + k];
    for (int j = (int)sphv_monomial_count(layout->dimension, degrees.from - 1);
         j < (int)sphv_monomial_count(layout->dimension, degrees.to); j++) {
        int at =
            field < 0 ? sphv_moment_index(layout, k, j) : sphv_field_sum_index(layout, field, k, j);
        double bound = size * pow(support, monomials[j].degree - lowest) *
                       (field < 0 ? 1 : found->spread[field]);
        if (!is_close(got[at], want[at], bound))
            print_error("%s: level %d, particle %zu, p_%d, monomial %d, field %d\n", what,
                        (int)layout->level, a, k, j, field);
        assert_close(got[at], want[at], bound);
        // A bound that says nothing would let everything pass.
        assert_true(bound <= 1e-9 * (got[layout->size_at + k] + want[layout->size_at + k]) *
                                 pow(support, monomials[j].degree - lowest) *
                                 (field < 0 ? 1 : found->spread[field]));
    }
}

static void compare(const struct cloud *cloud, const sphv_profile *profile, double h,
                    sphv_sum_level level, int fields, const sphv_pass_set *passes, const char *what)
{
    struct sums *found = sum(cloud, profile, h, level, fields, SPHV_ROUTE_DIRECT, passes);
    struct sums *expected = sum(cloud, profile, h, level, fields, SPHV_ROUTE_BRUTE_FORCE, NULL);
    assert_memory_equal(found->neighbours, expected->neighbours,
                        cloud->particles.count * sizeof *found->neighbours);
    assert_true(found->pairs == expected->pairs);
    assert_true(found->tested >= found->pairs);
    const sphv_sum_set *set = &sphv_sum_sets[level];
    for (size_t a = 0; a < cloud->particles.count; a++)
        for (int k = 0; k < 3; k++) {
            compare_degrees(found, expected, a, k, set->moment[k], -1, profile->support, what);
            for (int f = 0; f < fields; f++)
                compare_degrees(found, expected, a, k, set->field[k], f, profile->support, what);
        }
    sums_free(found);
    sums_free(expected);
}

/// Every kernel in every dimension it is made for, every level, one to three fields, every
/// instruction set of this processor.
static void test_kernels(void **state)
{
    (void)state;
    random_start("engine kernels");
    for (int d = 1; d <= 3; d++) {
        struct cloud *cloud = cloud_make(d, quick() ? 40 : 130);
        for (size_t k = 0; k < catalogue.count; k++) {
            const sphv_profile *profile = sphv_kernel_profile(catalogue.kernels[k], d);
            if (!profile) continue;
            double reach = random_uniform(0.15, 0.5);
            for (int level = 0; level < SPHV_SUM_LEVELS; level++) {
                int fields = (int)random_integer(0, FIELDS);
                for (const sphv_pass_set *const *set = sphv_pass_sets(); *set; set++)
                    compare(cloud, profile, reach / profile->support, (sphv_sum_level)level, fields,
                            *set, sphv_kernel_name(catalogue.kernels[k]));
            }
        }
        free(cloud);
    }
}

int main(void)
{
    sphv_error error;
    tests_begin();
    if (sphv_catalogue_load(data_directory(), &catalogue, &error) != SPHV_OK) {
        print_error("%s\n", error.message);
        return 1;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kernels),
    };
    int failed = cmocka_run_group_tests_name("engine", tests, NULL, NULL);
    sphv_catalogue_free(&catalogue);
    return failed;
}
