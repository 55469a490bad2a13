/// \file internal.h
/// Shared inside the empirical half only.
#ifndef SPHVERIFY_EMPIRICAL_INTERNAL_H
#define SPHVERIFY_EMPIRICAL_INTERNAL_H

#include <float.h>
#include <math.h>

#include "sphverify/measure.h"

static const double SPHV_U = DBL_EPSILON / 2; ///< unit roundoff

/// A compensated sum (Neumaier 1974) with a running bound of all errors fed into it.
typedef struct sphv_sum {
    double value, lost, bound;
} sphv_sum;

/// Adds a term that is itself uncertain by `uncertainty`.
static inline void sphv_sum_add(sphv_sum *sum, double term, double uncertainty)
{
    double next = sum->value + term;
    sum->lost +=
        fabs(sum->value) >= fabs(term) ? (sum->value - next) + term : (term - next) + sum->value;
    sum->value = next;
    // The lost parts are added in plain arithmetic: second order in u, covered by 4u² per term.
    sum->bound += uncertainty + 4 * SPHV_U * SPHV_U * fabs(next);
}

static inline sphv_result sphv_sum_result(const sphv_sum *sum)
{
    double value = sum->value + sum->lost;
    return (sphv_result){value, sum->bound * (1 + 1e-10) + SPHV_U * fabs(value)};
}

#endif
