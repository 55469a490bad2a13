#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "evaluation.h"

#ifdef _OPENMP
#include <omp.h>
#else
static int omp_get_thread_num(void)
{
    return 0;
}
#endif

void sphv_evaluation_advance(const sphv_evaluation *evaluation, size_t *done, size_t all)
{
    size_t now;
#pragma omp atomic capture
    now = ++*done;
    if (evaluation->progress && omp_get_thread_num() == 0)
        evaluation->progress(evaluation->context, (double)now / (double)all);
}

/// Copies of the results' descriptions, each with a `rounding` of its own: the arrays of estimates
/// are shared, since no two threads write to the same particle.
static bool copy_methods(sphv_worker *worker)
{
    const sphv_estimates *out = worker->evaluation->out;
    worker->methods = calloc(out->method_count ? out->method_count : 1, sizeof *worker->methods);
    if (!worker->methods) return false;
    for (size_t m = 0; m < out->method_count; m++) {
        worker->methods[m] = out->methods[m];
        size_t arrays = out->field_count * out->methods[m].quantities;
        worker->methods[m].rounding = calloc(arrays ? arrays : 1, sizeof(double));
        if (!worker->methods[m].rounding) return false;
    }
    return true;
}

sphv_status sphv_worker_make(sphv_worker *worker, const sphv_evaluation *evaluation)
{
    size_t fields = evaluation->request->field_count, sums = (size_t)evaluation->layout.count;
    *worker = (sphv_worker){.evaluation = evaluation};
    worker->block.layout = &evaluation->layout;
    worker->block.spread = evaluation->spread;
    worker->block.stride = SPHV_BLOCK;
    worker->block.sums = aligned_alloc(64, (sums + 1) * SPHV_BLOCK * sizeof(double));
    worker->particle = malloc(SPHV_BLOCK * sizeof *worker->particle);
    worker->neighbours = malloc(SPHV_BLOCK * sizeof *worker->neighbours);
    worker->rounding = calloc(SPHV_BLOCK, sizeof *worker->rounding);
    worker->values = calloc((fields + 1) * SPHV_BLOCK, sizeof *worker->values);
    if (worker->block.sums) memset(worker->block.sums, 0, (sums + 1) * SPHV_BLOCK * sizeof(double));
    worker->block.particle = worker->particle;
    worker->block.neighbours = worker->neighbours;
    worker->block.rounding = worker->rounding;
    if (!copy_methods(worker) || !worker->block.sums || !worker->particle || !worker->neighbours ||
        !worker->rounding || !worker->values)
        return SPHV_RESOURCE_FAILURE;
    return SPHV_OK;
}

void sphv_worker_finish_block(sphv_worker *worker, size_t first, size_t count)
{
    const sphv_request *request = worker->evaluation->request;
    sphv_estimates *out = worker->evaluation->out;
    worker->block.first = first;
    worker->block.count = count;
    size_t pairs = 0;
    for (size_t i = 0; i < count; i++) {
        out->neighbours[worker->particle[i]] = worker->neighbours[i];
        pairs += worker->neighbours[i];
    }
    worker->pairs += (double)pairs;
    for (size_t f = 0; f < request->field_count && !worker->valued; f++)
        for (size_t i = 0; i < count; i++)
            worker->values[f * worker->block.stride + i] = request->fields[f][worker->particle[i]];
    if (worker->evaluation->watch)
        worker->evaluation->watch(worker->evaluation->watcher, &worker->block);
    for (size_t m = 0; m < out->method_count; m++)
        sphv_solve_block(&worker->block, request, worker->values, &worker->methods[m]);
}

void sphv_worker_free(sphv_worker *worker)
{
    sphv_estimates *out = worker->evaluation->out;
    for (size_t m = 0; worker->methods && m < out->method_count; m++) {
        const double *rounding = worker->methods[m].rounding;
        for (size_t a = 0; rounding && a < out->field_count * out->methods[m].quantities; a++)
            out->methods[m].rounding[a] = fmax(out->methods[m].rounding[a], rounding[a]);
        free(worker->methods[m].rounding);
    }
    out->pairs += worker->pairs;
    out->tested += worker->tested;
    free(worker->methods);
    free(worker->block.sums);
    free(worker->particle);
    free(worker->neighbours);
    free(worker->rounding);
    free(worker->values);
    *worker = (sphv_worker){0};
}
