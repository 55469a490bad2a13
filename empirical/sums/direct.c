/// Any particles: sorted into cells, a vector of targets at a time over the ranges of sources that
/// may be near, the kernel compiled from its profile.
///
/// Work is cut into blocks of targets that do not depend on the threads, and a target is summed by
/// one thread in the order of the cells: results do not depend on the number of threads.
#include <stdlib.h>
#include <string.h>

#include "../internal.h"
#include "cells.h"
#include "evaluation.h"
#include "memory.h"

enum {
    GROUPS = SPHV_BLOCK / SPHV_LANES_MAX, ///< groups of a block
    GATHERED = 2048,                      ///< candidates that are copied together first
};

/// Targets that are summed side by side.
struct group {
    uint32_t first, count;
};

/// Everything the threads share.
struct direct {
    const sphv_evaluation *evaluation;
    const sphv_pass_set *passes;
    sphv_cell_grid grid;
    sphv_radial radial;
    double *v;      ///< V/h^d of each source, where the sources' volumes were
    double v_most;  ///< max |V|/h^d
    double **field; ///< of each source
    double *scale;  ///< of each sum, from powers of d to powers of s
    size_t groups;
    struct group *group;
};

/// What one thread needs.
struct bench {
    sphv_worker worker;
    sphv_pass pass;
    sphv_range *ranges;
    double *gathered[SPHV_DIMENSIONS + 1 + SPHV_PASS_FIELDS];
    double *sums;
};

static size_t fields_of(const struct direct *direct)
{
    return direct->evaluation->request->field_count;
}

/// Groups never reach over the end of a row.
static bool make_groups(struct direct *direct)
{
    const sphv_cell_grid *grid = &direct->grid;
    size_t rows = grid->cells[1] * grid->cells[2], lanes = (size_t)direct->passes->lanes;
    direct->group = malloc((grid->targets / lanes + rows + 1) * sizeof *direct->group);
    if (!direct->group) return false;
    for (size_t r = 0; r < rows; r++) {
        size_t end = grid->row[r + 1].first_target;
        for (size_t t = grid->row[r].first_target; t < end; t += lanes) {
            size_t count = end - t < lanes ? end - t : lanes;
            direct->group[direct->groups++] = (struct group){(uint32_t)t, (uint32_t)count};
        }
    }
    return true;
}

static bool make_sources(struct direct *direct)
{
    const sphv_cell_grid *grid = &direct->grid;
    const sphv_request *request = direct->evaluation->request;
    size_t n = grid->count ? grid->count : 1;
    double unit = 1;
    for (int i = 0; i < grid->dimension; i++) unit *= request->h;
    direct->v = grid->volume;
    // A pass has at least one field; without any it gets one that is nowhere different.
    size_t fields = fields_of(direct) ? fields_of(direct) : 1;
    direct->field = calloc(fields, sizeof *direct->field);
    bool enough = direct->field != NULL;
    for (size_t f = 0; enough && f < fields; f++)
        enough = (direct->field[f] = sphv_room(n, sizeof(double))) != NULL;
    if (!enough) return false;
    for (size_t b = 0; b < grid->count; b++) {
        direct->v[b] /= unit;
        direct->v_most = fmax(direct->v_most, fabs(direct->v[b]));
        for (size_t f = 0; f < fields_of(direct); f++)
            direct->field[f][b] = request->fields[f][grid->particle[b]];
    }
    return true;
}

/// (1/h)^|α| of each sum.
static bool make_scale(struct direct *direct)
{
    const sphv_sum_layout *layout = &direct->evaluation->layout;
    const sphv_sum_set *set = &sphv_sum_sets[layout->level];
    const sphv_monomial *monomials = sphv_monomials(layout->dimension);
    direct->scale = malloc((size_t)layout->count * sizeof *direct->scale);
    if (!direct->scale) return false;
    for (int k = 0; k < layout->count; k++) direct->scale[k] = 1;
    for (int k = 0; k < 3; k++) {
        const sphv_degrees *moment = &set->moment[k], *field = &set->field[k];
        int to = moment->to > field->to ? moment->to : field->to;
        int count = (int)sphv_monomial_count(layout->dimension, to);
        for (int j = 0; j < count; j++) {
            int degree = monomials[j].degree;
            double scale = pow(direct->radial.h, -degree);
            if (degree >= moment->from && degree <= moment->to)
                direct->scale[sphv_moment_index(layout, k, j)] = scale;
            for (size_t f = 0;
                 degree >= field->from && degree <= field->to && f < fields_of(direct); f++)
                direct->scale[sphv_field_sum_index(layout, (int)f, k, j)] = scale;
        }
    }
    return true;
}

static void direct_free(struct direct *direct)
{
    for (size_t f = 0; direct->field && f < (fields_of(direct) ? fields_of(direct) : 1); f++)
        free(direct->field[f]);
    free(direct->field);
    free(direct->scale);
    free(direct->group);
    sphv_cell_grid_free(&direct->grid);
}

static sphv_status direct_make(struct direct *direct, const sphv_evaluation *evaluation,
                               sphv_error *error)
{
    const sphv_request *request = evaluation->request;
    *direct = (struct direct){.evaluation = evaluation, .passes = evaluation->passes};
    if (!direct->passes) direct->passes = *sphv_pass_sets();
    sphv_status status = sphv_cell_grid_make(&direct->grid, evaluation->particles,
                                             request->profile->support * request->h, 0, error);
    if (status != SPHV_OK) return status;
    sphv_radial_make(&direct->radial, request->profile, request->h * direct->grid.unit,
                     evaluation->layout.level);
    if (make_groups(direct) && make_sources(direct) && make_scale(direct)) return SPHV_OK;
    direct_free(direct);
    return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory for %zu particles",
                     evaluation->particles->count);
}

static bool bench_make(struct bench *bench, const struct direct *direct)
{
    size_t rows = direct->grid.cells[1] * direct->grid.cells[2];
    bool enough = sphv_worker_make(&bench->worker, direct->evaluation) == SPHV_OK;
    bench->ranges = malloc((rows + 1) * sizeof *bench->ranges);
    bench->sums = calloc(SPHV_PASS_SUMS * SPHV_LANES_MAX, sizeof *bench->sums);
    for (size_t k = 0; k < sizeof bench->gathered / sizeof *bench->gathered; k++)
        enough = (bench->gathered[k] = malloc((GATHERED + 8) * sizeof(double))) && enough;
    bench->pass = (sphv_pass){
        .radial = &direct->radial, .layout = &direct->evaluation->layout, .sums = bench->sums};
    return enough && bench->ranges && bench->sums;
}

static void bench_free(struct bench *bench)
{
    sphv_worker_free(&bench->worker);
    free(bench->ranges);
    free(bench->sums);
    for (size_t k = 0; k < sizeof bench->gathered / sizeof *bench->gathered; k++)
        free(bench->gathered[k]);
}

/// Puts the targets into the lanes, the last one into those left over, and finds their box.
static void load_targets(const struct direct *direct, const struct group *group, sphv_pass *pass,
                         double low[SPHV_DIMENSIONS], double high[SPHV_DIMENSIONS])
{
    const sphv_cell_grid *grid = &direct->grid;
    for (int i = 0; i < grid->dimension; i++) {
        low[i] = INFINITY;
        high[i] = -INFINITY;
        for (uint32_t l = 0; l < SPHV_LANES_MAX; l++) {
            uint32_t at = l < group->count ? l : group->count - 1;
            double x = grid->x[i][grid->target[group->first + at]];
            pass->x[i][l] = x;
            if (x < low[i]) low[i] = x;
            if (x > high[i]) high[i] = x;
        }
    }
}

/// Sums of one pass into the block; those of the moments only with the first fields. All lanes: the
/// block has room, and the next group's come over those that are left over.
static void store_sums(const struct direct *direct, struct bench *bench, size_t at, int first_field,
                       int fields)
{
    const sphv_sum_layout *layout = &direct->evaluation->layout;
    double *to = bench->worker.block.sums;
    int head = layout->moments + 3;
    for (int k = first_field ? head : 0; k < head + fields * layout->per_field; k++) {
        int sum = k < head ? k : k + first_field * layout->per_field;
        if (sum >= layout->count) break; // the field that stands in for none
        const double *from = bench->sums + k * SPHV_LANES_MAX, scale = direct->scale[sum];
        double *row = to + (size_t)sum * bench->worker.block.stride + at;
        for (int l = 0; l < SPHV_LANES_MAX; l++) row[l] = from[l] * scale;
    }
}

/// Sizes and the error of the accumulation, from the number of neighbours.
static void store_bounds(const struct direct *direct, struct bench *bench, size_t at,
                         uint32_t count, double longest, double parts)
{
    const sphv_sum_layout *layout = &direct->evaluation->layout;
    sphv_worker *worker = &bench->worker;
    double rounding = sphv_summand_rounding(layout) + (longest + parts + 2) * SPHV_U;
    for (uint32_t l = 0; l < count; l++) {
        worker->rounding[at + l] = rounding;
        worker->neighbours[at + l] = (unsigned)bench->pass.neighbours[l];
        for (int k = 0; k < 3 && direct->radial.form != SPHV_RADIAL_PROFILE; k++)
            worker->block.sums[(size_t)(layout->size_at + k) * worker->block.stride + at + l] =
                layout->field_at[k] < 0 ? 0
                                        : direct->radial.size[k] * bench->pass.neighbours[l] *
                                              direct->v_most * (1 + 8 * SPHV_U);
    }
}

/// The sums of one group's targets.
static void sum_group(const struct direct *direct, struct bench *bench, const struct group *group,
                      size_t at)
{
    const sphv_cell_grid *grid = &direct->grid;
    sphv_pass *pass = &bench->pass;
    double low[SPHV_DIMENSIONS], high[SPHV_DIMENSIONS], longest = 0, parts = 0;
    load_targets(direct, group, pass, low, high);
    size_t ranges = sphv_cell_grid_ranges(grid, low, high, direct->radial.limit, bench->ranges),
           total = 0;
    for (size_t r = 0; r < ranges; r++) total += bench->ranges[r].to - bench->ranges[r].from;
    bool gathers = total <= GATHERED && direct->radial.form != SPHV_RADIAL_PROFILE;
    bool plain = direct->evaluation->layout.level == SPHV_SUMS_PLAIN;
    int all = fields_of(direct) ? (int)fields_of(direct) : 1, d = grid->dimension;
    for (int f = 0; f < all; f += SPHV_PASS_FIELDS) {
        int fields = all - f < SPHV_PASS_FIELDS ? all - f : SPHV_PASS_FIELDS;
        sphv_sources sources = {.v = direct->v};
        for (int i = 0; i < d; i++) sources.x[i] = grid->x[i];
        for (int j = 0; j < SPHV_PASS_FIELDS; j++) { // the first again for want of a second
            sources.field[j] = direct->field[j < fields ? f + j : f];
            for (uint32_t l = 0; l < SPHV_LANES_MAX; l++) {
                uint32_t target = l < group->count ? l : group->count - 1;
                pass->a[j][l] = plain ? 0 : sources.field[j][grid->target[group->first + target]];
            }
        }
        sphv_pass_function *function =
            direct->passes->choose(d, direct->evaluation->layout.level, fields, &direct->radial);
        sphv_range whole = {0};
        pass->sources = sources;
        if (gathers) {
            whole.to = direct->passes->gather(&sources, d, fields, low, high, direct->radial.limit,
                                              ranges, bench->ranges, bench->gathered);
            for (int i = 0; i < d; i++) pass->sources.x[i] = bench->gathered[i];
            pass->sources.v = bench->gathered[d];
            for (int j = 0; j < SPHV_PASS_FIELDS; j++)
                pass->sources.field[j] = bench->gathered[d + 1 + (j < fields ? j : 0)];
            total = whole.to;
        }
        function(pass, gathers ? 1 : ranges, gathers ? &whole : bench->ranges);
        store_sums(direct, bench, at, f, fields);
        for (size_t r = 0; r < (gathers ? 1 : ranges); r++) {
            const sphv_range *range = gathers ? &whole : &bench->ranges[r];
            double length = (double)(range->to - range->from);
            longest = fmax(longest, fmin(length, SPHV_PASS_PART));
            if (f == 0) parts += ceil(length / SPHV_PASS_PART);
        }
    }
    store_bounds(direct, bench, at, group->count, longest, parts);
    bench->worker.tested += (double)total * group->count;
    for (uint32_t l = 0; l < group->count; l++)
        bench->worker.particle[at + l] = grid->particle[grid->target[group->first + l]];
}

sphv_status sphv_evaluate_direct(const sphv_evaluation *evaluation, sphv_error *error)
{
    struct direct direct;
    sphv_status status = direct_make(&direct, evaluation, error);
    if (status != SPHV_OK) return status;
    size_t blocks = (direct.groups + GROUPS - 1) / GROUPS, done = 0;
#pragma omp parallel if (blocks > 1)
    {
        struct bench bench;
        bool ready = bench_make(&bench, &direct);
        if (!ready) {
#pragma omp critical(sphv_direct)
            status = SPHV_RESOURCE_FAILURE;
        }
#pragma omp for schedule(dynamic)
        for (size_t block = 0; block < blocks; block++) {
            size_t from = block * GROUPS, to = from + GROUPS, count = 0;
            for (size_t g = from; ready && g < to && g < direct.groups; g++) {
                sum_group(&direct, &bench, &direct.group[g], count);
                count += direct.group[g].count;
            }
            if (ready) sphv_worker_finish_block(&bench.worker, direct.group[from].first, count);
            sphv_evaluation_advance(evaluation, &done, blocks);
        }
#pragma omp critical(sphv_direct)
        bench_free(&bench);
    }
    direct_free(&direct);
    return status == SPHV_OK ? SPHV_OK : sphv_fail(error, status, "out of memory");
}
