/// Boxes of particles: where each layout puts them, what volumes they get, and what is refused.
#include <float.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_sort.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "../../empirical/random.h"
#include "sphverify/estimate.h"
#include "support.h"

#define U (DBL_EPSILON / 2)

static sphv_box plain_box(int dimension, size_t side)
{
    return (sphv_box){.dimension = dimension,
                      .side = side,
                      .layout = SPHV_LATTICE,
                      .placement = SPHV_PLACEMENT_CELL,
                      .volume = SPHV_VOLUME_LATTICE,
                      .seed = 1};
}

static sphv_particles make(const sphv_box *box)
{
    sphv_particles particles;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_particles_make(box, NULL, 0, &particles, &error), error);
    assert_int_equal(particles.dimension, box->dimension);
    assert_int_equal(particles.count, pow((double)box->side, box->dimension));
    for (int i = 0; i < SPHV_DIMENSIONS; i++)
        assert_true((particles.x[i] != NULL) == (i < box->dimension));
    return particles;
}

/// Particle by particle in exact small fractions, first coordinate slowest.
static void test_lattices(void **state)
{
    (void)state;
    for (int d = 1; d <= 3; d++)
        for (int placement = SPHV_PLACEMENT_VERTEX; placement <= SPHV_PLACEMENT_CELL; placement++)
            for (size_t side = placement ? 1 : 2; side <= 7; side += 2) {
                sphv_box box = plain_box(d, side);
                box.placement = (sphv_placement)placement;
                sphv_particles particles = make(&box);
                double intervals = placement ? (double)side : (double)side - 1;
                assert_close(sphv_box_spacing(&box), 1 / intervals, 0);
                assert_close(particles.spacing, 1 / intervals, 0);
                assert_int_equal(particles.lattice_side, side);
                for (size_t n = 0; n < particles.count; n++) {
                    const size_t place[] = {n / (d == 1   ? 1
                                                 : d == 2 ? side
                                                          : side * side),
                                            d == 3 ? n / side % side : n % side, n % side};
                    for (int i = 0; i < d; i++)
                        assert_close(particles.x[i][n],
                                     ((double)place[i] + (placement ? 0.5 : 0)) / intervals, 0);
                    assert_close(particles.volume[n], pow(intervals, -d), 8 * U);
                }
                sphv_particles_free(&particles);
                assert_null(particles.x[0]);
            }
}

/// A second route to reflection: fold after fold.
static double folded(double x)
{
    while (x < 0 || x > 1) x = x < 0 ? -x : 2 - x;
    return x;
}

/// Perturbations are the generator's numbers of (seed, coordinate, particle), however far they go.
static void test_perturbed(void **state)
{
    (void)state;
    random_start("perturbed boxes");
    for (int l = 0; l < 60; l++) {
        sphv_box box = plain_box(l % 3 + 1, (size_t)random_integer(2, 9));
        box.layout = SPHV_PERTURBED;
        box.placement = l % 2 ? SPHV_PLACEMENT_CELL : SPHV_PLACEMENT_VERTEX;
        box.jitter = l / 2 % 2 ? SPHV_JITTER_NORMAL : SPHV_JITTER_UNIFORM;
        box.amplitude = l % 5 ? random_log(1e-3, 10) : 10;
        box.reflected = l / 4 % 2;
        box.periodic = l % 2 && !box.reflected && l / 8 % 2;
        box.seed = (uint64_t)random_integer(0, 1L << 40);
        sphv_particles particles = make(&box);
        double step = sphv_box_spacing(&box);
        size_t folds = 0;
        assert_int_equal(particles.lattice_side, 0);
        for (size_t n = 0; n < particles.count; n++) {
            size_t rest = n;
            for (int i = box.dimension - 1; i >= 0; i--, rest /= box.side) {
                double random = box.jitter == SPHV_JITTER_NORMAL
                                    ? sphv_normal(box.seed, i, (long)n)
                                    : 2 * sphv_uniform(box.seed, i, (long)n) - 1;
                double moved = ((double)(rest % box.side) + (l % 2 ? 0.5 : 0)) * step +
                               box.amplitude * step * random;
                double x = particles.x[i][n], expected = moved;
                if (box.reflected) expected = folded(moved);
                if (box.periodic) expected = moved - floor(moved);
                folds += fabs(moved - 0.5) > 1.5;
                assert_true(x == expected || !(box.reflected || box.periodic) ||
                            (x >= 0 && x <= 1));
                // Few roundings of a place up to 9 + 86 steps away; on the circle 0 and 1 are one
                double off = fabs(x - expected);
                if (box.periodic) off = fmin(off, 1 - off);
                assert_close(off, 0, 6 * U * (2 + fabs(moved)));
                assert_true(!box.periodic || x < 1);
            }
        }
        if (box.amplitude == 10 && box.side <= 4) assert_true(folds > 0 || particles.count < 20);
        sphv_particles_free(&particles);
    }
}

/// Statistics of displacements and of scattered particles, at five standard deviations: one seed in
/// 10^5 or fewer would fail any of the dozen tests of each kind.
static void test_statistics(void **state)
{
    (void)state;
    random_start("statistics of boxes");
    for (int d = 1; d <= 3; d++)
        for (int jitter = SPHV_JITTER_NORMAL; jitter <= SPHV_JITTER_UNIFORM; jitter++) {
            sphv_box box = plain_box(d, d == 1 ? 3000 : d == 2 ? 60 : 15);
            box.layout = SPHV_PERTURBED;
            box.jitter = (sphv_jitter)jitter;
            box.amplitude = 0.3;
            box.seed = (uint64_t)random_integer(0, 1L << 40);
            sphv_particles particles = make(&box);
            box.layout = SPHV_LATTICE;
            box.amplitude = 0;
            sphv_particles lattice = make(&box);
            double n = (double)particles.count, sum[3][2] = {{0}}, cross = 0;
            for (size_t b = 0; b < particles.count; b++) {
                double moved[3] = {0};
                for (int i = 0; i < d; i++) {
                    moved[i] = (particles.x[i][b] - lattice.x[i][b]) / particles.spacing / 0.3;
                    sum[i][0] += moved[i] / n;
                    sum[i][1] += moved[i] * moved[i] / n;
                    if (jitter == SPHV_JITTER_UNIFORM) assert_true(fabs(moved[i]) < 1 + 1e-9);
                }
                if (d > 1) cross += moved[0] * moved[d - 1] / n;
            }
            // ξ: variance 1 and fourth moment 3, or 1/3 and 1/5
            double variance = jitter == SPHV_JITTER_NORMAL ? 1 : 1.0 / 3;
            double fourth = jitter == SPHV_JITTER_NORMAL ? 3 : 1.0 / 5;
            for (int i = 0; i < d; i++) {
                assert_close(sum[i][0], 0, 5 * sqrt(variance / n));
                assert_close(sum[i][1], variance, 5 * sqrt((fourth - variance * variance) / n));
            }
            assert_close(cross, 0, 5 * variance / sqrt(n));
            sphv_particles_free(&particles);
            sphv_particles_free(&lattice);
        }
    for (int d = 1; d <= 3; d++)
        for (int layout = SPHV_QUASI_RANDOM; layout <= SPHV_RANDOM; layout++) {
            sphv_box box = plain_box(d, d == 1 ? 4096 : d == 2 ? 64 : 16);
            box.layout = (sphv_layout)layout;
            box.seed = (uint64_t)random_integer(0, 1L << 40);
            sphv_particles particles = make(&box);
            assert_close(particles.spacing, 1 / (double)box.side, 0);
            double n = (double)particles.count, share[64] = {0}, worst = 0;
            int cells = d == 1 ? 64 : d == 2 ? 8 : 4;
            for (size_t b = 0; b < particles.count; b++) {
                int cell = 0;
                for (int i = 0; i < d; i++) {
                    double x = particles.x[i][b];
                    assert_true(x >= 0 && x < 1);
                    if (layout == SPHV_QUASI_RANDOM) {
                        x = x - sphv_uniform(box.seed, i, -1) + 0x1p-20;
                        x -= floor(x);
                    }
                    cell = cell * cells + (int)(x * cells);
                }
                share[cell]++;
            }
            for (int c = 0; c < 64; c++) worst = fmax(worst, fabs(share[c] - n / 64));
            // Counts of 64 cells, mean 64, each within 6 deviations of a binomial. Sobol's points
            // before their shift, 1 to 2^12, share the cells evenly but for point 0 and the last
            assert_true(worst <= (layout == SPHV_RANDOM ? 6 * 8 : 1));
            if (layout == SPHV_RANDOM) assert_true(worst > 3);
            sphv_particles_free(&particles);
        }
}

static bool same(const sphv_particles *p, const sphv_particles *q)
{
    bool equal = p->count == q->count;
    for (int i = 0; i < p->dimension && equal; i++)
        equal = memcmp(p->x[i], q->x[i], p->count * sizeof(double)) == 0;
    return equal && memcmp(p->volume, q->volume, p->count * sizeof(double)) == 0;
}

/// One, two or seven threads: the same bits. Another seed: other particles.
static void test_threads_and_seeds(void **state)
{
    (void)state;
    int before = omp_get_max_threads();
    for (int layout = SPHV_PERTURBED; layout <= SPHV_RANDOM; layout++)
        for (int d = 1; d <= 3; d++) {
            sphv_box box = plain_box(d, 11);
            box.layout = (sphv_layout)layout;
            if (layout == SPHV_PERTURBED) box.amplitude = 0.2;
            if (d == 1) box.volume = SPHV_VOLUME_TESSELLATED;
            omp_set_num_threads(1);
            sphv_particles one = make(&box);
            for (int threads = 2; threads <= 7; threads += 5) {
                omp_set_num_threads(threads);
                sphv_particles many = make(&box);
                assert_true(same(&one, &many));
                sphv_particles_free(&many);
            }
            box.seed++;
            sphv_particles other = make(&box);
            for (int i = 0; i < d; i++)
                for (size_t n = 0; n < one.count; n++) assert_true(one.x[i][n] != other.x[i][n]);
            sphv_particles_free(&one);
            sphv_particles_free(&other);
        }
    omp_set_num_threads(before);
}

/// Constant rules; tessellated cells tile the line from side to side and hold their particles.
static void test_volumes(void **state)
{
    (void)state;
    random_start("volumes of boxes");
    for (int d = 1; d <= 3; d++) {
        sphv_box box = plain_box(d, 6);
        box.placement = SPHV_PLACEMENT_VERTEX;
        static const sphv_volume rules[] = {SPHV_VOLUME_LATTICE, SPHV_VOLUME_EQUAL,
                                            SPHV_VOLUME_UNIT};
        const double volumes[] = {pow(0.2, d), pow(6, -d), 1};
        for (int rule = 0; rule < 3; rule++) {
            box.volume = rules[rule];
            sphv_particles particles = make(&box);
            for (size_t n = 0; n < particles.count; n++)
                assert_close(particles.volume[n], volumes[rule], 8 * U * volumes[rule]);
            sphv_particles_free(&particles);
        }
    }
    for (int l = 0; l < 200; l++) {
        sphv_box box = plain_box(1, (size_t)random_integer(2, 30));
        box.volume = SPHV_VOLUME_TESSELLATED;
        box.layout = (sphv_layout)random_integer(SPHV_LATTICE, SPHV_RANDOM);
        if (box.layout == SPHV_PERTURBED) box.amplitude = random_log(0.01, 3);
        box.periodic = l % 3 == 0;
        if (!box.periodic && l % 2) box.placement = SPHV_PLACEMENT_VERTEX;
        box.reflected = !box.periodic && l % 5 < 2;
        box.seed = (uint64_t)random_integer(0, 1L << 40);
        sphv_particles particles = make(&box);
        size_t order[30];
        const double *x = particles.x[0];
        gsl_sort_index(order, x, 1, particles.count);
        double first = x[order[0]], last = x[order[particles.count - 1]], total = 0;
        double end = box.periodic ? 0.5 * (first + last - 1) : fmin(0, first);
        for (size_t n = 0; n < particles.count; n++) {
            double volume = particles.volume[order[n]];
            assert_true(volume >= 0 && x[order[n]] >= end - 64 * U);
            end += volume;
            total += volume;
            assert_true(x[order[n]] <= end + 64 * U);
        }
        double hull = box.periodic ? 1 : fmax(1, last) - fmin(0, first);
        assert_close(total, hull, 64 * U * (1 + hull) * 4);
        sphv_particles_free(&particles);
    }
}

/// m/ρ against plain sums over every pair; a particle that sees no other has 1/W(0).
static void test_density_volumes(void **state)
{
    (void)state;
    random_start("density volumes");
    sphv_kernel *kernel = load_kernel("cubic-spline");
    for (int l = 0; l < (quick() ? 4 : 24); l++) {
        int d = l % 3 + 1;
        const sphv_profile *profile = sphv_kernel_profile(kernel, d);
        sphv_box box = plain_box(d, (size_t)random_integer(2, d == 1 ? 60 : d == 2 ? 9 : 4));
        double step = 1 / (double)box.side, h = l % 4 ? step * random_uniform(0.6, 3) : step * 0.1;
        box.layout = l % 4 ? (sphv_layout)random_integer(SPHV_LATTICE, SPHV_RANDOM) : SPHV_LATTICE;
        if (box.layout == SPHV_PERTURBED) box.amplitude = 0.3;
        box.volume = SPHV_VOLUME_DENSITY;
        box.seed = (uint64_t)random_integer(0, 1L << 40);
        sphv_particles particles;
        sphv_error error = {SPHV_OK, ""};
        assert_ok(sphv_particles_make(&box, profile, h, &particles, &error), error);
        for (size_t a = 0; a < particles.count; a++) {
            long double sum = 0;
            for (size_t b = 0; b < particles.count; b++) {
                double square = 0;
                for (int i = 0; i < d; i++)
                    square += gsl_pow_2(particles.x[i][b] - particles.x[i][a]);
                sum += sphv_profile_derivative(profile, 0, sqrt(square) / h).value;
            }
            double expected = (double)(powl(h, d) / sum);
            // One kernel of at most 60 is off by a rounding of q, times q Ŵ′/Ŵ(0) < 3; h^d, 1/ρ
            // and the sum by few more
            assert_close(particles.volume[a], expected, 60 * 12 * U * expected);
            if (l % 4 == 0)
                assert_close(expected, pow(h, d) / sphv_profile_derivative(profile, 0, 0).value,
                             8 * U * expected);
        }
        sphv_particles_free(&particles);
    }
    sphv_kernel_free(kernel);
}

static void refuse(sphv_box box, const char *part)
{
    sphv_particles particles;
    sphv_error error = {SPHV_OK, ""};
    assert_failed(sphv_box_check(&box, &error), &error, SPHV_INVALID_INPUT, part);
    assert_failed(sphv_particles_make(&box, NULL, 0, &particles, &error), &error,
                  SPHV_INVALID_INPUT, part);
    assert_null(particles.x[0]);
    assert_null(particles.volume);
}

static void test_refusals(void **state)
{
    (void)state;
    sphv_box box = plain_box(2, 5);
    for (int d = 0; d <= 4; d += 4) {
        box.dimension = d;
        refuse(box, "allowed: 1 to 3");
    }
    box = plain_box(2, 0);
    refuse(box, "at least 1");
    box = plain_box(2, 1);
    box.placement = SPHV_PLACEMENT_VERTEX;
    refuse(box, "at least 2 with placement vertex");
    static const size_t sides[] = {200000001, 14143, 585};
    for (int d = 1; d <= 3; d++) {
        refuse(plain_box(d, sides[d - 1]), "too many");
        refuse(plain_box(d, SIZE_MAX), "too many");
        refuse(plain_box(d, (size_t)1 << (d == 1 ? 63 : d == 2 ? 32 : 22)), "too many");
        sphv_box largest = plain_box(d, sides[d - 1] - 1);
        sphv_error error = {SPHV_OK, ""};
        assert_ok(sphv_box_check(&largest, &error), error);
    }
    static const double amplitudes[] = {-0.1, NAN, INFINITY, 10.1};
    for (int i = 0; i < 4; i++) {
        box = plain_box(2, 5);
        box.layout = SPHV_PERTURBED;
        box.amplitude = amplitudes[i];
        refuse(box, "allowed: 0 to 10");
    }
    box = plain_box(2, 5);
    box.amplitude = 0.1;
    refuse(box, "allowed: amplitude with layout perturbed");
    box = plain_box(2, 5);
    box.periodic = true;
    box.placement = SPHV_PLACEMENT_VERTEX;
    refuse(box, "allowed: placement cell");
    box = plain_box(2, 5);
    box.periodic = box.reflected = true;
    refuse(box, "allowed: one of both");
    box = plain_box(2, 5);
    box.volume = SPHV_VOLUME_TESSELLATED;
    refuse(box, "tessellated");
    // These need more than a box, or another one.
    box = plain_box(2, 5);
    box.volume = SPHV_VOLUME_DENSITY;
    sphv_particles particles;
    sphv_error error = {SPHV_OK, ""};
    assert_failed(sphv_particles_make(&box, NULL, 0, &particles, &error), &error,
                  SPHV_INVALID_INPUT, "without a kernel");
    sphv_kernel *kernel = load_kernel("cubic-spline");
    static const double lengths[] = {0, -1, NAN, INFINITY};
    for (int i = 0; i < 4; i++)
        assert_failed(sphv_particles_make(&box, sphv_kernel_profile(kernel, 2), lengths[i],
                                          &particles, &error),
                      &error, SPHV_INVALID_INPUT, "without a kernel");
    assert_failed(
        sphv_particles_make(&box, sphv_kernel_profile(kernel, 3), 0.1, &particles, &error), &error,
        SPHV_INVALID_INPUT, "allowed: the same");
    sphv_kernel_free(kernel);
}

/// An endless line has no volume to share.
static void test_equal_volumes_need_a_box(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    sphv_experiment experiment = {.profile = sphv_kernel_profile(kernel, 1),
                                  .h = 0.1,
                                  .spacing = sphv_number_from_double(0.5),
                                  .method = SPHV_SPH,
                                  .layout = SPHV_LATTICE,
                                  .volume = SPHV_VOLUME_EQUAL,
                                  .width = 0.1,
                                  .realisations_min = 2,
                                  .realisations_max = 3};
    sphv_error error = {SPHV_OK, ""};
    assert_failed(sphv_experiment_check(&experiment, &error), &error, SPHV_INVALID_INPUT,
                  "volume 'equal' without a box");
    experiment.volume = SPHV_VOLUME_LATTICE;
    assert_ok(sphv_experiment_check(&experiment, &error), error);
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lattices),   cmocka_unit_test(test_perturbed),
        cmocka_unit_test(test_statistics), cmocka_unit_test(test_threads_and_seeds),
        cmocka_unit_test(test_volumes),    cmocka_unit_test(test_density_volumes),
        cmocka_unit_test(test_refusals),   cmocka_unit_test(test_equal_volumes_need_a_box),
    };
    return run_group(tests);
}
