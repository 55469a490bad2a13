#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "internal.h"

long sphv_special_n(const sphv_profile *profile, sphv_number spacing)
{
    sphv_lattice_place place = sphv_number_place(profile->support_exact, spacing);
    return fabs(place.fraction - 0.5) < 1e-12 * (double)(place.inside + 1) ? place.inside : -1;
}

sphv_status sphv_compare_paper(const sphv_profile *profile, double h, sphv_number spacing,
                               const sphv_measurement *measured, sphv_prediction *paper,
                               sphv_verdict *verdict, sphv_error *error)
{
    sphv_status status = sphv_predict_lattice(profile, h, spacing, SPHV_FORM_PAPER, paper, error);
    if (status != SPHV_OK) return status;
    double scale = fmax(fabs(paper->smoothing.value), fabs(paper->discretisation.value));
    *verdict = sphv_compare(paper->total, measured->total, scale);
    return SPHV_OK;
}

/// Ŵ(q) from a Taylor expansion about another point: for closed forms, which have no exact value,
/// this is the reference that the direct evaluation is compared with.
static sphv_result by_taylor(const sphv_profile *profile, double q)
{
    double step = profile->support / 16, centre = step * floor(q / step + 0.5), jet[41];
    if (!(q < profile->support)) return (sphv_result){0, 0};
    if (centre >= profile->support) centre -= step;
    sphv_profile_jet(profile, 0, centre, 40, jet);
    double sum = 0, magnitude = 0;
    for (int i = 40; i >= 0; i--) {
        sum = sum * (q - centre) + jet[i];
        magnitude = magnitude * fabs(q - centre) + fabs(jet[i]);
    }
    double remainder = profile->pieces[0].derivative_bound[41] * pow(fabs(q - centre), 41);
    return (sphv_result){sum, 1e-14 * magnitude + remainder};
}

static void evaluate_profile(const sphv_curve *curve, sphv_sample *sample)
{
    double exact;
    sphv_result analytic;
    if (sphv_kernel_exact_value(curve->kernel, 1, 0, sample->x, &exact))
        analytic = (sphv_result){exact, 0x1p-53 * fabs(exact)};
    else
        analytic = by_taylor(curve->profile, sample->x);
    sphv_result empirical = sphv_profile_derivative(curve->profile, 0, sample->x);
    sample->point.analytic.total = analytic;
    sample->point.empirical.total = empirical;
    sample->point.difference = analytic.value - empirical.value;
    // The quantity is the kernel: 1 % of its size at the origin must not go unnoticed.
    sample->point.verdict =
        sphv_compare(analytic, empirical, sphv_profile_derivative(curve->profile, 0, 0).value);
}

static sphv_status evaluate(const sphv_scene *scene, const sphv_curve *curve, sphv_sample *sample,
                            sphv_error *error)
{
    if (scene->abscissa == SPHV_OVER_Q) {
        evaluate_profile(curve, sample);
        return SPHV_OK;
    }
    sphv_experiment experiment = curve->experiment;
    experiment.h = sample->h;
    experiment.spacing = sample->spacing;
    sphv_status status =
        scene->statistical
            ? sphv_evaluate_experiment(&experiment, NULL, NULL, &sample->point, error)
            : sphv_evaluate_point(curve->profile, sample->h, sample->spacing, SPHV_FORM_EXACT,
                                  false, NULL, NULL, &sample->point, error);
    if (status == SPHV_OK && sample->n >= 0)
        status =
            sphv_compare_paper(curve->profile, sample->h, sample->spacing, &sample->point.empirical,
                               &sample->paper, &sample->paper_verdict, error);
    return status;
}

sphv_number sphv_curve_spacing(const sphv_scene *scene, const sphv_curve *curve, double h)
{
    if (curve->spacing_exponent == 0) return curve->spacing;
    return sphv_number_from_double(curve->spacing.value *
                                   pow(h / scene->to, curve->spacing_exponent));
}

static double abscissa_at(const sphv_scene *scene, size_t i)
{
    double t = (double)i / (double)(scene->points - 1);
    if (i + 1 == scene->points) return scene->to;
    return scene->logarithmic ? scene->from * pow(scene->to / scene->from, t)
                              : scene->from + t * (scene->to - scene->from);
}

static int by_x(const void *a, const void *b)
{
    double x = ((const sphv_sample *)a)->x, y = ((const sphv_sample *)b)->x;
    return (x > y) - (x < y);
}

/// Where an even point falls on a special spacing, the special one stands for both.
static size_t merge_equal(sphv_sample *samples, size_t count)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        bool equal = kept > 0 && samples[i].x - samples[kept - 1].x <= 1e-14 * samples[i].x;
        if (!equal)
            samples[kept++] = samples[i];
        else if (samples[i].marked)
            samples[kept - 1] = samples[i];
    }
    return kept;
}

/// Lays out a curve's samples: the scene's points and, over spacing, every special spacing in
/// range.
static sphv_status lay_out(const sphv_scene *scene, const sphv_curve *curve, size_t *count,
                           sphv_sample **out, sphv_error *error)
{
    long first = 0, last = -1;
    if (scene->abscissa == SPHV_OVER_SPACING && !scene->statistical) {
        // 2κ/(2n+1) ≤ to and ≥ from
        first = (long)fmax(1, ceil(curve->profile->support / scene->to - 0.5 - 1e-9));
        last = (long)floor(curve->profile->support / scene->from - 0.5 + 1e-9);
    }
    size_t special = last >= first ? (size_t)(last - first + 1) : 0;
    sphv_sample *samples = calloc(scene->points + special, sizeof *samples);
    if (!samples) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    size_t every = scene->markers > 1 ? (scene->points - 1) / (scene->markers - 1) : scene->points;
    if (every == 0) every = 1;
    for (size_t i = 0; i < scene->points; i++) {
        sphv_sample *sample = &samples[i];
        sample->x = abscissa_at(scene, i);
        sample->h = scene->abscissa == SPHV_OVER_H ? sample->x : curve->h;
        sample->spacing = scene->abscissa == SPHV_OVER_SPACING
                              ? sphv_number_from_double(sample->x)
                              : sphv_curve_spacing(scene, curve, sample->h);
        sample->n = scene->abscissa == SPHV_OVER_Q || scene->statistical
                        ? -1
                        : sphv_special_n(curve->profile, sample->spacing);
        sample->marked = (scene->abscissa != SPHV_OVER_SPACING || scene->statistical) &&
                         scene->markers > 0 && i % every == 0;
    }
    for (size_t i = 0; i < special; i++) {
        sphv_sample *sample = &samples[scene->points + i];
        sample->n = first + (long)i;
        sample->spacing = sphv_profile_special_spacing(curve->profile, (int)sample->n);
        sample->x = sample->spacing.value;
        sample->h = curve->h;
        sample->marked = true;
    }
    qsort(samples, scene->points + special, sizeof *samples, by_x);
    *count = merge_equal(samples, scene->points + special);
    *out = samples;
    return SPHV_OK;
}

static void tally(sphv_scene_result *result)
{
    const sphv_scene *scene = result->scene;
    size_t *exact[] = {&result->agreeing, &result->disagreeing, &result->inconclusive};
    size_t *paper[] = {&result->paper_agreeing, &result->paper_disagreeing,
                       &result->paper_inconclusive};
    for (size_t c = 0; c < scene->curve_count; c++)
        for (size_t i = 0; i < result->sample_count[c]; i++) {
            const sphv_sample *sample = &result->samples[c][i];
            ++*exact[sample->point.verdict];
            if (sample->n >= 0) ++*paper[sample->paper_verdict];
        }
    result->verdict = result->disagreeing                       ? SPHV_DISAGREES
                      : result->inconclusive > result->agreeing ? SPHV_INCONCLUSIVE
                                                                : SPHV_AGREES;
    for (size_t i = 0; i < scene->claim_count; i++) {
        result->claims[i] = sphv_claim_judge(result, &scene->claims[i]);
        if (result->claims[i].surprising)
            result->verdict = sphv_verdict_worse(
                result->verdict, result->claims[i].verdict == SPHV_INCONCLUSIVE ? SPHV_INCONCLUSIVE
                                                                                : SPHV_DISAGREES);
    }
}

static sphv_status allocate(sphv_scene_result *result, sphv_error *error)
{
    const sphv_scene *scene = result->scene;
    result->sample_count = calloc(scene->curve_count, sizeof *result->sample_count);
    result->samples = calloc(scene->curve_count, sizeof *result->samples);
    result->claims = calloc(scene->claim_count + 1, sizeof *result->claims);
    if (!result->sample_count || !result->samples || !result->claims)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    for (size_t c = 0; c < scene->curve_count; c++) {
        sphv_status status =
            lay_out(scene, &scene->curves[c], &result->sample_count[c], &result->samples[c], error);
        if (status != SPHV_OK) return status;
    }
    return SPHV_OK;
}

static sphv_status evaluate_all(sphv_scene_result *result, sphv_progress progress, void *context,
                                sphv_error *error)
{
    const sphv_scene *scene = result->scene;
    sphv_status first = SPHV_OK;
    size_t done = 0, all = 0;
    for (size_t c = 0; c < scene->curve_count; c++) all += result->sample_count[c];
    for (size_t c = 0; c < scene->curve_count; c++) {
        long count = (long)result->sample_count[c];
#pragma omp parallel for schedule(dynamic, 1)
        for (long i = 0; i < count; i++) {
            sphv_error reason;
            sphv_status status =
                evaluate(scene, &scene->curves[c], &result->samples[c][i], &reason);
#pragma omp critical(sphv_scene_progress)
            {
                if (status != SPHV_OK && first == SPHV_OK) {
                    first = status;
                    sphv_fail(error, status, "%s, curve '%s' at %g: %s", scene->path,
                              scene->curves[c].id, result->samples[c][i].x, reason.message);
                }
                done++;
                if (progress && done % 16 == 0) progress(context, (double)done / (double)all);
            }
        }
    }
    return first;
}

sphv_status sphv_scene_run(const sphv_scene *scene, sphv_progress progress, void *context,
                           sphv_scene_result **out, sphv_error *error)
{
    struct timespec start, end;
    clock_gettime(CLOCK_MONOTONIC, &start);
    sphv_scene_result *result = calloc(1, sizeof *result);
    if (!result) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    result->scene = scene;
    sphv_status status = allocate(result, error);
    if (status == SPHV_OK) status = evaluate_all(result, progress, context, error);
    if (status != SPHV_OK) {
        sphv_scene_result_free(result);
        return status;
    }
    tally(result);
    if (progress) progress(context, 1);
    clock_gettime(CLOCK_MONOTONIC, &end);
    result->seconds =
        (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    *out = result;
    return SPHV_OK;
}

void sphv_scene_result_free(sphv_scene_result *result)
{
    if (!result) return;
    for (size_t c = 0; result->samples && c < result->scene->curve_count; c++)
        free(result->samples[c]);
    free(result->samples);
    free(result->sample_count);
    free(result->claims);
    free(result);
}
