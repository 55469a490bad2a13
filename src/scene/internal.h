/// \file internal.h
/// Shared inside the scene runner only.
#ifndef SPHVERIFY_SCENE_INTERNAL_H
#define SPHVERIFY_SCENE_INTERNAL_H

#include "sphverify/scene.h"

/// n when Δs = 2κ/(2n+1) to rounding, else −1.
long sphv_special_n(const sphv_profile *profile, sphv_number spacing);

/// Evaluates the paper's form beside a measured point and compares the two.
sphv_status sphv_compare_paper(const sphv_profile *profile, double h, sphv_number spacing,
                               const sphv_measurement *measured, sphv_prediction *paper,
                               sphv_verdict *verdict, sphv_error *error) SPHV_MUST_CHECK;

/// Δx/h of a curve over h: constant, or following a power of h.
sphv_number sphv_curve_spacing(const sphv_scene *scene, const sphv_curve *curve, double h);

#endif
