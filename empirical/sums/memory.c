#include "memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef __linux__
#include <sys/mman.h>
#endif

void *sphv_array(size_t count, size_t size)
{
    if (count == 0) count = 1;
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    const size_t page = (size_t)2 << 20;
    if (count <= (SIZE_MAX - page) / size && count * size >= 2 * page) {
        size_t bytes = (count * size + page - 1) / page * page;
        void *array = aligned_alloc(page, bytes);
        if (!array) return NULL;
        (void)madvise(array, bytes, MADV_HUGEPAGE); // a wish: without it the array is as good
        return memset(array, 0, bytes);
    }
#endif
    return calloc(count, size);
}
