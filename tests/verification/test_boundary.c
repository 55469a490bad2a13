/// The theory of boxes against the particles: every method, in one to three dimensions.
#include <gsl/gsl_fit.h>
#include <gsl/gsl_math.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "sphverify/boundary.h"
#include "sphverify/estimate.h"
#include "support.h"

enum { METHODS = SPHV_MSPH + 1 };

/// A field at all particles, or one of its derivatives.
static double *sample(const sphv_particles *particles, const sphv_field *field,
                      const int order[SPHV_DIMENSIONS])
{
    double *values = malloc(particles->count * sizeof *values);
    assert_non_null(values);
    for (size_t n = 0; n < particles->count; n++) {
        double x[SPHV_DIMENSIONS] = {0};
        for (int i = 0; i < particles->dimension; i++) x[i] = particles->x[i][n];
        values[n] = sphv_field_derivative(field, order, x);
    }
    return values;
}

/// One experiment: a box, and every method on it.
struct trial {
    sphv_box box;
    const sphv_profile *profile;
    double h;
    sphv_field field;
    sphv_route route;
};

/// Holds one method's prediction against what was measured.
static void compare(const struct trial *of, const sphv_particles *particles,
                    const sphv_estimates *estimates, size_t method, sphv_box_prediction prediction)
{
    sphv_method name = estimates->methods[method].method;
    assert_int_equal(prediction.quantities, estimates->methods[method].quantities);
    for (size_t q = 0; q < prediction.quantities; q++) {
        double *exact = sample(particles, &of->field, sphv_monomials(of->box.dimension)[q].power);
        double margin = of->h * of->profile->support;
        sphv_norms all = sphv_error_norms(particles, estimates, method, 0, q, exact, 0);
        sphv_norms inside = sphv_error_norms(particles, estimates, method, 0, q, exact, margin);
        size_t excluded = 0;
        for (int fault = 0; fault < SPHV_FAULTS; fault++) excluded += all.excluded[fault];
        assert_close(prediction.excluded, (double)excluded, 1e-6 * (double)particles->count);
        if (!is_close(prediction.rmse[q].value, all.rmse, prediction.rmse[q].bound + all.bound))
            printf("%s, quantity %zu of %s, side %zu\n", sphv_methods[name].name, q, of->field.name,
                   of->box.side);
        assert_close(prediction.rmse[q].value, all.rmse, prediction.rmse[q].bound + all.bound);
        if (inside.counted > 0)
            assert_close(prediction.interior[q].value, inside.rmse,
                         prediction.interior[q].bound + inside.bound);
        // The agreement must mean something: where no moment matrix can be close to singular,
        // bounds are far below the errors.
        if (sphv_methods[name].unknowns[of->box.dimension - 1] <= 1 && all.rmse > 1e-3)
            assert_true(prediction.rmse[q].bound < 1e-3 * all.rmse);
        free(exact);
    }
}

static void run(const struct trial *of)
{
    sphv_error error;
    sphv_particles particles;
    sphv_estimates estimates;
    sphv_method methods[METHODS];
    for (int m = 0; m < METHODS; m++) methods[m] = (sphv_method)m;
    assert_ok(sphv_particles_make(&of->box, of->profile, of->h, &particles, &error), error);
    double *values = sample(&particles, &of->field, (int[SPHV_DIMENSIONS]){0});
    const double *fields[] = {values};
    sphv_request request = {of->profile, of->h, METHODS, methods, 1, fields, of->route};
    assert_ok(sphv_estimate_particles(&particles, &request, NULL, NULL, &estimates, &error), error);
    sphv_box_prediction predictions[METHODS], alone;
    assert_ok(sphv_predict_box_methods(&of->box, of->profile, of->h, METHODS, methods, &of->field,
                                       predictions, &error),
              error);
    for (size_t m = 0; m < METHODS; m++) compare(of, &particles, &estimates, m, predictions[m]);
    // Together or alone: the same numbers, to the last bit.
    size_t one = (size_t)random_integer(0, METHODS - 1);
    assert_ok(
        sphv_predict_box(&of->box, of->profile, of->h, methods[one], &of->field, &alone, &error),
        error);
    for (size_t q = 0; q < alone.quantities; q++)
        for (int part = 0; part < 2; part++) {
            sphv_result a = part ? alone.interior[q] : alone.rmse[q];
            sphv_result b = part ? predictions[one].interior[q] : predictions[one].rmse[q];
            assert_true(a.value == b.value && a.bound == b.bound);
        }
    sphv_estimates_free(&estimates);
    sphv_particles_free(&particles);
    free(values);
}

static void test_every_method(void **state)
{
    (void)state;
    static const struct {
        const char *kernel, *field;
        int dimension;
    } cases[] = {
        {"cubic-spline", "f1", 2},
        {"cubic-spline", "f2", 2},
        {"wendland-c4", "f1", 2},
        {"wendland-c4", "f2", 2},
        {"cubic-spline", "sine", 1},
        {"quinlan-w10", "1 - x^3 + 2*x", 1},
        {"wendland-c2", "1 + x*y^2 - z", 3},
        {"cubic-spline", "x^4*y + y^3", 2},
    };
    sphv_error error;
    random_start("every method");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        if (quick() && i % 4) continue;
        int d = cases[i].dimension;
        sphv_kernel *kernel = load_kernel(cases[i].kernel);
        struct trial trial = {
            .box = {.dimension = d,
                    .side = (size_t)random_integer(d == 3 ? 6 : 12, d == 3 ? 8 : 30),
                    .layout = SPHV_LATTICE,
                    .placement = random_integer(0, 1) ? SPHV_PLACEMENT_CELL : SPHV_PLACEMENT_VERTEX,
                    .volume = random_integer(0, 1) ? SPHV_VOLUME_EQUAL : SPHV_VOLUME_LATTICE},
            .profile = sphv_kernel_profile(kernel, d),
            .route = SPHV_ROUTE_BRUTE_FORCE};
        assert_ok(sphv_field_parse(cases[i].field, d, &trial.field, &error), error);
        // Up to four spacings within the support, but not so few that corners are singular.
        double reach = random_uniform(2.05, d == 3 ? 2.4 : 4.5);
        trial.h = reach / trial.profile->support * sphv_box_spacing(&trial.box);
        run(&trial);
        sphv_kernel_free(kernel);
    }
}

/// Boxes so large that most particles are summed by a rule, and supports so wide that the lines of
/// their strips are, too.
static void test_large_boxes(void **state)
{
    (void)state;
    sphv_error error;
    static const struct {
        const char *field;
        size_t side;
        double reach; ///< spacings within the support
    } cases[] = {{"f1", 100, 2.03}, {"f2", 100, 2.03}, {"f1", 80, 35.6}, {"f2", 76, 33.2}};
    sphv_kernel *kernel = load_kernel("cubic-spline");
    for (size_t i = 0; i < (quick() ? 0 : sizeof cases / sizeof *cases); i++) {
        struct trial trial = {.box = {.dimension = 2,
                                      .side = cases[i].side,
                                      .layout = SPHV_LATTICE,
                                      .placement = SPHV_PLACEMENT_VERTEX,
                                      .volume = SPHV_VOLUME_LATTICE},
                              .profile = sphv_kernel_profile(kernel, 2),
                              .route = SPHV_ROUTE_AUTOMATIC};
        assert_ok(sphv_field_parse(cases[i].field, 2, &trial.field, &error), error);
        trial.h = cases[i].reach / trial.profile->support * sphv_box_spacing(&trial.box);
        run(&trial);
    }
    sphv_kernel_free(kernel);
}

/// Slopes of the RMSE over Sigalotti's 13 resolutions, from theory alone, against Table 2.
static void test_table_2(void **state)
{
    (void)state;
    static const size_t sides[] = {25, 50, 75, 100, 125, 150, 175, 200, 250, 300, 400, 500, 750};
    enum { SIDES = sizeof sides / sizeof *sides };
    static const struct {
        sphv_method method;
        const char *field;
        double printed[6]; ///< NaN: not given, or not reproducible (theory.md, section 7)
    } columns[] = {
        {SPHV_SPH_DIFFERENCE, "f2", {-0.28, -0.26, -0.26}},
        {SPHV_CSPM, "f1", {-0.76, -0.77, -0.77}},
        {SPHV_CSPM, "f2", {-0.76, -0.75, -0.75}},
        {SPHV_FPM, "f1", {-1.0, -0.77, -0.77}},
        {SPHV_FPM, "f2", {-1.0, -0.76, -0.77}},
        {SPHV_MSPH, "f1", {-1.76, -1.0, -1.0, -0.75, -1.0, -0.75}},
        {SPHV_MSPH, "f2", {-1.76, -1.0, -1.0, -0.62, NAN, NAN}},
    };
    sphv_kernel *kernel = load_kernel("cubic-spline");
    sphv_error error;
    for (size_t c = 0; c < (quick() ? 1 : sizeof columns / sizeof *columns); c++) {
        double x[SIDES], y[6][SIDES];
        sphv_box_prediction prediction = {0};
        sphv_field field;
        assert_ok(sphv_field_parse(columns[c].field, 2, &field, &error), error);
        for (size_t i = 0; i < SIDES; i++) {
            sphv_box box = {.dimension = 2,
                            .side = sides[i],
                            .layout = SPHV_LATTICE,
                            .placement = SPHV_PLACEMENT_VERTEX,
                            .volume = SPHV_VOLUME_LATTICE};
            double h = sqrt(13 / (4 * M_PI)) * sphv_box_spacing(&box);
            assert_ok(sphv_predict_box(&box, sphv_kernel_profile(kernel, 2), h, columns[c].method,
                                       &field, &prediction, &error),
                      error);
            x[i] = 2 * log((double)sides[i]);
            for (size_t q = 0; q < prediction.quantities; q++)
                y[q][i] = log(prediction.rmse[q].value);
        }
        for (size_t q = 0; q < prediction.quantities; q++) {
            double at, slope, c00, c01, c11, square;
            if (isnan(columns[c].printed[q])) continue;
            gsl_fit_linear(x, 1, y[q], 1, SIDES, &at, &slope, &c00, &c01, &c11, &square);
            // The task's own measure of "reproduced".
            assert_close(slope, columns[c].printed[q], 0.05);
        }
    }
    sphv_kernel_free(kernel);
}

/// Moments of the continuum explain those of the lattice to second order in Δx/h.
static void test_continuum(void **state)
{
    (void)state;
    static const sphv_method methods[] = {SPHV_SPH, SPHV_CSPM};
    sphv_kernel *kernel = load_kernel("sigalotti-wendland-c4");
    sphv_error error;
    sphv_field field;
    assert_ok(sphv_field_parse("f1", 2, &field, &error), error);
    for (size_t m = 0; m < (quick() ? 1 : 2); m++)
        for (size_t q = 0; q < 2; q++) {
            double off[3];
            for (int i = 0; i < 3; i++) {
                sphv_box box = {.dimension = 2,
                                .side = (size_t)(40 << i),
                                .layout = SPHV_LATTICE,
                                .placement = SPHV_PLACEMENT_CELL,
                                .volume = SPHV_VOLUME_LATTICE};
                sphv_box_prediction lattice, continuum;
                const sphv_profile *profile = sphv_kernel_profile(kernel, 2);
                assert_ok(sphv_predict_box_from(&box, profile, 0.2, methods[m], &field,
                                                SPHV_MOMENTS_LATTICE, &lattice, &error),
                          error);
                assert_ok(sphv_predict_box_from(&box, profile, 0.2, methods[m], &field,
                                                SPHV_MOMENTS_CONTINUUM, &continuum, &error),
                          error);
                off[i] = fabs(continuum.rmse[q].value / lattice.rmse[q].value - 1);
                // Second order with a constant of order one: Δx/h is 1/8, 1/16, 1/32.
                assert_true(off[i] < gsl_pow_2(sphv_box_spacing(&box) / 0.2));
            }
            assert_true(off[1] < off[0] / 2 && off[2] < off[1] / 2);
        }
    sphv_kernel_free(kernel);
}

/// Readings of the consistency measures from estimates of 1, x and x².
static void read_measures(const sphv_particles *particles, const sphv_profile *profile, double h,
                          double mean[SPHV_CONSISTENCY_MEASURES],
                          double deviation[SPHV_CONSISTENCY_MEASURES], double *counted)
{
    enum { ONE, X, SQUARE, FIELDS };
    static const char *const names[FIELDS] = {"1", "x", "x^2"};
    sphv_error error;
    sphv_method method = SPHV_SPH;
    double *values[FIELDS], square[SPHV_CONSISTENCY_MEASURES] = {0};
    for (int f = 0; f < FIELDS; f++) {
        sphv_field field;
        assert_ok(sphv_field_parse(names[f], 2, &field, &error), error);
        values[f] = sample(particles, &field, (int[SPHV_DIMENSIONS]){0});
    }
    sphv_request request = {profile,          h, 1, &method, FIELDS, (const double *const *)values,
                            SPHV_ROUTE_DIRECT};
    sphv_estimates estimates;
    assert_ok(sphv_estimate_particles(particles, &request, NULL, NULL, &estimates, &error), error);
    double *const *e = estimates.methods[0].estimate;
    double margin = h * profile->support + particles->spacing;
    *counted = 0;
    for (int m = 0; m < SPHV_CONSISTENCY_MEASURES; m++) mean[m] = 0;
    for (size_t n = 0; n < particles->count; n++) {
        double x = particles->x[0][n], y = particles->x[1][n];
        if (fmin(fmin(x, 1 - x), fmin(y, 1 - y)) < margin) continue;
        double one = e[ONE * 3][n], first = e[X * 3][n];
        double z[SPHV_CONSISTENCY_MEASURES] = {
            one - 1,
            (first - x * one) / h,
            (e[SQUARE * 3][n] - 2 * x * first + x * x * one) / (h * h),
            -h * e[ONE * 3 + 1][n],
            e[X * 3 + 1][n] - x * e[ONE * 3 + 1][n] - 1,
            e[X * 3 + 2][n] - x * e[ONE * 3 + 2][n],
        };
        *counted += 1;
        for (int m = 0; m < SPHV_CONSISTENCY_MEASURES; m++) {
            mean[m] += z[m];
            square[m] += z[m] * z[m];
        }
    }
    for (int m = 0; m < SPHV_CONSISTENCY_MEASURES; m++) {
        mean[m] /= *counted;
        deviation[m] = sqrt(fmax(0, square[m] / *counted - mean[m] * mean[m]));
    }
    sphv_estimates_free(&estimates);
    for (int f = 0; f < FIELDS; f++) free(values[f]);
}

static void test_consistency_measures(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("sigalotti-wendland-c4");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 2);
    random_start("consistency measures");
    for (int round = 0; round < (quick() ? 1 : 4); round++) {
        sphv_box box = {.dimension = 2,
                        .side = quick() ? 30 : 200,
                        .layout = round % 2 ? SPHV_PERTURBED : SPHV_LATTICE,
                        .placement = SPHV_PLACEMENT_VERTEX,
                        .jitter = SPHV_JITTER_UNIFORM,
                        .amplitude = round % 2 ? 0.13 : 0,
                        .seed = (uint64_t)random_integer(1, 1000000)};
        double spacing = round < 2 ? 1 / 2.3 : 1 / 4.4, h = sphv_box_spacing(&box) / spacing;
        double mean[SPHV_CONSISTENCY_MEASURES], deviation[SPHV_CONSISTENCY_MEASURES], counted;
        sphv_consistency expected;
        sphv_particles particles;
        sphv_error error;
        assert_ok(sphv_particles_make(&box, profile, h, &particles, &error), error);
        read_measures(&particles, profile, h, mean, deviation, &counted);
        assert_ok(sphv_predict_consistency(profile, spacing, SPHV_JITTER_UNIFORM, box.amplitude,
                                           &expected, &error),
                  error);
        for (int m = 0; m < SPHV_CONSISTENCY_MEASURES; m++) {
            sphv_result at = expected.mean[m], scatter = expected.deviation[m];
            // Particles share neighbours: no more than counted/n_nb of them are independent. Six
            // standard errors; of a deviation, that of a normal variable.
            double independent = counted / expected.neighbours;
            double doubt = 6 * scatter.value / sqrt(independent);
            // Rounding of x² against h².
            double rounding = 1e-12 / (h * h);
            assert_close(mean[m], at.value, at.bound + doubt + rounding);
            assert_close(deviation[m], scatter.value,
                         scatter.bound + doubt / sqrt(2) + sqrt(rounding));
        }
        sphv_particles_free(&particles);
    }
    sphv_kernel_free(kernel);
}

static void test_refusals(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 2);
    sphv_error error;
    sphv_field field;
    sphv_box_prediction out;
    assert_ok(sphv_field_parse("f1", 2, &field, &error), error);
    const sphv_box sound = {.dimension = 2, .side = 20, .layout = SPHV_LATTICE};
    sphv_box box = sound;
    assert_failed(sphv_predict_box(&box, profile, NAN, SPHV_SPH, &field, &out, &error), &error,
                  SPHV_INVALID_INPUT, "h is");
    assert_failed(sphv_predict_box(&box, profile, 0.01, SPHV_SPH, &field, &out, &error), &error,
                  SPHV_NO_CLOSED_FORM, "no neighbour");
    box.layout = SPHV_RANDOM;
    assert_failed(sphv_predict_box(&box, profile, 0.1, SPHV_SPH, &field, &out, &error), &error,
                  SPHV_NO_CLOSED_FORM, "layout");
    box = sound;
    box.volume = SPHV_VOLUME_DENSITY;
    assert_failed(sphv_predict_box(&box, profile, 0.1, SPHV_SPH, &field, &out, &error), &error,
                  SPHV_NO_CLOSED_FORM, "volume");
    box.volume = SPHV_VOLUME_UNIT;
    assert_failed(sphv_predict_box(&box, profile, 0.1, SPHV_SPH, &field, &out, &error), &error,
                  SPHV_INVALID_INPUT, "unit");
    assert_failed(sphv_predict_box(&sound, sphv_kernel_profile(kernel, 1), 0.1, SPHV_SPH, &field,
                                   &out, &error),
                  &error, SPHV_INVALID_INPUT, "dimensions");
    box = sound;
    box.side = 2000;
    assert_failed(sphv_predict_box(&box, profile, 0.9, SPHV_SPH, &field, &out, &error), &error,
                  SPHV_NO_CLOSED_FORM, "too many");
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_method),
        cmocka_unit_test(test_large_boxes),
        cmocka_unit_test(test_table_2),
        cmocka_unit_test(test_continuum),
        cmocka_unit_test(test_consistency_measures),
        cmocka_unit_test(test_refusals),
    };
    return run_group(tests);
}
