/// \file svg_path.h
/// Paths and numbers of a picture, as short as its resolution allows.
#ifndef SPHVERIFY_REPORT_SVG_PATH_H
#define SPHVERIFY_REPORT_SVG_PATH_H

#include <stdio.h>

/// A path's data with coordinates rounded to a tenth of a unit, and without the points that lie
/// within a tenth of a unit of the line between their neighbours. Only the commands that gnuplot
/// draws curves with are changed (M, L, Z); a path with others is copied as it is.
/// \param data, end the value of an attribute d, [data, end)
void sphv_svg_put_path(FILE *out, const char *data, const char *end);

/// An attribute's value with its numbers at most `decimals` behind the point, without trailing
/// zeros, and rgb(r, g, b) as #rrggbb.
void sphv_svg_put_value(FILE *out, const char *value, const char *end, int decimals);

#endif
