#include <math.h>

#include "sphverify/compare.h"

const char *sphv_verdict_name(sphv_verdict verdict)
{
    static const char *const names[] = {"agrees", "disagrees", "inconclusive"};
    return names[verdict];
}

sphv_verdict sphv_verdict_worse(sphv_verdict a, sphv_verdict b)
{
    static const int badness[] = {[SPHV_AGREES] = 0, [SPHV_INCONCLUSIVE] = 1, [SPHV_DISAGREES] = 2};
    return badness[a] >= badness[b] ? a : b;
}

sphv_verdict sphv_compare(sphv_result analytic, sphv_result empirical, double scale)
{
    double difference = fabs(analytic.value - empirical.value);
    double bound = analytic.bound + empirical.bound;
    if (!isfinite(difference) || !isfinite(bound)) return SPHV_INCONCLUSIVE;
    if (difference > bound) return SPHV_DISAGREES;
    return bound <= 0.01 * fabs(scale) ? SPHV_AGREES : SPHV_INCONCLUSIVE;
}

double sphv_norm_interval(double rmse, double bound, sphv_rigour rigour, size_t count,
                          size_t neighbours, double scatter)
{
    if (rigour != SPHV_RIGOUR_STATISTICAL) return bound;
    return bound + 3.29 * fmin(scatter, rmse * sqrt((double)neighbours / (2 * (double)count)));
}

sphv_verdict sphv_compare_norm(sphv_result analytic, sphv_rigour rigour, double rmse, double bound,
                               size_t count, size_t neighbours, double scatter, double scale)
{
    // A realisation of few particles may be much better than expected.
    double larger = analytic.value > rmse ? analytic.value : rmse;
    sphv_result empirical = {rmse,
                             sphv_norm_interval(larger, bound, rigour, count, neighbours, scatter)};
    // A realisation knows a root mean square to 20 % at best; a larger error of theory must not go
    // unnoticed.
    if (rigour == SPHV_RIGOUR_STATISTICAL) scale = 20 * rmse;
    return sphv_compare(analytic, empirical, scale);
}
