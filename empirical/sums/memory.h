/// \file memory.h
/// Arrays as long as there are particles.
#ifndef SPHVERIFY_EMPIRICAL_MEMORY_H
#define SPHVERIFY_EMPIRICAL_MEMORY_H

#include <stddef.h>

/// Zeroed memory for `count` things, to be released with free. Large arrays ask for large pages: at
/// twenty neighbours a particle a seventh of the time went into the system handing out small ones.
/// \return NULL without memory, and for sizes that overflow
void *sphv_array(size_t count, size_t size);

/// The same without zeros, for arrays that are written before they are read.
void *sphv_room(size_t count, size_t size);

#endif
