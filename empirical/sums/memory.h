/// \file memory.h
/// Arrays as long as there are particles.
#ifndef SPHVERIFY_EMPIRICAL_MEMORY_H
#define SPHVERIFY_EMPIRICAL_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

/// Zeroed memory for `count` things, to be released with free. Large arrays ask for large pages: at
/// twenty neighbours a particle a seventh of the time went into the system handing out small ones.
/// \return NULL without memory, and for sizes that overflow
void *sphv_array(size_t count, size_t size);

/// The same without zeros, for arrays that are written before they are read.
void *sphv_room(size_t count, size_t size);

/// Memory that arrays are cut from one after the other, so that many of middling size get large
/// pages together. Without memory the cuts are measured only.
typedef struct sphv_bolt {
    char *memory; ///< NULL, or as many bytes as all cuts took when they were measured
    size_t used;  ///< bytes; SIZE_MAX where they overflow
} sphv_bolt;

/// \return room for `count` things; NULL while measuring
void *sphv_cut(sphv_bolt *bolt, size_t count, size_t size);

/// Gets the memory that was measured, and starts over. \return whether there was enough
bool sphv_bolt_buy(sphv_bolt *bolt);

#endif
