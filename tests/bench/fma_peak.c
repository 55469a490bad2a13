/// Fused multiply-adds per second of one instruction set, in floating-point operations.
#include <time.h>

#include "../../empirical/sums/vector.h"

double FMA_PEAK(void);

double FMA_PEAK(void)
{
    enum { CHAINS = 12, STEPS = 4000000 };
    vec sum[CHAINS];
    volatile double sink = 0, factor = 0.999, term = 1e-9;
    const vec m = v_set(factor), c = v_set(term);
    for (int i = 0; i < CHAINS; i++) sum[i] = v_set(1.0 + i);
    clock_t start = clock();
    for (long k = 0; k < STEPS; k++)
        _Pragma("GCC unroll 12") for (int i = 0; i < CHAINS; i++) sum[i] = v_fma(sum[i], m, c);
    double seconds = (double)(clock() - start) / CLOCKS_PER_SEC, lanes[LANES];
    for (int i = 0; i < CHAINS; i++) {
        v_store(lanes, sum[i]);
        sink = sink + lanes[0];
    }
    return 2.0 * LANES * CHAINS * STEPS / seconds;
}
