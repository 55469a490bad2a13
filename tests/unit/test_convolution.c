/// Sums by Fourier transform and prefix sums on lattices: their parts against plain sums, and the
/// whole against every pair of particles.
#include <float.h>
#include <gsl/gsl_math.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "../../empirical/sums/lattice_table.h"
#include "../../empirical/sums/transform.h"
#include "sphverify/estimate.h"
#include "support.h"

#define U (DBL_EPSILON / 2)

static size_t power(size_t base, int exponent)
{
    size_t product = 1;
    for (int i = 0; i < exponent; i++) product *= base;
    return product;
}

/// Sizes: no prime above 5, none in between left out.
static void test_sizes(void **state)
{
    (void)state;
    size_t last = 0;
    for (size_t least = 0; least <= 1100; least++) {
        size_t size = sphv_transform_size(least), rest = size;
        while (rest % 2 == 0) rest /= 2;
        while (rest % 3 == 0) rest /= 3;
        while (rest % 5 == 0) rest /= 5;
        assert_int_equal(rest, 1);
        assert_true(size >= least && size >= 1 && size >= last);
        last = size;
    }
    assert_int_equal(sphv_transform_size(7), 8);
    assert_int_equal(sphv_transform_size(831), 864);
    assert_int_equal(sphv_transform_size(0), 1);
}

/// One output of the transform, summed as it is defined, in long double.
/// \param circle cos and sin of 2πj/size
static void plain_transform(const sphv_transform *of, const double *data, const size_t k[3],
                            int sign, long double (*circle)[2], long double out[2])
{
    out[0] = out[1] = 0;
    for (size_t n = 0; n < of->points; n++) {
        size_t rest = n, turn = 0;
        for (int i = of->dimension - 1; i >= 0; i--, rest /= of->size)
            turn += rest % of->size * k[i];
        const long double *at = circle[turn % of->size];
        out[0] += data[2 * n] * at[0] - sign * data[2 * n + 1] * at[1];
        out[1] += sign * data[2 * n] * at[1] + data[2 * n + 1] * at[0];
    }
}

/// Both directions, every radix, cubes partly filled and partly wanted, against the definition, in
/// the norm that the bound is for.
static void test_transforms(void **state)
{
    (void)state;
    random_start("transforms");
    static const size_t sizes[] = {1, 2, 3, 4, 5, 6, 8, 9, 10, 12, 15, 16, 20, 25, 27, 30};
    for (int d = 1; d <= 3; d++)
        for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
            size_t size = sizes[s], part = (size_t)random_integer(1, (long)size);
            sphv_transform of;
            if (power(size, d) > (quick() ? 200 : 1000)) continue;
            assert_int_equal(sphv_transform_make(&of, d, size), SPHV_OK);
            long double circle[30][2];
            for (size_t j = 0; j < size; j++) {
                long double angle = 2 * acosl(-1.0L) * (long double)j / (long double)size;
                circle[j][0] = cosl(angle);
                circle[j][1] = sinl(angle);
            }
            double *data = calloc(2 * of.points, sizeof *data), total = 0;
            double *input = calloc(2 * of.points, sizeof *input);
            assert_non_null(data);
            assert_non_null(input);
            for (int backward = 0; backward < 2; backward++) {
                total = 0;
                for (size_t n = 0; n < of.points; n++) {
                    bool filled = true;
                    size_t rest = n;
                    for (int i = 0; i < d; i++, rest /= size)
                        filled = filled && (backward || rest % size < part);
                    for (int c = 0; c < 2; c++)
                        input[2 * n + c] = filled ? random_uniform(-1, 1) : 0;
                    total += hypot(input[2 * n], input[2 * n + 1]);
                }
                memcpy(data, input, 2 * of.points * sizeof *data);
                assert_int_equal(backward ? sphv_transform_backward(&of, data, part)
                                          : sphv_transform_forward(&of, data, part),
                                 SPHV_OK);
                for (size_t n = 0; n < of.points; n++) {
                    size_t k[3] = {0}, rest = n;
                    bool wanted = true;
                    for (int i = d - 1; i >= 0; i--, rest /= size) {
                        k[i] = rest % size;
                        wanted = wanted && (!backward || k[i] < part);
                    }
                    if (!wanted) continue;
                    long double expected[2];
                    plain_transform(&of, input, k, backward ? 1 : -1, circle, expected);
                    double off =
                        (double)hypotl(data[2 * n] - expected[0], data[2 * n + 1] - expected[1]);
                    assert_close(off, 0, sphv_transform_error(&of) * total);
                }
            }
            free(data);
            free(input);
            sphv_transform_free(&of);
        }
}

/// Relative rounding of long double: some checkers compute it as double.
static double long_epsilon(void)
{
    volatile long double above = 1 + LDBL_EPSILON;
    return above > 1 ? (double)LDBL_EPSILON : DBL_EPSILON;
}

struct scene {
    sphv_kernel *kernel;
    sphv_particles particles;
    double *field[3];
    const double *fields[3];
    sphv_request request;
};

static void make(struct scene *scene, const char *kernel, int d, size_t side, int placement,
                 double h)
{
    sphv_error error = {SPHV_OK, ""};
    sphv_box box = {.dimension = d,
                    .side = side,
                    .layout = SPHV_LATTICE,
                    .placement = (sphv_placement)placement,
                    .volume = placement ? SPHV_VOLUME_LATTICE : SPHV_VOLUME_EQUAL};
    memset(scene, 0, sizeof *scene);
    scene->kernel = load_kernel(kernel);
    const sphv_profile *profile = sphv_kernel_profile(scene->kernel, d);
    assert_non_null(profile);
    assert_ok(sphv_particles_make(&box, NULL, 0, &scene->particles, &error), error);
    size_t count = scene->particles.count;
    for (int f = 0; f < 3; f++) {
        scene->fields[f] = scene->field[f] = malloc(count * sizeof(double));
        assert_non_null(scene->field[f]);
        // Smooth, rough and far from 0, constant
        for (size_t n = 0; n < count; n++) {
            double x = scene->particles.x[0][n], y = d > 1 ? scene->particles.x[d - 1][n] : 0.3;
            scene->field[f][n] = f == 0   ? sin(3 * x) * cos(2 * y) + x
                                 : f == 1 ? 1e6 + 1e-3 * random_uniform(-1, 1)
                                          : -7.7;
        }
    }
    scene->request =
        (sphv_request){.profile = profile, .h = h, .field_count = 3, .fields = scene->fields};
}

static void unmake(struct scene *scene)
{
    for (int f = 0; f < 3; f++) free(scene->field[f]);
    sphv_particles_free(&scene->particles);
    sphv_kernel_free(scene->kernel);
}

/// Prefix sums over the cuboids of all classes, and the neighbours counted, against loops.
static void test_cuboids(void **state)
{
    (void)state;
    random_start("cuboids");
    for (int l = 0; l < (quick() ? 6 : 30); l++) {
        int d = l % 3 + 1;
        size_t side = (size_t)random_integer(2, d == 1 ? 40 : d == 2 ? 12 : 6);
        struct scene scene;
        make(&scene, "cubic-spline", d, side, l % 2, random_log(0.02, 1));
        sphv_evaluation evaluation = {
            .particles = &scene.particles,
            .request = &scene.request,
            .layout = sphv_sum_layout_make(d, SPHV_SUMS_ALL, 0),
        };
        sphv_lattice_table table;
        sphv_error error = {SPHV_OK, ""};
        assert_ok(sphv_lattice_table_make(&evaluation, &table, &error), error);
        double *sums = malloc(table.classes * sizeof *sums);
        assert_non_null(sums);
        for (size_t m = 0; m < sphv_monomial_count(d, 2); m++) {
            sphv_offset_function function = {table.p[m % 3], 0.7, &sphv_monomials(d)[m]};
            assert_int_equal(sphv_cuboid_sums(&table, &function, sums), SPHV_OK);
            for (size_t n = 0; n < scene.particles.count; n++) {
                size_t place[3], c = sphv_lattice_class(&table, n, place);
                long double expected = 0, whole = 0;
                for (size_t o = 0; o < table.cells; o++) {
                    long offset[3] = {0};
                    size_t rest = o;
                    bool within = true;
                    for (int i = d - 1; i >= 0; i--, rest /= table.width) {
                        offset[i] = (long)(rest % table.width) - (long)table.reach;
                        long at = (long)place[i] + offset[i];
                        within = within && at >= 0 && at < (long)side;
                    }
                    double value = sphv_offset_value(&table, &function, offset);
                    whole += fabs(value);
                    if (within) expected += value;
                }
                // prefix sums, the loop's own additions in long double, and a rounding of each
                double prefix = sphv_cuboid_error(&table) * (long_epsilon() / (double)LDBL_EPSILON);
                double allowed = (prefix + (double)table.cells * long_epsilon()) * (double)whole +
                                 2 * U * fabs((double)expected);
                assert_close(sums[c], (double)expected, allowed);
            }
        }
        free(sums);
        sphv_lattice_table_free(&table);
        unmake(&scene);
    }
}

/// How the two routes differ.
struct difference {
    double bounds; ///< largest ratio of the convolution's bound to the other
    double share;  ///< largest part of both bounds that a difference takes up
};

/// Estimates of one method by both routes: within the sum of their bounds, with the same faults.
static void compare(const sphv_estimates *got, const sphv_estimates *expected, size_t m,
                    struct difference *worst)
{
    const sphv_method_estimates *a = &got->methods[m], *b = &expected->methods[m];
    for (size_t n = 0; n < got->count; n++) {
        // Rounding alone decides whether a matrix that has no inverse meets a zero pivot.
        bool hopeless = a->fault[n] >= SPHV_FAULT_SINGULAR && b->fault[n] >= SPHV_FAULT_SINGULAR;
        assert_true(a->fault[n] == b->fault[n] || hopeless);
        for (size_t i = 0; i < 3 * a->quantities; i++) {
            assert_true(isfinite(a->estimate[i][n]));
            if (a->fault[n] != SPHV_FAULT_NONE) continue;
            double allowed = a->rounding[i] + b->rounding[i];
            assert_close(a->estimate[i][n], b->estimate[i][n], allowed);
            if (!(b->rounding[i] > 0)) continue;
            worst->bounds = fmax(worst->bounds, a->rounding[i] / b->rounding[i]);
            worst->share =
                fmax(worst->share, fabs(a->estimate[i][n] - b->estimate[i][n]) / allowed);
        }
    }
}

/// All methods of one level.
static sphv_estimates estimate(const struct scene *scene, sphv_sum_level level, sphv_route route)
{
    sphv_method methods[16];
    sphv_request request = scene->request;
    sphv_estimates out;
    sphv_error error = {SPHV_OK, ""};
    request.methods = methods;
    request.route = route;
    request.method_count = 0;
    for (int m = 0; sphv_methods[m].name; m++)
        if (sphv_method_level((sphv_method)m) == level)
            methods[request.method_count++] = (sphv_method)m;
    assert_true(request.method_count > 0);
    assert_ok(sphv_estimate_particles(&scene->particles, &request, NULL, NULL, &out, &error),
              error);
    assert_int_equal(out.route, route);
    return out;
}

/// Every level of one scene by both routes.
static void compare_levels(const struct scene *scene, struct difference *worst)
{
    for (int level = SPHV_SUMS_STANDARD; level < SPHV_SUM_LEVELS; level++) {
        sphv_sum_level of = (sphv_sum_level)level;
        sphv_estimates got = estimate(scene, of, SPHV_ROUTE_CONVOLUTION);
        sphv_estimates expected = estimate(scene, of, SPHV_ROUTE_BRUTE_FORCE);
        double pairs = 0;
        for (size_t n = 0; n < got.count; n++) {
            assert_int_equal(got.neighbours[n], expected.neighbours[n]);
            pairs += got.neighbours[n];
        }
        assert_close(got.pairs, pairs, 0);
        for (size_t m = 0; m < got.method_count; m++) compare(&got, &expected, m, worst);
        sphv_estimates_free(&got);
        sphv_estimates_free(&expected);
    }
}

/// Every level in every dimension; odd and even sides; supports from less than the spacing to
/// beyond the box; a kernel with a cusp and one that is cut off.
static void test_against_every_pair(void **state)
{
    (void)state;
    random_start("convolutions");
    static const char *const kernels[] = {"cubic-spline", "wendland-c4", "quartic-spline", "spiky",
                                          "gaussian"};
    struct difference worst = {0, 0};
    for (int l = 0; l < (quick() ? 3 : 15); l++) {
        int d = l % 3 + 1;
        size_t side = (size_t)random_integer(2, d == 1 ? 20 : d == 2 ? 7 : 4);
        struct scene scene;
        double step = 1 / (double)side;
        make(&scene, kernels[l / 3 % 5], d, side, l % 2,
             l % 9 ? random_log(0.8 * step, 1.5) : 0.3 * step);
        compare_levels(&scene, &worst);
        unmake(&scene);
    }
    print_message("bounds up to %.3g times those of the other route; differences up to %.2g of "
                  "both bounds\n",
                  worst.bounds, worst.share);
}

/// Supports that end where particles are, to within rounding: neighbours are counted pair by pair.
static void test_ties(void **state)
{
    (void)state;
    random_start("ties");
    struct difference worst = {0, 0};
    static const size_t sides[] = {23, 8, 5};
    for (int d = 1; d <= (quick() ? 1 : 3); d++)
        for (int times = 1; times <= (quick() ? 1 : 3); times++) {
            struct scene scene;
            double step = 1 / (double)(sides[d - 1] - 1);
            make(&scene, "cubic-spline", d, sides[d - 1], SPHV_PLACEMENT_VERTEX, times * step / 2);
            compare_levels(&scene, &worst);
            unmake(&scene);
        }
}

/// Fields and volumes near the ends of the range of numbers.
static void test_extremes(void **state)
{
    (void)state;
    random_start("extremes");
    struct difference worst = {0, 0};
    for (int d = 1; d <= (quick() ? 1 : 3); d++) {
        struct scene scene;
        make(&scene, "cubic-spline", d, d == 1 ? 20 : 5, d % 2, 0.37);
        for (size_t n = 0; n < scene.particles.count; n++) {
            scene.field[0][n] *= 1e270;
            scene.field[1][n] = (scene.field[1][n] - 1e6) * 1e-240;
            scene.particles.volume[n] *= d == 2 ? 1e-20 : 1e3;
        }
        compare_levels(&scene, &worst);
        unmake(&scene);
    }
}

/// What is no lattice in a box is refused, and summed directly when the choice is left open.
static void test_refusals(void **state)
{
    (void)state;
    random_start("refusals of convolutions");
    for (int l = quick() ? 5 : 0; l < 6; l++) {
        struct scene scene;
        const char *part = "an unperturbed lattice";
        // h that the choice gives to the convolution
        make(&scene, l == 4 ? "quadratic-spline" : "cubic-spline", 2, 41, SPHV_PLACEMENT_VERTEX,
             10 * 0.025);
        const sphv_method method = SPHV_SPH, second = SPHV_MSPH;
        sphv_route taken = SPHV_ROUTE_DIRECT;
        sphv_particles *of = &scene.particles;
        scene.request.methods = &method;
        scene.request.method_count = 1;
        if (l == 0) of->lattice_side = 0;
        if (l == 1) of->lattice_side = 40;
        if (l == 2) {
            of->volume[77] *= 1 + DBL_EPSILON;
            part = "the same volume";
        }
        if (l == 3) {
            of->x[1][77] += 1e-14;
            part = "off a lattice";
        }
        if (l == 4) { // Ŵ″ jumps at the edge and inside, where there are particles
            scene.request.methods = &second;
            part = "jumps at the distance";
        }
        if (l == 5) {
            taken = SPHV_ROUTE_CONVOLUTION;
            part = NULL;
        }
        sphv_error error = {SPHV_OK, ""};
        sphv_estimates out;
        scene.request.route = SPHV_ROUTE_CONVOLUTION;
        sphv_status status = sphv_estimate_particles(of, &scene.request, NULL, NULL, &out, &error);
        if (part) assert_failed(status, &error, SPHV_INVALID_INPUT, part);
        if (!part) assert_ok(status, error);
        if (!part) sphv_estimates_free(&out);
        scene.request.route = SPHV_ROUTE_AUTOMATIC;
        assert_ok(sphv_estimate_particles(of, &scene.request, NULL, NULL, &out, &error), error);
        assert_int_equal(out.route, taken);
        sphv_estimates_free(&out);
        unmake(&scene);
    }
}

/// One, two or five threads: the same bits.
static void test_threads(void **state)
{
    (void)state;
    random_start("threads of convolutions");
    int before = omp_get_max_threads();
    for (int d = 1; d <= (quick() ? 1 : 3); d++) {
        struct scene scene;
        make(&scene, "wendland-c4", d,
             d == 1   ? 9000
             : d == 2 ? 110
                      : 20,
             d % 2, d == 1 ? 0.02 : 0.1);
        omp_set_num_threads(1);
        sphv_estimates one = estimate(&scene, SPHV_SUMS_FIRST, SPHV_ROUTE_CONVOLUTION);
        for (int threads = 2; threads <= 5; threads += 3) {
            omp_set_num_threads(threads);
            sphv_estimates many = estimate(&scene, SPHV_SUMS_FIRST, SPHV_ROUTE_CONVOLUTION);
            for (size_t m = 0; m < one.method_count; m++)
                for (size_t i = 0; i < 3 * one.methods[m].quantities; i++) {
                    assert_memory_equal(one.methods[m].estimate[i], many.methods[m].estimate[i],
                                        one.count * sizeof(double));
                    assert_true(one.methods[m].rounding[i] == many.methods[m].rounding[i]);
                }
            assert_true(one.pairs == many.pairs);
            sphv_estimates_free(&many);
        }
        sphv_estimates_free(&one);
        unmake(&scene);
    }
    omp_set_num_threads(before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sizes),    cmocka_unit_test(test_transforms),
        cmocka_unit_test(test_cuboids),  cmocka_unit_test(test_against_every_pair),
        cmocka_unit_test(test_ties),     cmocka_unit_test(test_extremes),
        cmocka_unit_test(test_refusals), cmocka_unit_test(test_threads),
    };
    return run_group(tests);
}
