/// Any particles: sorted into cells, a vector of targets at a time over the ranges of sources that
/// may be near, the kernel compiled from its profile.
///
/// Work is cut into blocks of targets that do not depend on the threads, and a target is summed by
/// one thread in the order of the cells: results do not depend on the number of threads.
#include <stdlib.h>
#include <string.h>

#include "../clones.h"
#include "../internal.h"
#include "sorted.h"

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
    sphv_sorted sorted;
    const sphv_pass_set *passes;
    sphv_pass_function *pass[SPHV_PASS_FIELDS]; ///< for one field, for two, …
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
    bool gathers; ///< whether this group's candidates are few enough, or the last one's were
};

/// Groups never reach over the end of a row.
static bool make_groups(struct direct *direct)
{
    const sphv_cell_grid *grid = &direct->sorted.grid;
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

static void direct_free(struct direct *direct)
{
    free(direct->group);
    sphv_sorted_free(&direct->sorted);
}

static sphv_status direct_make(struct direct *direct, const sphv_evaluation *evaluation,
                               sphv_error *error)
{
    *direct = (struct direct){.passes = evaluation->passes};
    if (!direct->passes) direct->passes = *sphv_pass_sets();
    sphv_status status = sphv_sorted_make(&direct->sorted, evaluation, 0, error);
    if (status != SPHV_OK) return status;
    for (int f = 0; f < SPHV_PASS_FIELDS; f++)
        direct->pass[f] = direct->passes->choose(
            evaluation->layout.dimension, evaluation->layout.level, f + 1, &direct->sorted.radial);
    if (make_groups(direct)) return SPHV_OK;
    direct_free(direct);
    return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory for %zu particles",
                     evaluation->particles->count);
}

static bool bench_make(struct bench *bench, const struct direct *direct)
{
    size_t rows = direct->sorted.grid.cells[1] * direct->sorted.grid.cells[2];
    bool enough = sphv_worker_make(&bench->worker, direct->sorted.evaluation) == SPHV_OK;
    bench->ranges = malloc((rows + 1) * sizeof *bench->ranges);
    bench->sums = calloc(SPHV_PASS_SUMS * SPHV_LANES_MAX, sizeof *bench->sums);
    for (size_t k = 0; k < sizeof bench->gathered / sizeof *bench->gathered; k++)
        enough = (bench->gathered[k] = malloc((GATHERED + 8) * sizeof(double))) && enough;
    bench->pass = (sphv_pass){.radial = &direct->sorted.radial,
                              .layout = &direct->sorted.evaluation->layout,
                              .sums = bench->sums};
    bench->gathers = bench->worker.valued = true;
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

/// Puts what the targets have into the lanes, and finds what it lies between.
static void load_lanes(const double *from, const uint32_t *target, double *to, double *low,
                       double *high)
{
    double least = INFINITY, most = -INFINITY;
    for (int l = 0; l < SPHV_LANES_MAX; l++) {
        double value = from[target[l]];
        to[l] = value;
        least = value < least ? value : least;
        most = value > most ? value : most;
    }
    *low = least;
    *high = most;
}

/// Sums times scale, into rows of a block. All lanes: the block has room, and the next group's come
/// over those that are left over.
SPHV_CLONES static void store_rows(const double *sums, const double *scale, int count, double *to,
                                   size_t stride)
{
    for (int k = 0; k < count; k++) {
#pragma omp simd
        for (int l = 0; l < SPHV_LANES_MAX; l++)
            to[(size_t)k * stride + (size_t)l] = sums[k * SPHV_LANES_MAX + l] * scale[k];
    }
}

/// Sums of one pass into the block; those of the moments only with the first fields.
static void store_sums(const struct direct *direct, struct bench *bench, size_t at, int first_field,
                       int fields)
{
    const sphv_sum_layout *layout = &direct->sorted.evaluation->layout;
    int head = layout->moments + 3, skip = first_field ? head : 0;
    int to = skip + first_field * layout->per_field, end = head + fields * layout->per_field;
    int most =
        layout->count - first_field * layout->per_field; // less the field that stands in for none
    size_t stride = bench->worker.block.stride;
    store_rows(bench->sums + skip * SPHV_LANES_MAX, direct->sorted.scale + to,
               (end < most ? end : most) - skip,
               bench->worker.block.sums + (size_t)to * stride + at, stride);
}

/// Takes up to SPHV_PASS_FIELDS fields, from the f-th on, and all sources.
static void take_fields(const struct direct *direct, struct bench *bench, const uint32_t *target,
                        size_t at, int f, int fields)
{
    const sphv_sorted *sorted = &direct->sorted;
    sphv_pass *pass = &bench->pass;
    pass->sources = (sphv_sources){.v = sorted->v};
    for (int i = 0; i < sorted->grid.dimension; i++) pass->sources.x[i] = sorted->grid.x[i];
    for (int j = 0; j < SPHV_PASS_FIELDS; j++) { // the first again for want of a second
        const int field = j < fields ? f + j : f;
        const double *from = sorted->field[field];
        double *own = bench->worker.values + (size_t)field * bench->worker.block.stride + at;
        pass->sources.field[j] = from;
        for (int l = 0; l < SPHV_LANES_MAX; l++) {
            own[l] = from[target[l]];
            pass->a[j][l] = from[target[l]];
        }
    }
}

/// The ranges of a group, and how many candidates they have. Which are sure matters only where they
/// are not gathered; most groups do what the last one did.
static size_t find_ranges(const struct direct *direct, struct bench *bench,
                          const double low[SPHV_DIMENSIONS], const double high[SPHV_DIMENSIONS],
                          size_t *total)
{
    const sphv_sorted *sorted = &direct->sorted;
    for (;;) {
        bool guess = bench->gathers;
        size_t ranges = sphv_cell_grid_ranges(&sorted->grid, low, high, sorted->radial.limit,
                                              !guess, bench->ranges);
        *total = 0;
        for (size_t r = 0; r < ranges; r++) *total += bench->ranges[r].to - bench->ranges[r].from;
        bench->gathers = *total <= GATHERED && sorted->radial.form != SPHV_RADIAL_PROFILE;
        if (bench->gathers || !guess) return ranges;
    }
}

/// The sums of one group's targets; the last one is in the lanes that are left over, too.
static void sum_group(const struct direct *direct, struct bench *bench, const struct group *group,
                      size_t at)
{
    const sphv_sorted *sorted = &direct->sorted;
    const sphv_cell_grid *grid = &sorted->grid;
    sphv_pass *pass = &bench->pass;
    const int all = sorted->fields ? (int)sorted->fields : 1, d = grid->dimension;
    uint32_t target[SPHV_LANES_MAX];
    double low[SPHV_DIMENSIONS], high[SPHV_DIMENSIONS];
    size_t longest = 0, parts = 0, total = 0;
    for (uint32_t l = 0; l < SPHV_LANES_MAX; l++)
        target[l] = grid->target[group->first + (l < group->count ? l : group->count - 1)];
    for (int i = 0; i < d; i++) load_lanes(grid->x[i], target, pass->x[i], &low[i], &high[i]);
    size_t ranges = find_ranges(direct, bench, low, high, &total);
    bool gathers = bench->gathers;
    for (int f = 0; f < all; f += SPHV_PASS_FIELDS) {
        int fields = all - f < SPHV_PASS_FIELDS ? all - f : SPHV_PASS_FIELDS;
        sphv_range whole = {0};
        take_fields(direct, bench, target, at, f, fields);
        if (gathers) {
            whole.to =
                direct->passes->gather(&pass->sources, d, fields, low, high, sorted->radial.limit,
                                       ranges, bench->ranges, bench->gathered);
            for (int i = 0; i < d; i++) pass->sources.x[i] = bench->gathered[i];
            pass->sources.v = bench->gathered[d];
            for (int j = 0; j < SPHV_PASS_FIELDS; j++)
                pass->sources.field[j] = bench->gathered[d + 1 + (j < fields ? j : 0)];
            total = whole.to;
        }
        direct->pass[fields - 1](pass, gathers ? 1 : ranges, gathers ? &whole : bench->ranges);
        store_sums(direct, bench, at, f, fields);
        for (size_t r = 0; r < (gathers ? 1 : ranges); r++) {
            const sphv_range *range = gathers ? &whole : &bench->ranges[r];
            size_t length = range->to - range->from;
            size_t part = length < SPHV_PASS_PART ? length : SPHV_PASS_PART;
            longest = part > longest ? part : longest;
            if (f == 0) parts += (length + SPHV_PASS_PART - 1) / SPHV_PASS_PART;
        }
    }
    sphv_sorted_bound(sorted, &bench->worker, at, group->count, pass->neighbours,
                      (double)(longest + parts));
    bench->worker.tested += (double)total * group->count;
    for (uint32_t l = 0; l < group->count; l++)
        bench->worker.particle[at + l] = grid->particle[target[l]];
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
