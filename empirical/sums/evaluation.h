/// \file evaluation.h
/// What the routes of an evaluation share: the question, and blocks of sums on their way to the
/// methods.
#ifndef SPHVERIFY_EMPIRICAL_EVALUATION_H
#define SPHVERIFY_EMPIRICAL_EVALUATION_H

#include "sums.h"

enum { SPHV_BLOCK = 256 }; ///< particles whose sums are turned into estimates at a time

/// The question, checked, and where the answer goes.
typedef struct sphv_evaluation {
    const sphv_particles *particles;
    const sphv_request *request;
    sphv_sum_layout layout;
    const double *spread;   ///< max A − min A of each field
    const double *largest;  ///< max |A| of each field; for sphv_estimate_particles alone
    sphv_progress progress; ///< may be NULL
    void *context;
    sphv_estimates *out;
    /// Sees every block of sums before the methods do, from any thread; NULL but in tests.
    void (*watch)(void *watcher, const sphv_sum_block *block);
    void *watcher;
    const struct sphv_pass_set *passes; ///< of the direct route; NULL for the processor's best
} sphv_evaluation;

/// How far a pair of particles is apart in the eyes of every route: dx² (+ dy² (+ dz²)), each
/// operation rounded. A pair is in support when this is < (κh)², and within a knot k when it is
/// < (kh)², products rounded as well; ties are decided by these comparisons alone.
static inline double sphv_square(int dimension, const double d[SPHV_DIMENSIONS])
{
    double square = d[0] * d[0];
    for (int i = 1; i < dimension; i++) square += d[i] * d[i];
    return square;
}

/// What one thread needs to carry blocks from sums to estimates.
typedef struct sphv_worker {
    const sphv_evaluation *evaluation;
    sphv_sum_block block; ///< of at most SPHV_BLOCK particles; `sums` is written by the route
    size_t *particle;     ///< behind block.particle
    unsigned *neighbours; ///< behind block.neighbours
    double *rounding;     ///< behind block.rounding
    double *values;       ///< A at the block's particles
    bool valued;          ///< whether the route sets `values`; else they are looked up
    sphv_method_estimates *methods; ///< the results, with `rounding` of this thread
    double pairs, tested;
} sphv_worker;

sphv_status sphv_worker_make(sphv_worker *worker, const sphv_evaluation *evaluation);
/// Turns the block into estimates; the route has set particle, neighbours, rounding and sums.
void sphv_worker_finish_block(sphv_worker *worker, size_t first, size_t count);
/// Adds what the thread counted to the results, and frees it. Not to be called by two threads at
/// once.
void sphv_worker_free(sphv_worker *worker);

/// Counts one more of `all` pieces of work as done; tells the caller when the first thread did it.
void sphv_evaluation_advance(const sphv_evaluation *evaluation, size_t *done, size_t all);

/// Relative error of a summand: radial functions wrong by no more than SPHV_RADIAL_ERROR u of their
/// size (Σ v|p_k|q^k in the sums; what they are wrong by beyond that is part of the size), and the
/// roundings of V, δA and s^α.
#define SPHV_RADIAL_ERROR 16.0
double sphv_summand_rounding(const sphv_sum_layout *layout);

/// The routes. Each fills every array of the results.
sphv_status sphv_evaluate_brute_force(const sphv_evaluation *evaluation, sphv_error *error);
sphv_status sphv_evaluate_direct(const sphv_evaluation *evaluation, sphv_error *error);
sphv_status sphv_evaluate_convolution(const sphv_evaluation *evaluation, sphv_error *error);

/// Whether sums by convolution are possible, accurate, and faster than direct ones.
bool sphv_convolution_wins(const sphv_evaluation *evaluation);

#endif
