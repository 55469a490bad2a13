#include "sorted.h"

#include <stdlib.h>
#include <string.h>

#include "../clones.h"
#include "../internal.h"
#include "chunks.h"
#include "memory.h"

/// V/h^d. \return the largest modulus
SPHV_CLONES static double scale_volumes(double *v, size_t count, double unit)
{
    double most = 0;
#pragma omp simd reduction(max : most)
    for (size_t b = 0; b < count; b++) {
        v[b] /= unit;
        most = fabs(v[b]) > most ? fabs(v[b]) : most;
    }
    return most;
}

static void take_field(double *to, const double *field, const uint32_t *particle, size_t count)
{
    for (size_t b = 0; b < count; b++) to[b] = field[particle[b]];
}

static void place_fields(sphv_sorted *sorted, size_t fields, sphv_arena *arena)
{
    size_t n = sorted->grid.count ? sorted->grid.count : 1;
    for (size_t f = 0; f < fields; f++)
        sorted->field[f] = sphv_arena_take(arena, n, sizeof **sorted->field);
}

static bool make_sources(sphv_sorted *sorted)
{
    const sphv_cell_grid *grid = &sorted->grid;
    const sphv_request *request = sorted->evaluation->request;
    double unit = 1;
    for (int i = 0; i < grid->dimension; i++) unit *= request->h;
    sorted->v = grid->volume;
    // A pass has at least one field; without any it gets one that is nowhere different.
    size_t fields = sorted->fields ? sorted->fields : 1;
    sorted->field = calloc(fields, sizeof *sorted->field);
    if (!sorted->field) return false;
    sphv_arena arena = {NULL, 0};
    place_fields(sorted, fields, &arena);
    if (!sphv_arena_reserve(&arena)) return false;
    sorted->memory = arena.memory;
    place_fields(sorted, fields, &arena);
    if (sorted->fields == 0) memset(sorted->field[0], 0, grid->count * sizeof(double));
    const size_t chunks = sphv_chunks(grid->count);
#pragma omp parallel for schedule(static) if (chunks > 1)
    for (size_t c = 0; c < chunks; c++) {
        size_t from = sphv_chunk_begin(grid->count, chunks, c);
        size_t count = sphv_chunk_begin(grid->count, chunks, c + 1) - from;
        double most = scale_volumes(sorted->v + from, count, unit);
        for (size_t f = 0; f < sorted->fields; f++)
            take_field(sorted->field[f] + from, request->fields[f], grid->particle + from, count);
#pragma omp critical(sphv_sorted)
        sorted->v_most = fmax(sorted->v_most, most);
    }
    return true;
}

/// (1/h)^|α| of each sum.
static bool make_scale(sphv_sorted *sorted)
{
    const sphv_sum_layout *layout = &sorted->evaluation->layout;
    const sphv_sum_set *set = &sphv_sum_sets[layout->level];
    const sphv_monomial *monomials = sphv_monomials(layout->dimension);
    sorted->scale = malloc((size_t)layout->count * sizeof *sorted->scale);
    if (!sorted->scale) return false;
    for (int k = 0; k < layout->count; k++) sorted->scale[k] = 1;
    for (int k = 0; k < 3; k++) {
        const sphv_degrees *moment = &set->moment[k], *field = &set->field[k];
        int to = moment->to > field->to ? moment->to : field->to;
        int count = (int)sphv_monomial_count(layout->dimension, to);
        for (int j = 0; j < count; j++) {
            int degree = monomials[j].degree;
            double scale = pow(sorted->radial.h, -degree);
            if (degree >= moment->from && degree <= moment->to)
                sorted->scale[sphv_moment_index(layout, k, j)] = scale;
            for (size_t f = 0; degree >= field->from && degree <= field->to && f < sorted->fields;
                 f++)
                sorted->scale[sphv_field_sum_index(layout, (int)f, k, j)] = scale;
        }
    }
    return true;
}

void sphv_sorted_free(sphv_sorted *sorted)
{
    free(sorted->memory);
    free(sorted->field);
    free(sorted->scale);
    sphv_cell_grid_free(&sorted->grid);
}

sphv_status sphv_sorted_make(sphv_sorted *sorted, const sphv_evaluation *evaluation,
                             double thickness, sphv_error *error)
{
    const sphv_request *request = evaluation->request;
    *sorted = (sphv_sorted){.evaluation = evaluation, .fields = request->field_count};
    sphv_status status =
        sphv_cell_grid_make(&sorted->grid, evaluation->particles,
                            request->profile->support * request->h, thickness, error);
    if (status != SPHV_OK) return status;
    sphv_radial_make(&sorted->radial, request->profile, request->h * sorted->grid.unit,
                     evaluation->layout.level);
    sorted->rounding = sphv_summand_rounding(&evaluation->layout);
    if (make_sources(sorted) && make_scale(sorted)) return SPHV_OK;
    sphv_sorted_free(sorted);
    return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory for %zu particles",
                     evaluation->particles->count);
}

/// A number for each of some particles, from the number of their neighbours.
SPHV_CLONES static void multiply(const double *neighbours, size_t count, double factor, double *to)
{
#pragma omp simd
    for (size_t i = 0; i < count; i++) to[i] = factor * neighbours[i];
}

SPHV_CLONES static void set_bounds(sphv_worker *worker, size_t at, size_t count,
                                   const double *neighbours, double rounding)
{
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
        worker->rounding[at + i] = rounding;
        worker->neighbours[at + i] = (unsigned)(int)neighbours[i]; // there are fewer than 2^29
    }
}

void sphv_sorted_bound(const sphv_sorted *sorted, sphv_worker *worker, size_t at, size_t count,
                       const double *neighbours, double depth)
{
    const sphv_sum_layout *layout = &sorted->evaluation->layout;
    set_bounds(worker, at, count, neighbours, sorted->rounding + (depth + 2) * SPHV_U);
    for (int k = 0; k < 3 && sorted->radial.form != SPHV_RADIAL_PROFILE; k++) {
        double largest = sorted->radial.size[k] * sorted->v_most * (1 + 8 * SPHV_U);
        multiply(neighbours, count, layout->field_at[k] < 0 ? 0 : largest,
                 worker->block.sums + (size_t)(layout->size_at + k) * worker->block.stride + at);
    }
}
