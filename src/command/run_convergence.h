/// \file run_convergence.h
/// What `run` does with a convergence scene's results.
#ifndef SPHVERIFY_COMMAND_RUN_CONVERGENCE_H
#define SPHVERIFY_COMMAND_RUN_CONVERGENCE_H

#include "sphverify/report.h"

/// The tables and claims as text on stdout.
void sphv_print_convergence(const sphv_convergence_result *result);

/// Writes a plot to a file and frees it; where it could not be drawn, fails with the reason and
/// with what can be had without.
sphv_status sphv_write_drawn(sphv_status drawn, char *svg, const sphv_error *reason,
                             const char *directory, const char *name,
                             sphv_error *error) SPHV_MUST_CHECK;

/// Writes SCENE.csv and, with `plots`, SCENE-FIGURE.svg for each of its figures.
sphv_status sphv_write_convergence(const sphv_convergence_result *result, const char *directory,
                                   bool plots, sphv_error *error) SPHV_MUST_CHECK;

#endif
