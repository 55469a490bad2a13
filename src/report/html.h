/// \file html.h
/// Parts of the HTML page.
#ifndef SPHVERIFY_REPORT_HTML_H
#define SPHVERIFY_REPORT_HTML_H

#include "rendering.h"

/// Opens the box in which a wide table scrolls, by keyboard too.
#define SPHV_HTML_SCROLL "<div class=scroll role=group aria-label=Table tabindex=0>"

/// Style sheet of the page in parts, ended by NULL: screen, phone, paper.
extern const char *const sphv_html_style[];

/// A verdict as a word with its colour.
void sphv_html_verdict(FILE *stream, sphv_verdict verdict);

/// Begins the article of a scene: its title, name, verdict and source.
/// \param anchor what its address in the page begins with, before `-index`
void sphv_html_scene_head(FILE *stream, const char *anchor, size_t index, const char *title,
                          const char *name, sphv_verdict verdict, const char *source);

/// A number, never broken across lines.
void sphv_html_number(FILE *stream, double value, int digits);

/// A table cell with a number.
void sphv_html_number_cell(FILE *stream, double value, int digits);
void sphv_html_verdict_cell(FILE *stream, sphv_verdict verdict);
/// A table cell with data from outside.
void sphv_html_text_cell(FILE *stream, const char *text);
/// The header of a row.
void sphv_html_row_begin(FILE *stream, const char *text);

/// Counts of agreeing, disagreeing and inconclusive points as three cells; a dash in each when
/// there are no points.
void sphv_html_tally_cells(FILE *stream, const size_t counts[3]);

/// A table in a box of its own that scrolls sideways on a narrow screen.
/// \param caption  shown above the table; markup
/// \param columns  column headers, ended by NULL; markup
void sphv_html_table_begin(FILE *stream, const char *caption, const char *const *columns);
void sphv_html_table_end(FILE *stream);

/// Text from outside, a paragraph per line. \param css_class may be NULL
void sphv_html_paragraphs(FILE *stream, const char *text, const char *css_class);

/// A plot, or the reason why there is none.
/// \param caption markup
void sphv_html_figure(FILE *stream, const sphv_rendering *rendering, const char *svg,
                      const char *caption);

/// The sections.
void sphv_html_slips(FILE *stream, const sphv_slips *slips);
void sphv_html_disorder(FILE *stream, const sphv_rendering *rendering);
void sphv_html_kernel(FILE *stream, const sphv_rendering *rendering, size_t index);
/// The convergence scenes: what becomes of their tables, then each.
void sphv_html_rates(FILE *stream, const sphv_rendering *rendering);
void sphv_html_convergence(FILE *stream, const sphv_rendering *rendering, size_t index);
void sphv_html_scene(FILE *stream, const sphv_rendering *rendering, size_t index);

#endif
