#include <math.h>

#include "sphverify/report.h"
#include "text.h"

/// 17 significant digits, so that reading it back gives the same double; nothing for no number.
static void put_number(FILE *stream, double value)
{
    if (isfinite(value))
        fprintf(stream, ",%.17g", value);
    else
        fputc(',', stream);
}

static void put_result(FILE *stream, sphv_result result)
{
    put_number(stream, result.value);
    put_number(stream, result.bound);
}

static void put_curve(FILE *stream, const sphv_curve *curve)
{
    sphv_put_csv(stream, curve->id);
    fputc(',', stream);
    sphv_put_csv(stream, curve->label);
    fputc(',', stream);
    sphv_put_csv(stream, sphv_kernel_name(curve->kernel));
}

static void put_prediction(FILE *stream, const sphv_prediction *prediction)
{
    put_number(stream, prediction->smoothing.value);
    put_number(stream, prediction->discretisation.value);
    put_result(stream, prediction->total);
    put_number(stream, prediction->l2.value);
}

static void put_name(FILE *stream, const char *name)
{
    fputc(',', stream);
    sphv_put_csv(stream, name);
}

/// What was done and what failed; empty where it does not apply.
static void put_experiment(FILE *stream, const sphv_curve *curve, const sphv_sample *sample)
{
    const sphv_experiment *of = &curve->experiment;
    const sphv_disorder_measurement *found = &sample->point.disorder;
    bool random = sample->point.statistical && of->layout != SPHV_LATTICE;
    put_name(stream, sphv_methods[of->method].name);
    put_name(stream, sphv_layouts[of->layout].name);
    put_name(stream, sphv_volumes[of->volume].name);
    put_number(stream, of->layout == SPHV_PERTURBED ? of->sigma : NAN);
    if (random)
        fprintf(stream, ",%llu", (unsigned long long)of->seed);
    else
        fputc(',', stream);
    put_number(stream, sample->point.analytic.l2.bound);
    put_number(stream, sample->point.empirical.l2.bound);
    if (sample->point.statistical) {
        fprintf(stream, ",%d,%ld,%ld,%ld,%ld", found->realisations, found->particles,
                found->singular, found->ill_conditioned, found->not_finite);
        put_number(stream, found->worst_condition);
    } else {
        fputs(",,,,,,", stream);
    }
    fputc('\n', stream);
}

static void put_error_sample(FILE *stream, const sphv_curve *curve, const sphv_sample *sample)
{
    put_number(stream, sample->h);
    put_number(stream, sample->spacing.value);
    if (sample->n >= 0)
        fprintf(stream, ",%ld", sample->n);
    else
        fputc(',', stream);
    put_prediction(stream, &sample->point.analytic);
    put_result(stream, sample->point.empirical.total);
    put_number(stream, sample->point.empirical.l2.value);
    put_number(stream, sample->point.difference);
    fprintf(stream, ",%s", sphv_verdict_name(sample->point.verdict));
    if (sample->n >= 0) {
        put_prediction(stream, &sample->paper);
        fprintf(stream, ",%s", sphv_verdict_name(sample->paper_verdict));
    } else {
        fputs(",,,,,,", stream);
    }
    put_experiment(stream, curve, sample);
}

static void put_kernel_sample(FILE *stream, const sphv_curve *curve, const sphv_sample *sample)
{
    (void)curve;
    put_number(stream, sample->x);
    put_result(stream, sample->point.analytic.total);
    put_result(stream, sample->point.empirical.total);
    put_number(stream, sample->point.difference);
    fprintf(stream, ",%s\n", sphv_verdict_name(sample->point.verdict));
}

void sphv_scene_csv(FILE *stream, const sphv_scene_result *result)
{
    const sphv_scene *scene = result->scene;
    bool kernels = scene->abscissa == SPHV_OVER_Q;
    fputs(kernels ? "curve,label,kernel,q,analytic,analytic_bound,empirical,empirical_bound,"
                    "difference,verdict\n"
                  : "curve,label,kernel,h,spacing,n,analytic_smoothing,analytic_discretisation,"
                    "analytic_total,analytic_bound,analytic_l2,empirical_total,empirical_bound,"
                    "empirical_l2,difference,verdict,paper_smoothing,paper_discretisation,"
                    "paper_total,paper_bound,paper_l2,paper_verdict,method,layout,volume,sigma,"
                    "seed,analytic_l2_bound,empirical_l2_bound,realisations,estimates,singular,ill_"
                    "conditioned,not_finite,worst_condition\n",
          stream);
    for (size_t c = 0; c < scene->curve_count; c++)
        for (size_t i = 0; i < result->sample_count[c]; i++) {
            put_curve(stream, &scene->curves[c]);
            (kernels ? put_kernel_sample : put_error_sample)(stream, &scene->curves[c],
                                                             &result->samples[c][i]);
        }
}
