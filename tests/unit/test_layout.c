/// Particle layouts: the random numbers behind them, and neighbourhoods and volumes against brute
/// force over a much wider range of particles.
#include "../../empirical/layout.h"

#include <Random123/philox.h>
#include <float.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../empirical/random.h"
#include "support.h"

#define U (DBL_EPSILON / 2)

/// Philox 4x32 of ten rounds as Salmon, Moraes, Dror and Shaw 2011 (SC11), sections 3.3 and 4.3,
/// define it: written from the paper, not from the library.
static void philox_by_hand(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4])
{
    uint32_t x[4], k[2] = {key[0], key[1]};
    memcpy(x, counter, sizeof x);
    for (int i = 0; i < 10; i++) {
        uint64_t a = (uint64_t)0xD2511F53u * x[0], b = (uint64_t)0xCD9E8D57u * x[2];
        uint32_t next[4] = {(uint32_t)(b >> 32) ^ x[1] ^ k[0], (uint32_t)b,
                            (uint32_t)(a >> 32) ^ x[3] ^ k[1], (uint32_t)a};
        memcpy(x, next, sizeof x);
        k[0] += 0x9E3779B9u;
        k[1] += 0xBB67AE85u;
    }
    memcpy(out, x, sizeof x);
}

/// The known answers that Random123 is published with (its file tests/kat_vectors).
static void test_known_answers(void **state)
{
    (void)state;
    static const uint32_t known[][10] = {
        {0, 0, 0, 0, 0, 0, 0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8},
        {0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0x408f276d,
         0x41c83b0e, 0xa20bc7c6, 0x6d5451fd},
        {0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344, 0xa4093822, 0x299f31d0, 0xd16cfe09,
         0x94fdcceb, 0x5001e420, 0x24126ea1},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        uint32_t out[4];
        philox_by_hand(known[i], known[i] + 4, out);
        assert_memory_equal(out, known[i] + 6, sizeof out);
        philox4x32_ctr_t counter;
        philox4x32_key_t key;
        memcpy(counter.v, known[i], sizeof counter.v);
        memcpy(key.v, known[i] + 4, sizeof key.v);
        philox4x32_ctr_t library = philox4x32(counter, key);
        assert_memory_equal(library.v, known[i] + 6, sizeof library.v);
    }
}

/// Counter = (index, realisation, tag), key = seed: nothing else may enter.
static void test_numbers_are_functions_of_seed_realisation_index(void **state)
{
    (void)state;
    random_start("random numbers");
    for (int l = 0; l < 2000; l++) {
        uint64_t seed =
            (uint64_t)random_integer(0, 1L << 31) << 32 ^ (uint64_t)random_integer(0, 0xffffffffL);
        int realisation = (int)random_integer(0, 1 << 30);
        long index = random_integer(-1000, 1000) * (l % 2 ? 1 : 1L << 35);
        const uint32_t counter[4] = {(uint32_t)(uint64_t)index, (uint32_t)((uint64_t)index >> 32),
                                     (uint32_t)realisation, 0x53504856u};
        const uint32_t key[2] = {(uint32_t)seed, (uint32_t)(seed >> 32)};
        uint32_t v[4];
        philox_by_hand(counter, key, v);
        long double first = ((long double)(((uint64_t)v[0] << 32 | v[1]) >> 12) + 0.5L) / 0x1p52L;
        long double second = ((long double)(((uint64_t)v[2] << 32 | v[3]) >> 12) + 0.5L) / 0x1p52L;
        assert_close(sphv_uniform(seed, realisation, index), (double)first, 0);
        long double normal = sqrtl(-2 * logl(first)) * cosl(2 * acosl(-1.0L) * second);
        // 2π u is off by 2u of at most 2π, cosine by u, root and logarithm by 3u, all times 8.6
        assert_close(sphv_normal(seed, realisation, index), (double)normal,
                     8.6 * (4 * M_PI + 4) * U);
    }
}

enum { NUMBERS = 1000000 };

/// Five standard deviations of each statistic: one seed in 10^5 would fail this test.
static void test_normal_numbers(void **state)
{
    (void)state;
    random_start("normal numbers");
    uint64_t seed = (uint64_t)random_integer(0, 1L << 40);
    double n = quick() ? NUMBERS / 50 : NUMBERS, sum[5] = {0}, largest = 0, previous = 0;
    double along_index = 0, along_realisation = 0, along_seed = 0, counts[16] = {0};
    for (long i = 0; i < (long)n; i++) {
        double x = sphv_normal(seed, 0, i), power = x;
        for (int k = 1; k <= 4; k++, power *= x) sum[k] += power / n;
        largest = fmax(largest, fabs(x));
        along_index += x * previous / n;
        previous = x;
        if (i % 4 == 0) {
            along_realisation += 4 * x * sphv_normal(seed, 1, i) / n;
            along_seed += 4 * x * sphv_normal(seed + 1, 0, i) / n;
        }
        counts[(int)(16 * 0.5 * erfc(-x / M_SQRT2))] += 1;
    }
    // Moments of x^k: variances 1, 3 − 1, 15, 105 − 9
    assert_close(sum[1], 0, 5 * sqrt(1 / n));
    assert_close(sum[2], 1, 5 * sqrt(2 / n));
    assert_close(sum[3], 0, 5 * sqrt(15 / n));
    assert_close(sum[4], 3, 5 * sqrt(96 / n));
    assert_close(along_index, 0, 5 * sqrt(1 / n));
    assert_close(along_realisation, 0, 5 * sqrt(4 / n));
    assert_close(along_seed, 0, 5 * sqrt(4 / n));
    // P(|x| < 3) to the power of 20000 is 1e-24
    assert_true(largest < 8.6 && largest > 3);
    // Equal shares: χ² with 15 degrees of freedom exceeds 55 with probability 2e-6
    double chi = 0;
    for (int i = 0; i < 16; i++) chi += gsl_pow_2(counts[i] - n / 16) / (n / 16);
    assert_true(chi < 55);
}

/// One experiment with all that brute force needs.
struct scene {
    sphv_experiment of;
    sphv_kernel *kernel;
};

static void make(struct scene *scene, const char *kernel, sphv_layout layout, sphv_volume volume,
                 double sigma, double spacing, double h)
{
    scene->kernel = load_kernel(kernel);
    scene->of = (sphv_experiment){.profile = sphv_kernel_profile(scene->kernel, 1),
                                  .h = h,
                                  .spacing = sphv_number_from_double(spacing),
                                  .method = SPHV_SPH,
                                  .layout = layout,
                                  .volume = volume,
                                  .sigma = sigma,
                                  .seed = (uint64_t)random_integer(0, 1L << 40),
                                  .width = 0.1,
                                  .realisations_min = 2,
                                  .realisations_max = 2};
}

/// All positions in units of h relative to particle `index`, from a range of indices far wider than
/// any that can matter, sorted.
static size_t all_positions(const sphv_cloud *cloud, long index, double **out)
{
    const sphv_experiment *of = cloud->experiment;
    if (cloud->x) {
        double *x = malloc((size_t)cloud->stored * sizeof *x);
        assert_non_null(x);
        for (long i = 0; i < cloud->stored; i++)
            x[i] = (cloud->x[i] - cloud->x[cloud->first + index]) / of->h;
        *out = x;
        return (size_t)cloud->stored;
    }
    long side = (long)(3 * of->profile->support / of->spacing.value) + 50 + (long)(60 * of->sigma);
    double *x = malloc((size_t)(2 * side + 1) * sizeof *x);
    assert_non_null(x);
    long double own = sphv_normal(of->seed, cloud->realisation, index);
    for (long j = -side; j <= side; j++)
        x[j + side] =
            (double)(((long double)j +
                      (long double)of->sigma *
                          ((long double)sphv_normal(of->seed, cloud->realisation, index + j) -
                           own)) *
                     (long double)of->spacing.value);
    gsl_sort(x, 1, (size_t)(2 * side + 1));
    *out = x;
    return (size_t)(2 * side + 1);
}

static double steepest(const sphv_profile *profile)
{
    double most = 0;
    for (int i = 0; i < profile->piece_count; i++)
        most = fmax(most, profile->pieces[i].derivative_bound[1]);
    return most;
}

/// The volume of x[b] with its uncertainty, when positions are uncertain by `off`.
static sphv_result brute_volume(const sphv_experiment *of, const double *x, size_t count, size_t b,
                                double off)
{
    const sphv_profile *profile = of->profile;
    if (of->volume == SPHV_VOLUME_TESSELLATED)
        return (sphv_result){(x[b + 1] - x[b - 1]) / 2, off + U * fabs(x[b + 1])};
    if (of->volume != SPHV_VOLUME_DENSITY) return (sphv_result){of->spacing.value, 0};
    double sum = 0, bound = 0, slope = steepest(profile);
    for (size_t c = 0; c < count; c++) {
        double distance = fabs(x[c] - x[b]);
        if (!(distance < profile->support)) continue;
        sphv_result value = sphv_profile_derivative(profile, 0, distance);
        sum += value.value;
        bound += 2 * value.bound + 2 * slope * off + 200 * U * fabs(value.value);
    }
    return (sphv_result){1 / sum, 1.01 * bound / (sum * sum) + 4 * U / sum};
}

static void compare(const sphv_cloud *cloud, long index, sphv_neighbourhood *around)
{
    const sphv_experiment *of = cloud->experiment;
    assert_int_equal(sphv_cloud_neighbourhood(cloud, index, around), SPHV_OK);
    double *x;
    size_t count = all_positions(cloud, index, &x);
    // (|j| + σ(ξ_j − ξ_0)) Δs in a few operations; stored positions come of one subtraction
    double reach = 3 * of->profile->support / of->spacing.value + 40 * of->sigma;
    double off = cloud->x ? 0 : 8 * U * reach * of->spacing.value;
    assert_true(around->self >= 0 && around->self < around->count);
    assert_close(around->s[around->self], 0, 0);
    int met = 0;
    bool zero_seen = false;
    for (size_t b = 1; b + 1 < count; b++) {
        zero_seen = zero_seen || x[b] == 0;
        if (!(fabs(x[b]) < of->profile->support - off)) continue;
        if (met >= around->count)
            fail_msg("a neighbour at %.17g is missing (Δs = %g, σ = %g, layout %d)", x[b],
                     of->spacing.value, of->sigma, (int)of->layout);
        sphv_result volume = brute_volume(of, x, count, b, off);
        if (!is_close(around->s[met], x[b], off) ||
            !is_close(around->volume[met], volume.value, volume.bound))
            fail_msg("neighbour %d of particle %ld is at %.17g with volume %.17g; brute force: at "
                     "%.17g with %.17g (Δs = %g, σ = %g, layout %d, rule %d, seed %lu)",
                     met, index, around->s[met], around->volume[met], x[b], volume.value,
                     of->spacing.value, of->sigma, (int)of->layout, (int)of->volume,
                     (unsigned long)of->seed);
        met++;
    }
    assert_true(zero_seen);
    assert_int_equal(met, around->count);
    free(x);
}

/// Nothing within the support is missing, nothing else is there, in order, with the right volume.
static void test_neighbourhoods_by_brute_force(void **state)
{
    (void)state;
    random_start("neighbourhoods");
    static const char *const kernels[] = {"quinlan-w10", "gaussian", "sigalotti-wendland-c4"};
    static const double sigmas[] = {0.02, 0.2, 0.5, 2, 10};
    sphv_neighbourhood around = {0};
    int rounds = quick() ? 1 : 12;
    for (int layout = SPHV_LATTICE; layout <= SPHV_RANDOM; layout++)
        for (int rule = SPHV_VOLUME_LATTICE; rule <= SPHV_VOLUME_UNIT; rule++)
            for (size_t k = 0; k < 3; k++)
                for (int l = 0; l < rounds; l++) {
                    struct scene scene;
                    make(&scene, kernels[k], (sphv_layout)layout, (sphv_volume)rule, 0,
                         random_log(0.07, 0.99), random_log(0.002, 2));
                    scene.of.spacing.value *= scene.of.profile->support;
                    if (layout == SPHV_PERTURBED) scene.of.sigma = sigmas[l % 5];
                    sphv_cloud cloud;
                    sphv_error error = {SPHV_OK, ""};
                    assert_ok(sphv_cloud_make(&cloud, &scene.of, l, &error), error);
                    for (int i = 0; i < 10 && cloud.particles > 0; i++)
                        compare(&cloud, random_integer(0, cloud.particles - 1), &around);
                    sphv_cloud_free(&cloud);
                    sphv_kernel_free(scene.kernel);
                }
    sphv_neighbourhood_free(&around);
}

/// Tessellated volumes tile: their sum is the length from mid-way before the first particle to
/// mid-way behind the last.
static void test_tessellated_volumes_tile(void **state)
{
    (void)state;
    random_start("tiling");
    sphv_neighbourhood around = {0};
    for (int l = 0; l < (quick() ? 5 : 60); l++) {
        struct scene scene;
        make(&scene, "quinlan-w10", l % 3 ? SPHV_PERTURBED : SPHV_RANDOM, SPHV_VOLUME_TESSELLATED,
             l % 3 ? 0.2 : 0, random_log(0.1, 0.7), 0.02);
        sphv_cloud cloud;
        sphv_error error = {SPHV_OK, ""};
        assert_ok(sphv_cloud_make(&cloud, &scene.of, l, &error), error);
        long index = random_integer(0, cloud.particles - 1);
        assert_int_equal(sphv_cloud_neighbourhood(&cloud, index, &around), SPHV_OK);
        double *x, sum = 0;
        size_t count = all_positions(&cloud, index, &x), first = 0, last = count - 1;
        while (!(x[first] > -scene.of.profile->support)) first++;
        while (!(x[last] < scene.of.profile->support)) last--;
        for (int b = 0; b < around.count; b++) sum += around.volume[b];
        double length = (x[last] + x[last + 1]) / 2 - (x[first] + x[first - 1]) / 2;
        assert_close(sum, length, 8 * U * (around.count + 20) * length);
        free(x);
        sphv_cloud_free(&cloud);
        sphv_kernel_free(scene.kernel);
    }
    sphv_neighbourhood_free(&around);
}

/// A particle is at one place, whichever neighbour looks at it and in whatever order.
static void test_one_place_for_each_particle(void **state)
{
    (void)state;
    random_start("one place");
    struct scene scene;
    make(&scene, "quinlan-w10", SPHV_PERTURBED, SPHV_VOLUME_TESSELLATED, 0.2, 4.0 / 11, 0.02);
    sphv_cloud cloud;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_cloud_make(&cloud, &scene.of, 3, &error), error);
    sphv_neighbourhood here = {0}, there = {0}, again = {0};
    for (int l = 0; l < 100; l++) {
        long index = random_integer(0, cloud.particles - 1);
        assert_int_equal(sphv_cloud_neighbourhood(&cloud, index, &here), SPHV_OK);
        assert_int_equal(sphv_cloud_neighbourhood(&cloud, index + 1, &there), SPHV_OK);
        // seen from the next particle, this one stands where that one is seen from here
        bool seen = false;
        for (int b = 0; b < there.count; b++) {
            double distance = there.origin + there.s[b] * scene.of.h - here.origin;
            if (fabs(distance) > 16 * U * (1 + fabs(here.origin))) continue;
            seen = true;
            assert_close(there.volume[b], here.volume[here.self], 32 * U * 4);
        }
        assert_true(seen);
        assert_int_equal(sphv_cloud_neighbourhood(&cloud, index, &again), SPHV_OK);
        assert_int_equal(again.count, here.count);
        assert_memory_equal(again.s, here.s, (size_t)here.count * sizeof *here.s);
        assert_memory_equal(again.volume, here.volume, (size_t)here.count * sizeof *here.s);
    }
    // another realisation and another seed are other particles
    sphv_experiment other = scene.of;
    other.seed++;
    sphv_cloud clouds[2];
    assert_ok(sphv_cloud_make(&clouds[0], &scene.of, 4, &error), error);
    assert_ok(sphv_cloud_make(&clouds[1], &other, 3, &error), error);
    assert_int_equal(sphv_cloud_neighbourhood(&cloud, 7, &here), SPHV_OK);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(sphv_cloud_neighbourhood(&clouds[i], 7, &there), SPHV_OK);
        assert_true(there.origin != here.origin);
        sphv_cloud_free(&clouds[i]);
    }
    sphv_neighbourhood_free(&here);
    sphv_neighbourhood_free(&there);
    sphv_neighbourhood_free(&again);
    sphv_cloud_free(&cloud);
    sphv_kernel_free(scene.kernel);
}

/// Scattered layouts have the density asked for, evenly: Kolmogorov's distance of N uniform numbers
/// exceeds 2.7/√N with probability 1e-6; a Sobol sequence's is of order ln N/N.
static void test_scattered_positions(void **state)
{
    (void)state;
    random_start("scattered positions");
    for (int layout = SPHV_QUASI_RANDOM; layout <= SPHV_RANDOM; layout++)
        for (int l = 0; l < 8; l++) {
            struct scene scene;
            make(&scene, "quinlan-w10", (sphv_layout)layout, SPHV_VOLUME_LATTICE, 0,
                 random_log(0.1, 1), random_log(1e-3, 0.1));
            sphv_cloud cloud;
            sphv_error error = {SPHV_OK, ""};
            assert_ok(sphv_cloud_make(&cloud, &scene.of, l, &error), error);
            double n = (double)cloud.stored, step = scene.of.h * scene.of.spacing.value;
            double reach = -cloud.x[0], length = cloud.x[cloud.stored - 1] - cloud.x[0], worst = 0;
            assert_true(reach > 2 * 2 * scene.of.h && length > 1 + 4 * 2 * scene.of.h);
            for (long i = 0; i < cloud.stored; i++) {
                assert_true(i == 0 || cloud.x[i] >= cloud.x[i - 1]);
                worst = fmax(worst, fabs((cloud.x[i] - cloud.x[0]) / length - (double)i / n));
            }
            // the ends are taken from the sample itself: a few gaps
            if (layout == SPHV_RANDOM)
                assert_true(worst < 2.7 / sqrt(n) + 20 / n);
            else
                assert_true(worst < 2 * log2(n) / n);
            // as many in the wavelength as asked for: five deviations, or the discrepancy
            double allowed = layout == SPHV_RANDOM ? 5 / sqrt(step) : 2 * log2(n);
            assert_close((double)cloud.particles, 1 / step, allowed);
            assert_true(cloud.x[cloud.first] >= 0 && cloud.x[cloud.first - 1] < 0);
            sphv_cloud_free(&cloud);
            sphv_kernel_free(scene.kernel);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known_answers),
        cmocka_unit_test(test_numbers_are_functions_of_seed_realisation_index),
        cmocka_unit_test(test_normal_numbers),
        cmocka_unit_test(test_neighbourhoods_by_brute_force),
        cmocka_unit_test(test_tessellated_volumes_tile),
        cmocka_unit_test(test_one_place_for_each_particle),
        cmocka_unit_test(test_scattered_positions),
    };
    return run_group(tests);
}
