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

/// Compiled into its callers, and so for their processors.
#define SPHV_INLINE static inline __attribute__((always_inline))

#endif
