/// Both halves against the oracle, for every shipped kernel that is legal in one dimension.
#include "oracle.h"

#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sphverify/compare.h"
#include "support.h"

/// A kernel as the library and as the oracle read it.
struct pair {
    sphv_kernel *kernel;
    const sphv_profile *profile;
    oracle *oracle;
};

static struct pair pairs[200];
static size_t pair_count;

static int load_all(void **state)
{
    (void)state;
    char *pattern = NULL;
    glob_t files;
    if (asprintf(&pattern, "%s/kernels/*.yaml", data_directory()) < 0 ||
        glob(pattern, 0, NULL, &files) != 0)
        return -1;
    free(pattern);
    for (size_t i = 0; i < files.gl_pathc && pair_count < 200; i++) {
        struct pair *pair = &pairs[pair_count];
        sphv_error error = {SPHV_OK, ""};
        assert_ok(sphv_kernel_load(files.gl_pathv[i], &pair->kernel, &error), error);
        pair->profile = sphv_kernel_profile(pair->kernel, 1);
        const char *reason = NULL;
        pair->oracle = pair->profile ? oracle_load(files.gl_pathv[i], &reason) : NULL;
        if (pair->profile && !pair->oracle)
            fail_msg("the oracle cannot judge %s: %s", files.gl_pathv[i], reason);
        if (pair->oracle)
            pair_count++;
        else
            sphv_kernel_free(pair->kernel);
    }
    globfree(&files);
    return pair_count >= 4 ? 0 : -1;
}

static int free_all(void **state)
{
    (void)state;
    for (size_t i = 0; i < pair_count; i++) {
        sphv_kernel_free(pairs[i].kernel);
        oracle_free(pairs[i].oracle);
    }
    mpfr_free_cache();
    return 0;
}

/// What was seen over all points of one kernel.
struct tally {
    long points, wrong, outside, disagreeing, inconclusive;
    double worst_relative;
};

/// Judges one point; prints what is wrong with it.
static void judge(const struct pair *pair, double h, const mpq_t spacing, sphv_number number,
                  struct tally *tally)
{
    sphv_point point;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_evaluate_point(pair->profile, h, number, SPHV_FORM_EXACT, false, NULL, NULL,
                                  &point, &error),
              error);
    double truth = oracle_lattice_error(pair->oracle, h, spacing);
    double allowed = fmax(1e-12 * fabs(truth), 1e-14); // the accuracy that is promised
    double off = fabs(point.analytic.total.value - truth);
    tally->points++;
    if (off / allowed > tally->worst_relative) tally->worst_relative = off / allowed;
    bool wrong = h <= 0.2 && !is_close(point.analytic.total.value, truth, allowed);
    bool outside = !is_within_bounds(point.analytic.total, truth) ||
                   !is_within_bounds(point.empirical.total, truth);
    tally->wrong += wrong;
    tally->outside += outside;
    tally->disagreeing += point.verdict == SPHV_DISAGREES;
    tally->inconclusive += point.verdict == SPHV_INCONCLUSIVE;
    if (wrong || outside || point.verdict != SPHV_AGREES)
        print_message("%s: h %.17g, spacing %.17g: true %.17g, analytic %+.3g (bound %.3g), "
                      "empirical %+.3g (bound %.3g), %s\n",
                      oracle_name(pair->oracle), h, number.value, truth,
                      point.analytic.total.value - truth, point.analytic.total.bound,
                      point.empirical.total.value - truth, point.empirical.total.bound,
                      sphv_verdict_name(point.verdict));
}

/// Every point within its bounds, as accurate as promised, and with the verdict `agrees`.
static void assert_clean(const struct tally *tally, const char *name)
{
    print_message("%-24s %6ld points, worst %.3g of the promised accuracy\n", name, tally->points,
                  tally->worst_relative);
    if (tally->wrong || tally->outside || tally->disagreeing || tally->inconclusive)
        fail_msg("%s: of %ld points %ld are less accurate than promised, %ld outside their "
                 "bounds, %ld disagree, %ld are inconclusive",
                 name, tally->points, tally->wrong, tally->outside, tally->disagreeing,
                 tally->inconclusive);
}

static const double smoothing_lengths[] = {0.0018, 0.0036, 0.0072, 0.0144, 0.02,
                                           0.0288, 0.0576, 0.1,    0.1152, 0.2,
                                           0.2304, 0.3,    0.4,    0.4608, 0.5};
enum { LENGTHS = sizeof smoothing_lengths / sizeof *smoothing_lengths };

/// The whole grid of special spacings, Δs = 2κ/(2n+1).
static void test_special_spacings(void **state)
{
    (void)state;
    mpq_t spacing, part;
    mpq_inits(spacing, part, NULL);
    int bad = 0;
    for (size_t k = 0; k < pair_count; k++) {
        struct tally tally = {0};
        for (int n = 2; n <= 40; n++) {
            sphv_number number = sphv_profile_special_spacing(pairs[k].profile, n);
            oracle_support(pairs[k].oracle, spacing);
            mpq_set_ui(part, 2, (unsigned long)(2 * n + 1));
            mpq_canonicalize(part);
            mpq_mul(spacing, spacing, part);
            assert_close(number.value, mpq_get_d(spacing), 0x1p-52 * number.value);
            for (int i = 0; i < LENGTHS; i++)
                judge(&pairs[k], smoothing_lengths[i], spacing, number, &tally);
        }
        print_message("%-24s %ld points, worst %.3g; %ld %ld %ld %ld\n",
                      oracle_name(pairs[k].oracle), tally.points, tally.worst_relative, tally.wrong,
                      tally.outside, tally.disagreeing, tally.inconclusive);
        bad += tally.wrong || tally.outside || tally.disagreeing || tally.inconclusive;
    }
    mpq_clears(spacing, part, NULL);
    assert_int_equal(bad, 0);
}

/// Random fractions and decimals below the support, h logarithmic over the whole range.
static void test_arbitrary_spacings(void **state)
{
    (void)state;
    random_start("arbitrary spacings");
    mpq_t spacing;
    mpq_init(spacing);
    for (size_t k = 0; k < pair_count; k++) {
        struct tally tally = {0};
        double support = pairs[k].profile->support;
        for (int i = 0; i < 60; i++) {
            char text[64];
            double wanted = random_log(0.03, 0.6 * support);
            if (i % 2)
                snprintf(text, sizeof text, "%.3g", wanted);
            else
                snprintf(text, sizeof text, "%ld/%ld", random_integer(1, 90),
                         (long)ceil(90 / wanted));
            assert_true(oracle_rational(text, spacing));
            sphv_number number;
            sphv_error error = {SPHV_OK, ""};
            assert_ok(sphv_number_parse(text, &number, &error), error);
            if (number.value < 0.02) continue;
            judge(&pairs[k], random_log(1.8e-3, 0.5), spacing, number, &tally);
        }
        assert_clean(&tally, oracle_name(pairs[k].oracle));
    }
    mpq_clear(spacing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_special_spacings),
        cmocka_unit_test(test_arbitrary_spacings),
    };
    tests_begin();
    return cmocka_run_group_tests(tests, load_all, free_all);
}
