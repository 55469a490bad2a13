/// \file methods_support.h
/// Sums at one particle by the plainest of loops, handed to the methods under test; and the same
/// estimates in long double from the methods' definitions, neighbour by neighbour.
#ifndef SPHVERIFY_TESTS_METHODS_SUPPORT_H
#define SPHVERIFY_TESTS_METHODS_SUPPORT_H

#include <string.h>

#include "../../empirical/sums/sums.h"
#include "support.h"

enum { CLOUD_MOST = 400 };

/// Particles in the unit box, the first few on its corners and edges.
struct cloud {
    int dimension, count;
    double h;
    double x[CLOUD_MOST][SPHV_DIMENSIONS], volume[CLOUD_MOST];
    double field[2][CLOUD_MOST];
    int fields; ///< 0 counts as 1
};

/// Disordered particles, positions multiples of 2^−8, and h a power of two with enough neighbours
/// for every method at most particles.
void scatter(int dimension, double support, struct cloud *out);

/// The estimates at one particle; `rounding` of the first field.
struct single {
    double estimate[SPHV_QUANTITIES_MAX], rounding[SPHV_QUANTITIES_MAX];
    double second[SPHV_QUANTITIES_MAX]; ///< of the second field
    double condition;
    sphv_fault fault;
    unsigned neighbours;
};

void estimate_at(const sphv_profile *profile, sphv_method method, const struct cloud *cloud, int a,
                 struct single *out);
void estimate_at_level(const sphv_profile *profile, sphv_method method, const struct cloud *cloud,
                       int a, sphv_sum_level level, struct single *out);

/// In long double, kernel values those of the profile.
void reference_at(const sphv_profile *profile, sphv_method method, const struct cloud *cloud, int a,
                  long double out[SPHV_QUANTITIES_MAX]);

#endif
