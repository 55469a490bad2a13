/// \file plot.h
/// What the plots share: their look, and running gnuplot.
#ifndef SPHVERIFY_REPORT_PLOT_H
#define SPHVERIFY_REPORT_PLOT_H

#include "sphverify/report.h"

/// How a curve is drawn: Okabe and Ito's colours, which colour-blind readers can tell apart, each
/// with its own dashes and point shape for print without colour.
typedef struct sphv_plot_style {
    const char *colour;
    const char *dash;   ///< gnuplot's dashtype
    int filled, hollow; ///< gnuplot's point types
} sphv_plot_style;

const sphv_plot_style *sphv_plot_style_of(size_t curve);

/// A gnuplot script being written.
typedef struct sphv_plot_script {
    FILE *stream;
    char *text;
    size_t size;
} sphv_plot_script;

/// Begins a script with terminal and style.
/// \param width, height of the picture in its own units; text is 17 high
sphv_status sphv_plot_begin(sphv_plot_script *script, int width, int height,
                            sphv_error *error) SPHV_MUST_CHECK;

/// Logarithmic horizontal axis with tics at 1, 2, 5 where they have room, else at decades.
void sphv_plot_log_axis(FILE *script, char axis, double from, double to);

/// Ends the script, runs gnuplot, and embeds its picture.
/// \param id, title see sphv_svg_embed
sphv_status sphv_plot_finish(sphv_plot_script *script, const char *id, const char *title,
                             char **svg, sphv_error *error) SPHV_MUST_CHECK;

/// sphv_plot_scene, sphv_plot_rates and sphv_plot_kernel with the prefix of the ids in the picture.
sphv_status sphv_plot_scene_as(const sphv_scene_result *result, const char *id, char **svg,
                               sphv_error *error) SPHV_MUST_CHECK;
sphv_status sphv_plot_rates_as(const sphv_convergence_result *result, size_t plot, const char *id,
                               char **svg, sphv_error *error) SPHV_MUST_CHECK;
sphv_status sphv_plot_kernel_as(const sphv_kernel *kernel, const char *id, char **svg,
                                sphv_error *error) SPHV_MUST_CHECK;

#endif
