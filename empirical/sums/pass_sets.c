#include <stddef.h>

#include "../processor.h"
#include "pass.h"

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
    return all + sphv_processor_lacks();
}
