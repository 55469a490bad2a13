#include "random.h"

#include <Random123/philox.h>
#include <gsl/gsl_math.h>

static philox4x32_ctr_t philox(uint64_t seed, int stream, long index)
{
    philox4x32_ctr_t counter = {{(uint32_t)(uint64_t)index, (uint32_t)((uint64_t)index >> 32),
                                 (uint32_t)stream, 0x53504856u}};
    philox4x32_key_t key = {{(uint32_t)seed, (uint32_t)(seed >> 32)}};
    return philox4x32(counter, key);
}

/// A number in (0, 1): 52 random bits, shifted by half a step so that 0 and 1 cannot occur.
static double unit_interval(uint32_t high, uint32_t low)
{
    uint64_t bits = ((uint64_t)high << 32 | low) >> 12;
    return ((double)bits + 0.5) * 0x1p-52;
}

double sphv_uniform(uint64_t seed, int stream, long index)
{
    philox4x32_ctr_t random = philox(seed, stream, index);
    return unit_interval(random.v[0], random.v[1]);
}

double sphv_normal(uint64_t seed, int stream, long index)
{
    philox4x32_ctr_t random = philox(seed, stream, index);
    return sqrt(-2 * log(unit_interval(random.v[0], random.v[1]))) *
           cos(2 * M_PI * unit_interval(random.v[2], random.v[3]));
}
