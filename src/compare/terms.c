#include <math.h>
#include <string.h>

#include "sphverify/compare.h"

static const int realisations = 4, particles = 128;

static double square(double x)
{
    return x * x;
}

/// One particle: its terms, the error they stand for and the error measured.
static void add_particle(const sphv_experiment *of, double smoothing, const sphv_observation *seen,
                         sphv_term_table *table)
{
    double terms[SPHV_TERMS_MAX], sum[2] = {0, 0};
    table->rows = sphv_disorder_terms(of, &seen->cells, terms);
    if (!table->rows) return;
    for (int i = 0; table->rows[i].name; i++) {
        table->rms[i] += 0.5 * square(terms[i]);
        sum[table->rows[i].phase] += terms[i];
    }
    for (int phase = SPHV_PHASE_SINE; phase <= SPHV_PHASE_COSINE; phase++) {
        double measured = seen->error[phase] - (phase == SPHV_PHASE_SINE ? smoothing : 0);
        table->sum += 0.5 * square(sum[phase]);
        table->measured += 0.5 * square(measured);
        table->residual += 0.5 * square(measured - sum[phase]);
    }
    table->particles++;
}

sphv_status sphv_evaluate_terms(const sphv_experiment *experiment, sphv_term_table *table,
                                sphv_error *error)
{
    memset(table, 0, sizeof *table);
    sphv_status status = sphv_experiment_check(experiment, error);
    if (status != SPHV_OK) return status;
    if (experiment->volume != SPHV_VOLUME_TESSELLATED ||
        (experiment->method != SPHV_SPH && experiment->method != SPHV_BONET_LOK))
        return sphv_fail(error, SPHV_NO_CLOSED_FORM,
                         "no terms for method '%s' with volume '%s'; allowed: sph or bonet-lok "
                         "with tessellated",
                         sphv_methods[experiment->method].name,
                         sphv_volumes[experiment->volume].name);
    double smoothing = experiment->method == SPHV_SPH
                           ? sphv_smoothing_error(experiment->profile, experiment->h).value
                           : 0;
    long stride = (long)ceil(2 * experiment->profile->support / experiment->spacing.value);
    for (int r = 0; r < realisations; r++)
        for (int i = 0; i < particles; i++) {
            sphv_observation seen;
            status = sphv_observe(experiment, r, i * stride, &seen, error);
            if (status != SPHV_OK) return status;
            if (isfinite(seen.error[0]) && isfinite(seen.error[1]))
                add_particle(experiment, smoothing, &seen, table);
            sphv_observation_free(&seen);
        }
    double count = table->particles;
    for (int i = 0; i < SPHV_TERMS_MAX; i++) table->rms[i] = sqrt(table->rms[i] / count);
    table->sum = sqrt(table->sum / count);
    table->measured = sqrt(table->measured / count);
    table->residual = sqrt(table->residual / count);
    return SPHV_OK;
}
