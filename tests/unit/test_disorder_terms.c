/// Eqs. 20 and 25 term by term on actual particles, against the error measured at the same
/// particles.
#include "disorder_support.h"
#include "sphverify/compare.h"

static sphv_term_table terms_at(const sphv_profile *profile, sphv_method method, double h, int n)
{
    sphv_experiment of =
        experiment(profile, method, SPHV_VOLUME_TESSELLATED, 0.1, 4.0 / (2 * n + 1), h);
    sphv_term_table table;
    sphv_error error;
    assert_int_equal(sphv_evaluate_terms(&of, &table, &error), SPHV_OK);
    assert_true(table.particles > 100);
    return table;
}

/// What the printed terms leave out is at least one order higher in Δs, so the part of the error
/// that they miss must fall at least like Δs: by 23/11 from n = 5 to 11 and 47/23 on to 23. It is a
/// ratio of two norms over the same 512 particles and 2 phases, each known to 1/√1024 or better: a
/// tenth. A term with a wrong sign or factor leaves a constant part.
static void the_rest_is_of_higher_order(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    double last = 0, spacing = 0;
    for (int n = 5; n <= 23; n = 2 * n + 1) {
        sphv_term_table table = terms_at(profile, SPHV_SPH, 0.002, n);
        double rest = table.residual / table.measured, own = 4.0 / (2 * n + 1);
        if (last > 0) assert_true(rest <= 1.1 * last * own / spacing);
        last = rest;
        spacing = own;
    }
    // The corrected method at h/λ = 0.05 is smoothing almost alone, which eq. 25 has to second
    // order: (kh)² μ4/(12 μ2) of it, 0.0066, is left; noise of order Δs comes on top.
    double left =
        pow(2 * M_PI * 0.05, 2) * profile->moment[4].value / (12 * profile->moment[2].value);
    sphv_term_table fine = terms_at(profile, SPHV_BONET_LOK, 0.05, 23);
    assert_close(fine.residual / fine.measured, left, 0.1 * left);
    sphv_kernel_free(kernel);
}

static void only_where_they_exist(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    sphv_experiment of = experiment(profile, SPHV_SPH, SPHV_VOLUME_LATTICE, 0.1, 0.5, 0.01);
    sphv_term_table table;
    sphv_error error;
    assert_int_equal(sphv_evaluate_terms(&of, &table, &error), SPHV_NO_CLOSED_FORM);
    of = experiment(profile, SPHV_RKPM, SPHV_VOLUME_TESSELLATED, 0.1, 0.5, 0.01);
    assert_int_equal(sphv_evaluate_terms(&of, &table, &error), SPHV_NO_CLOSED_FORM);
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rest_is_of_higher_order),
        cmocka_unit_test(only_where_they_exist),
    };
    return run_group(tests);
}
