#include <gsl/gsl_math.h>
#include <stdlib.h>
#include <time.h>

#include "internal.h"

enum { CHUNK = 256 }; ///< particles summed together; fixes the order of addition for any threads

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static sphv_status check_arguments(const sphv_profile *profile, double h, sphv_number spacing,
                                   sphv_error *error)
{
    if (profile->dimension != 1)
        return sphv_fail(error, SPHV_NO_CLOSED_FORM,
                         "no lattice measurement in %d dimensions; allowed: 1", profile->dimension);
    if (!(h > 0 && isfinite(h)))
        return sphv_fail(error, SPHV_INVALID_INPUT, "h is %g; allowed: a positive number", h);
    if (!(spacing.value > 0 && spacing.value < profile->support &&
          profile->support / spacing.value < 1e9))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "no neighbour is left at spacing %g; allowed: above %g and below the "
                         "support %g",
                         spacing.value, profile->support * 1e-9, profile->support);
    return SPHV_OK;
}

/// q of the j-th neighbour, kept on the inner side of κ where it belongs.
static double neighbour_offset(const sphv_profile *profile, sphv_number spacing, long j)
{
    double q = fma((double)j, spacing.value, (double)j * spacing.residual);
    return q < profile->support ? q : nextafter(profile->support, 0);
}

sphv_status sphv_measure_lattice(const sphv_profile *profile, double h, sphv_number spacing,
                                 sphv_measurement *out, sphv_error *error)
{
    sphv_status status = check_arguments(profile, h, spacing, error);
    if (status != SPHV_OK) return status;
    double start = now(), K = 2 * M_PI * h;
    long inside = sphv_number_place(profile->support_exact, spacing).inside;
    sphv_sum sum = {0, 0, 0};
    for (long j = inside; j >= 1; j--) {
        double q = neighbour_offset(profile, spacing, j), field = sin(K * q) / K;
        sphv_result kernel[3];
        sphv_profile_values(profile, q, kernel);
        sphv_result slope = kernel[1];
        double bend = kernel[2].value;
        double weight = 2 * spacing.value;
        // sin: argument known to 3u; q: to u, which moves the slope by |Ŵ″| q u.
        double uncertainty = fabs(field) * (slope.bound + fabs(bend) * q * SPHV_U) +
                             fabs(slope.value) * SPHV_U * (3 * q + 5 * fabs(field));
        sphv_sum_add(&sum, -weight * slope.value * field, weight * uncertainty);
    }
    sphv_sum_add(&sum, -1, 0);
    out->total = sphv_sum_result(&sum);
    out->l2 = (sphv_result){fabs(out->total.value) / M_SQRT2,
                            out->total.bound / M_SQRT2 + 2 * SPHV_U * fabs(out->total.value)};
    out->particles = 1;
    out->neighbours = 2 * inside + 1;
    out->pairs = inside;
    out->seconds = now() - start;
    return SPHV_OK;
}

/// sin and cos of 2πx for x = index·step, reduced before it is multiplied by π.
static void phase(double index, double step, double *sine, double *cosine)
{
    double x = index * step, low = fma(index, step, -x), turn = (x - nearbyint(x)) + low;
    *sine = sin(2 * M_PI * turn);
    *cosine = cos(2 * M_PI * turn);
}

/// Sums over the particles of a chunk.
struct partial {
    sphv_sum error_slope, slope_square, error_square; ///< Σ err·A′, ΣA′², Σerr²
};

static void measure_particle(const sphv_profile *profile, double h, sphv_number spacing,
                             double step, long inside, long a, struct partial *into)
{
    double own_sine, own_slope, uncertainty = 0;
    phase((double)a, step, &own_sine, &own_slope);
    sphv_sum estimate = {0, 0, 0};
    for (long j = inside; j >= 1; j--) {
        double q = neighbour_offset(profile, spacing, j), right, left, unused;
        phase((double)(a + j), step, &right, &unused);
        phase((double)(a - j), step, &left, &unused);
        sphv_result kernel[3];
        sphv_profile_values(profile, q, kernel);
        sphv_result slope = kernel[1];
        double bend = kernel[2].value;
        double weight = spacing.value / (2 * M_PI * h);
        uncertainty =
            weight * (slope.bound + fabs(bend) * q * SPHV_U + 8 * SPHV_U * fabs(slope.value));
        sphv_sum_add(&estimate, -weight * slope.value * right, uncertainty);
        sphv_sum_add(&estimate, weight * slope.value * left, uncertainty);
    }
    sphv_sum_add(&estimate, -own_slope, 8 * SPHV_U);
    sphv_result err = sphv_sum_result(&estimate);
    sphv_sum_add(&into->error_slope, err.value * own_slope, err.bound * fabs(own_slope));
    sphv_sum_add(&into->slope_square, own_slope * own_slope, 16 * SPHV_U);
    sphv_sum_add(&into->error_square, err.value * err.value,
                 err.bound * (2 * fabs(err.value) + err.bound));
}

static void merge(struct partial *into, const struct partial *from)
{
    sphv_sum *to[] = {&into->error_slope, &into->slope_square, &into->error_square};
    const sphv_sum *part[] = {&from->error_slope, &from->slope_square, &from->error_square};
    for (int i = 0; i < 3; i++) {
        sphv_sum_add(to[i], part[i]->value, part[i]->bound);
        sphv_sum_add(to[i], part[i]->lost, 0);
    }
}

sphv_status sphv_measure_lattice_exhaustive(const sphv_profile *profile, double h,
                                            sphv_number spacing, sphv_progress progress,
                                            void *context, sphv_measurement *out, sphv_error *error)
{
    sphv_status status = check_arguments(profile, h, spacing, error);
    if (status != SPHV_OK) return status;
    double start = now(), step = h * spacing.value;
    long inside = sphv_number_place(profile->support_exact, spacing).inside;
    double wanted = ceil(1 / step);
    if (wanted * ((double)inside + 16) > 2e9)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%.3g particles with %ld neighbours each are too many to evaluate one by "
                         "one; allowed: 2e9 pairs, or one particle without --exhaustive",
                         wanted, 2 * inside);
    long count = (long)wanted, chunks = (count + CHUNK - 1) / CHUNK, done = 0;
    struct partial *partials = calloc((size_t)chunks, sizeof *partials);
    if (!partials) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
#pragma omp parallel for schedule(dynamic)
    for (long chunk = 0; chunk < chunks; chunk++) {
        long last = (chunk + 1) * CHUNK < count ? (chunk + 1) * CHUNK : count;
        for (long a = chunk * CHUNK; a < last; a++)
            measure_particle(profile, h, spacing, step, inside, a, &partials[chunk]);
        if (progress) {
#pragma omp critical(sphv_lattice_progress)
            progress(context, (double)++done / (double)chunks);
        }
    }
    struct partial all = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (long chunk = 0; chunk < chunks; chunk++) merge(&all, &partials[chunk]);
    free(partials);
    sphv_result es = sphv_sum_result(&all.error_slope), ss = sphv_sum_result(&all.slope_square),
                ee = sphv_sum_result(&all.error_square);
    out->total.value = es.value / ss.value;
    out->total.bound =
        es.bound / ss.value + fabs(out->total.value) * (ss.bound / ss.value + SPHV_U);
    out->l2.value = sqrt(ee.value / ss.value) / M_SQRT2;
    // √ is 1/2-Hölder at zero: |√x − √y| ≤ √|x − y| there, |x − y|/√x elsewhere.
    double spread = ee.bound / ss.value;
    out->l2.bound =
        (ee.value > 0 ? fmin(sqrt(spread), spread / sqrt(ee.value / ss.value)) : sqrt(spread)) +
        out->l2.value * (ss.bound / ss.value + 4 * SPHV_U);
    out->particles = count;
    out->neighbours = 2 * inside + 1;
    out->pairs = count * 2 * inside;
    out->seconds = now() - start;
    return SPHV_OK;
}
