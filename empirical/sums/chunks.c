#include "chunks.h"

#include <math.h>

#include "../clones.h"

enum {
    MOST = 64,
    LEAST = 8192 ///< particles that waking a thread is worth
};

size_t sphv_chunks(size_t count)
{
    size_t chunks = count / LEAST;
    return chunks < 1 ? 1 : chunks < MOST ? chunks : MOST;
}

/// One chunk's.
SPHV_CLONES static sphv_span span_of(const double *values, size_t count)
{
    double low = INFINITY, high = -INFINITY, rest = 0; // x − x is 0 where x is finite, else NaN
#pragma omp simd reduction(min : low) reduction(max : high) reduction(+ : rest)
    for (size_t i = 0; i < count; i++) {
        low = values[i] < low ? values[i] : low;
        high = values[i] > high ? values[i] : high;
        rest += values[i] - values[i];
    }
    return (sphv_span){low, high, rest == 0};
}

sphv_span sphv_span_of(const double *values, size_t count)
{
    size_t chunks = sphv_chunks(count);
    sphv_span all = {INFINITY, -INFINITY, true};
#pragma omp parallel for schedule(static) if (chunks > 1)
    for (size_t c = 0; c < chunks; c++) {
        size_t from = sphv_chunk_begin(count, chunks, c);
        sphv_span part = span_of(values + from, sphv_chunk_begin(count, chunks, c + 1) - from);
#pragma omp critical(sphv_span)
        {
            all.low = fmin(all.low, part.low);
            all.high = fmax(all.high, part.high);
            all.finite = all.finite && part.finite;
        }
    }
    return all;
}
