/// Every pair of particles, the kernel from its profile, compensated sums: slow, and right.
#include <stdlib.h>
#include <string.h>

#include "../internal.h"
#include "evaluation.h"
#include "radial.h"

/// Radial functions of one pair and their sizes, errors included.
struct radial {
    double p[3], size[3];
};

/// The periodic copy of x_b that is nearest to x_a, as a rounded number.
static double nearest_copy(double x_b, double x_a)
{
    return x_a - x_b > 0.5 ? x_b + 1 : x_a - x_b < -0.5 ? x_b - 1 : x_b;
}

struct accumulators {
    sphv_sum *sum;
    unsigned neighbours;
};

/// Adds one neighbour to all sums.
static void add_pair(const sphv_evaluation *evaluation, const struct radial *radial, double v,
                     const double s[SPHV_DIMENSIONS], size_t a, size_t b, sphv_sum *sum)
{
    const sphv_sum_layout *layout = &evaluation->layout;
    const sphv_sum_set *set = &sphv_sum_sets[layout->level];
    const sphv_request *request = evaluation->request;
    const sphv_monomial *monomials = sphv_monomials(layout->dimension);
    for (int k = 0; k < 3; k++) {
        sphv_sum_add(&sum[layout->size_at + k], fabs(v) * radial->size[k], 0);
        int to = set->moment[k].to > set->field[k].to ? set->moment[k].to : set->field[k].to;
        int count = (int)sphv_monomial_count(layout->dimension, to);
        for (int j = 0; j < count; j++) {
            const sphv_monomial *monomial = &monomials[j];
            double term = v * radial->p[k];
            for (int i = 0; i < layout->dimension; i++)
                for (int n = 0; n < monomial->power[i]; n++) term *= s[i];
            if (monomial->degree >= set->moment[k].from && monomial->degree <= set->moment[k].to)
                sphv_sum_add(&sum[sphv_moment_index(layout, k, j)], term, 0);
            if (monomial->degree < set->field[k].from || monomial->degree > set->field[k].to)
                continue;
            for (size_t f = 0; f < request->field_count; f++) {
                double own = layout->level == SPHV_SUMS_PLAIN ? 0 : request->fields[f][a];
                sphv_sum_add(&sum[sphv_field_sum_index(layout, (int)f, k, j)],
                             term * (request->fields[f][b] - own), 0);
            }
        }
    }
}

/// All sums at one particle.
static void sum_particle(const sphv_evaluation *evaluation, const sphv_radial *functions, size_t a,
                         struct accumulators *into)
{
    const sphv_particles *particles = evaluation->particles;
    double h = evaluation->request->h, unit = 1;
    for (int i = 0; i < particles->dimension; i++) unit *= h;
    memset(into->sum, 0, (size_t)evaluation->layout.count * sizeof *into->sum);
    into->neighbours = 0;
    for (size_t b = 0; b < particles->count; b++) {
        double d[SPHV_DIMENSIONS] = {0, 0, 0}, s[SPHV_DIMENSIONS];
        for (int i = 0; i < particles->dimension; i++) {
            double x_a = particles->x[i][a], x_b = particles->x[i][b];
            d[i] = (particles->periodic ? nearest_copy(x_b, x_a) : x_b) - x_a;
        }
        double square = sphv_square(particles->dimension, d);
        if (!(square < functions->limit)) continue;
        for (int i = 0; i < SPHV_DIMENSIONS; i++) s[i] = d[i] / h;
        struct radial radial = {{0}, {0}};
        sphv_radial_values(functions, evaluation->layout.level, square, radial.p, radial.size);
        add_pair(evaluation, &radial, particles->volume[b] / unit, s, a, b, into->sum);
        into->neighbours++;
    }
}

sphv_status sphv_evaluate_brute_force(const sphv_evaluation *evaluation, sphv_error *error)
{
    size_t count = evaluation->particles->count, sums = (size_t)evaluation->layout.count;
    size_t blocks = (count + SPHV_BLOCK - 1) / SPHV_BLOCK, done = 0;
    sphv_radial functions;
    sphv_radial_make(&functions, evaluation->request->profile, evaluation->request->h,
                     evaluation->layout.level);
    // The result of a compensated sum is rounded once more.
    double rounding = sphv_summand_rounding(&evaluation->layout) + 2 * SPHV_U;
    sphv_status status = SPHV_OK;
#pragma omp parallel if (blocks > 1)
    {
        sphv_worker worker;
        struct accumulators at = {malloc(sums * sizeof *at.sum), 0};
        bool ready = sphv_worker_make(&worker, evaluation) == SPHV_OK && at.sum;
        if (!ready) {
#pragma omp critical(sphv_brute_force)
            status = SPHV_RESOURCE_FAILURE;
        }
#pragma omp for schedule(dynamic)
        for (size_t block = 0; block < blocks; block++) {
            size_t first = block * SPHV_BLOCK,
                   n = count - first < SPHV_BLOCK ? count - first : SPHV_BLOCK;
            for (size_t i = 0; ready && i < n; i++) {
                sum_particle(evaluation, &functions, first + i, &at);
                for (size_t k = 0; k < sums; k++)
                    worker.block.sums[k * worker.block.stride + i] =
                        sphv_sum_result(&at.sum[k]).value;
                worker.particle[i] = first + i;
                worker.neighbours[i] = at.neighbours;
                worker.rounding[i] = rounding;
            }
            if (ready) {
                worker.tested += (double)n * (double)count;
                sphv_worker_finish_block(&worker, first, n);
            }
            sphv_evaluation_advance(evaluation, &done, blocks);
        }
#pragma omp critical(sphv_brute_force)
        {
            sphv_worker_free(&worker);
            free(at.sum);
        }
    }
    return status == SPHV_OK ? SPHV_OK : sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
}
