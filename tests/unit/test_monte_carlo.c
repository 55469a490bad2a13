/// Monte-Carlo measurements: the same for any number of threads, honest intervals, an independent
/// second measurement, and particles without an estimate counted instead of averaged.
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdlib.h>

#include "sphverify/compare.h"
#include "support.h"

#ifdef _OPENMP
#include <omp.h>
#endif

static sphv_kernel *kernel;

static sphv_experiment experiment(sphv_method method, sphv_layout layout, sphv_volume volume,
                                  double sigma, double spacing, double h)
{
    return (sphv_experiment){.profile = sphv_kernel_profile(kernel, 1),
                             .h = h,
                             .spacing = sphv_number_from_double(spacing),
                             .method = method,
                             .layout = layout,
                             .volume = volume,
                             .sigma = sigma,
                             .seed = 20060,
                             .width = 1e-9,
                             .realisations_min = 4,
                             .realisations_max = 12};
}

static sphv_disorder_measurement measure(const sphv_experiment *of)
{
    sphv_disorder_measurement out;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_measure_disorder(of, NULL, NULL, &out, &error), error);
    return out;
}

static void threads(int count)
{
#ifdef _OPENMP
    omp_set_num_threads(count);
#else
    (void)count;
#endif
}

static void assert_same(const sphv_disorder_measurement *a, const sphv_disorder_measurement *b)
{
    assert_memory_equal(&a->mean_square, &b->mean_square, sizeof a->mean_square);
    assert_memory_equal(&a->l2, &b->l2, sizeof a->l2);
    assert_int_equal(a->realisations, b->realisations);
    assert_int_equal(a->particles, b->particles);
    assert_int_equal(a->pairs, b->pairs);
    assert_int_equal(a->singular, b->singular);
    assert_int_equal(a->ill_conditioned, b->ill_conditioned);
    assert_int_equal(a->not_finite, b->not_finite);
    assert_memory_equal(&a->worst_condition, &b->worst_condition, sizeof a->worst_condition);
}

/// To the last bit, for every method and layout, also when the number of realisations is decided on
/// the way.
static void test_any_number_of_threads(void **state)
{
    (void)state;
    for (int method = 0; sphv_methods[method].name; method++)
        for (int layout = SPHV_LATTICE; layout <= SPHV_RANDOM; layout++)
            for (int l = 0; l < 2; l++) {
                sphv_experiment of =
                    experiment((sphv_method)method, (sphv_layout)layout, SPHV_VOLUME_TESSELLATED,
                               layout == SPHV_PERTURBED ? 0.15 : 0, 0.9, 0.03);
                of.realisations_max = 6;
                if (l) of.width = 0.3;
                threads(1);
                sphv_disorder_measurement one = measure(&of);
                for (int n = 2; n <= 5; n += 3) {
                    threads(n);
                    sphv_disorder_measurement many = measure(&of);
                    assert_same(&one, &many);
                }
                threads(2);
                if (layout == SPHV_LATTICE) continue;
                of.seed++;
                sphv_disorder_measurement other = measure(&of);
                assert_true(other.l2.value != one.l2.value);
            }
}

/// Realisations between least and most, and as many as the width needs.
static void test_width_decides_realisations(void **state)
{
    (void)state;
    sphv_experiment of =
        experiment(SPHV_SPH, SPHV_PERTURBED, SPHV_VOLUME_TESSELLATED, 0.1, 0.5, 0.02);
    assert_int_equal(measure(&of).realisations, 12);
    of.width = 1;
    of.realisations_min = 6;
    assert_int_equal(measure(&of).realisations, 6);
    of.width = 0.04;
    of.realisations_max = 1000;
    sphv_disorder_measurement found = measure(&of);
    assert_true(found.l2.bound <= 0.04 * found.l2.value);
    assert_true(found.realisations > 6 && found.realisations < 1000);
    assert_close(found.l2.value, sqrt(found.mean_square.value), 1e-15);
    assert_int_equal(found.particles, 160L * found.realisations);
    // Without chance two realisations of one particle say it all
    of.sigma = 0;
    found = measure(&of);
    assert_int_equal(found.particles, 2);
    assert_true(found.l2.bound < 1e-12);
}

/// The expectation is known for volumes Δx and standard SPH (each neighbour on its own). Of 60
/// intervals of 99.9 % each, three or more miss with probability 4e-5; and the intervals
/// are not wider than they claim: Student's t of 15 degrees has variance 15/13, and the variance of
/// 60 samples stays within a factor of 2.3 of it, but once in 10^6.
static void test_intervals_are_honest(void **state)
{
    (void)state;
    static const double sigmas[] = {0.02, 0.1, 0.2};
    int misses = 0, count = 60;
    double sum = 0, squares = 0, quantile = gsl_cdf_tdist_Pinv(0.9995, 15);
    for (int l = 0; l < count; l++) {
        sphv_experiment of = experiment(SPHV_SPH, SPHV_PERTURBED, SPHV_VOLUME_LATTICE,
                                        sigmas[l % 3], 0.5 + 0.1 * (l % 4), 0.02);
        of.seed = (uint64_t)(1000 + l);
        of.realisations_min = of.realisations_max = 16;
        sphv_prediction truth;
        sphv_error error = {SPHV_OK, ""};
        assert_ok(sphv_predict_disorder(&of, &truth, &error), error);
        assert_true(truth.l2.bound < 1e-3 * truth.l2.value);
        sphv_disorder_measurement found = measure(&of);
        double off = found.mean_square.value - gsl_pow_2(truth.l2.value);
        double t = off / found.mean_square.bound * quantile;
        misses += !(fabs(off) <= found.mean_square.bound);
        sum += t;
        squares += t * t;
    }
    print_message("%d of %d intervals miss; t has mean %.2f and mean square %.2f\n", misses, count,
                  sum / count, squares / count);
    assert_true(misses < 3);
    assert_close(sum / count, 0, 5 * sqrt(15.0 / 13 / count));
    assert_true(squares / count < 2.3 * 15 / 13 && squares / count > 15.0 / 13 / 2.3);
}

/// A standard normal number of the test's own.
static double normal(void)
{
    return sqrt(-2 * log(1 - random_uniform(0, 1))) * cos(2 * M_PI * random_uniform(0, 1));
}

enum { SIDE = 20 };

/// The error/max|A'| of one estimate, written without any of the program's sums: standard SPH, or
/// eqs. 27–28 with everything spelt out.
static double error_of(const sphv_experiment *of, const double *x, double own, double phase)
{
    double h = of->h, step = h * of->spacing.value, wv[2 * SIDE], dwv[2 * SIDE], a[2 * SIDE];
    double sum_w = 0, sum_dw = 0, gradient = 0, matrix = 0;
    for (int b = 1; b < 2 * SIDE; b++) {
        double r = fabs(x[b] - own), sign = x[b] > own ? 1 : -1;
        double volume = of->volume == SPHV_VOLUME_TESSELLATED ? (x[b + 1] - x[b - 1]) / 2 : step;
        wv[b] = r < 2 * h ? volume * sphv_profile_derivative(of->profile, 0, r / h).value / h : 0;
        // ∂W(x_b − x)/∂x at x = own
        dwv[b] =
            r < 2 * h && r > 0
                ? -sign * volume * sphv_profile_derivative(of->profile, 1, r / h).value / (h * h)
                : 0;
        a[b] = sin(2 * M_PI * x[b] + phase);
        sum_w += wv[b];
        sum_dw += dwv[b];
    }
    for (int b = 1; b < 2 * SIDE; b++) {
        if (of->method == SPHV_SPH) {
            gradient += a[b] * dwv[b];
            continue;
        }
        double corrected = dwv[b] / sum_w - wv[b] * sum_dw / (sum_w * sum_w);
        gradient += a[b] * corrected;
        matrix += x[b] * corrected;
    }
    if (of->method == SPHV_BONET_LOK) gradient /= matrix;
    return gradient / (2 * M_PI) - cos(2 * M_PI * own + phase);
}

/// The whole measurement once more: other random numbers, other sums, one particle a realisation.
static void test_against_independent_trials(void **state)
{
    (void)state;
    random_start("independent trials");
    int trials = quick() ? 1000 : 12000;
    static const sphv_method methods[] = {SPHV_SPH, SPHV_BONET_LOK};
    for (int m = 0; m < 2; m++)
        for (int volume = SPHV_VOLUME_LATTICE; volume <= SPHV_VOLUME_TESSELLATED; volume++) {
            sphv_experiment of =
                experiment(methods[m], SPHV_PERTURBED, (sphv_volume)volume, 0.2, 0.55, 0.02);
            of.realisations_min = of.realisations_max = 80;
            double mean = 0, squares = 0, step = of.h * of.spacing.value;
            for (int l = 0; l < trials; l++) {
                double x[2 * SIDE + 1];
                for (int j = 0; j <= 2 * SIDE; j++) x[j] = (j - SIDE + of.sigma * normal()) * step;
                double own = x[SIDE];
                gsl_sort(x, 1, 2 * SIDE + 1);
                double e = error_of(&of, x, own, random_uniform(0, 2 * M_PI));
                mean += e * e / trials;
                squares += e * e * e * e / trials;
            }
            sphv_disorder_measurement found = measure(&of);
            double spread = 5 * sqrt((squares - mean * mean) / trials);
            assert_true(spread < (quick() ? 0.8 : 0.3) * mean &&
                        found.mean_square.bound < 0.1 * mean);
            if (!is_close(found.mean_square.value, mean, spread + found.mean_square.bound))
                fail_msg("%s, volumes %s: %.6g ± %.2g, independent trials %.6g ± %.2g",
                         sphv_methods[of.method].name, sphv_volumes[volume].name,
                         found.mean_square.value, found.mean_square.bound, mean, spread);
        }
}

/// Particles that swap or coincide, supports of one particle or two, scattered layouts: no NaN
/// where any estimate is sound, faults counted, and no verdict on what nobody predicts.
static void test_where_methods_fail(void **state)
{
    (void)state;
    static const double spacings[] = {0.3, 0.95, 1.4, 1.98}, sigmas[] = {0.3, 1, 10};
    long faults = 0;
    for (int method = 0; sphv_methods[method].name; method++)
        for (int layout = SPHV_PERTURBED; layout <= SPHV_RANDOM; layout++)
            for (int volume = SPHV_VOLUME_LATTICE; volume <= SPHV_VOLUME_DENSITY; volume++)
                for (int l = 0; l < 4; l++) {
                    sphv_experiment of =
                        experiment((sphv_method)method, (sphv_layout)layout, (sphv_volume)volume,
                                   layout == SPHV_PERTURBED ? sigmas[l % 3] : 0, spacings[l], 0.02);
                    of.realisations_min = of.realisations_max = 2;
                    sphv_point point;
                    sphv_error error = {SPHV_OK, ""};
                    assert_ok(sphv_evaluate_experiment(&of, NULL, NULL, &point, &error), error);
                    const sphv_disorder_measurement *found = &point.disorder;
                    long bad = found->singular + found->ill_conditioned + found->not_finite;
                    faults += bad;
                    assert_true(found->particles > 0 && bad <= found->particles);
                    assert_true(found->worst_condition >= 1);
                    if (bad < found->particles)
                        assert_true(isfinite(found->l2.value) && found->l2.value >= 0);
                    else
                        assert_true(point.verdict == SPHV_INCONCLUSIVE);
                    assert_false(isnan(found->l2.bound) && isfinite(found->l2.value));
                    if (layout != SPHV_PERTURBED) assert_true(point.verdict == SPHV_INCONCLUSIVE);
                    // what needs no matrix has none to be singular
                    if (method == SPHV_SPH) assert_int_equal(bad, 0);
                    // three unknowns from one particle or two
                    if (method == SPHV_RKPM_2 && spacings[l] > 1.3) assert_true(bad > 0);
                    assert_true((bad == 0) == (found->worst_condition <= 1 / sqrt(0x1p-52)));
                }
    print_message("%ld particles without an estimate, all counted\n", faults);
    assert_true(faults > 1000);
}

static void refused(sphv_experiment of, const char *part)
{
    sphv_point point;
    sphv_error error = {SPHV_OK, ""};
    assert_failed(sphv_evaluate_experiment(&of, NULL, NULL, &point, &error), &error,
                  SPHV_INVALID_INPUT, part);
}

static void test_refusals(void **state)
{
    (void)state;
    sphv_experiment good =
        experiment(SPHV_SPH, SPHV_PERTURBED, SPHV_VOLUME_LATTICE, 0.1, 0.5, 0.02);
    static const double bad[] = {0, -1, NAN, INFINITY, -INFINITY, 1e300, 1e-300};
    for (int i = 0; i < 7; i++) {
        sphv_experiment of = good;
        of.h = bad[i];
        refused(of, "h is");
        of = good;
        of.spacing = sphv_number_from_double(bad[i]);
        refused(of, "spacing");
        of = good;
        if (i > 0 && i < 6) {
            of.sigma = bad[i];
            refused(of, "sigma");
        }
        of = good;
        of.width = bad[i];
        if (i < 3 || i == 4) refused(of, "width");
    }
    sphv_experiment of = good;
    of.volume = SPHV_VOLUME_UNIT;
    refused(of, "unit");
    of = good;
    of.layout = SPHV_RANDOM;
    refused(of, "layout");
    of = good;
    of.realisations_min = 1;
    refused(of, "realisations");
    of = good;
    of.realisations_max = of.realisations_min - 1;
    refused(of, "realisations");
}

static int load(void **state)
{
    (void)state;
    kernel = load_kernel("quinlan-w10");
    return 0;
}

static int unload(void **state)
{
    (void)state;
    sphv_kernel_free(kernel);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_number_of_threads),
        cmocka_unit_test(test_width_decides_realisations),
        cmocka_unit_test(test_intervals_are_honest),
        cmocka_unit_test(test_against_independent_trials),
        cmocka_unit_test(test_where_methods_fail),
        cmocka_unit_test(test_refusals),
    };
    tests_begin();
    return cmocka_run_group_tests(tests, load, unload);
}
