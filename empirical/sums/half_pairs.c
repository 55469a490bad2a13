#include "half_pairs.h"

#include <stdlib.h>
#include <string.h>

#include "../internal.h"
#include "half_tiles.h"
#include "memory.h"
#include "sorted.h"

/// Everything the threads share.
struct half {
    sphv_sorted sorted;
    sphv_half_pass_function *pass;
    sphv_half_tiles tiles;
    size_t size;                     ///< of a tile: targets that the pass takes together
    size_t count;                    ///< particles
    size_t sums;                     ///< of a pass
    size_t room;                     ///< in a row's scratch
    double *total;                   ///< sum k of source b: total[k * count + b]
    double *number;                  ///< neighbours of each source
    double *depth;                   ///< most additions in one visit of a pair of rows
    double *field[SPHV_PASS_FIELDS]; ///< v A
    size_t steps, done;              ///< of the progress
};

/// What one thread needs.
struct visits {
    sphv_half_pass pass;
    sphv_half_visit *visit;
    double tested;
};

/// A row's own pairs, or those with the row so much further along.
struct offset {
    long y, z;
};

/// \param finite whether all are: lanes that do not count are multiplied by 0
static bool make_fields(struct half *half, bool *finite)
{
    const sphv_sorted *sorted = &half->sorted;
    for (size_t f = 0; f < sorted->fields; f++) {
        double *field = half->field[f] = sphv_array(half->count + SPHV_SPARE, sizeof(double));
        if (!field) return false;
        for (size_t b = 0; b < half->count; b++) {
            field[b] = sorted->field[f][b] * sorted->v[b];
            *finite = *finite && isfinite(field[b]);
        }
    }
    return true;
}

static void half_free(struct half *half)
{
    for (size_t f = 0; f < SPHV_PASS_FIELDS; f++) free(half->field[f]);
    free(half->total);
    free(half->number);
    free(half->depth);
    sphv_half_tiles_free(&half->tiles);
    sphv_sorted_free(&half->sorted);
}

/// First source of a row.
static size_t row_begin(const sphv_cell_grid *grid, size_t row)
{
    return grid->start[row * grid->cells[0]];
}

static sphv_status half_make(struct half *half, const sphv_evaluation *evaluation,
                             sphv_error *error)
{
    const sphv_pass_set *set = evaluation->passes ? evaluation->passes : *sphv_pass_sets();
    const sphv_sum_layout *layout = &evaluation->layout;
    *half = (struct half){.count = evaluation->particles->count,
                          .sums = (size_t)(layout->count - layout->size_at - 3)};
    // Thick rows make long runs of sources, thin ones few that are not neighbours.
    double thickness = 2 + sphv_mean_of(evaluation).reach / 12;
    sphv_status status = sphv_sorted_make(&half->sorted, evaluation, thickness, error);
    if (status != SPHV_OK) return status;
    const sphv_cell_grid *grid = &half->sorted.grid;
    half->pass = set->choose_half(layout->dimension, (int)half->sorted.fields, &half->sorted.radial,
                                  &half->size);
    for (size_t r = 0; r < grid->cells[1] * grid->cells[2]; r++) {
        size_t length = row_begin(grid, r + 1) - row_begin(grid, r);
        if (length > half->room) half->room = length;
    }
    half->room = (half->room + SPHV_LANES_MAX + SPHV_SPARE) / SPHV_LANES_MAX * SPHV_LANES_MAX;
    half->total = sphv_array(half->count * half->sums, sizeof(double));
    half->number = sphv_array(half->count, sizeof(double));
    half->depth = sphv_array(half->count, sizeof(double));
    bool finite = true;
    bool cusp = sphv_profile_derivative(evaluation->request->profile, 1, 0).value != 0;
    bool enough = half->total && half->number && half->depth && make_fields(half, &finite) &&
                  sphv_half_tiles_make(&half->tiles, grid, half->size);
    if (enough && finite && !cusp && half->pass) return SPHV_OK;
    half_free(half);
    if (enough)
        return sphv_fail(error, SPHV_NO_CLOSED_FORM,
                         "pairs of such a kernel or field are not visited once");
    return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory for %zu particles",
                     evaluation->particles->count);
}

static bool visits_make(struct visits *visits, const struct half *half)
{
    const sphv_sorted *sorted = &half->sorted;
    *visits = (struct visits){
        .pass = {.radial = &sorted->radial,
                 .sources = {.v = sorted->v, .field = {half->field[0], half->field[1]}},
                 .total = half->total,
                 .stride = half->count,
                 .room = half->room}};
    for (int i = 0; i < SPHV_DIMENSIONS; i++) visits->pass.sources.x[i] = sorted->grid.x[i];
    visits->pass.row = sphv_array(half->room * half->sums, sizeof(double));
    visits->pass.met = sphv_array(half->room, sizeof(double));
    visits->pass.sure = calloc(half->room + 1, sizeof(double));
    visits->pass.neighbours = malloc(half->room * sizeof(double));
    visits->visit = malloc(half->room * sizeof *visits->visit);
    visits->pass.visit = visits->visit;
    return visits->pass.row && visits->pass.met && visits->pass.sure && visits->pass.neighbours &&
           visits->visit;
}

static void visits_free(struct visits *visits)
{
    free(visits->pass.row);
    free(visits->pass.met);
    free(visits->pass.sure);
    free(visits->pass.neighbours);
    free(visits->visit);
}

/// Lists the tiles of a row that have sources in another, or later ones in their own.
/// \param end receives the end of the sources that are met. \return their begin
static size_t list_visits(const struct half *half, struct visits *visits, size_t row, size_t other,
                          size_t *end)
{
    const sphv_cell_grid *grid = &half->sorted.grid;
    size_t begin = row_begin(grid, other + 1);
    *end = row_begin(grid, other);
    visits->pass.count = 0;
    for (size_t i = half->tiles.row[row]; i < half->tiles.row[row + 1]; i++) {
        const sphv_half_tile *tile = &half->tiles.tile[i];
        sphv_half_visit visit = {.tile = tile, .own = row == other};
        sphv_range *range = &visit.range;
        if (!sphv_cell_grid_range(grid, other, tile->low, tile->high, half->sorted.radial.limit,
                                  range))
            continue;
        if (visit.own && range->from <= tile->first) range->from = tile->first + 1;
        if (visit.own && range->sure <= tile->last) range->sure = tile->last + 1;
        if (tile->count < half->size || range->sure > range->sure_to)
            range->sure = range->sure_to = range->from;
        if (range->from >= range->to) continue;
        visits->visit[visits->pass.count++] = visit;
        visits->tested += 2 * (double)(tile->count * (range->to - range->from));
        if (range->from < begin) begin = range->from;
        if (range->to > *end) *end = range->to;
    }
    return begin;
}

static void count_met(struct half *half, size_t b, double neighbours)
{
    half->number[b] += neighbours;
    if (neighbours > half->depth[b]) half->depth[b] = neighbours;
}

/// All pairs of two rows, or of one.
static void visit_rows(struct half *half, struct visits *visits, size_t row, size_t other)
{
    sphv_half_pass *pass = &visits->pass;
    size_t end, begin = list_visits(half, visits, row, other, &end);
    if (!pass->count) return;
    // Vectors begin where lines of the cache do; sources before `begin` belong to another row.
    size_t skip = begin % SPHV_LANES_MAX, met = end - begin;
    pass->first = begin - skip;
    pass->first_target = row_begin(&half->sorted.grid, row);
    half->pass(pass);
    for (size_t i = 0; i < pass->count; i++)
        for (size_t t = 0; t < pass->visit[i].tile->count; t++) {
            size_t a = pass->visit[i].tile->target[t];
            count_met(half, a, pass->neighbours[a - pass->first_target]);
        }
    for (size_t k = 0; k < half->sums; k++) {
        double *total = half->total + k * half->count + begin;
        double *sums = pass->row + k * pass->room + skip;
#pragma omp simd
        for (size_t b = 0; b < met; b++) total[b] += sums[b];
        memset(sums, 0, met * sizeof *sums);
    }
    double sure = 0;
    for (size_t b = 0; b < skip + met; b++) {
        sure += pass->sure[b];
        if (b >= skip) count_met(half, pass->first + b, pass->met[b] + sure);
    }
    memset(pass->met, 0, (skip + met) * sizeof *pass->met);
    memset(pass->sure, 0, (skip + met + 1) * sizeof *pass->sure);
}

/// How many rows further along an axis a neighbour may be.
static long reach(const sphv_cell_grid *grid, int axis, double limit)
{
    if (axis >= grid->dimension || grid->cells[axis] < 2) return 0;
    double rows = ceil(sqrt(limit) * grid->per_cell[axis] * (1 + 16 * SPHV_U)) + 1;
    double most = (double)grid->cells[axis] - 1;
    return (long)(rows < most ? rows : most);
}

/// Visits the pairs of rows that are an offset apart, those in the columns of one colour.
static void visit_offset(struct half *half, struct visits *visits, struct offset offset, int colour)
{
    const sphv_cell_grid *grid = &half->sorted.grid;
    long rows_y = (long)grid->cells[1], rows = rows_y * (long)grid->cells[2];
#pragma omp for schedule(dynamic)
    for (long row = 0; row < rows; row++) {
        long y = row % rows_y, z = row / rows_y;
        long turn = offset.z ? z / offset.z : offset.y ? y / offset.y : 0;
        bool inside =
            y + offset.y >= 0 && y + offset.y < rows_y && (row + offset.z * rows_y) < rows;
        if (!inside || turn % 2 != colour) continue;
        if (visits)
            visit_rows(half, visits, (size_t)row, (size_t)(row + offset.y + offset.z * rows_y));
        sphv_evaluation_advance(half->sorted.evaluation, &half->done, half->steps);
    }
}

/// Takes the sums of a block of particles over, scaled and with what each adds to its own.
/// \param additions that a particle's sums went through beyond those of one visit
static void finish_block(const struct half *half, sphv_worker *worker, size_t first, size_t count,
                         double additions)
{
    const sphv_sorted *sorted = &half->sorted;
    const sphv_sum_layout *layout = &sorted->evaluation->layout;
    double p[3], size[3];
    sphv_radial_values(&sorted->radial, layout->level, 0, p, size);
    for (size_t k = 0; k < half->sums; k++) {
        size_t sum = (size_t)layout->size_at + 3 + k;
        const double *from = half->total + k * half->count + first, scale = sorted->scale[sum];
        double *to = worker->block.sums + sum * worker->block.stride;
        for (size_t i = 0; i < count; i++) to[i] = from[i] * scale;
    }
    for (size_t f = 0; f < sorted->fields; f++) {
        size_t sum = (size_t)sphv_field_sum_index(layout, (int)f, 0, 0);
        double *to = worker->block.sums + sum * worker->block.stride;
        for (size_t i = 0; i < count; i++) to[i] += p[0] * half->field[f][first + i];
    }
    for (size_t i = 0; i < count; i++) {
        double neighbours = half->number[first + i] + 1; // itself
        sphv_sorted_bound(sorted, worker, i, 1, &neighbours, half->depth[first + i] + additions);
        worker->particle[i] = sorted->grid.particle[first + i];
    }
    worker->tested += (double)count; // each itself
}

sphv_status sphv_evaluate_half_pairs(const sphv_evaluation *evaluation, sphv_error *error)
{
    struct half half;
    sphv_status status = half_make(&half, evaluation, error);
    if (status != SPHV_OK) return status;
    const sphv_cell_grid *grid = &half.sorted.grid;
    long most_y = reach(grid, 1, half.sorted.radial.limit);
    long most_z = reach(grid, 2, half.sorted.radial.limit);
    size_t rows = grid->cells[1] * grid->cells[2];
    size_t blocks = (half.count + SPHV_BLOCK - 1) / SPHV_BLOCK;
    half.steps = 1 + rows * (size_t)((most_y + 1) + most_z * (2 * most_y + 1)) + blocks;
    // A particle is target and source once each, and then the lanes of a vector are added.
    double additions = 2.0 * (double)((most_y + 1) + most_z * (2 * most_y + 1)) + SPHV_LANES_MAX;
#pragma omp parallel if (half.count > SPHV_BLOCK)
    {
        struct visits visits;
        sphv_worker worker;
        bool ready = visits_make(&visits, &half);
        ready = sphv_worker_make(&worker, evaluation) == SPHV_OK && ready;
        if (!ready) {
#pragma omp critical(sphv_half_pairs)
            status = SPHV_RESOURCE_FAILURE;
        }
        for (long z = 0; z <= most_z; z++)
            for (long y = z ? -most_y : 0; y <= most_y; y++)
                for (int colour = 0; colour < (y || z ? 2 : 1); colour++)
                    visit_offset(&half, ready ? &visits : NULL, (struct offset){y, z}, colour);
#pragma omp for schedule(dynamic)
        for (size_t block = 0; block < blocks; block++) {
            size_t first = block * SPHV_BLOCK;
            size_t count = half.count - first < SPHV_BLOCK ? half.count - first : SPHV_BLOCK;
            if (ready) finish_block(&half, &worker, first, count, additions);
            if (ready) sphv_worker_finish_block(&worker, first, count);
            sphv_evaluation_advance(evaluation, &half.done, half.steps);
        }
        worker.tested += visits.tested;
        visits_free(&visits);
#pragma omp critical(sphv_half_pairs)
        sphv_worker_free(&worker);
    }
    half_free(&half);
    return status == SPHV_OK ? SPHV_OK : sphv_fail(error, status, "out of memory");
}
