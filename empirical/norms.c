#include <stddef.h>

#include "internal.h"
#include "sphverify/estimate.h"

/// Particles are summed in at most so many blocks, each by one thread; the blocks are then added in
/// order, so that the result does not depend on the number of threads.
enum { BLOCKS = 256, BLOCK_MIN = 1024 };

/// One array of estimates beside the exact values.
typedef struct comparison {
    const sphv_particles *particles;
    const double *estimate, *exact;
    const unsigned char *fault;
    double margin;
    double scale; ///< power of two that keeps squares in range
    double mean;  ///< of the scaled errors
} comparison;

/// What one block contributes.
typedef struct partial {
    sphv_norms counts;
    double maximum;
    sphv_sum square, absolute, plain, deviation;
} partial;

/// Whether a particle belongs to the part of the box that is looked at.
static bool is_inside(const comparison *of, size_t n)
{
    for (int i = 0; i < of->particles->dimension; i++) {
        double x = of->particles->x[i][n];
        if (!(x >= of->margin && 1 - x >= of->margin)) return false;
    }
    return true;
}

/// The rule of the norms. False when the particle is left out; `counts` then says why.
static bool error_at(const comparison *of, size_t n, sphv_norms *counts, double *error)
{
    if (of->margin > 0 && !is_inside(of, n)) return false;
    sphv_fault fault = of->fault[n] < SPHV_FAULTS ? of->fault[n] : SPHV_FAULT_NOT_FINITE;
    *error = of->estimate[n] - of->exact[n];
    if (fault == SPHV_FAULT_NONE && !isfinite(of->exact[n])) {
        counts->exact_undefined++;
        return false;
    }
    if (fault == SPHV_FAULT_NONE && !isfinite(*error)) fault = SPHV_FAULT_NOT_FINITE;
    if (fault != SPHV_FAULT_NONE) {
        counts->excluded[fault]++;
        return false;
    }
    counts->counted++;
    return true;
}

/// First pass: who counts, the largest error, and the sums of the scaled errors.
static void add_errors(const comparison *of, size_t first, size_t end, partial *out)
{
    *out = (partial){0};
    for (size_t n = first; n < end; n++) {
        double error;
        if (!error_at(of, n, &out->counts, &error)) continue;
        out->maximum = fmax(out->maximum, fabs(error));
        error *= of->scale;
        sphv_sum_add(&out->square, error * error, 0);
        sphv_sum_add(&out->absolute, fabs(error), 0);
        sphv_sum_add(&out->plain, error, 0);
    }
}

/// Second pass: the scatter about the mean.
static void add_deviations(const comparison *of, size_t first, size_t end, partial *out)
{
    sphv_norms ignored = {0};
    for (size_t n = first; n < end; n++) {
        double error;
        if (!error_at(of, n, &ignored, &error)) continue;
        double deviation = error * of->scale - of->mean;
        sphv_sum_add(&out->deviation, deviation * deviation, 0);
    }
}

/// Runs a pass over all particles, block by block.
static void run_pass(const comparison *of,
                     void (*pass)(const comparison *, size_t, size_t, partial *),
                     partial parts[BLOCKS])
{
    size_t count = of->particles->count, block = (count + BLOCKS - 1) / BLOCKS;
    if (block < BLOCK_MIN) block = BLOCK_MIN;
#pragma omp parallel for schedule(static) if (count > 16 * BLOCK_MIN)
    for (size_t b = 0; b < BLOCKS; b++) {
        size_t first = b * block < count ? b * block : count;
        pass(of, first, first + block < count ? first + block : count, &parts[b]);
    }
}

/// Adds what the blocks found.
static sphv_sum total(const partial parts[BLOCKS], size_t member)
{
    sphv_sum sum = {0};
    for (size_t b = 0; b < BLOCKS; b++) {
        const sphv_sum *part = (const sphv_sum *)((const char *)&parts[b] + member);
        sphv_sum_add(&sum, part->value, part->bound);
        sphv_sum_add(&sum, part->lost, 0);
    }
    return sum;
}

static void collect(const partial parts[BLOCKS], sphv_norms *out)
{
    for (size_t b = 0; b < BLOCKS; b++) {
        const sphv_norms *counts = &parts[b].counts;
        out->counted += counts->counted;
        out->exact_undefined += counts->exact_undefined;
        for (int f = 0; f < SPHV_FAULTS; f++) out->excluded[f] += counts->excluded[f];
        out->maximum = fmax(out->maximum, parts[b].maximum);
    }
}

sphv_norms sphv_error_norms(const sphv_particles *particles, const sphv_estimates *estimates,
                            size_t method, size_t field, size_t quantity, const double *exact,
                            double margin)
{
    const sphv_method_estimates *from = &estimates->methods[method];
    size_t array = field * from->quantities + quantity;
    comparison of = {particles, from->estimate[array], exact, from->fault, margin * (1 - 1e-12), 1,
                     0};
    partial parts[BLOCKS];
    sphv_norms out = {0};
    run_pass(&of, add_errors, parts);
    collect(parts, &out);
    if (out.counted == 0 || out.maximum == 0) {
        out.bound = out.counted ? from->rounding[array] : 0;
        return out;
    }
    // Squares far out of range are summed once more, scaled.
    int exponent = 0;
    if (out.maximum > 1e150 || out.maximum < 1e-120) {
        frexp(out.maximum, &exponent);
        if (exponent < -1000) exponent = -1000;
        of.scale = ldexp(1, -exponent);
        run_pass(&of, add_errors, parts);
    }
    double count = (double)out.counted;
    sphv_sum sum = total(parts, offsetof(partial, square));
    sphv_result square = sphv_sum_result(&sum);
    sum = total(parts, offsetof(partial, absolute));
    out.mae = ldexp(sphv_sum_result(&sum).value / count, exponent);
    sum = total(parts, offsetof(partial, plain));
    of.mean = sphv_sum_result(&sum).value / count;
    run_pass(&of, add_deviations, parts);
    sum = total(parts, offsetof(partial, deviation));
    out.standard_deviation = ldexp(sqrt(sphv_sum_result(&sum).value / count), exponent);
    out.rmse = ldexp(sqrt(square.value / count), exponent);
    out.mean_square = out.rmse * out.rmse;
    // Estimates off by r at most move the root mean square by r at most. Beside that: u from each
    // subtraction, u/2 from each square, half of the sum's own error, u/2 and u from the quotient
    // and the root.
    out.bound = from->rounding[array] + out.rmse * (4 * SPHV_U + 0.5 * square.bound / square.value);
    return out;
}
