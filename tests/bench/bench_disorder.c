/// Estimates per second on disordered particles, for each method: neighbourhoods, volumes and
/// estimates of two fields together, on one thread and on all; the prediction beside them. Ratios
/// to standard SPH of the same run tell what a method costs.
#include <gsl/gsl_errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "sphverify/measure.h"
#include "sphverify/theory.h"

#ifdef _OPENMP
#include <omp.h>
#endif

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int processors(void)
{
#ifdef _OPENMP
    return omp_get_num_procs();
#else
    return 1;
#endif
}

static void use_threads(int count)
{
#ifdef _OPENMP
    omp_set_num_threads(count);
#else
    (void)count;
#endif
}

/// Particles per second, the fastest of a few runs.
static double particles_per_second(const sphv_experiment *of)
{
    double best = 0;
    for (int run = 0; run < 4; run++) {
        sphv_disorder_measurement found;
        sphv_error error;
        if (sphv_measure_disorder(of, NULL, NULL, &found, &error) != SPHV_OK) {
            fprintf(stderr, "%s\n", error.message);
            exit(2);
        }
        double speed = (double)found.particles / found.seconds;
        if (run > 0 && speed > best) best = speed; // the first run warms up
    }
    return best;
}

static double predictions_per_second(const sphv_experiment *of)
{
    long count = 0;
    double start = now(), spent;
    sphv_prediction prediction;
    sphv_error error;
    do {
        if (sphv_predict_disorder(of, &prediction, &error) != SPHV_OK) exit(2);
        count++;
    } while ((spent = now() - start) < 0.1);
    return (double)count / spent;
}

int main(void)
{
    gsl_set_error_handler_off();
    const char *directory = getenv("SPHVERIFY_DATA");
    sphv_kernel *kernel = NULL;
    sphv_error error;
    if (!directory || sphv_catalogue_find(directory, "quinlan-w10", &kernel, &error) != SPHV_OK) {
        fprintf(stderr, "SPHVERIFY_DATA does not name the data folder\n");
        return 2;
    }
    int all = processors();
    double standard = 0;
    printf("particles per second, W10, Δx/h = 4/11, σ/Δx = 0.1; in brackets relative to sph with "
           "tessellated volumes\n");
    for (int volume = SPHV_VOLUME_TESSELLATED; volume <= SPHV_VOLUME_DENSITY; volume++)
        for (int method = 0; sphv_methods[method].name; method++) {
            sphv_experiment of = {.profile = sphv_kernel_profile(kernel, 1),
                                  .h = 0.02,
                                  .spacing = sphv_number_from_ratio(4, 11),
                                  .method = (sphv_method)method,
                                  .layout = SPHV_PERTURBED,
                                  .volume = (sphv_volume)volume,
                                  .sigma = 0.1,
                                  .seed = 1,
                                  .width = 1e-9,
                                  .realisations_min = 64,
                                  .realisations_max = 64};
            use_threads(1);
            double one = particles_per_second(&of), theory = predictions_per_second(&of);
            use_threads(all);
            double many = particles_per_second(&of);
            if (standard == 0) standard = one;
            printf("%-11s %-9s one thread %9.0f/s (%.2f)   %d threads %9.0f/s (%.2f of one)   "
                   "predictions %7.0f/s\n",
                   sphv_volumes[volume].name, sphv_methods[method].name, one, one / standard, all,
                   many, many / one, theory);
        }
    sphv_kernel_free(kernel);
    return 0;
}
