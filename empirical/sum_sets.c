#include "sums/sums.h"

const sphv_sum_set sphv_sum_sets[SPHV_SUM_LEVELS] = SPHV_SUM_SETS;

sphv_sum_level sphv_method_level(sphv_method method)
{
    switch (method) {
    case SPHV_SPH:
    case SPHV_SPH_DIFFERENCE:
    case SPHV_SHEPARD:
    case SPHV_RKPM_0:
        return SPHV_SUMS_STANDARD;
    case SPHV_BONET_LOK:
    case SPHV_CSPM:
    case SPHV_FPM:
        return SPHV_SUMS_FIRST;
    case SPHV_RKPM:
        return SPHV_SUMS_REPRODUCING;
    case SPHV_MSPH:
        return SPHV_SUMS_SECOND;
    case SPHV_RKPM_2:
        break;
    }
    return SPHV_SUMS_ALL;
}

static bool contains(const sphv_degrees *outer, const sphv_degrees *inner)
{
    return inner->from > inner->to || (outer->from <= inner->from && inner->to <= outer->to);
}

static bool covers(sphv_sum_level level, sphv_sum_level wanted)
{
    const sphv_sum_set *outer = &sphv_sum_sets[level], *inner = &sphv_sum_sets[wanted];
    for (int k = 0; k < 3; k++)
        if (!contains(&outer->moment[k], &inner->moment[k]) ||
            !contains(&outer->field[k], &inner->field[k]))
            return false;
    return true;
}

sphv_sum_level sphv_request_level(const sphv_request *request)
{
    int level = SPHV_SUMS_STANDARD;
    for (bool all = false; !all && level < SPHV_SUMS_ALL;) {
        all = true;
        for (size_t m = 0; m < request->method_count; m++)
            all = all && covers((sphv_sum_level)level, sphv_method_level(request->methods[m]));
        if (!all) level++;
    }
    return (sphv_sum_level)level;
}

/// Number of monomials with these degrees.
static int terms(int dimension, const sphv_degrees *degrees)
{
    if (degrees->from > degrees->to) return 0;
    return (int)(sphv_monomial_count(dimension, degrees->to) -
                 sphv_monomial_count(dimension, degrees->from - 1));
}

sphv_sum_layout sphv_sum_layout_make(int dimension, sphv_sum_level level, int fields)
{
    const sphv_sum_set *set = &sphv_sum_sets[level];
    sphv_sum_layout layout = {.dimension = dimension, .level = level};
    for (int k = 0; k < 3; k++) {
        int moments = terms(dimension, &set->moment[k]), sums = terms(dimension, &set->field[k]);
        layout.moment_at[k] = moments ? layout.moments : -1;
        layout.field_at[k] = sums ? layout.per_field : -1;
        layout.first_monomial[k] = (int)sphv_monomial_count(dimension, set->moment[k].from - 1);
        layout.first_field_monomial[k] =
            (int)sphv_monomial_count(dimension, set->field[k].from - 1);
        layout.moments += moments;
        layout.per_field += sums;
    }
    layout.size_at = layout.moments;
    layout.count = layout.moments + 3 + fields * layout.per_field;
    return layout;
}
