/// Sorting in two steps, so that any number of threads gives the same order: particles are cut into
/// chunks that do not depend on the threads, and the cells into buckets, runs of them. Chunks count
/// what they have for each bucket, which tells where their share of it begins; then each bucket is
/// sorted by cell on its own, within the reach of a cache. Neither step changes the order of
/// particles that share a cell.
#include "cell_sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../internal.h"
#include "chunks.h"

enum {
    BUCKETS_MOST = 1024,
    BUCKET_LEAST = 1024,             ///< cells
    TILE = 512,                      ///< sources that are looked at together
    COPIES = 1 << SPHV_DIMENSIONS,   ///< of a particle, itself included, at most
    COPY_SHIFT = 29,                 ///< which copy a source is stands above its particle
    PARTICLE = (1 << COPY_SHIFT) - 1 ///< the bits of the particle
};

/// A few sources.
struct tile {
    size_t count;
    uint32_t source[TILE];
    int place[TILE];
    double x[SPHV_DIMENSIONS][TILE];
};

/// What the threads share.
struct sort {
    sphv_cell_grid *grid;
    const sphv_particles *particles;
    double near; ///< the sides of a periodic box, for particles to have copies
    size_t chunks, buckets;
    int shift;        ///< a bucket is 2^shift cells
    size_t *first;    ///< source of each chunk; one more at the end
    uint32_t *place;  ///< [chunk * buckets + bucket]: how many sources, then where they go
    uint32_t *base;   ///< first source of each bucket; one more at the end
    size_t most;      ///< sources in a bucket
    uint32_t *source; ///< by chunk
    uint16_t *bucket; ///< of each of these
};

static double near_of(double radius)
{
    return radius * (1 + 4 * SPHV_U) + 2 * SPHV_U; // room for the rounding of x ± 1
}

/// The axes along which a particle of a periodic box has a copy, as bits.
static unsigned copied(const sphv_particles *particles, size_t b, double near)
{
    unsigned axes = 0;
    for (int i = 0; i < particles->dimension; i++) {
        double x = particles->x[i][b];
        axes |= (unsigned)!(x > near && x < 1 - near) << i;
    }
    return axes;
}

/// The coordinate of a source, in the particles' units.
static double coordinate(const sphv_particles *particles, int axis, uint32_t source)
{
    double x = particles->x[axis][source & PARTICLE];
    if (!(source >> COPY_SHIFT >> axis & 1)) return x;
    return x < 0.5 ? x + 1 : x - 1;
}

/// The sources of one particle. \return their number
static size_t list_sources(const sphv_particles *particles, size_t b, double near,
                           uint32_t source[COPIES])
{
    unsigned axes = copied(particles, b, near);
    size_t count = 0;
    for (unsigned copy = 0; copy < COPIES; copy++)
        if (!(copy & ~axes)) source[count++] = (uint32_t)b | copy << COPY_SHIFT;
    return count;
}

/// Widens an extent to the copies of some particles, in the particles' units.
static void widen(sphv_extent *extent, const sphv_particles *particles, double near, size_t from,
                  size_t to)
{
    for (size_t b = from; b < to; b++) {
        uint32_t source[COPIES];
        size_t count = list_sources(particles, b, near, source);
        extent->copies += count - 1;
        for (int i = 0; count > 1 && i < particles->dimension; i++) {
            double x = coordinate(particles, i, source[count - 1]);
            extent->low[i] = fmin(extent->low[i], x);
            extent->high[i] = fmax(extent->high[i], x);
        }
    }
}

sphv_extent sphv_cell_extent(const sphv_cell_grid *grid, const sphv_particles *particles,
                             double radius)
{
    size_t count = particles->count, chunks = particles->periodic ? sphv_chunks(count) : 0;
    sphv_extent extent = {{0}, {0}, 0};
    for (int i = 0; i < particles->dimension; i++) {
        sphv_span span = sphv_span_of(particles->x[i], count);
        extent.low[i] = span.low;
        extent.high[i] = span.high;
    }
    const sphv_extent own = extent;
#pragma omp parallel for schedule(static) if (chunks > 1)
    for (size_t c = 0; c < chunks; c++) {
        sphv_extent copies = own;
        widen(&copies, particles, near_of(radius), sphv_chunk_begin(count, chunks, c),
              sphv_chunk_begin(count, chunks, c + 1));
#pragma omp critical(sphv_cells)
        {
            extent.copies += copies.copies;
            for (int i = 0; i < SPHV_DIMENSIONS; i++) {
                extent.low[i] = fmin(extent.low[i], copies.low[i]);
                extent.high[i] = fmax(extent.high[i], copies.high[i]);
            }
        }
    }
    for (int i = 0; i < SPHV_DIMENSIONS; i++) { // by a power of two
        extent.low[i] *= grid->unit;
        extent.high[i] *= grid->unit;
    }
    return extent;
}

/// Cells of sources, by their sorted coordinates.
SPHV_CLONES static void find_places(const sphv_cell_grid *grid, const double *const *x,
                                    size_t count, int *place)
{
    const int d = grid->dimension, length = (int)grid->cells[0], rows = (int)grid->cells[1];
    const sphv_cell_grid of = *grid; // so that it may stay in registers
    if (d == 1) {
#pragma omp simd
        for (size_t k = 0; k < count; k++) place[k] = sphv_cell_of(&of, 0, x[0][k]);
    } else if (d == 2) {
#pragma omp simd
        for (size_t k = 0; k < count; k++)
            place[k] = sphv_cell_of(&of, 1, x[1][k]) * length + sphv_cell_of(&of, 0, x[0][k]);
    } else {
#pragma omp simd
        for (size_t k = 0; k < count; k++)
            place[k] =
                (sphv_cell_of(&of, 2, x[2][k]) * rows + sphv_cell_of(&of, 1, x[1][k])) * length +
                sphv_cell_of(&of, 0, x[0][k]);
    }
}

/// Takes the coordinates of sources.
static void take_sources(const struct sort *sort, const uint32_t *source, size_t count, double **x)
{
    const sphv_particles *particles = sort->particles;
    const double unit = sort->grid->unit;
    for (int i = 0; i < particles->dimension; i++)
        if (particles->periodic)
            for (size_t k = 0; k < count; k++) x[i][k] = coordinate(particles, i, source[k]) * unit;
        else
            for (size_t k = 0; k < count; k++) x[i][k] = particles->x[i][source[k]] * unit;
}

/// Takes a run of particles without copies.
SPHV_CLONES static void take_run(const struct sort *sort, size_t first, struct tile *tile)
{
    const double unit = sort->grid->unit;
#pragma omp simd
    for (size_t k = 0; k < tile->count; k++) tile->source[k] = (uint32_t)(first + k);
    for (int i = 0; i < sort->particles->dimension; i++) {
        const double *x = sort->particles->x[i] + first;
#pragma omp simd
        for (size_t k = 0; k < tile->count; k++) tile->x[i][k] = x[k] * unit;
    }
}

/// Lists the sources of a chunk, and counts those in each bucket.
static void count_chunk(const struct sort *sort, size_t chunk)
{
    const sphv_particles *particles = sort->particles;
    size_t b = sphv_chunk_begin(particles->count, sort->chunks, chunk), at = sort->first[chunk];
    size_t end = sphv_chunk_begin(particles->count, sort->chunks, chunk + 1);
    uint32_t *counts = sort->place + chunk * sort->buckets;
    struct tile tile;
    // cppcheck-suppress uninitvar ; where rows of it begin is known
    double *x[SPHV_DIMENSIONS] = {tile.x[0], tile.x[1], tile.x[2]};
    memset(counts, 0, sort->buckets * sizeof *counts);
    while (b < end) {
        tile.count = 0;
        if (particles->periodic) {
            for (; b < end && tile.count + COPIES <= TILE; b++)
                tile.count += list_sources(particles, b, sort->near, tile.source + tile.count);
            take_sources(sort, tile.source, tile.count, x);
        } else {
            tile.count = end - b < TILE ? end - b : TILE;
            take_run(sort, b, &tile);
            b += tile.count;
        }
        find_places(sort->grid, (const double *const *)x, tile.count, tile.place);
        for (size_t k = 0; k < tile.count; k++) {
            int bucket = tile.place[k] >> sort->shift;
            sort->source[at + k] = tile.source[k];
            sort->bucket[at + k] = (uint16_t)bucket;
            counts[bucket]++;
        }
        at += tile.count;
    }
}

/// Where the sources of each chunk go in each bucket.
static void find_shares(struct sort *sort)
{
    uint32_t at = 0;
    for (size_t k = 0; k < sort->buckets; k++) {
        sort->base[k] = at;
        for (size_t c = 0; c < sort->chunks; c++) {
            uint32_t *share = &sort->place[c * sort->buckets + k], count = *share;
            *share = at;
            at += count;
        }
        if (at - sort->base[k] > sort->most) sort->most = at - sort->base[k];
    }
    sort->base[sort->buckets] = at;
}

/// Moves the sources of a chunk to their buckets.
static void move_chunk(const struct sort *sort, size_t chunk)
{
    uint32_t *next = sort->place + chunk * sort->buckets;
    for (size_t k = sort->first[chunk]; k < sort->first[chunk + 1]; k++)
        sort->grid->particle[next[sort->bucket[k]]++] = sort->source[k];
}

/// What a thread needs for one bucket.
struct shelf {
    uint32_t *source;
    int *place;
    double *x[SPHV_DIMENSIONS];
};

static bool shelf_make(struct shelf *shelf, const struct sort *sort)
{
    size_t room = sort->most + 1;
    bool enough = (shelf->source = malloc(room * sizeof *shelf->source)) != NULL;
    enough = (shelf->place = malloc(room * sizeof *shelf->place)) && enough;
    for (int i = 0; i < SPHV_DIMENSIONS; i++)
        enough = (shelf->x[i] = malloc(room * sizeof(double))) && enough;
    return enough;
}

static void shelf_free(struct shelf *shelf)
{
    free(shelf->source);
    free(shelf->place);
    for (int i = 0; i < SPHV_DIMENSIONS; i++) free(shelf->x[i]);
}

/// Puts the sources of a bucket into its cells.
static void fill_bucket(const struct sort *sort, size_t bucket, struct shelf *shelf)
{
    const sphv_cell_grid *grid = sort->grid;
    const size_t base = sort->base[bucket], count = sort->base[bucket + 1] - base;
    const size_t all = grid->cells[0] * grid->cells[1] * grid->cells[2];
    const size_t first = bucket << sort->shift, last = (bucket + 1) << sort->shift;
    const size_t cells = (last < all ? last : all) - first;
    uint32_t *start = grid->start + first, at = (uint32_t)base;
    memcpy(shelf->source, grid->particle + base, count * sizeof *shelf->source);
    take_sources(sort, shelf->source, count, shelf->x);
    find_places(grid, (const double *const *)shelf->x, count, shelf->place);
    memset(start, 0, cells * sizeof *start);
    for (size_t k = 0; k < count; k++) start[shelf->place[k] - (int)first]++;
    for (size_t c = 0; c < cells; c++) {
        uint32_t here = start[c];
        start[c] = at;
        at += here;
    }
    for (size_t k = 0; k < count; k++) { // start[c] ends as the start of the next cell
        uint32_t source = shelf->source[k], particle = source & PARTICLE;
        size_t to = start[shelf->place[k] - (int)first]++;
        for (int i = 0; i < grid->dimension; i++) grid->x[i][to] = shelf->x[i][k];
        grid->volume[to] = sort->particles->volume[particle];
        grid->particle[to] = particle | (source == particle ? 0 : SPHV_CELL_COPY);
    }
    memmove(start + 1, start, (cells - 1) * sizeof *start);
    start[0] = (uint32_t)base;
}

/// First source of each chunk.
static void find_chunks(struct sort *sort)
{
    const sphv_particles *particles = sort->particles;
    sort->first[0] = 0;
#pragma omp parallel for schedule(static) if (sort->chunks > 1)
    for (size_t c = 0; c < sort->chunks; c++) {
        size_t from = sphv_chunk_begin(particles->count, sort->chunks, c);
        size_t to = sphv_chunk_begin(particles->count, sort->chunks, c + 1);
        sort->first[c + 1] = to - from;
        uint32_t source[COPIES];
        for (size_t b = from; b < to && particles->periodic; b++)
            sort->first[c + 1] += list_sources(particles, b, sort->near, source) - 1;
    }
    for (size_t c = 0; c < sort->chunks; c++) sort->first[c + 1] += sort->first[c];
}

static bool sort_sources(struct sort *sort)
{
    bool enough = true;
    find_chunks(sort);
#pragma omp parallel for schedule(static) if (sort->chunks > 1)
    for (size_t c = 0; c < sort->chunks; c++) count_chunk(sort, c);
    find_shares(sort);
#pragma omp parallel for schedule(static) if (sort->chunks > 1)
    for (size_t c = 0; c < sort->chunks; c++) move_chunk(sort, c);
#pragma omp parallel if (sort->chunks > 1)
    {
        struct shelf shelf = {0};
        bool ready = shelf_make(&shelf, sort);
        if (!ready) {
#pragma omp atomic write
            enough = false;
        }
#pragma omp for schedule(dynamic)
        for (size_t k = 0; k < sort->buckets; k++)
            if (ready) fill_bucket(sort, k, &shelf);
        shelf_free(&shelf);
    }
    return enough;
}

bool sphv_cell_sort(sphv_cell_grid *grid, const sphv_particles *particles, double radius)
{
    const size_t cells = grid->cells[0] * grid->cells[1] * grid->cells[2];
    size_t most = cells / BUCKET_LEAST < BUCKETS_MOST ? cells / BUCKET_LEAST : BUCKETS_MOST;
    struct sort sort = {.grid = grid,
                        .particles = particles,
                        .near = near_of(radius),
                        .chunks = sphv_chunks(particles->count)};
    while (cells >> sort.shift > most) sort.shift++;
    sort.buckets = ((cells - 1) >> sort.shift) + 1;
    sort.first = malloc((sort.chunks + 1) * sizeof *sort.first);
    sort.place = malloc(sort.chunks * sort.buckets * sizeof *sort.place);
    sort.base = malloc((sort.buckets + 1) * sizeof *sort.base);
    // Only the last step writes coordinates: until then their room holds what the others need.
    sort.source = (uint32_t *)(void *)grid->x[0];
    sort.bucket = (uint16_t *)(void *)(sort.source + grid->count);
    bool enough = sort.first && sort.place && sort.base && sort_sources(&sort);
    free(sort.first);
    free(sort.place);
    free(sort.base);
    grid->start[cells] = (uint32_t)grid->count;
    return enough;
}
