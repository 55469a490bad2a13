/// \file oracle_internal.h
/// What the oracle's reading of a kernel file and its mathematics share.
#ifndef SPHVERIFY_TESTS_ORACLE_INTERNAL_H
#define SPHVERIFY_TESTS_ORACLE_INTERNAL_H

#include <stddef.h>

#include "oracle.h"

enum { BITS = 320, PIECES = 32, DEGREE = 48, SERIES = 160 };

typedef enum shape { PIECEWISE, GAUSSIAN, SUPER_GAUSSIAN, DOUBLE_COSINE, SINC } shape;

struct oracle {
    char name[80];
    shape shape;
    int exponent;
    mpq_t support;
    int pieces, degree[PIECES];
    mpq_t until[PIECES], coefficient[PIECES][DEGREE + 1];
    mpfr_t constant;  ///< C_1
    mpfr_t transform; ///< a of w(1 − a q²), 0 without a transform
    bool transformed;
    mpfr_t series[SERIES]; ///< S(q)^m = Σ series[k] (πq/κ)^(2k)
    mpq_t spacing;         ///< of the slopes kept, 0 without any
    mpfr_t *slope;         ///< [j]: Ŵ′ at (j + 1) spacings
    size_t slope_count;
};

/// Fills `series` of a power of the sinc function.
void oracle_sinc_series(oracle *kernel);

/// Finds C_1, and the transform where there is one. \return false when C_1 is not positive
bool oracle_normalise(oracle *kernel);

void oracle_forget_slopes(oracle *kernel);

#endif
