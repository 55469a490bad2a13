#include "memory.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef __linux__
#include <sys/mman.h>
#endif

static const size_t PAGE = (size_t)2 << 20, LINE = 64;

#if defined(__linux__) && defined(MADV_HUGEPAGE)
/// Whether an array is worth large pages, and small enough to be rounded up to them.
static bool is_large(size_t count, size_t size)
{
    return count <= (SIZE_MAX - PAGE) / size && count * size >= PAGE / 2;
}

/// Touches every large page, so that the system hands each out once: threads that happen to touch a
/// new page at the same time would both have it cleared.
static void touch(char *array, size_t bytes)
{
#pragma omp parallel for schedule(static) if (bytes > PAGE)
    for (size_t at = 0; at < bytes; at += PAGE) *(volatile char *)(array + at) = 0;
}
#endif

void *sphv_room(size_t count, size_t size)
{
    if (count == 0) count = 1;
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (is_large(count, size)) {
        size_t bytes = (count * size + PAGE - 1) / PAGE * PAGE;
        void *array = aligned_alloc(PAGE, bytes);
        // a wish: without it the array is as good
        if (array) (void)madvise(array, bytes, MADV_HUGEPAGE);
        if (array) touch(array, bytes);
        return array;
    }
#endif
    if (count > (SIZE_MAX - LINE) / size) return NULL;
    return aligned_alloc(LINE, (count * size + LINE - 1) / LINE * LINE);
}

void *sphv_array(size_t count, size_t size)
{
    void *array = sphv_room(count, size);
    if (array) memset(array, 0, (count ? count : 1) * size);
    return array;
}

void *sphv_arena_take(sphv_arena *arena, size_t count, size_t size)
{
    const size_t from = arena->used;
    if (from > SIZE_MAX - LINE || count > (SIZE_MAX - LINE - from) / size) {
        arena->used = SIZE_MAX;
        return NULL;
    }
    arena->used += (count * size + LINE - 1) / LINE * LINE;
    return arena->memory ? arena->memory + from : NULL;
}

bool sphv_arena_reserve(sphv_arena *arena)
{
    arena->memory = arena->used < SIZE_MAX ? sphv_room(arena->used, 1) : NULL;
    arena->used = 0;
    return arena->memory != NULL;
}
