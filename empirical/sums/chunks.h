/// \file chunks.h
/// Loops over all particles, shared between threads in chunks that do not depend on their number.
#ifndef SPHVERIFY_EMPIRICAL_CHUNKS_H
#define SPHVERIFY_EMPIRICAL_CHUNKS_H

#include <stdbool.h>
#include <stddef.h>

/// How many chunks so many particles are worth, 1 at least; more than one deserve threads.
size_t sphv_chunks(size_t count);

/// First particle of a chunk; the next one's ends it.
static inline size_t sphv_chunk_begin(size_t count, size_t chunks, size_t chunk)
{
    size_t more = count % chunks;
    return count / chunks * chunk + (more < chunk ? more : chunk);
}

/// What some numbers lie between; of none at all, ∞ … −∞.
typedef struct sphv_span {
    double low, high;
    bool finite; ///< every one of them; else low and high may be anything
} sphv_span;

sphv_span sphv_span_of(const double *values, size_t count);

#endif
