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

/// Memory that arrays are taken from one after the other, so that many of middling size get large
/// pages together. All are taken twice: before there is memory, that only measures.
typedef struct sphv_arena {
    char *memory; ///< NULL, or as many bytes as were measured
    size_t used;  ///< bytes; SIZE_MAX where they overflow
} sphv_arena;

/// \return room for `count` things; NULL while measuring
void *sphv_arena_take(sphv_arena *arena, size_t count, size_t size);

/// Gets the memory that was measured, and starts over. \return whether there was enough
bool sphv_arena_reserve(sphv_arena *arena);

#endif
