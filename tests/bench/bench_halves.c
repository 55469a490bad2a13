/// Points per second of each half over the ranges of Figs. 2 and 3, and kernel derivatives per
/// second; each beside a naive reference in the same run, because only ratios travel from one
/// machine to another.
#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "sphverify/compare.h"

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static volatile double sink; ///< keeps results alive

/// A kernel at one point of Fig. 2 (over h) or Fig. 3 (over Δx/h).
struct point {
    const sphv_profile *profile;
    double h;
    sphv_number spacing;
};

enum { POINTS = 400 };

/// The naive particle sum: powers of q, no compensation, no bound.
struct naive {
    double coefficient[3][24];
    double until[3];
    int pieces, degree[3];
};

/// Powers of q from the profile's own expansions about the inner ends, so that any kernel serves.
static void naive_make(const sphv_profile *profile, struct naive *out)
{
    out->pieces = profile->piece_count < 3 ? profile->piece_count : 3;
    for (int i = 0; i < out->pieces; i++) {
        double jet[SPHV_JET_MAX + 1];
        sphv_profile_jet(profile, i, profile->pieces[i].inner, 20, jet);
        out->until[i] = profile->pieces[i].outer;
        out->degree[i] = 20;
        for (int k = 0; k <= 20; k++) out->coefficient[i][k] = jet[k];
    }
}

static double naive_slope(const struct naive *of, double q)
{
    int i = 0;
    while (i < of->pieces - 1 && q >= of->until[i]) i++;
    double t = q - (i ? of->until[i - 1] : 0), sum = 0;
    for (int k = of->degree[i]; k >= 1; k--) sum = sum * t + k * of->coefficient[i][k];
    return sum;
}

static double run_naive(const struct point *point, const struct naive *of)
{
    double K = 2 * M_PI * point->h, sum = 0;
    for (double q = point->spacing.value; q < point->profile->support; q += point->spacing.value)
        sum -= 2 * point->spacing.value * naive_slope(of, q) * sin(K * q) / K;
    return sum - 1;
}

/// Seconds per call of the fastest of a few batches, each long enough for the clock.
#define TIME(seconds, statement)                                                                   \
    do {                                                                                           \
        (seconds) = INFINITY;                                                                      \
        for (int batch = 0; batch < 5; batch++) {                                                  \
            long calls = 0;                                                                        \
            double start = now(), spent;                                                           \
            do {                                                                                   \
                for (int i = 0; i < POINTS; i++) {                                                 \
                    statement;                                                                     \
                }                                                                                  \
                calls += POINTS;                                                                   \
            } while ((spent = now() - start) < 0.05);                                              \
            (seconds) = fmin(seconds, spent / (double)calls);                                      \
        }                                                                                          \
    } while (0)

static void make_points(const sphv_profile *profile, int figure, struct point *points)
{
    for (int i = 0; i < POINTS; i++) {
        double part = (double)i / (POINTS - 1);
        points[i] = figure == 2 ? (struct point){profile, 1.8e-3 * pow(0.5 / 1.8e-3, part),
                                                 sphv_profile_special_spacing(profile, 5)}
                                : (struct point){profile, 0.02,
                                                 sphv_number_from_double(0.05 * pow(16, part))};
        // Fig. 2 shows several curves: go through n = 3 … 10
        if (figure == 2) points[i].spacing = sphv_profile_special_spacing(profile, 3 + i % 8);
    }
}

static void bench_points(const char *name, const sphv_profile *profile, int figure)
{
    static struct point points[POINTS];
    make_points(profile, figure, points);
    struct naive naive;
    naive_make(profile, &naive);
    sphv_error error;
    sphv_prediction prediction;
    sphv_measurement measurement;
    double reference, analytic, empirical, paper = INFINITY;
    TIME(reference, sink = run_naive(&points[i], &naive));
    TIME(empirical, if (sphv_measure_lattice(profile, points[i].h, points[i].spacing, &measurement,
                                             &error) == SPHV_OK) sink = measurement.total.value);
    TIME(analytic,
         if (sphv_predict_lattice(profile, points[i].h, points[i].spacing, SPHV_FORM_EXACT,
                                  &prediction, &error) == SPHV_OK) sink = prediction.total.value);
    if (figure == 2)
        TIME(paper, if (sphv_predict_lattice(profile, points[i].h, points[i].spacing,
                                             SPHV_FORM_PAPER, &prediction, &error) == SPHV_OK)
                        sink = prediction.total.value);
    printf("Fig. %d  %-14s naive sum %9.0f/s   empirical %9.0f/s (%.2f of naive)   exact %9.0f/s "
           "(%.2f of naive)   paper %9.0f/s\n",
           figure, name, 1 / reference, 1 / empirical, reference / empirical, 1 / analytic,
           reference / analytic, 1 / paper);
}

static void bench_derivatives(const char *name, const sphv_profile *profile)
{
    static double q[POINTS];
    struct naive naive;
    naive_make(profile, &naive);
    for (int i = 0; i < POINTS; i++) q[i] = profile->support * (i + 0.5) / POINTS;
    double reference, bounded;
    TIME(reference, sink = naive_slope(&naive, q[i]));
    TIME(bounded, sink = sphv_profile_derivative(profile, 1, q[i]).value);
    printf("W'      %-14s naive Horner of degree 20 %9.0f/s   with bound %9.0f/s (%.2f of naive)\n",
           name, 1 / reference, 1 / bounded, reference / bounded);
}

static void bench_exhaustive(const char *name, const sphv_profile *profile)
{
    sphv_error error;
    sphv_measurement all;
    sphv_number spacing = sphv_profile_special_spacing(profile, 5);
    double start = now();
    if (sphv_measure_lattice_exhaustive(profile, 1e-5, spacing, NULL, NULL, &all, &error) !=
        SPHV_OK)
        return;
    printf("all     %-14s %.3g pairs/s, one particle stands for %ld\n", name,
           (double)all.pairs / (now() - start), all.particles);
}

int main(void)
{
    gsl_set_error_handler_off();
    const char *directory = getenv("SPHVERIFY_DATA");
    sphv_catalogue catalogue;
    sphv_error error;
    if (!directory || sphv_catalogue_load(directory, &catalogue, &error) != SPHV_OK) {
        fprintf(stderr, "SPHVERIFY_DATA does not name the data folder\n");
        return 2;
    }
    for (size_t i = 0; i < catalogue.count; i++) {
        const sphv_profile *profile = sphv_kernel_profile(catalogue.kernels[i], 1);
        const char *name = sphv_kernel_name(catalogue.kernels[i]);
        static const char *const shown[] = {"cubic-spline", "quinlan-w8", "quinlan-w10",
                                            "gaussian"};
        for (int k = 0; profile && k < 4; k++) {
            if (strcmp(shown[k], name) != 0) continue;
            bench_points(name, profile, 2);
            bench_points(name, profile, 3);
            bench_derivatives(name, profile);
            bench_exhaustive(name, profile);
        }
    }
    sphv_catalogue_free(&catalogue);
    return 0;
}
