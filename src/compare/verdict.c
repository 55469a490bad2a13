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

sphv_verdict sphv_compare_norm(sphv_result analytic, sphv_rigour rigour, double rmse, double bound,
                               size_t count, size_t neighbours, double scale)
{
    sphv_result empirical = {rmse, bound};
    if (rigour == SPHV_RIGOUR_STATISTICAL) {
        // Half of the 99.9 % interval over one realisation.
        empirical.bound += 3.29 * rmse * sqrt((double)neighbours / (2 * (double)count));
        // A realisation knows a root mean square to 20 % at best; a larger error of theory must not
        // go unnoticed.
        scale = 20 * rmse;
    }
    return sphv_compare(analytic, empirical, scale);
}
