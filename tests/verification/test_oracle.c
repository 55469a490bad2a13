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

static mpfr_t exact, rest; ///< E in 320 bits, and what is left of it
static struct pair pairs[200];
static size_t pair_count;

static int load_all(void **state)
{
    (void)state;
    char *pattern = NULL;
    glob_t files;
    mpfr_inits2(320, exact, rest, (mpfr_ptr)NULL);
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
    mpfr_clears(exact, rest, (mpfr_ptr)NULL);
    mpfr_free_cache();
    return 0;
}

/// What was seen over all points of one kernel.
struct tally {
    long points, wrong, outside, disagreeing, inconclusive;
    double worst_relative;
};

/// exact − value, subtracted before it is rounded.
static double difference(const mpfr_t from, double value)
{
    mpfr_sub_d(rest, from, value, MPFR_RNDN);
    return mpfr_get_d(rest, MPFR_RNDA);
}

/// Judges one point; prints what is wrong with it.
static void judge(const struct pair *pair, double h, const mpq_t spacing, sphv_number number,
                  struct tally *tally)
{
    sphv_point point;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_evaluate_point(pair->profile, h, number, SPHV_FORM_EXACT, false, NULL, NULL,
                                  &point, &error),
              error);
    oracle_lattice_error_mpfr(pair->oracle, h, spacing, exact);
    // differences before rounding: a bound of half a unit in the last place can be judged too
    double truth = mpfr_get_d(exact, MPFR_RNDN),
           analytic_off = -difference(exact, point.analytic.total.value),
           empirical_off = -difference(exact, point.empirical.total.value);
    double allowed = fmax(1e-12 * fabs(truth), 1e-14); // the accuracy that is promised
    double off = fabs(analytic_off);
    tally->points++;
    if (off / allowed > tally->worst_relative) tally->worst_relative = off / allowed;
    bool wrong = h <= 0.2 && !is_close(analytic_off, 0, allowed);
    bool outside = !is_close(analytic_off, 0, point.analytic.total.bound) ||
                   !is_close(empirical_off, 0, point.empirical.total.bound);
    tally->wrong += wrong;
    tally->outside += outside;
    tally->disagreeing += point.verdict == SPHV_DISAGREES;
    tally->inconclusive += point.verdict == SPHV_INCONCLUSIVE;
    if (wrong || outside || point.verdict != SPHV_AGREES)
        print_message("%s: h %.17g, spacing %.17g: true %.17g, analytic %+.3g (bound %.3g), "
                      "empirical %+.3g (bound %.3g), %s\n",
                      oracle_name(pair->oracle), h, number.value, truth, analytic_off,
                      point.analytic.total.bound, empirical_off, point.empirical.total.bound,
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

static const double smoothing_lengths[] = {0.0018, 0.0036, 0.0072, 0.0144, 0.0288,
                                           0.0576, 0.1152, 0.2,    0.3,    0.5};
enum { LENGTHS = sizeof smoothing_lengths / sizeof *smoothing_lengths };

/// The whole grid of special spacings, Δs = 2κ/(2n+1).
static void test_special_spacings(void **state)
{
    (void)state;
    mpq_t spacing, part;
    mpq_inits(spacing, part, NULL);
    for (size_t k = 0; k < pair_count; k++) {
        struct tally tally = {0};
        for (int n = 2; n <= 40; n += quick() ? 19 : 1) {
            sphv_number number = sphv_profile_special_spacing(pairs[k].profile, n);
            oracle_support(pairs[k].oracle, spacing);
            mpq_set_ui(part, 2, (unsigned long)(2 * n + 1));
            mpq_canonicalize(part);
            mpq_mul(spacing, spacing, part);
            assert_close(number.value, mpq_get_d(spacing), 0x1p-52 * number.value);
            for (int i = 0; i < LENGTHS; i++)
                judge(&pairs[k], smoothing_lengths[i], spacing, number, &tally);
        }
        assert_clean(&tally, oracle_name(pairs[k].oracle));
    }
    mpq_clears(spacing, part, NULL);
}

/// A spacing as text: a fraction or a decimal.
static void random_spacing(double from, double to, char *text, size_t size)
{
    double wanted = random_log(from, to);
    long top = random_integer(1, 90);
    if (random_integer(0, 1)) {
        snprintf(text, size, "%ld/%ld", top, (long)ceil((double)top / wanted));
        return;
    }
    snprintf(text, size, "%.*g", (int)random_integer(2, 17), wanted);
    if (strtod(text, NULL) > to) snprintf(text, size, "%.17g", wanted); // rounded beyond the end
}

static sphv_number read_spacing(const char *text, mpq_t spacing)
{
    sphv_number number = {0, 0};
    sphv_error error = {SPHV_OK, ""};
    assert_true(oracle_rational(text, spacing));
    assert_ok(sphv_number_parse(text, &number, &error), error);
    return number;
}

/// Random fractions and decimals, h logarithmic over the whole range.
static void test_arbitrary_spacings(void **state)
{
    (void)state;
    random_start("arbitrary spacings");
    mpq_t spacing;
    mpq_init(spacing);
    for (size_t k = 0; k < pair_count; k++) {
        struct tally tally = {0};
        for (int i = 0; i < (quick() ? 4 : 40); i++) {
            char text[64];
            random_spacing(0.03, 0.9 * pairs[k].profile->support, text, sizeof text);
            sphv_number number = read_spacing(text, spacing);
            judge(&pairs[k], random_log(1.8e-3, 0.5), spacing, number, &tally);
        }
        assert_clean(&tally, oracle_name(pairs[k].oracle));
    }
    mpq_clear(spacing);
}

/// Particles exactly on knots, a hair inside and a hair outside: Δs = κ_i/m and the two doubles
/// beside it. Whether the last particle counts is decided exactly by both.
static void test_particles_on_knots(void **state)
{
    (void)state;
    mpq_t spacing;
    mpq_init(spacing);
    for (size_t k = 0; k < pair_count; k++) {
        struct tally tally = {0};
        const sphv_profile *profile = pairs[k].profile;
        for (int i = 0; i < profile->knot_count; i++)
            for (unsigned long m = 2; m <= (quick() ? 3 : 24); m += m < 8 ? 1 : 8) {
                sphv_number knot = profile->knots[i].position;
                if (knot.value == 0 || knot.residual != 0) continue;
                mpq_set_d(spacing, knot.value);
                mpq_t divisor;
                mpq_init(divisor);
                mpq_set_ui(divisor, m, 1);
                mpq_div(spacing, spacing, divisor);
                mpq_clear(divisor);
                char *text = mpq_get_str(NULL, 10, spacing);
                sphv_number number = read_spacing(text, spacing);
                const sphv_number at[] = {number,
                                          sphv_number_from_double(nextafter(number.value, 0)),
                                          sphv_number_from_double(nextafter(number.value, 9))};
                for (int b = 0; b < 3; b++) {
                    if (b) mpq_set_d(spacing, at[b].value);
                    const double lengths[] = {0.0018, 0.05, 0.2};
                    for (int l = 0; l < 3; l++)
                        judge(&pairs[k], lengths[l], spacing, at[b], &tally);
                }
                free(text);
            }
        assert_clean(&tally, oracle_name(pairs[k].oracle));
    }
    mpq_clear(spacing);
}

/// Far outside the range in which accuracy is promised the bounds must still hold: a bound may be
/// wide there, and the verdict inconclusive, but nothing may disagree with itself.
static void test_bounds_hold_at_the_extremes(void **state)
{
    (void)state;
    random_start("extremes");
    mpq_t spacing;
    mpq_init(spacing);
    long outside = 0, disagreeing = 0, points = 0;
    for (size_t k = 0; k < pair_count; k++)
        for (int i = 0; i < (quick() ? 2 : 30); i++) {
            char text[64];
            random_spacing(0.002, 0.999 * pairs[k].profile->support, text, sizeof text);
            sphv_number number = read_spacing(text, spacing);
            if (number.value < 0.002) continue;
            struct tally tally = {0};
            double h = i % 3 == 0   ? random_log(SPHV_H_MIN, 1e-3)
                       : i % 3 == 1 ? random_log(0.5, SPHV_H_MAX)
                                    : random_log(1e-3, 0.5);
            judge(&pairs[k], h, spacing, number, &tally);
            points++;
            outside += tally.outside;
            disagreeing += tally.disagreeing;
        }
    mpq_clear(spacing);
    if (outside || disagreeing)
        fail_msg("of %ld points %ld are outside their bounds and %ld disagree", points, outside,
                 disagreeing);
}

/// The constant of every kernel, from the oracle's own normalisation.
static void test_constants(void **state)
{
    (void)state;
    for (size_t k = 0; k < pair_count; k++) {
        double expected = oracle_constant(pairs[k].oracle);
        assert_within_bounds(pairs[k].profile->constant, expected);
        assert_close(pairs[k].profile->constant.value, expected, 1e-14 * expected);
    }
}

/// The judge must notice a kernel that is wrong in the fifth digit, or it judges nothing.
static void test_the_oracle_is_not_blind(void **state)
{
    (void)state;
    static const char wrong[] =
        "name: wrong\ntitle: Cubic spline with 0.75001\nsupport: 2\npieces:\n"
        "  - {until: 1, coefficients: [\"1\", \"0\", \"-3/2\", \"0.75001\"]}\n"
        "  - {until: 2, coefficients: [\"2\", \"-3\", \"3/2\", \"-1/4\"]}\ndimensions: [1]\n";
    char *folder = folder_make(), *path = file_write(folder, "wrong.yaml", wrong);
    const char *reason = NULL;
    oracle *judge_of_wrong = oracle_load(path, &reason);
    assert_non_null(judge_of_wrong);
    sphv_kernel *right = load_kernel("cubic-spline");
    mpq_t spacing;
    mpq_init(spacing);
    sphv_number number = read_spacing("4/11", spacing);
    sphv_prediction prediction;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_predict_lattice(sphv_kernel_profile(right, 1), 0.02, number, SPHV_FORM_EXACT,
                                   &prediction, &error),
              error);
    assert_false(
        is_within_bounds(prediction.total, oracle_lattice_error(judge_of_wrong, 0.02, spacing)));
    mpq_clear(spacing);
    sphv_kernel_free(right);
    oracle_free(judge_of_wrong);
    free(path);
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_special_spacings),
        cmocka_unit_test(test_arbitrary_spacings),
        cmocka_unit_test(test_particles_on_knots),
        cmocka_unit_test(test_bounds_hold_at_the_extremes),
        cmocka_unit_test(test_constants),
        cmocka_unit_test(test_the_oracle_is_not_blind),
    };
    tests_begin();
    return cmocka_run_group_tests(tests, load_all, free_all);
}
