/// The solvers of every instruction set against each other: the same bits, however many particles
/// stand side by side, and whoever they are.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../empirical/solvers.h"
#include "support.h"

enum { STRIDE = 24, FIELDS = 2, RESULTS = FIELDS * 10 };

static const sphv_profile *profile;

/// Sums of a block, made up; some of its matrices are singular, some fields overflow.
struct made_up {
    sphv_sum_layout layout;
    sphv_sum_block block;
    double *sums, rounding[STRIDE], spread[FIELDS], values[FIELDS * STRIDE];
    size_t particle[STRIDE];
    unsigned neighbours[STRIDE];
};

static void make(struct made_up *out, int dimension, size_t count)
{
    out->layout = sphv_sum_layout_make(dimension, SPHV_SUMS_ALL, FIELDS);
    size_t all = (size_t)out->layout.count;
    out->sums = malloc(all * STRIDE * sizeof *out->sums);
    assert_non_null(out->sums);
    for (size_t k = 0; k < all; k++) {
        bool size = (int)k >= out->layout.size_at && (int)k < out->layout.size_at + 3;
        for (size_t i = 0; i < STRIDE; i++)
            out->sums[k * STRIDE + i] = i % 5 == 3 && !size ? 0 : random_uniform(size ? 1 : -1, 2);
        if ((int)k > out->layout.size_at + 3) out->sums[k * STRIDE + 4] *= 1e308;
    }
    for (size_t i = 0; i < STRIDE; i++) {
        out->rounding[i] = 1e-14;
        out->particle[i] = (i * 5 + 1) % STRIDE;
        out->neighbours[i] = (unsigned)random_uniform(0, 40);
        for (int f = 0; f < FIELDS; f++) out->values[f * STRIDE + i] = random_uniform(-1, 1);
    }
    out->spread[0] = out->spread[1] = 4;
    out->block = (sphv_sum_block){.layout = &out->layout,
                                  .count = count,
                                  .stride = STRIDE,
                                  .sums = out->sums,
                                  .particle = out->particle,
                                  .neighbours = out->neighbours,
                                  .rounding = out->rounding,
                                  .spread = out->spread};
}

/// What a solver found.
struct found {
    double estimate[RESULTS][STRIDE], condition[STRIDE], rounding[RESULTS];
    unsigned char fault[STRIDE];
};

/// Solves the block, or one particle of it.
static void solve(const struct made_up *of, const sphv_solver_set *set, sphv_method method,
                  const size_t *alone, struct found *out)
{
    double *estimate[RESULTS];
    for (int a = 0; a < RESULTS; a++) estimate[a] = out->estimate[a];
    sphv_method_estimates into = {.method = method,
                                  .quantities =
                                      sphv_method_quantities(method, of->layout.dimension),
                                  .estimate = estimate,
                                  .condition = out->condition,
                                  .fault = out->fault,
                                  .rounding = out->rounding};
    sphv_request request = {.profile = profile, .h = 0.25, .field_count = FIELDS};
    struct made_up one = *of;
    if (alone) {
        one.block.count = 1;
        one.block.sums = malloc((size_t)of->layout.count * STRIDE * sizeof(double));
        assert_non_null(one.block.sums);
        for (int k = 0; k < of->layout.count; k++)
            for (size_t i = 0; i < STRIDE; i++)
                one.block.sums[(size_t)k * STRIDE + i] = of->sums[(size_t)k * STRIDE + *alone];
        for (int f = 0; f < FIELDS; f++) one.values[f * STRIDE] = of->values[f * STRIDE + *alone];
        one.block.particle = &of->particle[*alone];
        one.block.neighbours = &of->neighbours[*alone];
    }
    sphv_solve_block_with(set, &one.block, &request, one.values, &into);
    if (alone) free(one.block.sums);
}

static void test_same(void **state)
{
    (void)state;
    random_start("solvers");
    static const size_t counts[] = {1, 4, 7, 8, 13, 21};
    const sphv_solver_set *const *sets = sphv_solver_sets();
    size_t faults[SPHV_FAULTS] = {0};
    for (int d = 1; d <= SPHV_DIMENSIONS; d++)
        for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
            for (int method = 0; sphv_methods[method].name; method++) {
                struct made_up made;
                static struct found best, other, alone;
                make(&made, d, counts[c]);
                memset(&best, 0, sizeof best);
                solve(&made, sets[0], (sphv_method)method, NULL, &best);
                for (int s = 1; sets[s]; s++) {
                    memset(&other, 0, sizeof other);
                    solve(&made, sets[s], (sphv_method)method, NULL, &other);
                    assert_memory_equal(&best, &other, sizeof best);
                }
                memset(&alone, 0, sizeof alone);
                for (size_t i = 0; i < counts[c]; i++) {
                    solve(&made, sets[0], (sphv_method)method, &i, &alone);
                    faults[best.fault[made.particle[i]]]++;
                }
                assert_memory_equal(&best, &alone, sizeof best);
                free(made.sums);
            }
    // Every kind of particle was there.
    for (int k = 0; k < SPHV_FAULTS; k++)
        if (k != SPHV_FAULT_ILL_CONDITIONED) assert_true(faults[k] > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same)};
    sphv_kernel *kernel = load_kernel("cubic-spline"); // any support will do
    profile = sphv_kernel_profile(kernel, 1);
    int failed = run_group(tests);
    sphv_kernel_free(kernel);
    return failed;
}
