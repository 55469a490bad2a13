#include "transform.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../internal.h"

enum { BUNDLE = 8 }; ///< lines of a slow coordinate that are copied and transformed together

size_t sphv_transform_size(size_t least)
{
    for (size_t size = least ? least : 1;; size++) {
        size_t rest = size;
        for (size_t prime = 2; prime <= 5; prime++)
            while (rest % prime == 0) rest /= prime;
        if (rest == 1) return size;
    }
}

sphv_status sphv_transform_make(sphv_transform *transform, int dimension, size_t size)
{
    *transform = (sphv_transform){.dimension = dimension, .size = size, .points = 1};
    for (int i = 0; i < dimension; i++) transform->points *= size;
    transform->table = gsl_fft_complex_wavetable_alloc(size);
    return transform->table ? SPHV_OK : SPHV_RESOURCE_FAILURE;
}

void sphv_transform_free(sphv_transform *transform)
{
    if (transform->table) gsl_fft_complex_wavetable_free(transform->table);
    *transform = (sphv_transform){0};
}

double sphv_transform_error(const sphv_transform *transform)
{
    return 40 * SPHV_U * fmax(1, log2((double)transform->points));
}

static size_t power(size_t base, int exponent)
{
    size_t product = 1;
    for (int i = 0; i < exponent; i++) product *= base;
    return product;
}

/// Where the line begins whose slower coordinates are the digits of `line` in base `lines`.
static size_t start_of(const sphv_transform *of, int axis, size_t line, size_t lines)
{
    size_t start = 0, stride = power(of->size, of->dimension - axis);
    for (int i = 0; i < axis; i++, line /= lines, stride *= of->size)
        start += line % lines * stride;
    return start;
}

/// Transforms up to BUNDLE neighbouring lines `stride` points apart, through a buffer.
static void transform_bundle(const sphv_transform *of, gsl_fft_direction direction, double *data,
                             size_t stride, size_t lines, double *buffer,
                             gsl_fft_complex_workspace *workspace)
{
    for (size_t j = 0; j < of->size; j++)
        for (size_t l = 0; l < lines; l++)
            memcpy(buffer + 2 * (l * of->size + j), data + 2 * (j * stride + l),
                   2 * sizeof *buffer);
    for (size_t l = 0; l < lines; l++)
        gsl_fft_complex_transform(buffer + 2 * l * of->size, 1, of->size, of->table, workspace,
                                  direction);
    for (size_t j = 0; j < of->size; j++)
        for (size_t l = 0; l < lines; l++)
            memcpy(data + 2 * (j * stride + l), buffer + 2 * (l * of->size + j),
                   2 * sizeof *buffer);
}

/// Transforms all lines along one axis whose slower coordinates are below `limit`.
static sphv_status transform_axis(const sphv_transform *of, gsl_fft_direction direction,
                                  double *data, int axis, size_t limit)
{
    size_t stride = power(of->size, of->dimension - 1 - axis);
    size_t bundles = (stride + BUNDLE - 1) / BUNDLE, tasks = power(limit, axis) * bundles;
    sphv_status status = SPHV_OK;
#pragma omp parallel if (of->points > SPHV_PARALLEL_MIN)
    {
        gsl_fft_complex_workspace *workspace = gsl_fft_complex_workspace_alloc(of->size);
        double *buffer = malloc(2 * BUNDLE * of->size * sizeof *buffer);
        bool ready = workspace && buffer;
        if (!ready) {
#pragma omp atomic write
            status = SPHV_RESOURCE_FAILURE;
        }
#pragma omp for schedule(static)
        for (size_t task = 0; task < tasks; task++) {
            size_t inner = task % bundles * BUNDLE;
            size_t lines = stride - inner < BUNDLE ? stride - inner : BUNDLE;
            double *at = data + 2 * (start_of(of, axis, task / bundles, limit) + inner);
            if (!ready) continue;
            if (stride == 1)
                gsl_fft_complex_transform(at, 1, of->size, of->table, workspace, direction);
            else
                transform_bundle(of, direction, at, stride, lines, buffer, workspace);
        }
        if (workspace) gsl_fft_complex_workspace_free(workspace);
        free(buffer);
    }
    return status;
}

sphv_status sphv_transform_forward(const sphv_transform *transform, double *data, size_t filled)
{
    sphv_status status = SPHV_OK;
    for (int axis = transform->dimension - 1; axis >= 0 && status == SPHV_OK; axis--)
        status = transform_axis(transform, gsl_fft_forward, data, axis, filled);
    return status;
}

sphv_status sphv_transform_backward(const sphv_transform *transform, double *data, size_t wanted)
{
    sphv_status status = SPHV_OK;
    for (int axis = 0; axis < transform->dimension && status == SPHV_OK; axis++)
        status = transform_axis(transform, gsl_fft_backward, data, axis, wanted);
    return status;
}
