/// Every pair of particles, the kernel from its profile, compensated sums: slow, and right.
#include <stdlib.h>
#include <string.h>

#include "../internal.h"
#include "evaluation.h"

/// Radial functions of one pair and their sizes |p_k| q^k, errors included.
struct radial {
    double p[3], size[3];
};

/// sup |Ŵ^(n)| over all pieces: what a wrong q can do.
static double steepest(const sphv_profile *profile, int n)
{
    double largest = 0, factorial = 1;
    for (int i = 2; i <= n; i++) factorial *= i;
    for (int i = 0; i < profile->piece_count; i++)
        largest = fmax(largest, profile->pieces[i].derivative_bound[n] * factorial);
    return largest;
}

/// q on that side of every knot on which the squares are.
static double place(const sphv_profile *profile, double h, double square, double q)
{
    for (int i = 0; i < profile->knot_count; i++) {
        double knot = profile->knots[i].position.value, limit = knot * h;
        bool inside = square < limit * limit;
        if (inside && q >= knot) q = nextafter(knot, 0);
        if (!inside && q < knot) q = knot;
    }
    return q < profile->support ? q : nextafter(profile->support, 0);
}

/// \param slope sup |Ŵ^(n)|, n = 0 … 3
static struct radial radial_at(const sphv_profile *profile, const double slope[4], double q)
{
    sphv_result w[3];
    struct radial out = {{0, 0, 0}, {0, 0, 0}};
    sphv_profile_values(profile, q, w);
    double off = 6 * SPHV_U * q; // q is wrong by at most this
    double share = SPHV_RADIAL_ERROR * SPHV_U;
    out.p[0] = w[0].value;
    out.size[0] = fabs(w[0].value) + (w[0].bound + slope[1] * off) / share;
    if (q == 0) {
        out.p[1] = w[1].value == 0 ? w[2].value : 0;
        return out;
    }
    double p1 = w[1].value / q, second = w[2].value - p1;
    double p1_error = (w[1].bound + slope[2] * off) / q + 8 * SPHV_U * fabs(p1);
    out.p[1] = p1;
    out.p[2] = second / (q * q);
    out.size[1] = fabs(w[1].value) + p1_error * q / share;
    out.size[2] = fabs(second) +
                  (w[2].bound + slope[3] * off + p1_error + 14 * SPHV_U * fabs(second)) / share;
    return out;
}

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
            for (size_t f = 0; f < request->field_count; f++)
                sphv_sum_add(&sum[sphv_field_sum_index(layout, (int)f, k, j)],
                             term * (request->fields[f][b] - request->fields[f][a]), 0);
        }
    }
}

/// All sums at one particle.
static void sum_particle(const sphv_evaluation *evaluation, const double slope[4], size_t a,
                         struct accumulators *into)
{
    const sphv_particles *particles = evaluation->particles;
    const sphv_profile *profile = evaluation->request->profile;
    double h = evaluation->request->h, limit = (profile->support * h) * (profile->support * h);
    double unit = 1;
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
        if (!(square < limit)) continue;
        for (int i = 0; i < SPHV_DIMENSIONS; i++) s[i] = d[i] / h;
        struct radial radial =
            radial_at(profile, slope, place(profile, h, square, sqrt(square) / h));
        add_pair(evaluation, &radial, particles->volume[b] / unit, s, a, b, into->sum);
        into->neighbours++;
    }
}

sphv_status sphv_evaluate_brute_force(const sphv_evaluation *evaluation, sphv_error *error)
{
    size_t count = evaluation->particles->count, sums = (size_t)evaluation->layout.count;
    size_t blocks = (count + SPHV_BLOCK - 1) / SPHV_BLOCK, done = 0;
    double slope[4];
    for (int n = 0; n < 4; n++) slope[n] = steepest(evaluation->request->profile, n);
    // The result of a compensated sum is rounded once more.
    double rounding = sphv_summand_rounding(&evaluation->layout) + 2 * SPHV_U;
    sphv_status status = SPHV_OK;
#pragma omp parallel
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
                sum_particle(evaluation, slope, first + i, &at);
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
