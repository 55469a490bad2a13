/// The sums behind the theory of disorder: means and covariances against brute force, closed forms
/// and the first-order noise response, and what is made of them.
#include "disorder_support.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <stdlib.h>
#include <string.h>

/// Sums of the summands, of their products, and of the products' squares over the trials.
struct sample {
    double mean[SPHV_SUMS_MAX], product[SPHV_SUMS_MAX][SPHV_SUMS_MAX],
        square[SPHV_SUMS_MAX][SPHV_SUMS_MAX];
};

/// Mean and covariance against trials with six standard errors (2e-9 each; some 2000 comparisons).
static void compare_with_trials(const sphv_experiment *of, const sphv_sums *theory,
                                const struct sample *sample, double trials)
{
    for (int i = 0; i < theory->count; i++) {
        double mean = sample->mean[i] / trials;
        double error = sqrt(theory->covariance[i][i] / trials);
        // rounding: sums of the trials that do not vary at all
        if (!is_close(theory->mean[i], mean, 6 * error + 1e-12 * fabs(mean) + 1e-15))
            fail_msg("%s, volumes %s: mean %d is %.12g, %.0f trials say %.12g ± %.2g",
                     sphv_methods[of->method].name, sphv_volumes[of->volume].name, i,
                     theory->mean[i], trials, mean, error);
        for (int j = 0; j <= i; j++) {
            // products were taken about the theory's mean
            double covariance = sample->product[i][j] / trials;
            double spread =
                sqrt(fmax(sample->square[i][j] / trials - covariance * covariance, 0) / trials);
            double size = sqrt(theory->covariance[i][i] * theory->covariance[j][j]);
            if (!is_close(theory->covariance[i][j], covariance, 6 * spread + 1e-10 * size + 1e-28))
                fail_msg("%s, volumes %s: covariance %d %d is %.12g, %.0f trials say %.12g ± %.2g",
                         sphv_methods[of->method].name, sphv_volumes[of->volume].name, i, j,
                         theory->covariance[i][j], trials, covariance, spread);
            assert_close(theory->covariance[i][j], theory->covariance[j][i], 0);
        }
    }
}

static void trial(const sphv_experiment *of, double K, sphv_phase phase, double own,
                  const sphv_sums *theory, struct sample *sample)
{
    enum { SIDE = 24 };
    double s[2 * SIDE + 1], sum[SPHV_SUMS_MAX] = {0}, spacing = of->spacing.value;
    for (int j = -SIDE; j <= SIDE; j++)
        s[j + SIDE] = j ? (j + of->sigma * (normal() - own)) * spacing : 0;
    for (int b = 1; b < 2 * SIDE; b++) {
        double z[SPHV_SUMS_MAX];
        if (!(fabs(s[b]) < of->profile->support)) continue;
        double volume =
            of->volume == SPHV_VOLUME_TESSELLATED ? 0.5 * (s[b + 1] - s[b - 1]) : spacing;
        sphv_sums_summand(of->method, of->profile, K, phase, s[b], z);
        for (int i = 0; i < theory->count; i++) sum[i] += z[i] * volume;
    }
    for (int i = 0; i < theory->count; i++) {
        sample->mean[i] += sum[i];
        for (int j = 0; j <= i; j++) {
            double product = (sum[i] - theory->mean[i]) * (sum[j] - theory->mean[j]);
            sample->product[i][j] += product;
            sample->square[i][j] += product * product;
        }
    }
}

/// Nothing but the perturbations themselves, drawn many times.
static void test_conditional_sums_against_trials(void **state)
{
    (void)state;
    random_start("sums");
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    int trials = quick() ? 500 : 6000;
    for (int method = 0; sphv_methods[method].name; method++)
        for (int volume = SPHV_VOLUME_LATTICE; volume <= SPHV_VOLUME_TESSELLATED; volume++)
            for (int phase = SPHV_PHASE_SINE; phase <= SPHV_PHASE_COSINE; phase++) {
                sphv_experiment of = experiment(sphv_kernel_profile(kernel, 1), (sphv_method)method,
                                                (sphv_volume)volume, random_uniform(0.05, 0.25),
                                                random_uniform(0.35, 0.9), random_log(0.01, 0.2));
                double K = 2 * M_PI * of.h, own = normal();
                sphv_sums theory;
                conditional(&of, K, (sphv_phase)phase, own, MOST_NODES, &theory);
                struct sample *sample = calloc(1, sizeof *sample);
                assert_non_null(sample);
                for (int l = 0; l < trials; l++)
                    trial(&of, K, (sphv_phase)phase, own, &theory, sample);
                compare_with_trials(&of, &theory, sample, trials);
                free(sample);
            }
    sphv_kernel_free(kernel);
}

/// Integrand of the particle's own place on the lattice, which the particle itself never takes.
struct place {
    const sphv_experiment *of;
    double K, own;
    sphv_phase phase;
    int square; ///< 1: z, 2: z²
    int index;
};

static double at_place(double xi, void *context)
{
    const struct place *p = context;
    double s = (p->index + p->of->sigma * (xi - p->own)) * p->of->spacing.value, z;
    if (!(fabs(s) < p->of->profile->support)) return 0;
    sphv_sums_summand(SPHV_SPH, p->of->profile, p->K, p->phase, s, &z);
    return gsl_pow_int(z, p->square) * exp(-xi * xi / 2) / sqrt(2 * M_PI);
}

/// E over a neighbour's perturbation by adaptive quadrature.
static double expectation(const struct place *place)
{
    double value, error;
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(200);
    gsl_function f = {at_place, (void *)(uintptr_t)place};
    // some integrals vanish: rounding may keep the routine from what is asked, not from 1e-13
    int status = gsl_integration_qag(&f, -9, 9, 1e-14, 1e-12, 200, 6, w, &value, &error);
    assert_true((status == 0 || status == GSL_EROUND) && error < 1e-12);
    gsl_integration_workspace_free(w);
    return value;
}

/// Volumes Δx, standard SPH: a normal displacement multiplies each alias of the lattice sum by its
/// characteristic function. With neighbours at (b − σξ_a + σξ_b)Δs, ω_m = 2πm/Δs,
///
///     sine:    Σ_m F_m cos(2πmσξ_a) e^{−(2πmσ)²/2},   F_m = −½ [(K+ω)Ŵ_F(K+ω) + (K−ω)Ŵ_F(K−ω)]
///     cosine:  2 Σ_{m>0} G_m sin(−2πmσξ_a) e^{…},     G_m = −½ [(K+ω)Ŵ_F(K+ω) − (K−ω)Ŵ_F(K−ω)]
///
/// less what the sum has at b = 0, where the particle itself stands and adds nothing.
static double mean_by_characteristic_functions(const sphv_experiment *of, double K,
                                               sphv_phase phase, double own)
{
    double sum = 0;
    for (int m = 0; m <= 12; m++) {
        double omega = 2 * M_PI * m / of->spacing.value, turn = 2 * M_PI * m * of->sigma;
        double plus = (K + omega) * sphv_fourier_transform(of->profile, K + omega).value;
        double minus = (K - omega) * sphv_fourier_transform(of->profile, fabs(K - omega)).value;
        double damping = exp(-turn * turn / 2);
        if (phase == SPHV_PHASE_SINE)
            sum += (m ? 2 : 1) * -0.5 * (plus + minus) * cos(turn * own) * damping;
        else
            sum += 2 * -0.5 * (plus - minus) * sin(-turn * own) * damping;
    }
    struct place self = {of, K, own, phase, 1, 0};
    return sum - of->spacing.value * expectation(&self);
}

/// What the rule of 64 nodes leaves of the mean. At the edge the fourth derivative of W10's summand
/// jumps by 5!·693/1024 times the field; a rule of node distance δ = π/√n errs there as a lattice
/// sum does, by δ⁵ B̄_5/5! times the jump in ξ and the normal density, of which at most 0.4 + σ
/// comes together at either edge; sup|B̄_5|/5! is 2/(2π)⁵. Half as much again for higher orders.
static double rule_error(const sphv_experiment *of, double field)
{
    double spacing = of->spacing.value, jump = 81.2 * field * gsl_pow_4(of->sigma * spacing);
    return 1.5 * 2 * spacing * jump * pow(M_PI / sqrt(MANY_NODES), 5) * 2 / pow(2 * M_PI, 5) *
           (0.4 + of->sigma);
}

/// Twelve aliases are enough: beyond, at ω > 13·2π/1.1, Ŵ_F is 162/ω⁶ and the damping below 3e-4,
/// 1e-10 in all. 24 integrals to 1e-12 of numbers below 3 make as much in the variance.
static void test_mean_by_characteristic_functions(void **state)
{
    (void)state;
    random_start("characteristic functions");
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    for (int l = 0; l < (quick() ? 4 : 40); l++) {
        sphv_experiment of =
            experiment(profile, SPHV_SPH, SPHV_VOLUME_LATTICE, random_uniform(0.05, 0.25),
                       random_uniform(0.3, 1.1), random_log(0.003, 0.3));
        double K = 2 * M_PI * of.h, own = normal();
        sphv_phase phase = l % 2 ? SPHV_PHASE_COSINE : SPHV_PHASE_SINE;
        sphv_sums sums;
        double spacing = of.spacing.value;
        conditional(&of, K, phase, own, MANY_NODES, &sums);
        double bound = rule_error(&of, phase == SPHV_PHASE_SINE ? fmin(1, 2 * K) : 1) + 1e-10;
        double variance_bound = 2 * spacing * bound + 1e-10;
        assert_true(bound < 1e-5);
        assert_close(sums.mean[0], mean_by_characteristic_functions(&of, K, phase, own), bound);
        // independent summands: the variance is the sum of theirs
        double variance = 0;
        for (int b = -12; b <= 12; b++) {
            if (b == 0) continue;
            struct place place = {&of, K, own, phase, 1, b};
            double mean = expectation(&place);
            place.square = 2;
            variance += spacing * spacing * (expectation(&place) - mean * mean);
        }
        assert_true(variance_bound < 0.01 * variance + 2e-10);
        assert_close(sums.covariance[0][0], variance, variance_bound);
    }
    sphv_kernel_free(kernel);
}

/// Total covariance over the particle's own perturbation too.
static void total(const sphv_experiment *of, double K, sphv_phase phase, sphv_sums *out)
{
    double own[8], weights[8];
    rule(8, own, weights);
    memset(out, 0, sizeof *out);
    sphv_sums part[8];
    for (int k = 0; k < 8; k++) {
        conditional(of, K, phase, own[k], MOST_NODES, &part[k]);
        out->count = part[k].count;
        for (int i = 0; i < out->count; i++) out->mean[i] += weights[k] * part[k].mean[i];
    }
    for (int k = 0; k < 8; k++)
        for (int i = 0; i < out->count; i++)
            for (int j = 0; j < out->count; j++)
                out->covariance[i][j] +=
                    weights[k] * (part[k].covariance[i][j] + (part[k].mean[i] - out->mean[i]) *
                                                                 (part[k].mean[j] - out->mean[j]));
}

/// A spacing at which no offset crosses the edge of the support, where summands have kinks that no
/// power of σ describes: the rules move offsets by at most 2σ(6.7 + 4.2) < 0.03 spacings.
static double spacing_off_the_edge(const sphv_profile *profile)
{
    for (;;) {
        double spacing = random_uniform(0.3, 0.9), last = profile->support / spacing;
        if (fabs(last - nearbyint(last)) > 0.03) return spacing;
    }
}

/// The exact covariances tend to the first-order noise response as σ², with a relative rest of
/// order σ² by symmetry: what is left at σ is a third of the change to 2σ.
static void test_first_order_limit(void **state)
{
    (void)state;
    random_start("first order");
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    int compared = 0, telling = 0;
    for (int method = 0; sphv_methods[method].name; method++)
        for (int volume = SPHV_VOLUME_LATTICE; volume <= SPHV_VOLUME_TESSELLATED; volume++)
            for (int phase = SPHV_PHASE_SINE; phase <= SPHV_PHASE_COSINE; phase++) {
                double sigma = 1e-3;
                const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
                sphv_experiment of =
                    experiment(profile, (sphv_method)method, (sphv_volume)volume, sigma,
                               spacing_off_the_edge(profile), random_log(0.02, 0.2));
                double K = 2 * M_PI * of.h;
                sphv_sums once, twice, first;
                total(&of, K, (sphv_phase)phase, &once);
                sphv_sums_first_order(&of, K, (sphv_phase)phase, &first);
                of.sigma = 2 * sigma;
                total(&of, K, (sphv_phase)phase, &twice);
                for (int i = 0; i < first.count; i++)
                    for (int j = 0; j < first.count; j++) {
                        double size = sqrt(first.covariance[i][i] * first.covariance[j][j]);
                        double rest = fabs(twice.covariance[i][j] / 4 - once.covariance[i][j]) / 2;
                        // summands' slopes by differences: 1e-10 of their third derivatives
                        if (!is_close(once.covariance[i][j], first.covariance[i][j],
                                      rest + 1e-7 * size + 1e-28))
                            fail_msg("%s, volumes %s: covariance %d %d is %.12g, by noise response "
                                     "%.12g, rest %.2g",
                                     sphv_methods[method].name, sphv_volumes[volume].name, i, j,
                                     once.covariance[i][j], first.covariance[i][j], rest);
                        compared++;
                        telling += rest < 1e-2 * size;
                    }
            }
    // of smooth sums with tessellated volumes hardly any first order is left
    print_message("first order tells within 1 %% in %d of %d covariances\n", telling, compared);
    assert_true(telling > compared / 2);
    sphv_kernel_free(kernel);
}

/// E[error²] over the normal distribution by the tensor product of Gauss and Hermite's rule.
static double tensor(const sphv_experiment *of, double K, sphv_phase phase, const sphv_sums *sums,
                     int nodes_each)
{
    int n = sums->count, points = (int)gsl_pow_int(nodes_each, n);
    double nodes[MOST_NODES], weights[MOST_NODES], average = 0;
    rule(nodes_each, nodes, weights);
    gsl_matrix *root = gsl_matrix_alloc((size_t)n, (size_t)n);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            gsl_matrix_set(root, (size_t)i, (size_t)j, sums->covariance[i][j]);
    assert_int_equal(gsl_linalg_cholesky_decomp1(root), 0);
    for (int p = 0; p < points; p++) {
        double at[SPHV_SUMS_MAX], weight = 1;
        memcpy(at, sums->mean, sizeof at);
        for (int j = 0, rest = p; j < n; j++, rest /= nodes_each) {
            weight *= weights[rest % nodes_each];
            for (int i = j; i < n; i++)
                at[i] += gsl_matrix_get(root, (size_t)i, (size_t)j) * nodes[rest % nodes_each];
        }
        average += weight * gsl_pow_2(sphv_sums_error(of->method, K, phase, at));
    }
    gsl_matrix_free(root);
    return average;
}

/// The rule for E[error²] is exact through the fourth order in the fluctuations: halving them
/// divides what is left by 2⁶.
static void test_mean_square_of_random_sums(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    static const sphv_method methods[] = {SPHV_SHEPARD, SPHV_BONET_LOK};
    for (int l = 0; l < 4; l++) {
        sphv_experiment of = experiment(sphv_kernel_profile(kernel, 1), methods[l % 2],
                                        SPHV_VOLUME_TESSELLATED, 0.15, 0.7, 0.05);
        double K = 2 * M_PI * of.h, left[2], linear[2];
        sphv_phase phase = l < 2 ? SPHV_PHASE_SINE : SPHV_PHASE_COSINE;
        sphv_sums sums;
        total(&of, K, phase, &sums);
        for (int k = 0; k < 2; k++) {
            sphv_mean_square square = sphv_sums_mean_square(of.method, K, phase, &sums);
            double by_tensor = tensor(&of, K, phase, &sums, methods[l % 2] == SPHV_SHEPARD ? 8 : 6);
            left[k] = fabs(square.value - by_tensor) / by_tensor;
            linear[k] = fabs(square.linear - by_tensor) / by_tensor;
            for (int i = 0; i < sums.count; i++)
                for (int j = 0; j < sums.count; j++) sums.covariance[i][j] /= 4;
        }
        assert_true(left[0] < linear[0] && linear[0] > 1e-3);
        // relative to a mean square that itself falls by up to 2²
        assert_true(left[1] <= left[0] / 12 + 1e-9);
    }
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_conditional_sums_against_trials),
        cmocka_unit_test(test_mean_by_characteristic_functions),
        cmocka_unit_test(test_first_order_limit),
        cmocka_unit_test(test_mean_square_of_random_sums),
    };
    return run_group(tests);
}
