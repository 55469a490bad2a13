/// \file disorder_support.h
/// What the tests of the theory of disorder share: an experiment, random numbers and quadrature of
/// their own.
#ifndef SPHVERIFY_TESTS_DISORDER_SUPPORT_H
#define SPHVERIFY_TESTS_DISORDER_SUPPORT_H

#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>
#include <math.h>

#include "../../analytic/disorder.h"
#include "support.h"

static inline sphv_experiment experiment(const sphv_profile *profile, sphv_method method,
                                         sphv_volume volume, double sigma, double spacing, double h)
{
    return (sphv_experiment){.profile = profile,
                             .h = h,
                             .spacing = sphv_number_from_double(spacing),
                             .method = method,
                             .layout = SPHV_PERTURBED,
                             .volume = volume,
                             .sigma = sigma,
                             .seed = 1,
                             .width = 0.1,
                             .realisations_min = 2,
                             .realisations_max = 2};
}

/// A standard normal number of the test's own.
static inline double normal(void)
{
    return sqrt(-2 * log(1 - random_uniform(0, 1))) * cos(2 * M_PI * random_uniform(0, 1));
}

enum { MOST_NODES = 16, MANY_NODES = 64 };

/// Gauss and Hermite's rule for the standard normal distribution.
static inline void rule(int count, double *nodes, double *weights)
{
    gsl_integration_fixed_workspace *w =
        gsl_integration_fixed_alloc(gsl_integration_fixed_hermite, (size_t)count, 0, 0.5, 0, 0);
    assert_non_null(w);
    for (int i = 0; i < count; i++) {
        nodes[i] = gsl_integration_fixed_nodes(w)[i];
        weights[i] = gsl_integration_fixed_weights(w)[i] / sqrt(2 * M_PI);
    }
    gsl_integration_fixed_free(w);
}

static inline void conditional(const sphv_experiment *of, double K, sphv_phase phase, double own,
                               int count, sphv_sums *out)
{
    double nodes[MANY_NODES], weights[MANY_NODES];
    rule(count, nodes, weights);
    sphv_sums_conditional(of, K, phase, own, nodes, weights, count, out);
}

#endif
