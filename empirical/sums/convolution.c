/// Sums on an unperturbed lattice. Moments depend on the distances to the sides alone: prefix sums
/// over the offsets. Sums over a field are Σ K(b − a) A_b − A_a Σ K: Fourier transforms, two fields
/// as real and imaginary parts of one, and two kernels at once, whose transforms are real or
/// imaginary by their symmetry.
#include <stdlib.h>

#include "../internal.h"
#include "convolution.h"

/// Lists what the layout asks for, each in its place.
static void list_kernels(sphv_convolution *of)
{
    const sphv_sum_layout *layout = &of->evaluation->layout;
    const sphv_sum_set *set = &sphv_sum_sets[layout->level];
    for (int k = 0; k < 3; k++) {
        int first = layout->first_monomial[k], first_field = layout->first_field_monomial[k];
        int end = (int)sphv_monomial_count(layout->dimension, set->moment[k].to);
        int end_field = (int)sphv_monomial_count(layout->dimension, set->field[k].to);
        for (int j = first; layout->moment_at[k] >= 0 && j < end; j++)
            of->moment[layout->moment_at[k] + j - first] = (sphv_sum_kernel){k, j};
        for (int j = first_field; layout->field_at[k] >= 0 && j < end_field; j++)
            of->field[layout->field_at[k] + j - first_field] = (sphv_sum_kernel){k, j};
    }
}

/// Sums over each class: moments, sizes, errors and neighbours.
static sphv_status sum_classes(sphv_convolution *of)
{
    const sphv_lattice_table *table = &of->table;
    int moments = of->evaluation->layout.moments, failed = 0;
    double *sizes[3] = {NULL, NULL, NULL};
    of->moments = malloc(((size_t)moments * table->classes + 1) * sizeof *of->moments);
    of->counts = malloc(table->classes * sizeof *of->counts);
    bool enough = of->moments && of->counts;
    for (int k = 0; k < 3; k++) {
        sizes[k] = calloc(table->classes, sizeof *sizes[k]);
        of->bound[k] = calloc(table->classes, sizeof *of->bound[k]);
        enough = enough && sizes[k] && of->bound[k];
    }
    // The moments, then the neighbours, then sizes and errors of each radial function
#pragma omp parallel for schedule(dynamic) reduction(+ : failed) if (table->cells > SPHV_PARALLEL_MIN)
    for (int j = 0; j < moments + 7; j++) {
        int k = (j - moments - 1) / 2;
        bool error = j > moments && (j - moments - 1) % 2;
        sphv_offset_function function = {NULL, 1, NULL};
        double *out = of->counts;
        if (!enough || (j > moments && table->degree[k] < 0)) continue;
        if (j < moments) {
            function = sphv_kernel_function(of, &of->moment[j]);
            out = of->moments + (size_t)j * table->classes;
        } else if (j > moments) {
            function.octant = error ? table->error[k] : table->size[k];
            function.factor = fabs(table->volume);
            out = error ? of->bound[k] : sizes[k];
        }
        failed += sphv_cuboid_sums(table, &function, out) != SPHV_OK;
    }
    double prefix = sphv_cuboid_error(table);
    for (int k = 0; k < 3 && enough; k++) {
        double total = 0;
        if (table->degree[k] < 0) continue;
        for (size_t n = 0; n < table->octant; n++) total += table->size[k][n] + table->error[k][n];
        total *= fabs(table->volume) * (1 << table->dimension);
        // Beside the summands' errors: prefix sums, of which sums over a field take one more; A −
        // c, the own value's product and difference, and the roundings of results: 8u
        for (size_t c = 0; c < table->classes; c++)
            of->bound[k][c] =
                1.001 * (of->bound[k][c] + 8 * SPHV_U * sizes[k][c] + 3 * prefix * total);
    }
    for (int k = 0; k < 3; k++) free(sizes[k]);
    return enough && !failed ? SPHV_OK : SPHV_RESOURCE_FAILURE;
}

/// Neighbours at the support's edge, decided as every route does.
static unsigned count_ties(const sphv_convolution *of, size_t n,
                           const size_t place[SPHV_DIMENSIONS])
{
    const sphv_particles *particles = of->evaluation->particles;
    double reach = of->evaluation->request->profile->support * of->evaluation->request->h;
    unsigned count = 0;
    for (size_t t = 0; t < of->table.ties; t++) {
        const int *offset = of->table.tie[t];
        double d[SPHV_DIMENSIONS] = {0, 0, 0};
        size_t b = 0;
        bool there = true;
        for (int i = 0; i < particles->dimension; i++) {
            long at = (long)place[i] + offset[i];
            there = there && at >= 0 && at < (long)of->table.side;
            b = b * of->table.side + (size_t)at;
        }
        for (int i = 0; there && i < particles->dimension; i++)
            d[i] = particles->x[i][b] - particles->x[i][n];
        if (there) count += sphv_square(particles->dimension, d) < reach * reach;
    }
    return count;
}

/// All sums of the block's i-th particle, which is particle n.
static void assemble(const sphv_convolution *of, sphv_worker *worker, size_t i, size_t n)
{
    const sphv_sum_layout *layout = &of->evaluation->layout;
    const sphv_lattice_table *table = &of->table;
    size_t place[SPHV_DIMENSIONS], c = sphv_lattice_class(table, n, place);
    double *sums = worker->block.sums + i;
    size_t stride = worker->block.stride;
    for (int j = 0; j < layout->moments; j++)
        sums[(size_t)j * stride] = of->moments[(size_t)j * table->classes + c];
    // The bounds as multiples of a rounding of u
    for (int k = 0; k < 3; k++)
        sums[(size_t)(layout->size_at + k) * stride] =
            (of->bound[k][c] + of->transform_error[k]) / SPHV_U;
    for (size_t f = 0; f < of->fields; f++) {
        double own = of->evaluation->request->fields[f][n] - of->centre[f];
        for (int s = 0; s < layout->per_field; s++) {
            int moment = sphv_moment_index(layout, of->field[s].k, of->field[s].monomial);
            double whole = of->moments[(size_t)moment * table->classes + c];
            size_t at = (size_t)layout->moments + 3 + f * (size_t)layout->per_field + (size_t)s;
            sums[at * stride] =
                of->sums[f * (size_t)layout->per_field + (size_t)s][n] - own * whole;
        }
    }
    worker->particle[i] = n;
    worker->neighbours[i] = (unsigned)of->counts[c] + count_ties(of, n, place);
    worker->rounding[i] = SPHV_U;
}

static sphv_status finish(sphv_convolution *of)
{
    size_t count = of->evaluation->particles->count;
    size_t blocks = (count + SPHV_BLOCK - 1) / SPHV_BLOCK;
    sphv_status status = SPHV_OK;
#pragma omp parallel if (count > SPHV_PARALLEL_MIN)
    {
        sphv_worker worker;
        bool ready = sphv_worker_make(&worker, of->evaluation) == SPHV_OK;
        if (!ready) {
#pragma omp atomic write
            status = SPHV_RESOURCE_FAILURE;
        }
#pragma omp for schedule(dynamic)
        for (size_t block = 0; block < blocks; block++) {
            size_t first = block * SPHV_BLOCK;
            size_t n = count - first < SPHV_BLOCK ? count - first : SPHV_BLOCK;
            for (size_t i = 0; ready && i < n; i++) assemble(of, &worker, i, first + i);
            if (ready) sphv_worker_finish_block(&worker, first, n);
            sphv_evaluation_advance(of->evaluation, &of->done, of->steps);
        }
#pragma omp critical(sphv_convolution)
        sphv_worker_free(&worker);
    }
    return status;
}

static bool reserve(sphv_convolution *of)
{
    const sphv_request *request = of->evaluation->request;
    size_t count = of->evaluation->particles->count;
    size_t arrays = of->fields * (size_t)of->evaluation->layout.per_field;
    of->centre = calloc(of->fields + 1, sizeof *of->centre);
    of->sums = calloc(arrays + 1, sizeof *of->sums);
    bool enough = of->centre && of->sums;
    for (size_t a = 0; a < arrays && enough; a++)
        enough = (of->sums[a] = malloc(count * sizeof **of->sums)) != NULL;
    for (size_t f = 0; f < of->fields && enough; f++) {
        double least = request->fields[f][0], most = least;
        for (size_t n = 1; n < count; n++) {
            least = fmin(least, request->fields[f][n]);
            most = fmax(most, request->fields[f][n]);
        }
        of->centre[f] = least == most ? least : 0.5 * least + 0.5 * most;
    }
    return enough;
}

static void release(sphv_convolution *of)
{
    size_t arrays = of->fields * (size_t)of->evaluation->layout.per_field;
    for (size_t a = 0; of->sums && a < arrays; a++) free(of->sums[a]);
    for (int k = 0; k < 3; k++) free(of->bound[k]);
    free(of->sums);
    free(of->moments);
    free(of->counts);
    free(of->centre);
    sphv_transform_free(&of->transform);
    sphv_lattice_table_free(&of->table);
}

static sphv_status run(sphv_convolution *of)
{
    // A field that is wrapped round the cube must not come within reach again.
    size_t size = sphv_transform_size(of->table.side + of->table.reach);
    size_t pairs = (of->fields + 1) / 2, kernels = (size_t)of->evaluation->layout.per_field;
    size_t blocks = (of->evaluation->particles->count + SPHV_BLOCK - 1) / SPHV_BLOCK;
    size_t backward = (of->fields / 2) * kernels + (of->fields % 2) * ((kernels + 1) / 2);
    of->steps = pairs + (pairs ? (kernels + 1) / 2 : 0) + backward + blocks;
    list_kernels(of);
    sphv_status status = sphv_transform_make(&of->transform, of->table.dimension, size);
    if (status == SPHV_OK && !reserve(of)) status = SPHV_RESOURCE_FAILURE;
    if (status == SPHV_OK) status = sum_classes(of);
    if (status == SPHV_OK) status = sphv_convolve_fields(of);
    if (status == SPHV_OK) status = finish(of);
    return status;
}

sphv_status sphv_evaluate_convolution(const sphv_evaluation *evaluation, sphv_error *error)
{
    sphv_convolution of = {.evaluation = evaluation, .fields = evaluation->request->field_count};
    for (size_t f = 0; f < of.fields; f++)
        if (!isfinite(evaluation->spread[f]))
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "the values of field %zu lie too far apart; allowed: a range up to "
                             "1e308",
                             f + 1);
    sphv_status status = sphv_lattice_table_make(evaluation, &of.table, error);
    if (status != SPHV_OK) return status;
    status = run(&of);
    evaluation->out->tested += (double)of.table.octant;
    release(&of);
    if (status != SPHV_OK)
        return sphv_fail(error, status, "out of memory for sums by Fourier transform");
    return SPHV_OK;
}
