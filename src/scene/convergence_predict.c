#include <math.h>

#include "convergence_internal.h"

/// Puts a prediction beside what was measured.
static void compare(const sphv_convergence *scene, size_t field,
                    const sphv_box_prediction *prediction, sphv_stage *stage)
{
    for (size_t t = 0; t < scene->target_count; t++) {
        const sphv_target *target = &scene->targets[t];
        sphv_rate_point *point = &stage->points[t];
        if (target->field != field || target->altered || !point->there ||
            target->quantity >= prediction->quantities || !prediction->exists[target->quantity])
            continue;
        point->rigour = prediction->rigour;
        for (int part = 0; part < 2; part++) {
            const sphv_norms *norms = part ? &point->interior : &point->whole;
            point->prediction[part] =
                part ? prediction->interior[target->quantity] : prediction->rmse[target->quantity];
            double scatter = part ? prediction->interior_scatter[target->quantity]
                                  : prediction->scatter[target->quantity];
            // Theory is about all particles: where some are left out there is nothing to compare.
            point->predicted[part] = isfinite(point->prediction[part].value) && norms->counted > 0;
            point->verdict[part] =
                norms->counted + norms->exact_undefined <
                        (part ? point->interior.counted : stage->particles)
                    ? SPHV_INCONCLUSIVE
                    : sphv_compare_norm(point->prediction[part], prediction->rigour, norms->rmse,
                                        norms->bound, norms->counted, stage->neighbours, scatter,
                                        norms->rmse);
        }
    }
}

/// The root mean square of a consistency measure over interior particles, in the units of its
/// target: those of a gradient of the constant field are 1/h.
static sphv_result measure_rms(const sphv_consistency *predicted, sphv_consistency_measure measure,
                               bool lattice, double h)
{
    sphv_result mean = lattice ? predicted->lattice[measure] : predicted->mean[measure];
    sphv_result deviation = lattice ? (sphv_result){0, 0} : predicted->deviation[measure];
    sphv_result rms = {hypot(mean.value, deviation.value), mean.bound + deviation.bound};
    double scale = measure == SPHV_FLATNESS ? 1 / h : 1;
    return (sphv_result){scale * rms.value, scale * rms.bound};
}

/// Puts the consistency measures that the scene names beside what a scheme found in the interior.
static void compare_measures(const sphv_convergence *scene, const sphv_scheme *scheme, bool lattice,
                             const sphv_consistency *predicted, sphv_stage *stage)
{
    bool difference = scheme->method == SPHV_SPH_DIFFERENCE;
    if (!scheme->has_method || (scheme->method != SPHV_SPH && !difference)) return;
    for (size_t i = 0; i < scene->measure_count; i++) {
        sphv_consistency_measure measure = scene->measures[i].measure;
        sphv_rate_point *point = &stage->points[scene->measures[i].target];
        bool of_gradient = measure == SPHV_ROTATION || measure == SPHV_SHEAR;
        sphv_result rms = measure_rms(predicted, measure, lattice, stage->h);
        // The difference form alone gives the gradient of x free of where x has its origin, and
        // the sum form alone that of the constant. What vanishes by symmetry is no number to meet.
        if (!point->there || !point->interior.counted || !(rms.value > 0) ||
            (of_gradient && !difference) || (measure == SPHV_FLATNESS && difference))
            continue;
        point->predicted[1] = true;
        point->prediction[1] = rms;
        point->rigour = lattice ? SPHV_RIGOUR_EXACT : SPHV_RIGOUR_STATISTICAL;
        point->verdict[1] = sphv_compare_norm(rms, point->rigour, point->interior.rmse,
                                              point->interior.bound, point->interior.counted,
                                              stage->neighbours, INFINITY, point->interior.rmse);
    }
}

/// Predicts the consistency measures once for all schemes of a pass.
static sphv_status predict_measures(sphv_convergence_result *result, size_t level, size_t pass,
                                    sphv_error *error)
{
    const sphv_convergence *scene = result->scene;
    const sphv_scheme *leader = &scene->schemes[pass];
    sphv_stage *stages = &result->stages[level * scene->scheme_count];
    sphv_box box = sphv_scheme_box(scene, leader, level);
    bool lattice = box.layout == SPHV_LATTICE;
    double spacing = stages[pass].spacing / stages[pass].h;
    sphv_consistency predicted;
    if (!scene->measure_count || leader->pass != pass ||
        (!lattice && box.layout != SPHV_PERTURBED) || !(spacing < leader->profile->support))
        return SPHV_OK;
    sphv_status status = sphv_predict_consistency(leader->profile, spacing, box.jitter,
                                                  box.amplitude, &predicted, error);
    for (size_t s = pass; status == SPHV_OK && s < scene->scheme_count; s++)
        if (scene->schemes[s].pass == pass)
            compare_measures(scene, &scene->schemes[s], lattice, &predicted, &stages[s]);
    return status;
}

/// Predicts the methods of a pass together: they have particles, kernel and h in common.
static sphv_status predict_pass(sphv_convergence_result *result, size_t level, size_t pass,
                                sphv_error *error)
{
    const sphv_convergence *scene = result->scene;
    const sphv_scheme *leader = &scene->schemes[pass];
    sphv_stage *stages = &result->stages[level * scene->scheme_count];
    sphv_box box = sphv_scheme_box(scene, leader, level);
    sphv_method methods[SPHV_BOX_METHODS_MAX];
    sphv_stage *stage[SPHV_BOX_METHODS_MAX];
    for (size_t s = pass; s < scene->scheme_count;) {
        size_t count = 0;
        for (; s < scene->scheme_count && count < SPHV_BOX_METHODS_MAX; s++) {
            if (scene->schemes[s].pass != pass || !scene->schemes[s].has_method) continue;
            methods[count] = scene->schemes[s].method;
            stage[count++] = &stages[s];
        }
        for (size_t f = 0; f < scene->field_count; f++) {
            sphv_box_prediction predictions[SPHV_BOX_METHODS_MAX];
            sphv_status status =
                sphv_predict_box_methods(&box, leader->profile, stages[pass].h, count, methods,
                                         &scene->fields[f], predictions, error);
            if (status != SPHV_OK) return status;
            for (size_t m = 0; m < count; m++) compare(scene, f, &predictions[m], stage[m]);
        }
    }
    return SPHV_OK;
}

/// Both kinds of theory, one after the other: the second is about the same points.
static sphv_status predict_one(sphv_convergence_result *result, bool measures, size_t level,
                               size_t scheme, sphv_error *error)
{
    if (measures) return predict_measures(result, level, scheme, error);
    return result->scene->schemes[scheme].pass == scheme
               ? predict_pass(result, level, scheme, error)
               : SPHV_OK;
}

sphv_status sphv_convergence_predict(sphv_convergence_result *result, sphv_progress progress,
                                     void *context, sphv_error *error)
{
    const sphv_convergence *scene = result->scene;
    long count = (long)(scene->level_count * scene->scheme_count), done = 0;
    sphv_status first = SPHV_OK;
    for (int measures = 0; measures < 2; measures++) {
#pragma omp parallel for schedule(dynamic, 1)
        for (long i = count - 1; i >= 0; i--) { // the large ones first
            sphv_error reason;
            sphv_status status = predict_one(result, measures, (size_t)i / scene->scheme_count,
                                             (size_t)i % scene->scheme_count, &reason);
#pragma omp critical(sphv_convergence_theory)
            {
                if (status != SPHV_OK && first == SPHV_OK) {
                    first = status;
                    if (error) *error = reason;
                }
                if (progress) progress(context, 0.9 + 0.05 * (double)++done / (double)count);
            }
        }
    }
    return first;
}
