/// \file rendering.h
/// A report with everything its formats need, worked out before any of them is written.
#ifndef SPHVERIFY_REPORT_RENDERING_H
#define SPHVERIFY_REPORT_RENDERING_H

#include "facts.h"
#include "scene_facts.h"
#include "slips.h"
#include "volume_rules.h"

typedef struct sphv_rendering {
    const sphv_report *report;
    sphv_kernel_facts *facts; ///< per kernel
    sphv_slips slips;
    sphv_rule_comparison rules;
    size_t method_count;
    sphv_method_facts *methods;         ///< the methods that the scenes use
    char **kernel_plots, **scene_plots; ///< SVG, NULL where there is none
    char ***rate_plots;                 ///< [convergence scene][plot]
    bool plots_missing;
    sphv_error plot_error; ///< why, where plots are missing
} sphv_rendering;

/// The three formats. Failures to write show in the stream.
void sphv_render_html(FILE *stream, const sphv_rendering *rendering);
void sphv_render_markdown(FILE *stream, const sphv_rendering *rendering);
/// \return false without memory
bool sphv_render_json(FILE *stream, const sphv_rendering *rendering);

/// What the report covers and how it judges, ended by NULL: paragraphs for HTML and Markdown.
extern const char *const sphv_report_preface[];

/// The verdict of the whole report, claims of kernel files included.
sphv_verdict sphv_rendering_verdict(const sphv_rendering *rendering);

/// The counts of a scene's points by sphv_verdict.
void sphv_scene_tallies(const sphv_scene_result *result, size_t exact[3], size_t paper[3]);

/// Claims of a scene that came out as its file expects.
size_t sphv_scene_expected_claims(const sphv_scene_result *result);

#endif
