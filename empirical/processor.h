/// \file processor.h
/// Some files are compiled once for each of several instruction sets: AVX-512, AVX2 with FMA, and
/// what every processor has, where the build knows the first two (SPHV_X86_PASSES).
#ifndef SPHVERIFY_EMPIRICAL_PROCESSOR_H
#define SPHVERIFY_EMPIRICAL_PROCESSOR_H

/// How many of these sets, best first, this processor lacks.
int sphv_processor_lacks(void);

#endif
