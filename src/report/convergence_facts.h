/// \file convergence_facts.h
/// What the report says of convergence scenes, for all of its formats.
#ifndef SPHVERIFY_REPORT_CONVERGENCE_FACTS_H
#define SPHVERIFY_REPORT_CONVERGENCE_FACTS_H

#include "sphverify/convergence.h"

enum { SPHV_RULE_TEXT = 160, SPHV_SERIES_TEXT = 400, SPHV_RATE_TEXT = 24 };

/// How h is chosen: `h = sqrt(13/4/pi) Δx`. \return text
const char *sphv_h_rule_text(char text[SPHV_RULE_TEXT], const sphv_scheme *scheme);

/// Which particles: `perturbed, uniform ±0.13 Δx, reflected, volumes equal, seed 1`. \return text
const char *sphv_box_text(char text[SPHV_RULE_TEXT], const sphv_box *box);

/// What a claim measures: `slope of rmse of f1 by SPH against particles, levels 1 to 4`.
/// \return text
const char *sphv_claim_series_text(char text[SPHV_SERIES_TEXT], const sphv_convergence *scene,
                                   const sphv_rate_claim *claim);

/// A rate with its sign and two decimals: `−0.75`, `–` where there is none. \return text
const char *sphv_rate_text(char text[SPHV_RATE_TEXT], double rate);

/// What becomes of a printed number in one or two words, for narrow cells.
const char *sphv_cell_verdict_short(sphv_cell_verdict verdict);

/// Its class in the report's style sheet: agrees, inconclusive, disagrees.
const char *sphv_cell_verdict_class(sphv_cell_verdict verdict);

/// Cells of a table by verdict.
void sphv_cell_counts(const sphv_convergence_result *result, size_t counts[SPHV_CELL_VERDICTS]);

/// Largest |predicted/measured − 1| of the RMSE of a scheme over levels and quantities; NaN where
/// nothing is predicted.
double sphv_scheme_largest_difference(const sphv_convergence_result *result, size_t scheme);

/// Points of a scheme by sphv_verdict, whole and interior.
void sphv_scheme_verdicts(const sphv_convergence_result *result, size_t scheme, size_t counts[3]);

/// What the vertical axis of a figure is, with the metric's name.
const char *sphv_plot_axis_text(char text[SPHV_SERIES_TEXT], const sphv_convergence *scene,
                                const sphv_rate_plot *plot);

#endif
