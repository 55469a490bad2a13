#include "pass.h"

#include <stddef.h>

extern const sphv_pass_set sphv_passes_plain;
#ifdef SPHV_X86_PASSES
extern const sphv_pass_set sphv_passes_avx512, sphv_passes_avx2;
#endif

const sphv_pass_set *const *sphv_pass_sets(void)
{
    static const sphv_pass_set *const all[] = {
#ifdef SPHV_X86_PASSES
        &sphv_passes_avx512, &sphv_passes_avx2,
#endif
        &sphv_passes_plain, NULL};
#ifdef SPHV_X86_PASSES
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw"))
        return all;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return all + 1;
    return all + 2;
#else
    return all;
#endif
}
