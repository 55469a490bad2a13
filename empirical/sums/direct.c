/// Any particles: sorted into cells, a vector of targets at a time over the ranges of sources that
/// may be near, the kernel compiled from its profile.
///
/// Work is cut into blocks of targets that do not depend on the threads, and a target is summed by
/// one thread in the order of the cells: results do not depend on the number of threads.
#include <stdlib.h>
#include <string.h>

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
    const sphv_cell_grid *grid = &direct->sorted.grid;
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
    const sphv_sum_layout *layout = &direct->sorted.evaluation->layout;
    double *to = bench->worker.block.sums;
    int head = layout->moments + 3;
    for (int k = first_field ? head : 0; k < head + fields * layout->per_field; k++) {
        int sum = k < head ? k : k + first_field * layout->per_field;
        if (sum >= layout->count) break; // the field that stands in for none
        const double *from = bench->sums + k * SPHV_LANES_MAX, scale = direct->sorted.scale[sum];
        double *row = to + (size_t)sum * bench->worker.block.stride + at;
        for (int l = 0; l < SPHV_LANES_MAX; l++) row[l] = from[l] * scale;
    }
}

/// The sums of one group's targets.
static void sum_group(const struct direct *direct, struct bench *bench, const struct group *group,
                      size_t at)
{
    const sphv_cell_grid *grid = &direct->sorted.grid;
    sphv_pass *pass = &bench->pass;
    double low[SPHV_DIMENSIONS], high[SPHV_DIMENSIONS], longest = 0, parts = 0;
    load_targets(direct, group, pass, low, high);
    size_t ranges =
               sphv_cell_grid_ranges(grid, low, high, direct->sorted.radial.limit, bench->ranges),
           total = 0;
    for (size_t r = 0; r < ranges; r++) total += bench->ranges[r].to - bench->ranges[r].from;
    bool gathers = total <= GATHERED && direct->sorted.radial.form != SPHV_RADIAL_PROFILE;
    bool plain = direct->sorted.evaluation->layout.level == SPHV_SUMS_PLAIN;
    int all = direct->sorted.fields ? (int)direct->sorted.fields : 1, d = grid->dimension;
    for (int f = 0; f < all; f += SPHV_PASS_FIELDS) {
        int fields = all - f < SPHV_PASS_FIELDS ? all - f : SPHV_PASS_FIELDS;
        sphv_sources sources = {.v = direct->sorted.v};
        for (int i = 0; i < d; i++) sources.x[i] = grid->x[i];
        for (int j = 0; j < SPHV_PASS_FIELDS; j++) { // the first again for want of a second
            sources.field[j] = direct->sorted.field[j < fields ? f + j : f];
            for (uint32_t l = 0; l < SPHV_LANES_MAX; l++) {
                uint32_t target = l < group->count ? l : group->count - 1;
                pass->a[j][l] = plain ? 0 : sources.field[j][grid->target[group->first + target]];
            }
        }
        sphv_pass_function *function = direct->passes->choose(
            d, direct->sorted.evaluation->layout.level, fields, &direct->sorted.radial);
        sphv_range whole = {0};
        pass->sources = sources;
        if (gathers) {
            whole.to =
                direct->passes->gather(&sources, d, fields, low, high, direct->sorted.radial.limit,
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
    sphv_sorted_bound(&direct->sorted, &bench->worker, at, group->count, pass->neighbours,
                      longest + parts);
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
