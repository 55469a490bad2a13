/// \file clones.h
/// One binary for every processor: a function marked SPHV_CLONES is compiled several times over and
/// the fastest that the machine can run is taken when the program starts.
#ifndef SPHVERIFY_EMPIRICAL_CLONES_H
#define SPHVERIFY_EMPIRICAL_CLONES_H

// The choice runs before a sanitizer is ready, so its builds have one version.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) &&   \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SPHV_CLONES __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define SPHV_CLONES
#endif

/// Leaves the wide registers clean, as every function that used them should. gcc 12 forgets it on
/// some paths, and all older instructions after that are up to ten times slower.
static inline void sphv_leave_wide_registers(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
    if (__builtin_cpu_supports("avx")) __asm__ volatile("vzeroupper");
#endif
}

/// Compiled into its callers, and so for their processors.
#define SPHV_INLINE static inline __attribute__((always_inline))

#endif
