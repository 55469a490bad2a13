/// \file report.h
/// Results as files and streams: JSON, CSV, Markdown, plots, the HTML report.
#ifndef SPHVERIFY_REPORT_H
#define SPHVERIFY_REPORT_H

#include <stdio.h>

#include "sphverify/check.h"
#include "sphverify/convergence.h"
#include "sphverify/scene.h"

/// A file written under a temporary name beside its final one, so that a failure leaves nothing
/// under the final name.
typedef struct sphv_output_file {
    FILE *stream;
    char *path, *temporary;
} sphv_output_file;

/// Opens directory/name for writing; makes the directory when it is missing.
sphv_status sphv_output_open(const char *directory, const char *name, sphv_output_file *out,
                             sphv_error *error) SPHV_MUST_CHECK;
/// Whether files can be written to a directory, made if it is missing: to be asked before long
/// work.
sphv_status sphv_output_check(const char *directory, sphv_error *error) SPHV_MUST_CHECK;

/// Flushes to disk, checks, and renames to the final name; removes the temporary on failure.
sphv_status sphv_output_commit(sphv_output_file *file, sphv_error *error) SPHV_MUST_CHECK;
/// Removes the temporary. Harmless after a commit.
void sphv_output_discard(sphv_output_file *file);

/// Draws a scene with gnuplot, run as a child: analytic as points, empirical as curves.
/// \param svg  receives the SVG text, for the caller to free
/// \return SPHV_RESOURCE_FAILURE when gnuplot is missing or fails
sphv_status sphv_plot_scene(const sphv_scene_result *result, char **svg,
                            sphv_error *error) SPHV_MUST_CHECK;

/// Draws a kernel: Ŵ, Ŵ′ and Ŵ″ over q, and its Fourier transform.
sphv_status sphv_plot_kernel(const sphv_kernel *kernel, char **svg,
                             sphv_error *error) SPHV_MUST_CHECK;

/// Draws a figure of a convergence scene: measured as curves, predicted as hollow points.
/// \param plot index
sphv_status sphv_plot_rates(const sphv_convergence_result *result, size_t plot, char **svg,
                            sphv_error *error) SPHV_MUST_CHECK;

/// Writes every norm of every quantity by every scheme at every level as CSV, 17 significant
/// digits.
void sphv_convergence_csv(FILE *stream, const sphv_convergence_result *result);

/// Writes the points of a scene as CSV, 17 significant digits.
void sphv_scene_csv(FILE *stream, const sphv_scene_result *result);

/// Everything the report shows.
typedef struct sphv_report {
    size_t kernel_count, scene_count;
    sphv_kernel **kernels;
    sphv_agreement **agreements; ///< per kernel, NULL where it is not legal in one dimension
    sphv_check_report *checks;   ///< per kernel; NULL when the kernels were not checked
    sphv_scene_result **scenes;
    size_t convergence_count;
    sphv_convergence_result **convergences;
    sphv_verdict verdict;
    double seconds;
} sphv_report;

/// Writes index.html, report.json and report.md into a directory.
/// \param plots_missing receives whether gnuplot was missing; the report then says so
sphv_status sphv_report_write(const sphv_report *report, const char *directory, bool *plots_missing,
                              sphv_error *error) SPHV_MUST_CHECK;

#endif
