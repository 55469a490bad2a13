/// Particles that have no estimate, or one not to be trusted: each is marked with the reason, and
/// nothing is NaN.
#include <float.h>
#include <math.h>

#include "methods_support.h"

static struct cloud cloud;

static void add(double x, double y, double z)
{
    double *at = cloud.x[cloud.count];
    at[0] = x;
    at[1] = y;
    at[2] = z;
    cloud.volume[cloud.count] = 1;
    cloud.field[0][cloud.count] = 1 + x - 2 * y + 3 * z + x * y;
    cloud.field[1][cloud.count++] = 3;
}

static void begin(int dimension, double h)
{
    cloud = (struct cloud){.dimension = dimension, .h = h};
}

/// Estimates with a method at particle 0; what every outcome has in common is checked here.
static struct single found(const sphv_profile *profile, int method)
{
    struct single out;
    estimate_at(profile, (sphv_method)method, &cloud, 0, &out);
    size_t quantities = sphv_method_quantities((sphv_method)method, cloud.dimension);
    assert_in_range(out.fault, 0, SPHV_FAULTS - 1);
    assert_true(out.condition >= 1 - 4 * DBL_EPSILON);
    assert_true((out.fault == SPHV_FAULT_SINGULAR) <= (out.condition == INFINITY));
    for (size_t q = 0; q < quantities; q++) {
        assert_true(isfinite(out.estimate[q]) && isfinite(out.second[q]));
        if (out.fault == SPHV_FAULT_NONE)
            assert_true(out.condition <= 1 / sqrt(DBL_EPSILON));
        else
            assert_true(out.rounding[q] == 0); // no part in the largest bound
        if (out.fault == SPHV_FAULT_SINGULAR || out.fault == SPHV_FAULT_TOO_FEW)
            assert_true(out.estimate[q] == 0);
    }
    return out;
}

/// Alone: sums that need no neighbour keep what they say, all others are 0, and every one is
/// marked.
static void test_isolated(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    for (int d = 1; d <= 3; d++) {
        const sphv_profile *profile = sphv_kernel_profile(kernel, d);
        begin(d, 0.25);
        add(0.25, 0.5, 0.75);
        add(0.75, 0.5, 0.75); // at the support's very end
        double own = cloud.field[0][0];
        double alone = sphv_profile_derivative(profile, 0, 0).value / pow(0.25, d) * own;
        for (int m = 0; sphv_methods[m].name; m++) {
            struct single at = found(profile, m);
            assert_int_equal(at.neighbours, 1);
            assert_int_equal(at.fault, SPHV_FAULT_ISOLATED);
            bool raw = m == SPHV_SPH || m == SPHV_SPH_DIFFERENCE;
            double value = raw ? alone : m == SPHV_SHEPARD || m == SPHV_RKPM_0 ? own : 0;
            assert_close(at.estimate[0], value, 4 * DBL_EPSILON * fabs(value));
            for (int i = 1; i <= d; i++) assert_close(at.estimate[i], 0, 0);
            bool matrix = sphv_method_least((sphv_method)m, d) > 1;
            if (matrix)
                assert_true(at.condition == INFINITY);
            else
                assert_close(at.condition, 1, 4 * DBL_EPSILON);
        }
    }
    sphv_kernel_free(kernel);
}

/// One particle less than unknowns, in places that are otherwise as good as any.
static void test_too_few(void **state)
{
    (void)state;
    random_start("too few");
    sphv_kernel *kernel = load_kernel("wendland-c4");
    for (int d = 1; d <= 3; d++)
        for (int m = 0; sphv_methods[m].name; m++) {
            const sphv_profile *profile = sphv_kernel_profile(kernel, d);
            size_t least = sphv_method_least((sphv_method)m, d);
            if (least <= 2) continue;
            begin(d, 1 / profile->support);
            add(0.5, 0.5, 0.5);
            for (size_t b = 2; b < least; b++)
                add(random_uniform(0.1, 0.9), random_uniform(0.1, 0.9), random_uniform(0.1, 0.9));
            assert_int_equal(found(profile, m).fault, SPHV_FAULT_TOO_FEW);
            for (int b = 0; b < 8; b++)
                add(0.2 + 0.6 * (b & 1), 0.2 + 0.6 * (b >> 1 & 1) + 0.07 * b,
                    0.2 + 0.5 * (b >> 2) + 0.02 * b * b);
            assert_int_equal(found(profile, m).fault, SPHV_FAULT_NONE);
        }
    sphv_kernel_free(kernel);
}

/// On a line, in a plane, on a conic, all in one place: enough particles, and no matrix. The
/// gradient across is not to be had.
static void test_degenerate_places(void **state)
{
    (void)state;
    random_start("degenerate places");
    sphv_kernel *kernel = load_kernel("wendland-c4");
    for (int round = 0; round < (quick() ? 4 : 40); round++)
        for (int d = 1; d <= 3; d++)
            for (int m = 0; sphv_methods[m].name; m++) {
                const sphv_profile *profile = sphv_kernel_profile(kernel, d);
                int unknowns = sphv_methods[m].unknowns[d - 1];
                size_t least = sphv_method_least((sphv_method)m, d);
                double x = random_uniform(-1, 1), y = random_uniform(-1, 1);
                if (least == 1 || unknowns == 0) continue;
                begin(d, 2 / profile->support);
                add(0.5, 0.5, 0.5);
                for (int b = 0; b < 20; b++) { // a line through it; in 1D one place
                    double t = d == 1 ? 0 : random_uniform(-0.5, 0.5);
                    add(0.5 + t * x, 0.5 + t * y, 0.5 + t);
                }
                assert_true(found(profile, m).fault != SPHV_FAULT_NONE);
                if (least <= 4 && d < 3) continue;
                begin(d, 2 / profile->support);
                add(0.5, 0.5, 0.5);
                for (int b = 0; b < 40 && d > 1; b++) { // 3D: a plane, or two crossing lines in 2D
                    double s = random_uniform(-0.5, 0.5), t = d == 3 || b % 2 ? s : 0;
                    double u = d == 3 ? random_uniform(-0.5, 0.5) : b % 2 ? 0 : s;
                    add(0.5 + t, 0.5 + u, 0.5 + x * t + y * u);
                }
                assert_true(found(profile, m).fault != SPHV_FAULT_NONE);
            }
    sphv_kernel_free(kernel);
}

/// A vertex lattice and the cubic B-spline at h = 1.0171 Δx, MSPH: condition numbers of theory.md
/// §8, found there with another program, to the digits given.
static void test_corner_with_six_points(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 2);
    for (int place = 0; place < 2; place++) {
        begin(2, sqrt(13 / (4 * M_PI)) / 16);
        double corner = place == 0 ? 0 : 0.5;
        add(corner, corner, 0);
        for (int i = 0; i <= 16; i++)
            for (int j = 0; j <= 16; j++)
                if (i / 16.0 != corner || j / 16.0 != corner) add(i / 16.0, j / 16.0, 0);
        struct single at = found(profile, SPHV_MSPH);
        assert_int_equal(at.fault, SPHV_FAULT_NONE);
        assert_int_equal(at.neighbours, place == 0 ? 6 : 13);
        if (place == 0)
            assert_close(at.condition, 1.6e3, 50);
        else
            assert_close(at.condition, 1.4, 0.05);
    }
    // one of the six moves out of the corner's reach
    begin(2, sqrt(13 / (4 * M_PI)) / 16);
    add(0, 0, 0);
    for (int i = 0; i <= 2; i++)
        for (int j = 0; j <= 2; j++)
            if (i + j > 0) add(i / 16.0 + (i == 2 && j == 0 ? 0.1 / 16 : 0), j / 16.0, 0);
    assert_int_equal(found(profile, SPHV_MSPH).fault, SPHV_FAULT_TOO_FEW);
    assert_int_equal(found(profile, SPHV_FPM).fault, SPHV_FAULT_NONE);
    sphv_kernel_free(kernel);
}

/// Fields beyond the numbers: marked, 0 in that field, and the other field untouched.
static void test_overflow(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("wendland-c4");
    for (int d = 1; d <= 3; d++) {
        const sphv_profile *profile = sphv_kernel_profile(kernel, d);
        for (int m = 0; sphv_methods[m].name; m++) {
            scatter(d, profile->support, &cloud);
            cloud.fields = 2;
            for (int b = 0; b < cloud.count; b++) {
                cloud.field[0][b] = (b ? -1 : 1) * DBL_MAX;
                cloud.field[1][b] = 3;
            }
            struct single at = found(profile, m);
            assert_int_equal(at.fault, SPHV_FAULT_NOT_FINITE);
            if (sphv_methods[m].value_consistency >= 0)
                assert_close(at.second[0], 3, 64 * DBL_EPSILON);
        }
    }
    sphv_kernel_free(kernel);
}

/// A few particles anywhere, some of them together, some at the support's end, volumes of any size:
/// a fault, or a finite number whose bound is finite.
static void test_anything(void **state)
{
    (void)state;
    random_start("anything");
    static const char *const kernels[] = {"cubic-spline", "gaussian", "wendland-c2"};
    int faults[SPHV_FAULTS] = {0};
    for (int k = 0; k < 3; k++) {
        sphv_kernel *kernel = load_kernel(kernels[k]);
        for (int round = 0; round < (quick() ? 30 : 1500); round++) {
            int d = (int)random_integer(1, 3), count = (int)random_integer(1, 14);
            const sphv_profile *profile = sphv_kernel_profile(kernel, d);
            if (!profile) continue;
            begin(d, random_log(1e-3, 1) / profile->support);
            double reach = cloud.h * profile->support, volume = random_log(1e-80, 1e80);
            for (int b = 0; b < count; b++) {
                double size = random_integer(0, 2)
                                  ? random_uniform(-1, 1)
                                  : (double)random_integer(0, 1) * random_log(1e-300, 1);
                add(b ? size * reach : 0, b ? (double)random_integer(-1, 1) * size * reach : 0,
                    b ? random_uniform(-0.5, 0.5) * reach * (double)random_integer(0, 1) : 0);
                cloud.volume[b] = volume * random_log(1e-3, 1);
            }
            for (int m = 0; sphv_methods[m].name; m++) {
                struct single at = found(profile, m);
                faults[at.fault]++;
                for (size_t q = 0; q < sphv_method_quantities((sphv_method)m, d); q++)
                    assert_true(isfinite(at.rounding[q]));
            }
        }
        sphv_kernel_free(kernel);
    }
    for (int f = 0; f < SPHV_FAULTS; f++) print_message("fault %d: %d times\n", f, faults[f]);
    for (int f = SPHV_FAULT_NONE; f <= SPHV_FAULT_ILL_CONDITIONED; f++) assert_true(faults[f] > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_isolated),          cmocka_unit_test(test_too_few),
        cmocka_unit_test(test_degenerate_places), cmocka_unit_test(test_corner_with_six_points),
        cmocka_unit_test(test_overflow),          cmocka_unit_test(test_anything),
    };
    return run_group(tests);
}
