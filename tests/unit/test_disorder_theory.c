/// Theory of the disordered error: its closed form for weak disorder, the limit of none, what it
/// refuses, and what it says where methods fail.
#include "disorder_support.h"

/// ∫Ŵ″² ds over the whole support.
static double curvature(const sphv_profile *profile)
{
    double sum = 0;
    gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(64);
    for (int p = 0; p < profile->piece_count; p++)
        for (size_t i = 0; i < 64; i++) {
            double s, w;
            gsl_integration_glfixed_point(profile->pieces[p].inner, profile->pieces[p].outer, i, &s,
                                          &w, table);
            sum += 2 * w * gsl_pow_2(sphv_profile_derivative(profile, 2, s).value);
        }
    gsl_integration_glfixed_table_free(table);
    return sum;
}

/// Volumes Δx, h → 0, σ → 0: each displacement σΔx adds A Ŵ″ h⁻³ Δx σΔx on its own, and the sum
/// over particles is ∫/Δs. In units of max|A'| = 2π and averaged over the phase (A² → 1/2),
///
///     RMS = (σ/Δx) Δs^(3/2) √∫Ŵ″² / (2π √2 h).
///
/// Left out: what the sums of Ŵ″² and of Ŵ″ differ by from their integrals (the latter, 0, is what
/// the particle's own displacement does beyond its share), both summed here; (2πh)² = 4e-7 of the
/// field's slope; σ² of the second order.
static void test_closed_form_noise(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    static const double spacings[] = {0.1, 0.17, 0.2385, 0.3};
    for (int i = 0; i < 8; i++) {
        // however small σ is: at 1e-8 its square is below rounding
        double sigma = i < 4 ? 1e-3 : 1e-8, h = sigma / 10, spacing = spacings[i % 4];
        sphv_experiment of = experiment(profile, SPHV_SPH, SPHV_VOLUME_LATTICE, sigma, spacing, h);
        sphv_prediction disordered, uniform;
        sphv_error error = {SPHV_OK, ""};
        assert_ok(sphv_predict_disorder(&of, &disordered, &error), error);
        assert_ok(sphv_predict_lattice(profile, h, of.spacing, SPHV_FORM_EXACT, &uniform, &error),
                  error);
        double noise = sqrt(gsl_pow_2(disordered.l2.value) - gsl_pow_2(uniform.l2.value));
        double wanted =
            sigma * pow(spacing, 1.5) * sqrt(curvature(profile)) / (2 * M_PI * M_SQRT2 * h);
        double squares = 0, sum = 0, whole = curvature(profile);
        for (int j = -50; j <= 50; j++) {
            double w = sphv_profile_derivative(profile, 2, fabs(j * spacing)).value;
            squares += spacing * w * w;
            sum += spacing * w;
        }
        double own = 2 * fabs(sphv_profile_derivative(profile, 2, 0).value * sum) + sum * sum;
        double rest = (fabs(squares - whole) + own) / (2 * whole);
        assert_true(rest < 1e-3);
        assert_close(noise, wanted, (rest + 1e-6 + 20 * sigma * sigma) * wanted);
    }
    sphv_kernel_free(kernel);
}

/// Without perturbation every method's prediction is what is known of the lattice.
static void test_limit_of_no_disorder(void **state)
{
    (void)state;
    random_start("no disorder");
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    for (int volume = SPHV_VOLUME_LATTICE; volume <= SPHV_VOLUME_TESSELLATED; volume++)
        for (int l = 0; l < 20; l++) {
            double h = random_log(3e-3, 0.4), spacing = random_uniform(0.2, 1.1);
            sphv_experiment of =
                experiment(profile, SPHV_SPH, (sphv_volume)volume, 1e-8, spacing, h);
            sphv_prediction uniform, nearly;
            sphv_error error = {SPHV_OK, ""};
            assert_ok(
                sphv_predict_lattice(profile, h, of.spacing, SPHV_FORM_EXACT, &uniform, &error),
                error);
            assert_ok(sphv_predict_disorder(&of, &nearly, &error), error);
            // noise below σ/h, in squares; a sum of rounded terms of order 1/K
            double noise = gsl_pow_2(of.sigma / h) / uniform.l2.value;
            assert_close(nearly.l2.value, uniform.l2.value, noise + 1e-14 / h);
            of.sigma = 0;
            assert_ok(sphv_predict_disorder(&of, &nearly, &error), error);
            assert_close(nearly.l2.value, uniform.l2.value, 0);
            // The other route to Bonet and Lok's lattice error: the ratio of two sums.
            of.method = SPHV_BONET_LOK;
            assert_ok(sphv_predict_disorder(&of, &uniform, &error), error);
            of.sigma = 1e-8;
            assert_ok(sphv_predict_disorder(&of, &nearly, &error), error);
            noise = gsl_pow_2(of.sigma) / uniform.l2.value;
            if (!is_close(nearly.l2.value, uniform.l2.value,
                          noise + uniform.l2.bound + 1e-13 * uniform.l2.value))
                fail_msg("h = %.17g, Δs = %.17g: %.17g ± %.2g on the lattice, %.17g nearly so", h,
                         spacing, uniform.l2.value, uniform.l2.bound, nearly.l2.value);
        }
    sphv_kernel_free(kernel);
}

static void test_refusals(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    sphv_experiment of =
        experiment(sphv_kernel_profile(kernel, 1), SPHV_SPH, SPHV_VOLUME_LATTICE, 0, 0.5, 0.02);
    sphv_prediction out;
    sphv_error error = {SPHV_OK, ""};
    of.layout = SPHV_RANDOM;
    assert_failed(sphv_predict_disorder(&of, &out, &error), &error, SPHV_NO_CLOSED_FORM, "random");
    of.layout = SPHV_QUASI_RANDOM;
    assert_failed(sphv_predict_disorder(&of, &out, &error), &error, SPHV_NO_CLOSED_FORM, "quasi");
    of.layout = SPHV_PERTURBED;
    static const double bad[] = {-0.1, NAN, INFINITY, 11};
    for (int i = 0; i < 4; i++) {
        of.sigma = bad[i];
        assert_failed(sphv_predict_disorder(&of, &out, &error), &error, SPHV_INVALID_INPUT,
                      "sigma");
    }
    of.sigma = 0.1;
    of.profile = sphv_kernel_profile(kernel, 2);
    assert_failed(sphv_predict_disorder(&of, &out, &error), &error, SPHV_NO_CLOSED_FORM,
                  "2 dimensions");
    sphv_kernel_free(kernel);
}

/// However large the disorder and however few the neighbours: a number with a bound, or a number
/// that admits to nothing.
static void test_no_nan(void **state)
{
    (void)state;
    random_start("theory where methods fail");
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    for (int method = 0; sphv_methods[method].name; method++)
        for (int volume = SPHV_VOLUME_LATTICE; volume <= SPHV_VOLUME_DENSITY; volume++)
            for (int l = 0; l < (quick() ? 1 : 6); l++) {
                sphv_experiment of = experiment(sphv_kernel_profile(kernel, 1), (sphv_method)method,
                                                (sphv_volume)volume, l ? random_log(0.1, 10) : 0,
                                                random_uniform(0.8, 1.99), random_log(1e-3, 0.5));
                sphv_prediction out;
                sphv_error error = {SPHV_OK, ""};
                assert_ok(sphv_predict_disorder(&of, &out, &error), error);
                if (isnan(out.l2.value)) assert_true(!(out.l2.bound < INFINITY));
                assert_false(out.l2.value < 0 || out.l2.bound < 0);
            }
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed_form_noise),
        cmocka_unit_test(test_limit_of_no_disorder),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_no_nan),
    };
    return run_group(tests);
}
