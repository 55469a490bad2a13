/// The direct route of the sums against every pair of particles, within the bounds of both: each
/// sum of each level, for random and awkward particles and every shipped kernel.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../empirical/sums/evaluation.h"
#include "../../empirical/sums/half_pairs.h"
#include "../../empirical/sums/pass.h"
#include "support.h"

#ifdef _OPENMP
#include <omp.h>
#endif

enum { COUNT_MAX = 4096, FIELDS = 3 };

static sphv_catalogue catalogue;
static int halves; ///< comparisons of pairs that were visited once

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
    bool refused; ///< the kernel is not one that half pairs take
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
    sphv_status status = route == SPHV_ROUTE_BRUTE_FORCE
                             ? sphv_evaluate_brute_force(&evaluation, &error)
                         : level == SPHV_SUMS_PLAIN ? sphv_evaluate_half_pairs(&evaluation, &error)
                                                    : sphv_evaluate_direct(&evaluation, &error);
    sums->refused = level == SPHV_SUMS_PLAIN && status == SPHV_NO_CLOSED_FORM;
    if (!sums->refused) assert_ok(status, error);
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

static void compare_sums(const struct sums *found, const struct sums *expected,
                         const struct cloud *cloud, double support, int fields, const char *what)
{
    assert_memory_equal(found->neighbours, expected->neighbours,
                        cloud->particles.count * sizeof *found->neighbours);
    assert_true(found->pairs == expected->pairs);
    assert_true(found->tested >= found->pairs);
    const sphv_sum_set *set = &sphv_sum_sets[found->layout.level];
    for (size_t a = 0; a < cloud->particles.count; a++)
        for (int k = 0; k < 3; k++) {
            compare_degrees(found, expected, a, k, set->moment[k], -1, support, what);
            for (int f = 0; f < fields; f++)
                compare_degrees(found, expected, a, k, set->field[k], f, support, what);
        }
}

/// \param passes the instruction sets to try, up to NULL; or NULL: the one that would be chosen
static void compare(const struct cloud *cloud, const sphv_profile *profile, double h,
                    sphv_sum_level level, int fields, const sphv_pass_set *const *passes,
                    const char *what)
{
    struct sums *expected = sum(cloud, profile, h, level, fields, SPHV_ROUTE_BRUTE_FORCE, NULL);
    do {
        struct sums *found =
            sum(cloud, profile, h, level, fields, SPHV_ROUTE_DIRECT, passes ? *passes : NULL);
        if (!found->refused) compare_sums(found, expected, cloud, profile->support, fields, what);
        halves += level == SPHV_SUMS_PLAIN && !found->refused;
        sums_free(found);
    } while (passes && *++passes);
    sums_free(expected);
}

/// Every kernel in every dimension it is made for, every level, one to three fields, every
/// instruction set of this processor.
static void test_kernels(void **state)
{
    (void)state;
    random_start("engine kernels");
    for (int d = 1; d <= 3; d++) {
        struct cloud *cloud = cloud_make(d, quick() ? 20 : 70);
        for (size_t k = 0; k < catalogue.count; k++) {
            const sphv_profile *profile = sphv_kernel_profile(catalogue.kernels[k], d);
            if (!profile) continue;
            double reach = random_uniform(0.15, 0.5);
            for (int level = d > 1 ? SPHV_SUMS_PLAIN : SPHV_SUMS_STANDARD; level < SPHV_SUM_LEVELS;
                 level++) {
                int fields = (int)random_integer(0, FIELDS);
                if (level == SPHV_SUMS_PLAIN) fields = (int)random_integer(1, SPHV_PASS_FIELDS);
                compare(cloud, profile, reach / profile->support, (sphv_sum_level)level, fields,
                        sphv_pass_sets(), sphv_kernel_name(catalogue.kernels[k]));
            }
        }
        free(cloud);
    }
}

static const sphv_profile *profile_of(const char *name, int dimension)
{
    for (size_t k = 0; k < catalogue.count; k++)
        if (strcmp(sphv_kernel_name(catalogue.kernels[k]), name) == 0)
            return sphv_kernel_profile(catalogue.kernels[k], dimension);
    fail_msg("no kernel %s", name);
    return NULL;
}

/// Layouts that cells do not like.
enum awkward {
    LATTICE,    ///< distances that are equal, and pairs on the edge of the support
    CLUSTERED,  ///< nearly all in one cell
    COINCIDENT, ///< each place taken by several
    COLLINEAR,  ///< no volume
    FAR_APART,  ///< more than a support
    HUGE_SCALE, ///< lengths of 1e30
    TINY_SCALE, ///< lengths of 1e-30
    DISTANT,    ///< far from the origin
    NEGATIVE,   ///< volumes of either sign
    AWKWARD
};

static double arrange(struct cloud *cloud, enum awkward kind)
{
    size_t side =
        (size_t)ceil(pow((double)cloud->particles.count, 1.0 / cloud->particles.dimension));
    double scale = kind == HUGE_SCALE ? 1e30 : kind == TINY_SCALE ? 1e-30 : 1;
    for (size_t b = 0; b < cloud->particles.count; b++) {
        size_t cell = b;
        for (int i = 0; i < cloud->particles.dimension; i++, cell /= side) {
            double *x = &cloud->x[i][b];
            if (kind == LATTICE) *x = (double)(cell % side) * 0.0625;
            if (kind == CLUSTERED && b > 2) *x = 0.5 + 1e-3 * *x;
            if (kind == COINCIDENT) *x = cloud->x[i][b / 3 * 3];
            if (kind == COLLINEAR) *x = i ? 0.25 * (double)i : *x;
            if (kind == DISTANT) *x += 1e6;
            *x *= scale;
        }
        if (kind == NEGATIVE && b % 2) cloud->volume[b] *= -1;
    }
    double reach[AWKWARD] = {0.25, 1e-3, 0.3, 0.3, 1e-6, 0.3, 0.3, 0.3, 0.3};
    return reach[kind] * scale;
}

static void test_awkward(void **state)
{
    (void)state;
    random_start("engine awkward");
    static const char *const names[] = {"sigalotti-wendland-c4", "cubic-spline", "quintic-spline",
                                        "gaussian"};
    for (int d = 1; d <= 3; d++)
        for (int kind = 0; kind < AWKWARD; kind++) {
            struct cloud *cloud = cloud_make(d, quick() ? 30 : 100);
            double reach = arrange(cloud, (enum awkward)kind);
            for (int k = 0; k < 4; k++) {
                const sphv_profile *profile = profile_of(names[k], d);
                static const sphv_sum_level levels[] = {SPHV_SUMS_PLAIN, SPHV_SUMS_STANDARD,
                                                        SPHV_SUMS_SECOND};
                for (int l = d > 1 ? 0 : 1; l < 3; l++)
                    compare(cloud, profile, reach / profile->support, levels[l], 2, NULL, names[k]);
            }
            free(cloud);
        }
}

static void test_few(void **state)
{
    (void)state;
    random_start("engine few");
    for (int d = 1; d <= 3; d++)
        for (size_t count = 0; count < 12; count++) {
            struct cloud *cloud = cloud_make(d, count);
            compare(cloud, profile_of("wendland-c2", d), random_log(0.01, 10), SPHV_SUMS_FIRST, 1,
                    NULL, "few");
            if (d > 1 && count > 0)
                compare(cloud, profile_of("wendland-c2", d), random_log(0.01, 10), SPHV_SUMS_PLAIN,
                        1, NULL, "few");
            free(cloud);
        }
}

static void test_periodic(void **state)
{
    (void)state;
    random_start("engine periodic");
    for (int d = 1; d <= 3; d++)
        for (int i = 0; i < 4; i++) {
            struct cloud *cloud = cloud_make(d, quick() ? 40 : 150);
            cloud->particles.periodic = true;
            for (size_t b = 0; i == 0 && b < cloud->particles.count; b++)
                for (int j = 0; j < d; j++) cloud->x[j][b] = floor(16 * cloud->x[j][b]) / 16;
            if (i == 1) cloud->x[0][0] = 0;
            compare(cloud, profile_of("sigalotti-wendland-c4", d), random_uniform(0.05, 0.499),
                    SPHV_SUMS_FIRST, 2, NULL, "periodic");
            free(cloud);
        }
}

/// More particles than a few blocks, and ranges longer than what is copied (2048) or summed in one
/// go.
static void test_large(void **state)
{
    (void)state;
    random_start("engine large");
    for (int d = 1; d <= 3; d++) {
        struct cloud *cloud = cloud_make(d, quick() ? 300 : 2200);
        const sphv_profile *profile = profile_of("sigalotti-wendland-c4", d);
        for (int i = 0; i < 2; i++)
            compare(cloud, profile, i ? 2 : 0.2, SPHV_SUMS_STANDARD, 1, NULL, "large");
        for (int fields = 1; d > 1 && fields <= SPHV_PASS_FIELDS; fields++)
            compare(cloud, profile, random_log(0.1, 1), SPHV_SUMS_PLAIN, fields, sphv_pass_sets(),
                    "large");
        free(cloud);
    }
    assert_true(halves > 0);
}

#ifdef _OPENMP
/// The same bits for one thread and several.
static void test_threads(void **state)
{
    (void)state;
    if (quick()) skip(); // valgrind takes the threads that OpenMP keeps for a leak
    random_start("engine threads");
    static const sphv_sum_level levels[] = {SPHV_SUMS_PLAIN, SPHV_SUMS_FIRST};
    int before = omp_get_max_threads();
    struct cloud *cloud = cloud_make(2, COUNT_MAX);
    for (int l = 0; l < 2; l++) {
        struct sums *sums[2];
        for (int i = 0; i < 2; i++) {
            omp_set_num_threads(i ? 3 : 1);
            sums[i] = sum(cloud, profile_of("sigalotti-wendland-c4", 2), 0.11, levels[l], 2,
                          SPHV_ROUTE_DIRECT, NULL);
        }
        omp_set_num_threads(before);
        size_t size = cloud->particles.count * (size_t)sums[0]->layout.count * sizeof(double);
        assert_memory_equal(sums[0]->sum, sums[1]->sum, size);
        assert_memory_equal(sums[0]->rounding, sums[1]->rounding, sizeof sums[0]->rounding);
        assert_true(sums[0]->tested == sums[1]->tested && sums[0]->pairs == sums[1]->pairs);
        for (int i = 0; i < 2; i++) sums_free(sums[i]);
    }
    free(cloud);
}
#endif

static sphv_status estimate(const struct cloud *cloud, double h, sphv_error *error)
{
    static const sphv_method methods[] = {SPHV_SPH, SPHV_FPM};
    sphv_request request = {.profile = profile_of("wendland-c4", cloud->particles.dimension),
                            .h = h,
                            .method_count = 2,
                            .methods = methods,
                            .field_count = 2,
                            .fields = cloud->fields,
                            .route = SPHV_ROUTE_DIRECT};
    sphv_estimates out;
    sphv_status status =
        sphv_estimate_particles(&cloud->particles, &request, NULL, NULL, &out, error);
    if (status == SPHV_OK) sphv_estimates_free(&out);
    return status;
}

/// Standard SPH alone with many neighbours: the choice falls on half pairs, whose estimates are
/// those of every pair within both bounds.
static void test_half_pairs(void **state)
{
    (void)state;
    random_start("engine half pairs");
    static const sphv_method method = SPHV_SPH;
    for (int d = 2; d <= 3; d++) {
        struct cloud *cloud = cloud_make(d, 600);
        sphv_request request = {.profile = profile_of("sigalotti-wendland-c4", d),
                                .h = d == 2 ? 0.35 : 0.45,
                                .method_count = 1,
                                .methods = &method,
                                .field_count = 2,
                                .fields = cloud->fields};
        static const sphv_route routes[] = {SPHV_ROUTE_DIRECT, SPHV_ROUTE_BRUTE_FORCE};
        sphv_estimates out[2];
        sphv_error error;
        for (int i = 0; i < 2; i++) {
            request.route = routes[i];
            assert_ok(
                sphv_estimate_particles(&cloud->particles, &request, NULL, NULL, &out[i], &error),
                error);
        }
        // Not all pairs were tested.
        assert_true(out[0].pairs == out[1].pairs && out[0].tested < out[1].tested);
        const sphv_method_estimates *found = &out[0].methods[0], *expected = &out[1].methods[0];
        for (size_t q = 0; q < 2 * found->quantities; q++)
            for (size_t a = 0; a < 600; a++)
                assert_close(found->estimate[q][a], expected->estimate[q][a],
                             found->rounding[q] + expected->rounding[q]);
        for (int i = 0; i < 2; i++) sphv_estimates_free(&out[i]);
        free(cloud);
    }
}

static void test_refusals(void **state)
{
    (void)state;
    random_start("engine refusals");
    struct cloud *cloud = cloud_make(2, 50);
    sphv_error error;
    assert_ok(estimate(cloud, 0.1, &error), error);
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        double *places[] = {&cloud->x[1][7], &cloud->volume[7], &cloud->field[1][7]};
        static const char *const what[] = {"coordinate", "volume", "field"};
        for (int k = 0; k < 3; k++) {
            double sound = *places[k];
            *places[k] = bad[i];
            assert_failed(estimate(cloud, 0.1, &error), &error, SPHV_INVALID_INPUT, what[k]);
            *places[k] = sound;
        }
        assert_failed(estimate(cloud, bad[i], &error), &error, SPHV_INVALID_INPUT, "smoothing");
    }
    static const double lengths[] = {0, -1, 1e-200, 1e200};
    for (int i = 0; i < 4; i++)
        assert_failed(estimate(cloud, lengths[i], &error), &error, SPHV_INVALID_INPUT, "smoothing");
    cloud->particles.periodic = true;
    assert_failed(estimate(cloud, 0.3, &error), &error, SPHV_INVALID_INPUT, "periodic");
    cloud->x[1][3] = -0.25;
    assert_failed(estimate(cloud, 0.1, &error), &error, SPHV_INVALID_INPUT, "outside");
    cloud->particles.periodic = false;
    cloud->x[0][3] = 1e18;
    assert_failed(estimate(cloud, 0.1, &error), &error, SPHV_INVALID_INPUT, "spread");
    free(cloud);
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
        cmocka_unit_test(test_kernels),    cmocka_unit_test(test_awkward),
        cmocka_unit_test(test_few),        cmocka_unit_test(test_periodic),
        cmocka_unit_test(test_large),      cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_half_pairs),
#ifdef _OPENMP
        cmocka_unit_test(test_threads),
#endif
    };
    int failed = cmocka_run_group_tests_name("engine", tests, NULL, NULL);
    sphv_catalogue_free(&catalogue);
    return failed;
}
