#include <gsl/gsl_cdf.h>
#include <gsl/gsl_math.h>
#include <stdlib.h>
#include <time.h>

#include "estimate.h"
#include "internal.h"

enum { PARTICLES = 160, BATCH = 8 };

/// How many particles of a realisation are evaluated, and how far apart they are. A lattice has no
/// end, so particles are taken whose supports do not overlap: neighbours' errors are correlated and
/// would cost as much and tell less. Without a perturbation they are all alike, and one is enough.
static void choose_particles(const sphv_cloud *cloud, long *count, double *stride)
{
    const sphv_experiment *of = cloud->experiment;
    *count = PARTICLES;
    if (of->layout == SPHV_LATTICE || (of->layout == SPHV_PERTURBED && of->sigma == 0)) {
        *count = 1;
        *stride = 1;
    } else if (of->layout == SPHV_PERTURBED) {
        *stride = ceil(2 * of->profile->support / of->spacing.value);
    } else {
        if (cloud->particles < *count) *count = cloud->particles;
        *stride = (double)cloud->particles / (double)*count;
    }
}

/// Of the interval around a Monte-Carlo mean: a report holds hundreds of them, and at 95 % one in
/// twenty would seem to disagree by chance.
static const double confidence = 0.999;

/// What one realisation found.
struct realisation {
    double mean_square; ///< of the error at sound particles, divided by max|A′|²
    double mean;        ///< of the relative error of the slope, E
    long sound, particles, pairs;
    long faults[SPHV_FAULTS];
    double worst_condition;
    sphv_status status;
};

static void evaluate(const sphv_cloud *cloud, long index, sphv_neighbourhood *around,
                     double **field, int *field_size, struct realisation *into, sphv_sum *squares,
                     sphv_sum *errors)
{
    const sphv_experiment *of = cloud->experiment;
    if (sphv_cloud_neighbourhood(cloud, index, around) != SPHV_OK) {
        into->status = SPHV_RESOURCE_FAILURE;
        return;
    }
    if (around->count > *field_size) {
        double *larger = realloc(*field, (size_t)around->count * 2 * sizeof **field);
        if (!larger) {
            into->status = SPHV_RESOURCE_FAILURE;
            return;
        }
        *field = larger;
        *field_size = around->count;
    }
    // The error is linear in the field, so its square averaged over the field's phase is the mean
    // of those on a zero and on a crest: no bias from where the particles happen to stand on the
    // wave.
    double error[2];
    sphv_estimate estimate = sphv_phase_errors(of, around, *field, error);
    into->worst_condition = fmax(into->worst_condition, estimate.condition);
    into->particles++;
    into->pairs += around->count;
    into->faults[estimate.usable ? SPHV_FAULT_NONE : estimate.fault]++;
    if (!estimate.usable) return;
    sphv_sum_add(squares, 0.5 * (error[0] * error[0] + error[1] * error[1]), 0);
    sphv_sum_add(errors, error[SPHV_PHASE_SINE], 0);
    into->sound++;
}

static void run_realisation(const sphv_experiment *experiment, int number, struct realisation *out)
{
    sphv_cloud cloud;
    sphv_neighbourhood around = {0};
    sphv_sum squares = {0, 0, 0}, errors = {0, 0, 0};
    double *field = NULL;
    int field_size = 0;
    *out = (struct realisation){.worst_condition = 1};
    out->status = sphv_cloud_make(&cloud, experiment, number, NULL);
    if (out->status == SPHV_OK) {
        long count;
        double stride;
        choose_particles(&cloud, &count, &stride);
        for (long i = 0; i < count && out->status == SPHV_OK; i++) {
            long index = (long)((double)i * stride);
            evaluate(&cloud, index, &around, &field, &field_size, out, &squares, &errors);
        }
    }
    sphv_result total = sphv_sum_result(&squares);
    out->mean = out->sound > 0 ? sphv_sum_result(&errors).value / (double)out->sound : NAN;
    out->mean_square = out->sound > 0 ? total.value / (double)out->sound : NAN;
    free(field);
    sphv_neighbourhood_free(&around);
    sphv_cloud_free(&cloud);
}

static double mean_square_of(const struct realisation *found)
{
    return found->mean_square;
}

static double mean_of(const struct realisation *found)
{
    return found->mean;
}

/// Mean over realisations with the half-width of its 99.9 % interval (Student's t).
static sphv_result interval(const struct realisation *found, int count,
                            double (*take)(const struct realisation *found))
{
    double mean = 0, squares = 0;
    int used = 0;
    for (int i = 0; i < count; i++) {
        double value = take(&found[i]);
        if (!isfinite(value)) continue;
        double difference = value - mean;
        mean += difference / ++used;
        squares += difference * (value - mean);
    }
    if (used < 2) return (sphv_result){used ? mean : NAN, INFINITY};
    double error = sqrt(squares / (used - 1.0) / used);
    return (sphv_result){mean, gsl_cdf_tdist_Pinv(1 - 0.5 * (1 - confidence), used - 1.0) * error};
}

static void collect(const struct realisation *found, int count, double h,
                    sphv_disorder_measurement *out)
{
    *out = (sphv_disorder_measurement){.realisations = count, .worst_condition = 1};
    for (int i = 0; i < count; i++) {
        out->particles += found[i].particles;
        out->pairs += found[i].pairs;
        const long *faults = found[i].faults;
        out->singular +=
            faults[SPHV_FAULT_ISOLATED] + faults[SPHV_FAULT_TOO_FEW] + faults[SPHV_FAULT_SINGULAR];
        out->ill_conditioned += faults[SPHV_FAULT_ILL_CONDITIONED];
        out->not_finite += faults[SPHV_FAULT_NOT_FINITE];
        out->worst_condition = fmax(out->worst_condition, found[i].worst_condition);
    }
    out->mean_square = interval(found, count, mean_square_of);
    out->mean = interval(found, count, mean_of);
    out->l2.value = sqrt(out->mean_square.value);
    // Rounding, which alone is left on a lattice: n + 16 operations on terms that sum to less
    // than 4.
    double neighbours = out->particles ? (double)out->pairs / (double)out->particles : 0;
    // The inverse of the moment matrix magnifies it by the condition number.
    double condition = isfinite(out->worst_condition) ? out->worst_condition : 1;
    double rounding = (neighbours + 16) * 4 * SPHV_U * (1 + 1 / (2 * M_PI * h)) * condition;
    double chance = out->l2.value > 0 ? out->mean_square.bound / (2 * out->l2.value)
                                      : sqrt(out->mean_square.bound);
    out->l2.bound = chance + rounding;
    out->mean.bound += rounding;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

sphv_status sphv_measure_disorder(const sphv_experiment *experiment, sphv_progress progress,
                                  void *context, sphv_disorder_measurement *out, sphv_error *error)
{
    sphv_status status = sphv_experiment_check(experiment, error);
    if (status != SPHV_OK) return status;
    double start = now();
    int most = experiment->realisations_max, done = 0;
    struct realisation *found = calloc((size_t)most, sizeof *found);
    if (!found) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    // Without chance in the layout one realisation, twice for the form's sake, says it all.
    if (experiment->layout == SPHV_LATTICE ||
        (experiment->layout == SPHV_PERTURBED && experiment->sigma == 0))
        most = 2;
    while (done < most) {
        int wanted = done == 0 ? experiment->realisations_min : done + BATCH;
        if (wanted > most) wanted = most;
#pragma omp parallel for schedule(dynamic)
        for (int i = done; i < wanted; i++) run_realisation(experiment, i, &found[i]);
        done = wanted;
        collect(found, done, experiment->h, out);
        if (progress) progress(context, (double)done / most);
        if (out->l2.bound <= experiment->width * out->l2.value) break;
    }
    for (int i = 0; i < done; i++)
        if (found[i].status != SPHV_OK) status = SPHV_RESOURCE_FAILURE;
    free(found);
    if (progress) progress(context, 1);
    out->seconds = now() - start;
    return status == SPHV_OK ? SPHV_OK : sphv_fail(error, status, "out of memory");
}
