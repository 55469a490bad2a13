/// \file svg.h
/// Makes gnuplot's SVG fit to stand inline in a page, any number of times.
#ifndef SPHVERIFY_REPORT_SVG_H
#define SPHVERIFY_REPORT_SVG_H

#include "sphverify/status.h"

/// Rewrites an SVG document of gnuplot's: no XML prolog, one title for screen readers, ids made
/// unique by a prefix, black drawn in the colour of the text around, no fixed size (the viewBox
/// scales).
/// \param id     prefix of the ids; letters, digits and '-' only
/// \param title  short text that says what is drawn; data, not markup
/// \param svg    receives the new text, for the caller to free
/// \return SPHV_RESOURCE_FAILURE when it is no SVG
sphv_status sphv_svg_embed(const char *document, const char *id, const char *title, char **svg,
                           sphv_error *error) SPHV_MUST_CHECK;

#endif
