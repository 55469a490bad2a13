#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "error_box.h"
#include "error_output.h"
#include "point_options.h"

static const char *const forms[] = {"exact", "paper", NULL};

/// Method, layout, volume rule, σ and realisations.
static sphv_status read_experiment(const sphv_arguments *arguments, sphv_experiment *out,
                                   sphv_error *error)
{
    const char *method = sphv_argument(arguments, "method");
    const char *layout = sphv_argument(arguments, "layout");
    const char *volume = sphv_argument(arguments, "volume");
    long seed, realisations;
    sphv_status status = SPHV_OK;
    if (method) status = sphv_method_parse(method, &out->method, error);
    if (status == SPHV_OK && layout) status = sphv_layout_parse(layout, &out->layout, error);
    if (status == SPHV_OK && volume) status = sphv_volume_parse(volume, &out->volume, error);
    if (status == SPHV_OK) status = sphv_real_option(arguments, "sigma", 0, &out->sigma, error);
    if (status == SPHV_OK) status = sphv_real_option(arguments, "width", 0.02, &out->width, error);
    if (status == SPHV_OK)
        status = sphv_whole_option(arguments, "seed", 0, 1000000000, 1, &seed, error);
    if (status == SPHV_OK)
        status =
            sphv_whole_option(arguments, "realisations", 2, 1000000, 512, &realisations, error);
    if (status != SPHV_OK) return status;
    if (!layout && out->sigma > 0) out->layout = SPHV_PERTURBED;
    out->seed = (uint64_t)seed;
    out->realisations_max = (int)realisations;
    out->realisations_min = realisations < 16 ? (int)realisations : 16;
    return SPHV_OK;
}

static sphv_status read_question(const sphv_arguments *arguments, sphv_error_question *of,
                                 sphv_error *error)
{
    int dimension, form = 0;
    sphv_number h;
    const char *name = sphv_argument(arguments, "kernel");
    if (!name) return sphv_fail(error, SPHV_INVALID_INPUT, "--kernel is missing; see --help");
    sphv_status status = sphv_number_option(arguments, "h", &h, error);
    if (status == SPHV_OK)
        status = sphv_number_option(arguments, "spacing", &of->experiment.spacing, error);
    if (status == SPHV_OK) status = sphv_word_option(arguments, "form", forms, &form, error);
    if (status == SPHV_OK) status = read_experiment(arguments, &of->experiment, error);
    if (status == SPHV_OK) status = sphv_dimension_option(arguments, 1, &dimension, error);
    if (status == SPHV_OK && dimension != 1)
        status = sphv_fail(error, SPHV_NO_CLOSED_FORM,
                           "no endless lattice in %d dimensions; allowed: --dim 1, or a box of "
                           "particles by --particles",
                           dimension);
    if (status == SPHV_OK)
        status = sphv_catalogue_find(arguments->data_directory, name, &of->kernel, error);
    if (status == SPHV_OK)
        status = sphv_profile_required(of->kernel, dimension, &of->experiment.profile, error);
    if (status != SPHV_OK) return status;
    of->experiment.h = h.value;
    of->form = (sphv_form_of_theory)form;
    of->spacing_text = sphv_argument(arguments, "spacing");
    of->exhaustive = sphv_argument(arguments, "exhaustive") != NULL;
    return SPHV_OK;
}

static sphv_status evaluate(const sphv_error_question *of, sphv_point *point,
                            sphv_term_table *terms, sphv_error *error)
{
    const sphv_experiment *experiment = &of->experiment;
    terms->rows = NULL;
    if (experiment->method == SPHV_SPH && experiment->layout == SPHV_LATTICE &&
        experiment->volume == SPHV_VOLUME_LATTICE) {
        sphv_status status = sphv_experiment_check(experiment, error);
        if (status != SPHV_OK) return status;
        return sphv_evaluate_point(experiment->profile, experiment->h, experiment->spacing,
                                   of->form, of->exhaustive, sphv_progress_bar, "particles", point,
                                   error);
    }
    if (of->form == SPHV_FORM_PAPER || of->exhaustive)
        return sphv_fail(
            error, SPHV_INVALID_INPUT,
            "--%s with method '%s', layout '%s', volume '%s'; allowed: with sph on a "
            "lattice with lattice volumes",
            of->exhaustive ? "exhaustive" : "form paper", sphv_methods[experiment->method].name,
            sphv_layouts[experiment->layout].name, sphv_volumes[experiment->volume].name);
    sphv_status status =
        sphv_evaluate_experiment(experiment, sphv_progress_bar, "realisations", point, error);
    if (status == SPHV_OK && experiment->layout == SPHV_PERTURBED &&
        sphv_evaluate_terms(experiment, terms, NULL) != SPHV_OK)
        terms->rows = NULL; // methods and volume rules without such terms
    return status;
}

/// Refuses options that would be passed over: those of a box on the endless line, and the reverse.
static sphv_status check_place(const sphv_arguments *arguments, bool box, sphv_error *error)
{
    static const char *const of_boxes[] = {"field",     "placement", "jitter",
                                           "reflected", "periodic",  NULL};
    static const char *const of_the_line[] = {"form", "exhaustive", "width", "realisations", NULL};
    for (const char *const *name = box ? of_the_line : of_boxes; *name; name++)
        if (sphv_argument(arguments, *name))
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             box ? "--%s is of the endless line; not with --particles"
                                 : "--%s is of a box; allowed: with --particles",
                             *name);
    return SPHV_OK;
}

static int run(const sphv_arguments *arguments)
{
    sphv_error_question of = {0};
    sphv_error error;
    sphv_point point;
    sphv_term_table terms;
    bool box = sphv_argument(arguments, "particles") != NULL;
    sphv_status status = check_place(arguments, box, &error);
    if (status == SPHV_OK && box) return sphv_run_error_box(arguments);
    if (status == SPHV_OK) status = read_question(arguments, &of, &error);
    if (status == SPHV_OK) status = evaluate(&of, &point, &terms, &error);
    if (status != SPHV_OK) {
        sphv_kernel_free(of.kernel);
        return sphv_report_failure(arguments, &error);
    }
    sphv_print_error(arguments->format, &of, &point, terms.rows ? &terms : NULL);
    sphv_kernel_free(of.kernel);
    return sphv_verdict_exit(point.verdict);
}

static const sphv_option options[] = {
    {"kernel", 'k', "K", "catalogue name or path of a kernel file"},
    {"h", 0, "H", "smoothing length in wavelengths, or box sides, 1e-9 to 10"},
    {"spacing", 's', "S", "spacing ratio dx/h, 1e-4 to below the support; fractions such as 4/11"},
    {"form", 0, "FORM",
     "exact (default): all knots, any spacing; paper: eq. 16 at 2*support/(2n+1)"},
    {"exhaustive", 0, NULL, "evaluate every particle of a wavelength instead of one"},
    {"dim", 'd', "D", "dimension; 1 (default), with --particles 1, 2 (default) or 3"},
    {"method", 'm', "M",
     "sph (default), sph-difference, shepard, bonet-lok, rkpm, rkpm-0, rkpm-2, cspm, fpm, msph"},
    {"layout", 'l', "L", "lattice (default), perturbed, quasi-random, random"},
    {"volume", 'V', "V", "lattice (default), tessellated, density, unit; equal in a box"},
    {"sigma", 0, "R", "standard deviation of the perturbation, sigma/dx (then perturbed)"},
    {"seed", 0, "N", "of the random positions (default 1)"},
    {"width", 0, "W", "wanted relative half-width of the Monte-Carlo interval (default 0.02)"},
    {"realisations", 0, "N", "at most so many (default 512)"},
    {"particles", 'N', "N", "on a box of N particles, a square number in 2D, a cube in 3D"},
    {"field", 0, "F", "in a box: f1 (default), f2, sine, gaussian, or a polynomial '1 - 2*x*y^2'"},
    {"placement", 0, "P", "in a box: vertex (default; particles on the edges), cell"},
    {"jitter", 0, "J", "in a box: normal (default), uniform between +-sigma*dx"},
    {"reflected", 0, NULL, "in a box: what is moved out is reflected into it"},
    {"periodic", 0, NULL, "in a box: no boundary"},
    {NULL, 0, NULL, NULL},
};

const sphv_command sphv_command_error = {
    "error",
    "",
    "One point: the predicted error of the gradient beside the measured one",
    "E is the relative error of the gradient of sin(2*pi*x/lambda) at every particle, signed;\n"
    "its L2 norm over a wavelength is |E|/sqrt(2). The verdict is 'agrees' when analytic and\n"
    "empirical E differ by no more than the sum of their bounds. On disordered particles the\n"
    "expected L2 norm stands beside a Monte-Carlo mean with its 99.9 % interval.\n\n"
    "With --particles the particles fill the unit box, edges and all, in one to three dimensions;\n"
    "root mean square errors of value, gradient and second derivatives are predicted and "
    "measured.\n"
    "\n"
    "Examples:\n"
    "  sphverify error --kernel cubic-spline --h 0.02 --spacing 4/11\n"
    "  sphverify error -k quinlan-w10 --h 1/50 -s 0.37 --format json | jq .analytic.total\n"
    "  sphverify error -k quinlan-w10 --h 0.02 -s 4/11 --sigma 0.1 --volume tessellated\n"
    "  sphverify error -k cubic-spline --particles 2500 -s 0.98 --method fpm --field f2\n",
    0,
    0,
    options,
    run};
