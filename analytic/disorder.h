/// \file disorder.h
/// The sums behind each method as random vectors, and what an estimate makes of them.
#ifndef SPHVERIFY_ANALYTIC_DISORDER_H
#define SPHVERIFY_ANALYTIC_DISORDER_H

#include "internal.h"

enum { SPHV_SUMS_MAX = 16 };

/// Mean and covariance of a method's sums Z = Σ_b z(s_b) V_b/h.
typedef struct sphv_sums {
    int count;
    double mean[SPHV_SUMS_MAX];
    double covariance[SPHV_SUMS_MAX][SPHV_SUMS_MAX];
} sphv_sums;

/// Where the support ends: without a perturbation a particle can stand on the edge itself, where W
/// = 0 already, and rounding of its place must not decide that.
double sphv_disorder_reach(const sphv_experiment *experiment);

/// How many sums a method needs.
int sphv_sums_count(sphv_method method);

/// The summands z of one neighbour at signed offset s.
void sphv_sums_summand(sphv_method method, const sphv_profile *profile, double K, sphv_phase phase,
                       double s, double *z);

/// What the method divides by: the determinant of its moment matrix.
double sphv_sums_denominator(sphv_method method, const double *sums);

/// The error of the gradient, divided by max|A′|, that the method makes of its sums.
double sphv_sums_error(sphv_method method, double K, sphv_phase phase, const double *sums);

/// Mean and covariance given the particle's own perturbation, when volumes are Δx or tessellated:
/// exact but for the quadrature over each neighbour's perturbation and for particles that swap.
/// \param own the particle's own perturbation, in units of σ
/// \param nodes, weights, node_count quadrature for the standard normal distribution
void sphv_sums_conditional(const sphv_experiment *experiment, double K, sphv_phase phase,
                           double own, const double *nodes, const double *weights, int node_count,
                           sphv_sums *out);

/// Mean on the lattice and covariance to first order in σ, for any volume rule: σ² Σ_j ∂Z/∂x_j
/// ∂Z/∂x_jᵀ, the particle's own perturbation included.
void sphv_sums_first_order(const sphv_experiment *experiment, double K, sphv_phase phase,
                           sphv_sums *out);

/// Mean and covariance by the main effect of each particle's perturbation, for density volumes:
/// each is moved alone, by every node of the quadrature, and what two do together is neglected.
/// Exact to second order in σ for the mean and to first for the covariance. \return false without
/// memory
bool sphv_sums_main_effects(const sphv_experiment *experiment, double K, sphv_phase phase,
                            const double *nodes, const double *weights, int node_count,
                            sphv_sums *out);

/// What a method makes of random sums.
typedef struct sphv_mean_square {
    double value;       ///< E[error²], to second order in the sums' fluctuations
    double linear;      ///< the same by linearisation about the mean
    double fluctuation; ///< relative variance of the denominator
} sphv_mean_square;

/// E[error²] of a method whose sums have this mean and covariance.
sphv_mean_square sphv_sums_mean_square(sphv_method method, double K, sphv_phase phase,
                                       const sphv_sums *sums);

#endif
