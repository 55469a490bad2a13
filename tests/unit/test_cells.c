/// Particles sorted into cells: each where it belongs, in the order they came, for any number of
/// threads, and enough of them that threads share the work.
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../empirical/sums/cell_sort.h"
#include "../../empirical/sums/chunks.h"
#include "support.h"

#ifdef _OPENMP
#include <omp.h>
#else
static void omp_set_num_threads(int n)
{
    (void)n;
}
static int omp_get_max_threads(void)
{
    return 1;
}
#endif

enum { COUNT = 20000 };

/// How particles lie.
enum lie { EVEN, CLUSTERED, COINCIDENT, LIES };

struct cloud {
    sphv_particles particles;
    double x[SPHV_DIMENSIONS][COUNT], volume[COUNT];
};

static struct cloud *cloud_make(int dimension, enum lie lie, bool periodic)
{
    struct cloud *cloud = malloc(sizeof *cloud);
    assert_non_null(cloud);
    cloud->particles = (sphv_particles){
        .dimension = dimension, .count = COUNT, .periodic = periodic, .volume = cloud->volume};
    for (int i = 0; i < dimension; i++) cloud->particles.x[i] = cloud->x[i];
    for (size_t b = 0; b < COUNT; b++) {
        cloud->volume[b] = random_uniform(0.5, 1.5);
        for (int i = 0; i < dimension; i++) {
            double x = random_uniform(0, 1);
            bool spread = lie == EVEN || b % 1000 == 0;
            cloud->x[i][b] = spread ? x : lie == CLUSTERED ? 0.3 + 0.001 * x : 0.75;
        }
    }
    return cloud;
}

/// The cell that a source was put into, from the bounds of the cells.
static size_t cell_of(const sphv_cell_grid *grid, size_t source)
{
    size_t low = 0, high = grid->cells[0] * grid->cells[1] * grid->cells[2];
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (grid->start[middle] <= source)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/// Every particle once among the targets, with its copies within reach of the box, and each source
/// in its cell, behind those of the same cell that come before it.
static void check_sources(const sphv_cell_grid *grid, const sphv_particles *particles,
                          double radius)
{
    const double unit = grid->unit;
    unsigned *seen = calloc(COUNT, sizeof *seen);
    assert_non_null(seen);
    size_t expected = 0, target = 0, last_cell = 0;
    for (size_t s = 0; s < grid->count; s++) {
        size_t b = grid->particle[s], cell = 0, at = cell_of(grid, s);
        unsigned copy = 0;
        assert_true(b < COUNT);
        for (int i = grid->dimension - 1; i >= 0; i--) {
            double x = grid->x[i][s], own = particles->x[i][b] * unit;
            if (x != own) {
                copy |= 1u << i;
                assert_true(x == (own < 0.5 * unit ? own / unit + 1 : own / unit - 1) * unit);
            }
            cell = cell * grid->cells[i] + (size_t)sphv_cell_of(grid, i, x);
        }
        assert_true(cell == at);
        assert_true(grid->volume[s] == particles->volume[b]);
        assert_true(s == 0 || last_cell < cell || grid->particle[s - 1] <= b);
        assert_false(seen[b] >> copy & 1u);
        seen[b] |= 1u << copy;
        if (copy == 0) {
            assert_true(target < grid->targets);
            assert_true(grid->target[target++] == s);
        }
        last_cell = cell;
    }
    assert_int_equal(target, COUNT);
    for (size_t b = 0; b < COUNT; b++) {
        unsigned axes = 0;
        for (int i = 0; particles->periodic && i < grid->dimension; i++) {
            double x = particles->x[i][b], inside = fmin(x, 1 - x) - radius;
            // What is within rounding of the radius may have a copy or not.
            bool near = fabs(inside) < 1e-12 ? seen[b] >> (1u << i) & 1u : inside < 0;
            axes |= (unsigned)near << i;
        }
        for (unsigned copy = 0; copy < 8; copy++) {
            bool there = seen[b] >> copy & 1u;
            assert_true(there == !(copy & ~axes));
            expected += there;
        }
    }
    assert_int_equal(grid->count, expected);
    free(seen);
}

/// Rows hold their particles between their bounds, and count their targets.
static void check_rows(const sphv_cell_grid *grid)
{
    size_t rows = grid->cells[1] * grid->cells[2], length = grid->cells[0];
    assert_int_equal(grid->row[0].first_target, 0);
    assert_int_equal(grid->row[rows].first_target, COUNT);
    for (size_t r = 0; r < rows; r++) {
        for (size_t s = grid->start[r * length]; s < grid->start[(r + 1) * length]; s++)
            for (int i = 1; i < grid->dimension; i++)
                assert_true(grid->row[r].low[i] <= grid->x[i][s] &&
                            grid->x[i][s] <= grid->row[r].high[i]);
        for (size_t t = grid->row[r].first_target; t < grid->row[r + 1].first_target; t++)
            assert_true(grid->target[t] >= grid->start[r * length] &&
                        grid->target[t] < grid->start[(r + 1) * length]);
    }
}

static void check_same(const sphv_cell_grid *a, const sphv_cell_grid *b)
{
    size_t cells = a->cells[0] * a->cells[1] * a->cells[2];
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->cells, b->cells, sizeof a->cells);
    for (int i = 0; i < a->dimension; i++)
        assert_memory_equal(a->x[i], b->x[i], a->count * sizeof(double));
    assert_memory_equal(a->volume, b->volume, a->count * sizeof(double));
    assert_memory_equal(a->particle, b->particle, a->count * sizeof *a->particle);
    assert_memory_equal(a->target, b->target, a->targets * sizeof *a->target);
    assert_memory_equal(a->start, b->start, (cells + 1) * sizeof *a->start);
}

static void test_sorting(void **state)
{
    (void)state;
    random_start("cells");
    assert_true(sphv_chunks(COUNT) > 1);
    const int before = omp_get_max_threads();
    for (int d = 1; d <= SPHV_DIMENSIONS; d++)
        for (int lie = 0; lie < LIES; lie++)
            for (int periodic = 0; periodic < 2; periodic++) {
                const double radius = 0.0625 * sqrt(2);
                struct cloud *cloud = cloud_make(d, (enum lie)lie, periodic);
                sphv_cell_grid one, many;
                sphv_error error;
                omp_set_num_threads(1);
                assert_ok(sphv_cell_grid_make(&one, &cloud->particles, radius, 0, &error), error);
                check_sources(&one, &cloud->particles, radius);
                check_rows(&one);
                omp_set_num_threads(3);
                assert_ok(sphv_cell_grid_make(&many, &cloud->particles, radius, 0, &error), error);
                check_same(&one, &many);
                sphv_cell_grid_free(&many);
                sphv_cell_grid_free(&one);
                free(cloud);
            }
    omp_set_num_threads(before);
}

/// Spans of numbers, with those that are not numbers anywhere.
static void test_spans(void **state)
{
    (void)state;
    random_start("spans");
    double *values = malloc(COUNT * sizeof *values);
    assert_non_null(values);
    static const size_t counts[] = {0, 1, 7, 8, 33, COUNT};
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < counts[c]; i++) {
            values[i] = random_uniform(-1, 1) * DBL_MAX;
            low = fmin(low, values[i]);
            high = fmax(high, values[i]);
        }
        sphv_span span = sphv_span_of(values, counts[c]);
        assert_true(span.low == low && span.high == high && span.finite);
        for (size_t k = 0; counts[c] > 0 && k < 20; k++) {
            size_t at = (size_t)random_integer(0, (long)counts[c] - 1);
            double sound = values[at];
            values[at] = bad[k % 3];
            assert_false(sphv_span_of(values, counts[c]).finite);
            values[at] = sound;
        }
    }
    free(values);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_sorting),
                                       cmocka_unit_test(test_spans)};
    return run_group(tests);
}
