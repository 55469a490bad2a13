/// \file markdown.h
/// Parts of the Markdown report.
#ifndef SPHVERIFY_REPORT_MARKDOWN_H
#define SPHVERIFY_REPORT_MARKDOWN_H

#include "rendering.h"

/// A number for people. \param digits significant ones
void sphv_markdown_number(FILE *stream, double value, int digits);

/// A number, data from outside, counts of points: each with the end of its cell.
void sphv_markdown_number_cell(FILE *stream, double value, int digits);
void sphv_markdown_text_cell(FILE *stream, const char *text);

/// Title, name, source, verdict and notes of a scene.
void sphv_markdown_scene_head(FILE *stream, const char *title, const char *name, const char *source,
                              sphv_verdict verdict, const char *notes);

/// Ends the row of a claim: the reason of its tolerance, and remarks.
/// \param refuted why it is known not to hold; may be NULL
void sphv_markdown_claim_end(FILE *stream, const char *reason, bool surprising,
                             const char *refuted);
void sphv_markdown_tally_cell(FILE *stream, const size_t counts[3]);

/// Volume rules side by side, and failures by method.
void sphv_markdown_disorder(FILE *stream, const sphv_rendering *rendering);

/// The tables of rates.
void sphv_markdown_rates(FILE *stream, const sphv_rendering *rendering);
void sphv_markdown_convergence(FILE *stream, const sphv_convergence_result *result);

/// The curves of a statistical scene.
void sphv_markdown_curves(FILE *stream, const sphv_scene_result *result);

#endif
