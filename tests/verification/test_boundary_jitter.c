/// The theory of perturbed boxes against the particles.
#include <gsl/gsl_math.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "sphverify/boundary.h"
#include "sphverify/estimate.h"
#include "support.h"

static const sphv_method methods[] = {
    SPHV_SPH, SPHV_SPH_DIFFERENCE, SPHV_SHEPARD, SPHV_BONET_LOK, SPHV_CSPM, SPHV_FPM, SPHV_MSPH};
enum { METHODS = sizeof methods / sizeof *methods, REALISATIONS = 5, PARTS = 2 };

/// One experiment.
struct trial {
    sphv_box box;
    const sphv_profile *profile;
    double h;
    sphv_field field;
};

/// Mean squares over realisations, of all particles and of the interior.
struct measured {
    double square[METHODS][SPHV_QUANTITIES_MAX][PARTS], count[PARTS];
    bool faulty[METHODS];
    double neighbours;
};

static void sample(const struct trial *of, const sphv_particles *particles, size_t quantity,
                   double *out)
{
    const int *order = sphv_monomials(of->box.dimension)[quantity].power;
    for (size_t n = 0; n < particles->count; n++) {
        double x[SPHV_DIMENSIONS] = {0};
        for (int i = 0; i < of->box.dimension; i++) x[i] = particles->x[i][n];
        out[n] = sphv_field_derivative(&of->field, order, x);
    }
}

static void realise(const struct trial *of, struct measured *to)
{
    sphv_error error;
    sphv_particles particles;
    sphv_estimates estimates;
    assert_ok(sphv_particles_make(&of->box, of->profile, of->h, &particles, &error), error);
    double *values = malloc(particles.count * sizeof *values);
    assert_non_null(values);
    sample(of, &particles, 0, values);
    const double *fields[] = {values};
    sphv_request request = {of->profile, of->h, METHODS, methods, 1, fields, SPHV_ROUTE_DIRECT};
    assert_ok(sphv_estimate_particles(&particles, &request, NULL, NULL, &estimates, &error), error);
    for (size_t n = 0; n < particles.count; n++)
        to->neighbours = fmax(to->neighbours, estimates.neighbours[n]);
    for (size_t q = 0; q < sphv_method_quantities(SPHV_MSPH, of->box.dimension); q++) {
        sample(of, &particles, q, values);
        for (size_t m = 0; m < METHODS; m++) {
            if (q >= estimates.methods[m].quantities) continue;
            for (int part = 0; part < PARTS; part++) {
                double margin = part ? of->h * of->profile->support : 0;
                // A periodic box has no sides to be away from.
                if (of->box.periodic) margin = 0;
                sphv_norms norms =
                    sphv_error_norms(&particles, &estimates, m, 0, q, values, margin);
                to->square[m][q][part] += norms.mean_square / REALISATIONS;
                to->count[part] = (double)norms.counted;
                if (part == 0) to->faulty[m] = to->faulty[m] || norms.counted < particles.count;
            }
        }
    }
    sphv_estimates_free(&estimates);
    sphv_particles_free(&particles);
    free(values);
}

/// Holds predictions against the means; returns how many there were.
static int hold(const struct trial *of, const struct measured *found)
{
    sphv_error error;
    int compared = 0;
    for (size_t m = 0; m < METHODS; m++) {
        sphv_box_prediction expected;
        // In three dimensions these boxes have no interior to speak of, and `msph` takes its time.
        if (of->box.dimension == 3 && methods[m] == SPHV_MSPH) continue;
        assert_ok(sphv_predict_box(&of->box, of->profile, of->h, methods[m], &of->field, &expected,
                                   &error),
                  error);
        assert_int_equal(expected.rigour, SPHV_RIGOUR_STATISTICAL);
        for (size_t q = 0; q < expected.quantities; q++)
            for (int part = 0; part < PARTS; part++) {
                sphv_result at = part ? expected.interior[q] : expected.rmse[q];
                double rmse = sqrt(found->square[m][q][part]);
                if (!isfinite(at.value) || found->faulty[m] || !(found->count[part] > 0)) continue;
                // A quarter is the theory's own limit of what it calls a prediction.
                assert_true(at.bound <= 0.25 * at.value);
                // Six standard errors where particles share neighbours: of them no more than
                // count/n_nb are independent.
                double doubt =
                    6 * sqrt(found->neighbours / (2 * found->count[part] * REALISATIONS));
                double scatter = part ? expected.interior_scatter[q] : expected.scatter[q];
                doubt = fmin(doubt, 6 * scatter / (sqrt(REALISATIONS) * at.value));
                if (!is_close(rmse, at.value, at.bound + doubt * at.value))
                    printf("%s, quantity %zu, part %d of %s in %d dimensions, amplitude %g: %g of "
                           "%g +- %g\n",
                           sphv_methods[methods[m]].name, q, part, of->field.name,
                           of->box.dimension, of->box.amplitude, rmse, at.value, at.bound);
                assert_close(rmse, at.value, at.bound + doubt * at.value);
                compared++;
            }
    }
    return compared;
}

static void test_against_particles(void **state)
{
    (void)state;
    static const struct {
        const char *kernel, *field;
        size_t dimension, side;
        sphv_placement placement;
        sphv_jitter jitter;
        double amplitude;
        double reach; ///< spacings within the support; 0: √(13/π), or 13 neighbours in a plane
        bool reflected, periodic;
    } cases[] = {
        {"cubic-spline", "f1", 2, 50, SPHV_PLACEMENT_VERTEX, SPHV_JITTER_UNIFORM, 0.12, 0, true,
         false},
        {"cubic-spline", "f2", 2, 50, SPHV_PLACEMENT_VERTEX, SPHV_JITTER_UNIFORM, 0.05, 0, true,
         false},
        {"cubic-spline", "f1", 2, 50, SPHV_PLACEMENT_VERTEX, SPHV_JITTER_UNIFORM, 0.14, 0, false,
         false},
        {"wendland-c4", "f2", 2, 40, SPHV_PLACEMENT_CELL, SPHV_JITTER_UNIFORM, 0.12, 0, true,
         false},
        {"cubic-spline", "f1", 2, 36, SPHV_PLACEMENT_VERTEX, SPHV_JITTER_NORMAL, 0.05, 0, true,
         false},
        {"wendland-c2", "sine", 2, 40, SPHV_PLACEMENT_CELL, SPHV_JITTER_NORMAL, 0.07, 0, false,
         true},
        {"cubic-spline", "sine", 1, 400, SPHV_PLACEMENT_VERTEX, SPHV_JITTER_UNIFORM, 0.1, 0, true,
         false},
        {"cubic-spline", "1 + x*y^2 - z", 3, 7, SPHV_PLACEMENT_VERTEX, SPHV_JITTER_UNIFORM, 0.1, 0,
         true, false},
        {"wendland-c4", "f2", 2, 25, SPHV_PLACEMENT_VERTEX, SPHV_JITTER_UNIFORM, 0.2, 8.3, true,
         false},
        {"quinlan-w10", "sine", 1, 300, SPHV_PLACEMENT_CELL, SPHV_JITTER_NORMAL, 0.1, 8.5, true,
         false},
    };
    sphv_error error;
    random_start("perturbed boxes");
    for (size_t i = 0; i < (quick() ? 1 : sizeof cases / sizeof *cases); i++) {
        int d = (int)cases[i].dimension;
        sphv_kernel *kernel = load_kernel(cases[i].kernel);
        struct trial trial = {.box = {.dimension = d,
                                      .side = quick() ? 12 : cases[i].side,
                                      .layout = SPHV_PERTURBED,
                                      .placement = cases[i].placement,
                                      .periodic = cases[i].periodic,
                                      .jitter = cases[i].jitter,
                                      .amplitude = cases[i].amplitude,
                                      .reflected = cases[i].reflected,
                                      .volume = SPHV_VOLUME_EQUAL},
                              .profile = sphv_kernel_profile(kernel, d)};
        struct measured found = {0};
        assert_ok(sphv_field_parse(cases[i].field, d, &trial.field, &error), error);
        double reach = cases[i].reach > 0 ? cases[i].reach : sqrt(13 / M_PI);
        trial.h = reach / trial.profile->support * sphv_box_spacing(&trial.box);
        uint64_t seed = (uint64_t)random_integer(1, 1000000);
        for (int r = 0; r < REALISATIONS; r++) {
            trial.box.seed = seed + (uint64_t)r;
            realise(&trial, &found);
        }
        assert_true(hold(&trial, &found) >= 10);
        sphv_kernel_free(kernel);
    }
}

/// Without amplitude it is the lattice's prediction; a small one makes a small difference, which
/// grows with its square.
static void test_limits(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("cubic-spline");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 2);
    sphv_error error;
    sphv_field field;
    assert_ok(sphv_field_parse("f1", 2, &field, &error), error);
    sphv_box box = {.dimension = 2, .side = 10, .volume = SPHV_VOLUME_LATTICE};
    double h = 1.02 * sphv_box_spacing(&box);
    for (size_t m = 0; m < (quick() ? 1 : METHODS); m++) {
        sphv_box_prediction lattice, none, at[2];
        box.layout = SPHV_LATTICE;
        box.amplitude = 0;
        assert_ok(sphv_predict_box(&box, profile, h, methods[m], &field, &lattice, &error), error);
        box.layout = SPHV_PERTURBED;
        assert_ok(sphv_predict_box(&box, profile, h, methods[m], &field, &none, &error), error);
        for (int i = 0; i < 2; i++) {
            box.amplitude = i ? 2e-4 : 1e-4;
            assert_ok(sphv_predict_box(&box, profile, h, methods[m], &field, &at[i], &error),
                      error);
        }
        for (size_t q = 0; q < lattice.quantities; q++) {
            assert_true(none.rmse[q].value == lattice.rmse[q].value);
            double square = gsl_pow_2(lattice.interior[q].value);
            double near = gsl_pow_2(at[0].interior[q].value) - square;
            double far = gsl_pow_2(at[1].interior[q].value) - square;
            // Relative to either, the next order is smaller by the amplitude; the lattice's own
            // bound and the rounding of the difference count against the smaller.
            double rounding =
                1e-11 * square + 2 * lattice.interior[q].value * lattice.interior[q].bound;
            assert_close(far, 4 * near, 0.05 * fabs(far) + 8 * rounding);
        }
    }
    sphv_kernel_free(kernel);
}

/// Wide supports are summed by rules; here are the same sums over every neighbour of every
/// particle.
static void test_rules(void **state)
{
    (void)state;
    static const struct {
        const char *kernel, *field;
        sphv_method method;
        sphv_placement placement;
    } cases[] = {
        {"wendland-c4", "f1", SPHV_SPH, SPHV_PLACEMENT_VERTEX},
        {"wendland-c4", "f2", SPHV_FPM, SPHV_PLACEMENT_VERTEX},
        {"cubic-spline", "f2", SPHV_CSPM, SPHV_PLACEMENT_VERTEX},
        {"cubic-spline", "f1", SPHV_SPH_DIFFERENCE, SPHV_PLACEMENT_CELL},
    };
    sphv_error error;
    for (size_t i = 0; i < (quick() ? 1 : sizeof cases / sizeof *cases); i++) {
        sphv_kernel *kernel = load_kernel(cases[i].kernel);
        const sphv_profile *profile = sphv_kernel_profile(kernel, 2);
        sphv_box_prediction rules, every, lattice;
        int told = 0;
        sphv_field field;
        sphv_box box = {.dimension = 2,
                        .side = 20,
                        .layout = SPHV_PERTURBED,
                        .placement = cases[i].placement,
                        .jitter = SPHV_JITTER_UNIFORM,
                        .amplitude = 0.2,
                        .reflected = true,
                        .volume = SPHV_VOLUME_EQUAL};
        double h = 8.7 / profile->support * sphv_box_spacing(&box);
        assert_ok(sphv_field_parse(cases[i].field, 2, &field, &error), error);
        assert_ok(sphv_predict_box(&box, profile, h, cases[i].method, &field, &rules, &error),
                  error);
        assert_ok(sphv_predict_box_from(&box, profile, h, cases[i].method, &field,
                                        SPHV_MOMENTS_EVERY, &every, &error),
                  error);
        box.layout = SPHV_LATTICE;
        box.amplitude = 0;
        assert_ok(sphv_predict_box(&box, profile, h, cases[i].method, &field, &lattice, &error),
                  error);
        for (size_t q = 0; q < every.quantities; q++) {
            double bound = rules.rmse[q].bound + every.rmse[q].bound;
            assert_close(rules.rmse[q].value, every.rmse[q].value, bound);
            if (fabs(lattice.rmse[q].value - every.rmse[q].value) > bound) told++;
            if (isfinite(rules.interior[q].value))
                assert_close(rules.interior[q].value, every.interior[q].value,
                             rules.interior[q].bound + every.interior[q].bound);
        }
        // What perturbations change must not hide within the bounds.
        assert_true(told >= 1);
        sphv_kernel_free(kernel);
    }
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
    sphv_box box = {.dimension = 2, .side = 20, .layout = SPHV_PERTURBED, .amplitude = 0.1};
    double h = 1.02 * sphv_box_spacing(&box);
    assert_failed(sphv_predict_box(&box, profile, 5 * h, SPHV_MSPH, &field, &out, &error), &error,
                  SPHV_NO_CLOSED_FORM, "third derivative");
    sphv_kernel *cusp = load_kernel("spiky");
    assert_failed(sphv_predict_box(&box, sphv_kernel_profile(cusp, 2), 10 * h, SPHV_SPH, &field,
                                   &out, &error),
                  &error, SPHV_NO_CLOSED_FORM, "derivative");
    sphv_kernel_free(cusp);
    assert_failed(sphv_predict_box(&box, profile, h, SPHV_RKPM, &field, &out, &error), &error,
                  SPHV_NO_CLOSED_FORM, "rkpm");
    box.amplitude = 0.5;
    assert_failed(sphv_predict_box(&box, profile, h, SPHV_SPH, &field, &out, &error), &error,
                  SPHV_NO_CLOSED_FORM, "perturbations");
    // Six unknowns from six neighbours in a corner: no expectation that could be trusted.
    box.amplitude = 0.1;
    box.jitter = SPHV_JITTER_UNIFORM;
    assert_ok(sphv_predict_box(&box, profile, h, SPHV_MSPH, &field, &out, &error), error);
    assert_true(isnan(out.rmse[0].value) && isfinite(out.interior[0].value));
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_particles),
        cmocka_unit_test(test_limits),
        cmocka_unit_test(test_rules),
        cmocka_unit_test(test_refusals),
    };
    return run_group(tests);
}
