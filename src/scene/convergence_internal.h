/// \file convergence_internal.h
/// Shared inside the runner of convergence scenes only.
#ifndef SPHVERIFY_CONVERGENCE_INTERNAL_H
#define SPHVERIFY_CONVERGENCE_INTERNAL_H

#include "sphverify/convergence.h"

enum { SPHV_SCHEMES_MAX = 40, SPHV_RATE_FIELDS_MAX = 8 };

/// Predicts what theory can of what was measured, and compares the two.
sphv_status sphv_convergence_predict(sphv_convergence_result *result, sphv_progress progress,
                                     void *context, sphv_error *error) SPHV_MUST_CHECK;

/// Judges the table, the printed levels and the claims, once everything is measured and predicted;
/// whatever was judged before is forgotten.
void sphv_convergence_judge(sphv_convergence_result *result);

#endif
