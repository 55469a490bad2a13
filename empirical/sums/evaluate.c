#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../internal.h"
#include "chunks.h"
#include "evaluation.h"
#include "half_pairs.h"
#include "memory.h"

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/// What some numbers lie between, which have to be finite.
static sphv_status check_numbers(const double *values, size_t count, const char *what, size_t which,
                                 sphv_span *span, sphv_error *error)
{
    *span = sphv_span_of(values, count);
    for (size_t i = 0; !span->finite && i < count; i++)
        if (!isfinite(values[i]))
            return sphv_fail(error, SPHV_INVALID_INPUT, "%s %zu of particle %zu is not finite",
                             what, which, i);
    return SPHV_OK;
}

/// The squares of lengths and h^d have to be normal numbers, else supports would be empty or cover
/// everything.
static bool representable(double h, double support, int dimension)
{
    double square = (support * h) * (support * h), volume = pow(h, dimension);
    return isnormal(square) && isnormal(volume) && isnormal(1 / volume);
}

/// \param spans  receives those of the fields
static sphv_status check(const sphv_particles *particles, const sphv_request *request,
                         sphv_span *spans, sphv_error *error)
{
    const sphv_profile *profile = request->profile;
    if (!profile || profile->dimension != particles->dimension)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "the kernel's profile and the particles differ in dimension");
    if (!(request->h > 0) || !isfinite(request->h))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "the smoothing length is %g; it must be positive and finite", request->h);
    if (!representable(request->h, profile->support, particles->dimension))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "the smoothing length %g is too extreme: its square or its inverse volume "
                         "is out of range",
                         request->h);
    if (particles->periodic && !(profile->support * request->h < 0.5))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "a support radius of %g reaches half-way round the periodic box; it must "
                         "be below 1/2",
                         profile->support * request->h);
    for (size_t m = 0; m < request->method_count; m++)
        if ((int)request->methods[m] < 0 || sphv_method_level(request->methods[m]) < 0 ||
            sphv_method_level(request->methods[m]) >= SPHV_SUM_LEVELS)
            return sphv_fail(error, SPHV_INVALID_INPUT, "method %d does not exist",
                             (int)request->methods[m]);
    sphv_span span;
    for (int i = 0; i < particles->dimension; i++) {
        const double *x = particles->x[i];
        sphv_status status =
            check_numbers(x, particles->count, "coordinate", (size_t)i + 1, &span, error);
        if (status != SPHV_OK) return status;
        bool outside = particles->periodic && (span.low < 0 || span.high > 1);
        for (size_t b = 0; outside && b < particles->count; b++)
            if (!(x[b] >= 0 && x[b] <= 1))
                return sphv_fail(error, SPHV_INVALID_INPUT,
                                 "particle %zu is outside the periodic box [0, 1]", b);
    }
    sphv_status status =
        check_numbers(particles->volume, particles->count, "volume", 1, &span, error);
    for (size_t f = 0; status == SPHV_OK && f < request->field_count; f++)
        status =
            check_numbers(request->fields[f], particles->count, "field", f + 1, &spans[f], error);
    return status;
}

/// Cuts the arrays over particles.
static void place_estimates(sphv_estimates *out, sphv_arena *arena)
{
    out->neighbours = sphv_arena_take(arena, out->count, sizeof *out->neighbours);
    for (size_t m = 0; m < out->method_count; m++) {
        sphv_method_estimates *method = &out->methods[m];
        method->condition = sphv_arena_take(arena, out->count, sizeof *method->condition);
        method->fault = sphv_arena_take(arena, out->count, sizeof *method->fault);
        for (size_t a = 0; a < out->field_count * method->quantities; a++)
            method->estimate[a] = sphv_arena_take(arena, out->count, sizeof **method->estimate);
    }
}

static bool make_estimates(sphv_estimates *out, const sphv_request *request, int dimension,
                           size_t count)
{
    *out = (sphv_estimates){.count = count, .field_count = request->field_count};
    out->methods = sphv_array(request->method_count, sizeof *out->methods);
    if (!out->methods) return false;
    for (size_t m = 0; m < request->method_count; m++) {
        sphv_method_estimates *method = &out->methods[m];
        out->method_count = m + 1;
        method->method = request->methods[m];
        method->quantities = sphv_method_quantities(method->method, dimension);
        size_t arrays = request->field_count * method->quantities;
        method->rounding = sphv_array(arrays, sizeof *method->rounding);
        method->estimate = sphv_array(arrays, sizeof *method->estimate);
        if (!method->rounding || !method->estimate) return false;
    }
    sphv_arena arena = {NULL, 0};
    place_estimates(out, &arena);
    if (!sphv_arena_reserve(&arena)) return false;
    out->memory = arena.memory;
    place_estimates(out, &arena);
    return true;
}

void sphv_estimates_free(sphv_estimates *estimates)
{
    for (size_t m = 0; m < estimates->method_count; m++) {
        free(estimates->methods[m].estimate);
        free(estimates->methods[m].rounding);
    }
    free(estimates->methods);
    free(estimates->memory);
    *estimates = (sphv_estimates){0};
}

double sphv_summand_rounding(const sphv_sum_layout *layout)
{
    const sphv_sum_set *set = &sphv_sum_sets[layout->level];
    int degree = 0;
    for (int k = 0; k < 3; k++) {
        if (set->moment[k].to > degree) degree = set->moment[k].to;
        if (set->field[k].to > degree) degree = set->field[k].to;
    }
    // V/h^d: 4; δA: 1; products: 2; and per power of s: difference, division and product.
    return (SPHV_RADIAL_ERROR + 8 + 3 * degree) * SPHV_U;
}

/// Each pair once where that is possible and faster.
static sphv_status evaluate_direct(const sphv_evaluation *evaluation, sphv_error *error)
{
    sphv_evaluation plain = *evaluation;
    plain.layout = sphv_sum_layout_make(evaluation->layout.dimension, SPHV_SUMS_PLAIN,
                                        (int)evaluation->request->field_count);
    plain.spread = evaluation->largest;
    sphv_status status = SPHV_NO_CLOSED_FORM;
    if (sphv_half_pairs_win(evaluation)) status = sphv_evaluate_half_pairs(&plain, error);
    return status == SPHV_NO_CLOSED_FORM ? sphv_evaluate_direct(evaluation, error) : status;
}

static sphv_status take_route(const sphv_evaluation *evaluation, sphv_error *error)
{
    sphv_route asked = evaluation->request->route, *taken = &evaluation->out->route;
    sphv_status status;
    if (asked < SPHV_ROUTE_AUTOMATIC || asked > SPHV_ROUTE_BRUTE_FORCE)
        return sphv_fail(error, SPHV_INVALID_INPUT, "route %d does not exist", (int)asked);
    *taken = asked;
    if (asked == SPHV_ROUTE_BRUTE_FORCE) return sphv_evaluate_brute_force(evaluation, error);
    if (asked == SPHV_ROUTE_CONVOLUTION) return sphv_evaluate_convolution(evaluation, error);
    if (asked == SPHV_ROUTE_AUTOMATIC && sphv_convolution_wins(evaluation)) {
        *taken = SPHV_ROUTE_CONVOLUTION;
        status = sphv_evaluate_convolution(evaluation, error);
        // The particles may turn out not to be the lattice that they are said to be.
        if (status != SPHV_INVALID_INPUT) return status;
    }
    *taken = SPHV_ROUTE_DIRECT;
    return evaluate_direct(evaluation, error);
}

sphv_status sphv_estimate_particles(const sphv_particles *particles, const sphv_request *request,
                                    sphv_progress progress, void *context, sphv_estimates *out,
                                    sphv_error *error)
{
    double start = now();
    *out = (sphv_estimates){0};
    size_t fields = request->field_count;
    sphv_span *spans = sphv_array(fields, sizeof *spans);
    double *spread = sphv_array(fields, 2 * sizeof *spread);
    sphv_status status = SPHV_OK;
    if (spans && spread) status = check(particles, request, spans, error);
    if (status != SPHV_OK || !spans || !spread ||
        !make_estimates(out, request, particles->dimension, particles->count)) {
        free(spans);
        free(spread);
        sphv_estimates_free(out);
        if (status != SPHV_OK) return status;
        return sphv_fail(error, SPHV_RESOURCE_FAILURE,
                         "out of memory for the estimates of %zu particles", particles->count);
    }
    double *largest = spread + fields;
    for (size_t f = 0; f < fields && particles->count; f++) {
        spread[f] = (spans[f].high - spans[f].low) * (1 + 2 * SPHV_U);
        largest[f] = fmax(fabs(spans[f].low), fabs(spans[f].high));
    }
    free(spans);
    sphv_evaluation evaluation = {
        .particles = particles,
        .request = request,
        .layout =
            sphv_sum_layout_make(particles->dimension, sphv_request_level(request), (int)fields),
        .spread = spread,
        .largest = largest,
        .progress = progress,
        .context = context,
        .out = out,
    };
    status = take_route(&evaluation, error);
    free(spread);
    if (status != SPHV_OK) sphv_estimates_free(out);
    if (status == SPHV_OK && progress) progress(context, 1);
    out->seconds = now() - start;
    return status;
}
