/// \file families.h
/// Kernels that are closed forms rather than polynomial pieces: one row of one table each.
#ifndef SPHVERIFY_CORE_FAMILIES_H
#define SPHVERIFY_CORE_FAMILIES_H

#include <stdbool.h>

#include "sphverify/status.h"

struct sphv_family;

/// A closed form with its parameters: w(q) on 0 ≤ q < support, times `scale`, and times
/// (1 − transform·q²) for the fourth-order transform.
typedef struct sphv_form {
    const struct sphv_family *family;
    int dimension;
    int exponent; ///< m of sinc^m
    double support;
    double scale;           ///< normalisation constant once it is known, 1 before
    double scale_error;     ///< relative error of `scale`
    double support_error;   ///< |κ − support|, not 0 where κ is not a double
    double transform;       ///< a of w(q)(1 − a q²); 0 without a transform
    double transform_error; ///< relative error of `transform`
} sphv_form;

/// One family.
typedef struct sphv_family {
    const char *name;
    const char *formula;
    bool needs_exponent;
    /// The kernel is infinite by nature and cut at κ; its constant is that of the whole.
    bool truncated;
    /// Jets carry relative accuracy, so a tiny value at κ is a value, not rounding.
    bool relative_accuracy;
    /// w, w′ and w″ at q (without scale and transform) with rounding bounds.
    void (*values)(const sphv_form *form, double q, sphv_result out[3]);
    /// Taylor coefficients of w (without scale and transform) about q.
    void (*jet)(const sphv_form *form, double q, int order, double *jet);
    /// A bound of sup |w^(n)|/n! over the support.
    double (*derivative_bound)(const sphv_form *form, int n);
} sphv_family;

/// The table, ended by a row without a name.
extern const sphv_family sphv_families[];

const sphv_family *sphv_family_find(const char *name);

/// Value, first and second derivative of scale · w(q)(1 − transform·q²), with rounding bounds.
void sphv_form_values(const sphv_form *form, double q, sphv_result out[3]);

/// Taylor coefficients of scale · w(q)(1 − transform·q²).
void sphv_form_jet(const sphv_form *form, double q, int order, double *jet);

/// Bound of sup |Ŵ^(n)|/n! of the same.
double sphv_form_derivative_bound(const sphv_form *form, int n);

#endif
