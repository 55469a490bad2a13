#include <math.h>
#include <stdio.h>

#include "command.h"
#include "point_options.h"

static const char *const forms[] = {"exact", "paper", NULL};
static const char *const methods[] = {"sph", NULL};
static const char *const layouts[] = {"lattice", NULL};

/// What the options ask for.
struct question {
    sphv_kernel *kernel;
    const sphv_profile *profile;
    sphv_number h, spacing;
    int form;
    bool exhaustive;
};

static sphv_status read_question(const sphv_arguments *arguments, struct question *of,
                                 sphv_error *error)
{
    int dimension, unused;
    const char *name = sphv_argument(arguments, "kernel");
    if (!name) return sphv_fail(error, SPHV_INVALID_INPUT, "--kernel is missing; see --help");
    sphv_status status = sphv_number_option(arguments, "h", &of->h, error);
    if (status == SPHV_OK) status = sphv_number_option(arguments, "spacing", &of->spacing, error);
    if (status == SPHV_OK) status = sphv_word_option(arguments, "form", forms, &of->form, error);
    if (status == SPHV_OK) status = sphv_word_option(arguments, "method", methods, &unused, error);
    if (status == SPHV_OK) status = sphv_word_option(arguments, "layout", layouts, &unused, error);
    if (status == SPHV_OK) status = sphv_word_option(arguments, "volume", layouts, &unused, error);
    if (status == SPHV_OK) status = sphv_dimension_option(arguments, 1, &dimension, error);
    if (status == SPHV_OK && dimension != 1)
        status = sphv_fail(error, SPHV_NO_CLOSED_FORM,
                           "no lattice theory in %d dimensions; allowed: --dim 1", dimension);
    if (status == SPHV_OK)
        status = sphv_catalogue_find(arguments->data_directory, name, &of->kernel, error);
    if (status == SPHV_OK)
        status = sphv_profile_required(of->kernel, dimension, &of->profile, error);
    of->exhaustive = sphv_argument(arguments, "exhaustive") != NULL;
    return status;
}

static json_t *as_json(const struct question *of, const sphv_point *point)
{
    const sphv_prediction *a = &point->analytic;
    const sphv_measurement *e = &point->empirical;
    return json_pack(
        "{s:s, s:i, s:s, s:s, s:s, s:o, s:o, s:o, s:n, s:s,"
        " s:{s:o, s:o, s:o, s:o, s:o, s:s}, s:{s:o, s:o, s:o, s:I, s:I, s:I, s:o}, s:o, s:s}",
        "kernel", sphv_kernel_name(of->kernel), "dim", of->profile->dimension, "method", methods[0],
        "layout", layouts[0], "volume", layouts[0], "h", sphv_json_number(of->h.value), "spacing",
        sphv_json_number(of->spacing.value), "sigma", json_real(0), "seed", "form", forms[of->form],
        "analytic", "smoothing", sphv_json_number(a->smoothing.value), "discretisation",
        sphv_json_number(a->discretisation.value), "total", sphv_json_number(a->total.value), "l2",
        sphv_json_number(a->l2.value), "bound", sphv_json_number(a->total.bound), "rigour",
        sphv_rigour_name(a->rigour), "empirical", "total", sphv_json_number(e->total.value), "l2",
        sphv_json_number(e->l2.value), "bound", sphv_json_number(e->total.bound), "particles",
        (json_int_t)e->particles, "neighbours", (json_int_t)e->neighbours, "pairs",
        (json_int_t)e->pairs, "seconds", sphv_json_number(e->seconds), "difference",
        sphv_json_number(point->difference), "verdict", sphv_verdict_name(point->verdict));
}

static void print_text(const struct question *of, const char *spacing, const sphv_point *point)
{
    const sphv_prediction *a = &point->analytic;
    const sphv_measurement *e = &point->empirical;
    sphv_lattice_place place = sphv_number_place(of->profile->support_exact, of->spacing);
    printf("%s in 1D, standard SPH gradient of a sine on a uniform lattice\n",
           sphv_kernel_name(of->kernel));
    printf("h/λ = %g, Δx/h = %s, %ld neighbours", of->h.value, spacing, e->neighbours);
    if (fabs(place.fraction - 0.5) < 1e-9) printf(" (n = %ld, Δx/h = 2κ/(2n+1))", place.inside);
    printf("; %s form%s\n\n", forms[of->form],
           of->exhaustive ? ", every particle of a wavelength" : "");
    printf("relative error E          analytic                empirical\n");
    printf("  smoothing       %+.15e\n", a->smoothing.value);
    printf("  discretisation  %+.15e\n", a->discretisation.value);
    printf("  total           %+.15e  %+.15e\n", a->total.value, e->total.value);
    printf("  bound           %22.1e  %22.1e\n", a->total.bound, e->total.bound);
    printf("  L2 norm         %+.15e  %+.15e\n\n", a->l2.value, e->l2.value);
    printf("%s: |analytic - empirical| = %.1e, sum of bounds %.1e (%s)\n",
           sphv_verdict_name(point->verdict), fabs(point->difference),
           a->total.bound + e->total.bound, sphv_rigour_name(a->rigour));
}

static int run(const sphv_arguments *arguments)
{
    struct question of = {0};
    sphv_error error;
    sphv_point point;
    sphv_status status = read_question(arguments, &of, &error);
    if (status == SPHV_OK)
        status =
            sphv_evaluate_point(of.profile, of.h.value, of.spacing, (sphv_form_of_theory)of.form,
                                of.exhaustive, sphv_progress_bar, "particles", &point, &error);
    if (status != SPHV_OK) {
        sphv_kernel_free(of.kernel);
        return sphv_report_failure(arguments, &error);
    }
    if (arguments->format == SPHV_FORMAT_TEXT) {
        print_text(&of, sphv_argument(arguments, "spacing"), &point);
    } else {
        json_t *answer = as_json(&of, &point);
        if (arguments->format == SPHV_FORMAT_JSON) {
            sphv_print_json(answer);
        } else {
            json_t *rows = json_pack("[O]", answer);
            sphv_print_rows(arguments->format, rows);
            json_decref(rows);
        }
        json_decref(answer);
    }
    sphv_kernel_free(of.kernel);
    return sphv_verdict_exit(point.verdict);
}

static const sphv_option options[] = {
    {"kernel", 'k', "K", "catalogue name or path of a kernel file"},
    {"h", 0, "H", "smoothing length in wavelengths, 1e-9 to 10"},
    {"spacing", 's', "S", "spacing ratio dx/h, 1e-4 to below the support; fractions such as 4/11"},
    {"form", 0, "FORM",
     "exact (default): all knots, any spacing; paper: eq. 16 at 2*support/(2n+1)"},
    {"exhaustive", 0, NULL, "evaluate every particle of a wavelength instead of one"},
    {"dim", 'd', "D", "dimension; 1 (default)"},
    {"method", 0, "M", "sph (default)"},
    {"layout", 0, "L", "lattice (default)"},
    {"volume", 0, "V", "lattice (default)"},
    {NULL, 0, NULL, NULL},
};

const sphv_command sphv_command_error = {
    "error",
    "",
    "One point: the predicted error of the gradient beside the measured one",
    "E is the relative error of the gradient of sin(2*pi*x/lambda) at every particle, signed;\n"
    "its L2 norm over a wavelength is |E|/sqrt(2). The verdict is 'agrees' when analytic and\n"
    "empirical E differ by no more than the sum of their bounds.\n\n"
    "Examples:\n"
    "  sphverify error --kernel cubic-spline --h 0.02 --spacing 4/11\n"
    "  sphverify error -k quinlan-w10 --h 1/50 -s 0.37 --format json | jq .analytic.total\n",
    0,
    0,
    options,
    run};
