#include "error_output.h"

#include <math.h>
#include <stdio.h>

static json_t *terms_json(const sphv_term_table *terms)
{
    json_t *rows = json_array();
    for (int i = 0; terms->rows[i].name; i++)
        json_array_append_new(rows, json_pack("{s:s, s:s, s:o}", "term", terms->rows[i].name,
                                              "order", terms->rows[i].order, "rms",
                                              sphv_json_number(terms->rms[i])));
    return json_pack("{s:o, s:o, s:o, s:o, s:i}", "rows", rows, "sum", sphv_json_number(terms->sum),
                     "measured", sphv_json_number(terms->measured), "residual",
                     sphv_json_number(terms->residual), "particles", terms->particles);
}

static json_t *disorder_json(const sphv_disorder_measurement *measured)
{
    return json_pack("{s:i, s:I, s:I, s:I, s:I, s:o}", "realisations", measured->realisations,
                     "estimates", (json_int_t)measured->particles, "singular",
                     (json_int_t)measured->singular, "ill_conditioned",
                     (json_int_t)measured->ill_conditioned, "not_finite",
                     (json_int_t)measured->not_finite, "worst_condition",
                     sphv_json_number(measured->worst_condition));
}

/// The closed forms for standard SPH with volumes Δx, which say where the norm comes from.
static bool has_closed_form(const sphv_experiment *experiment)
{
    return experiment->method == SPHV_SPH && experiment->layout == SPHV_PERTURBED &&
           experiment->volume == SPHV_VOLUME_LATTICE;
}

static sphv_lattice_noise closed_form(const sphv_experiment *experiment)
{
    return sphv_predict_lattice_noise(experiment->profile, experiment->h, experiment->spacing,
                                      experiment->sigma);
}

static json_t *closed_form_json(const sphv_experiment *experiment,
                                const sphv_disorder_measurement *measured)
{
    sphv_lattice_noise noise = closed_form(experiment);
    return json_pack("{s:o, s:o, s:o, s:o, s:o}", "mean", sphv_json_number(noise.mean.value),
                     "measured_mean", sphv_json_number(measured->mean.value), "measured_mean_bound",
                     sphv_json_number(measured->mean.bound), "noise_l2",
                     sphv_json_number(noise.noise_l2), "l2", sphv_json_number(noise.l2));
}

static void print_closed_form(const sphv_experiment *experiment,
                              const sphv_disorder_measurement *measured)
{
    sphv_lattice_noise noise = closed_form(experiment);
    printf("\nclosed forms (characteristic function on each alias; first-order noise)\n"
           "  mean error E    %22.9e  %22.9e  (+- %.1e)\n"
           "  noise           %22.9e\n  norm of both    %22.9e\n",
           noise.mean.value, measured->mean.value, measured->mean.bound, noise.noise_l2, noise.l2);
}

static json_t *as_json(const sphv_error_question *of, const sphv_point *point,
                       const sphv_term_table *terms)
{
    const sphv_prediction *a = &point->analytic;
    const sphv_measurement *e = &point->empirical;
    const sphv_experiment *experiment = &of->experiment;
    json_t *answer = json_pack(
        "{s:s, s:i, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:s,"
        " s:{s:o, s:o, s:o, s:o, s:o, s:s}, s:{s:o, s:o, s:o, s:I, s:I, s:I, s:o}, s:o, s:s}",
        "kernel", sphv_kernel_name(of->kernel), "dim", experiment->profile->dimension, "method",
        sphv_methods[experiment->method].name, "layout", sphv_layouts[experiment->layout].name,
        "volume", sphv_volumes[experiment->volume].name, "h", sphv_json_number(experiment->h),
        "spacing", sphv_json_number(experiment->spacing.value), "sigma",
        sphv_json_number(experiment->sigma), "seed",
        point->statistical ? json_integer((json_int_t)experiment->seed) : json_null(), "form",
        sphv_form_name(of->form), "analytic", "smoothing", sphv_json_number(a->smoothing.value),
        "discretisation", sphv_json_number(a->discretisation.value), "total",
        sphv_json_number(a->total.value), "l2", sphv_json_number(a->l2.value), "bound",
        sphv_json_number(a->total.bound), "rigour", sphv_rigour_name(a->rigour), "empirical",
        "total", sphv_json_number(e->total.value), "l2", sphv_json_number(e->l2.value), "bound",
        sphv_json_number(e->total.bound), "particles", (json_int_t)e->particles, "neighbours",
        (json_int_t)e->neighbours, "pairs", (json_int_t)e->pairs, "seconds",
        sphv_json_number(e->seconds), "difference", sphv_json_number(point->difference), "verdict",
        sphv_verdict_name(point->verdict));
    if (point->statistical)
        json_object_set_new(answer, "disorder", disorder_json(&point->disorder));
    if (has_closed_form(experiment))
        json_object_set_new(answer, "closed_form", closed_form_json(experiment, &point->disorder));
    if (terms) json_object_set_new(answer, "terms", terms_json(terms));
    return answer;
}

static void print_lattice(const sphv_error_question *of, const sphv_point *point)
{
    const sphv_prediction *a = &point->analytic;
    const sphv_measurement *e = &point->empirical;
    const sphv_experiment *experiment = &of->experiment;
    sphv_lattice_place place =
        sphv_number_place(experiment->profile->support_exact, experiment->spacing);
    printf("%s in 1D, standard SPH gradient of a sine on a uniform lattice\n",
           sphv_kernel_name(of->kernel));
    printf("h/λ = %g, Δx/h = %s, %ld neighbours", experiment->h, of->spacing_text, e->neighbours);
    if (fabs(place.fraction - 0.5) < 1e-9) printf(" (n = %ld, Δx/h = 2κ/(2n+1))", place.inside);
    printf("; %s form%s\n\n", sphv_form_name(of->form),
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

static void print_terms(const sphv_term_table *terms)
{
    printf("\nroot mean square of each term over %d particles, and its order in the paper\n",
           terms->particles);
    for (int i = 0; terms->rows[i].name; i++)
        printf("  %10.3e  %-54s %s\n", terms->rms[i], terms->rows[i].name, terms->rows[i].order);
    printf("  %10.3e  their sum\n  %10.3e  the error they stand for, measured\n"
           "  %10.3e  measured - sum, particle by particle: higher orders\n",
           terms->sum, terms->measured, terms->residual);
}

static void print_statistics(const sphv_error_question *of, const sphv_point *point,
                             const sphv_term_table *terms)
{
    const sphv_experiment *experiment = &of->experiment;
    const sphv_disorder_measurement *measured = &point->disorder;
    printf("%s in 1D, gradient of a sine by %s\n", sphv_kernel_name(of->kernel),
           sphv_methods[experiment->method].name);
    printf("layout %s, σ/Δx = %g, seed %llu, volumes %s; h/λ = %g, Δx/h = %s\n\n",
           sphv_layouts[experiment->layout].name, experiment->sigma,
           (unsigned long long)experiment->seed, sphv_volumes[experiment->volume].name,
           experiment->h, of->spacing_text);
    bool predicted = isfinite(point->analytic.l2.value);
    printf("L2 norm of the error      analytic                empirical\n");
    if (predicted)
        printf("  value           %22.9e  %22.9e\n  bound           %22.1e  %22.1e  (99.9 %% "
               "interval)\n",
               point->analytic.l2.value, measured->l2.value, point->analytic.l2.bound,
               measured->l2.bound);
    else
        printf("  value           %22s  %22.9e\n  bound           %22s  %22.1e  (99.9 %% "
               "interval)\n",
               "no theory", measured->l2.value, "", measured->l2.bound);
    printf("\n%d realisations, %ld estimates, %ld pairs in %.2f s\n", measured->realisations,
           measured->particles, measured->pairs, measured->seconds);
    long faults = measured->singular + measured->ill_conditioned + measured->not_finite;
    if (faults)
        printf("left out: %ld singular, %ld ill-conditioned, %ld not finite\n", measured->singular,
               measured->ill_conditioned, measured->not_finite);
    if (isfinite(measured->worst_condition) && measured->worst_condition > 1)
        printf("worst condition number %.2e\n", measured->worst_condition);
    if (has_closed_form(experiment)) print_closed_form(experiment, measured);
    if (terms) print_terms(terms);
    if (predicted)
        printf("\n%s: |analytic - empirical| = %.1e, sum of bounds %.1e (%s)\n",
               sphv_verdict_name(point->verdict), fabs(point->difference),
               point->analytic.l2.bound + measured->l2.bound,
               sphv_rigour_name(point->analytic.rigour));
    else
        printf("\n%s: no finite prediction for method '%s' on layout '%s'\n",
               sphv_verdict_name(point->verdict), sphv_methods[experiment->method].name,
               sphv_layouts[experiment->layout].name);
}

void sphv_print_error(sphv_format format, const sphv_error_question *of, const sphv_point *point,
                      const sphv_term_table *terms)
{
    if (format == SPHV_FORMAT_TEXT) {
        if (point->statistical)
            print_statistics(of, point, terms);
        else
            print_lattice(of, point);
        return;
    }
    json_t *answer = as_json(of, point, format == SPHV_FORMAT_JSON ? terms : NULL);
    if (format == SPHV_FORMAT_JSON) {
        sphv_print_json(answer);
    } else {
        json_t *rows = json_pack("[O]", answer);
        sphv_print_rows(format, rows);
        json_decref(rows);
    }
    json_decref(answer);
}
