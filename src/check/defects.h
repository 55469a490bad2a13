/// \file defects.h
/// Mistakes that people make in kernel files, as changes of a loaded kernel: one row each.
#ifndef SPHVERIFY_CHECK_DEFECTS_H
#define SPHVERIFY_CHECK_DEFECTS_H

#include "check_internal.h"

/// What became of applying a defect.
typedef enum sphv_application {
    SPHV_NO_MORE,  ///< there is no such variant, nor any further one
    SPHV_NOT_HERE, ///< this variant means nothing for this kernel; a further one may
    SPHV_APPLIED,
} sphv_application;

/// One kind of defect.
typedef struct sphv_defect {
    const char *id;
    const char *meaning;
    /// Words of which one must stand in the cause for it to count as named; separated by `|`.
    const char *cause;
    /// Changes a kernel that has not been compiled.
    /// \param variant 0, 1, 2 …: which coefficient, knot or dimension
    sphv_application (*apply)(sphv_kernel *kernel, int variant);
} sphv_defect;

/// The tables, each ended by a row without an id: defects of the shape, of the file's claims and
/// closed form, and of its gradient.
extern const sphv_defect sphv_shape_defects[], sphv_claim_defects[], sphv_gradient_defects[];

/// A copy to spoil, with everything that a file says and nothing that is computed from it.
/// \return NULL without memory
sphv_kernel *sphv_defect_copy(const sphv_kernel *from);

/// Gives a kernel of pieces its right gradient, unless it has one.
/// \return false when it has none to give
bool sphv_defect_give_gradient(sphv_kernel *kernel);

/// Do two kernels differ by more than rounding (1e-14 of the largest value, or a claim)?
bool sphv_defect_changes(const sphv_kernel *sound, const sphv_kernel *faulty);

/// Finds coefficient number `index` among those of all pieces that are not zero; NULL beyond them.
mpq_t *sphv_defect_coefficient(sphv_exact_pieces *pieces, int index);

/// Multiplies a rational, or whole pieces, by a fraction.
void sphv_defect_scale(mpq_t value, long numerator, unsigned long denominator);
void sphv_defect_scale_all(sphv_exact_pieces *pieces, long numerator, unsigned long denominator);

/// Replaces a rational by its value printed with so many significant digits.
void sphv_defect_round(mpq_t value, int digits);
/// Rounds every coefficient to so many digits; 0: to single precision.
void sphv_defect_round_all(sphv_exact_pieces *pieces, int digits);

#endif
