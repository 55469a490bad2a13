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
