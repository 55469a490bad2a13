#include "svg_path.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/// A line of a path is looked at in stretches of this many points at most.
enum { STRETCH = 96 };

/// How far a point may lie from the line that replaces it, in units of the picture.
static const double tolerance = 0.1;

typedef struct place {
    double x, y;
} place;

/// Where the polyline goes after it has been written as far as `at`, in tenths of a unit.
typedef struct pencil {
    FILE *out;
    long x, y;
    bool drawing; ///< the last command was l
} pencil;

static double distance(place p, place a, place b)
{
    double dx = b.x - a.x, dy = b.y - a.y, length = hypot(dx, dy);
    if (!(length > 0)) return hypot(p.x - a.x, p.y - a.y);
    // Beyond the ends of the line the nearest point is an end: curves may turn back on themselves.
    double along = ((p.x - a.x) * dx + (p.y - a.y) * dy) / (length * length);
    along = along < 0 ? 0 : along > 1 ? 1 : along;
    return hypot(p.x - a.x - along * dx, p.y - a.y - along * dy);
}

/// The farthest point that a straight line from `from` may go to without passing any between them
/// by more than the tolerance.
static size_t reach(const place *points, size_t count, size_t from)
{
    size_t to = from + 1;
    while (to + 1 < count && to + 1 - from < STRETCH) {
        for (size_t i = from + 1; i <= to; i++)
            if (distance(points[i], points[from], points[to + 1]) > tolerance) return to;
        to++;
    }
    return to;
}

/// Tenths as a decimal number.
static void put_tenths(FILE *out, long tenths, bool separated)
{
    long magnitude = labs(tenths);
    fputs(tenths < 0 ? "-" : separated ? " " : "", out);
    if (magnitude >= 10 || magnitude % 10 == 0) fprintf(out, "%ld", magnitude / 10);
    if (magnitude % 10) fprintf(out, ".%ld", magnitude % 10);
}

static void move_to(pencil *pen, place to)
{
    pen->x = lround(10 * to.x);
    pen->y = lround(10 * to.y);
    fputc('M', pen->out);
    put_tenths(pen->out, pen->x, false);
    put_tenths(pen->out, pen->y, true);
    pen->drawing = false;
}

static void line_to(pencil *pen, place to)
{
    long x = lround(10 * to.x), y = lround(10 * to.y);
    if (!pen->drawing) fputc('l', pen->out);
    put_tenths(pen->out, x - pen->x, pen->drawing);
    put_tenths(pen->out, y - pen->y, true);
    pen->x = x;
    pen->y = y;
    pen->drawing = true;
}

static void put_polyline(pencil *pen, const place *points, size_t count)
{
    if (!count) return;
    move_to(pen, points[0]);
    for (size_t i = 0; i + 1 < count;) {
        i = reach(points, count, i);
        line_to(pen, points[i]);
    }
}

/// Reads `x,y` or `x y`.
static bool read_point(const char **at, const char *end, place *out)
{
    char *after;
    out->x = strtod(*at, &after);
    if (after == *at || after >= end) return false;
    const char *second = after + strspn(after, ", ");
    out->y = strtod(second, &after);
    if (after == second || after > end) return false;
    *at = after;
    // Beyond this a number of tenths would not be exact, nor the picture anything to look at.
    return fabs(out->x) < 1e7 && fabs(out->y) < 1e7;
}

/// \return false when the path holds what is not read here
static bool put_short(FILE *out, const char *data, const char *end, place *points)
{
    pencil pen = {out, 0, 0, false};
    size_t count = 0;
    for (const char *at = data; at < end;) {
        char command = *at++;
        if (isspace((unsigned char)command)) continue;
        if (command == 'Z' || command == 'z') {
            put_polyline(&pen, points, count);
            fputc('z', out);
            count = 0;
        } else if (command == 'M' || command == 'L') {
            if (command == 'M') {
                put_polyline(&pen, points, count);
                count = 0;
            } else if (!count) {
                return false;
            }
            if (!read_point(&at, end, &points[count++])) return false;
        } else {
            return false;
        }
    }
    put_polyline(&pen, points, count);
    return true;
}

void sphv_svg_put_path(FILE *out, const char *data, const char *end)
{
    size_t length = (size_t)(end - data), size = 0;
    char *text = NULL;
    // A point takes four bytes at least.
    place *points = malloc((length / 4 + 2) * sizeof *points);
    FILE *attempt = points ? open_memstream(&text, &size) : NULL;
    bool whole = attempt && put_short(attempt, data, end, points);
    if (attempt && fclose(attempt) != 0) whole = false;
    if (whole)
        fwrite(text, 1, size, out);
    else
        fwrite(data, 1, length, out);
    free(text);
    free(points);
}

static void put_number(FILE *out, double value, int decimals)
{
    char text[64];
    int length = snprintf(text, sizeof text, "%.*f", decimals, value);
    if (length < 0 || (size_t)length >= sizeof text) {
        fprintf(out, "%g", value);
        return;
    }
    while (strchr(text, '.') && (text[length - 1] == '0' || text[length - 1] == '.')) {
        bool point_reached = text[length - 1] == '.';
        text[--length] = '\0';
        if (point_reached) break;
    }
    fputs(strcmp(text, "-0") == 0 ? "0" : text, out);
}

/// \return what follows a colour rgb(r, g, b), or NULL when there is none
static const char *put_colour(FILE *out, const char *value, const char *end)
{
    if (strncmp(value, "rgb(", 4) != 0) return NULL;
    const char *at = value + 4;
    long part[3];
    for (int i = 0; i < 3; i++) {
        char *after;
        part[i] = strtol(at, &after, 10);
        if (after == at || part[i] < 0 || part[i] > 255) return NULL;
        at = after + strspn(after, " ");
        if (at >= end || *at++ != (i < 2 ? ',' : ')')) return NULL;
    }
    fprintf(out, "#%02lX%02lX%02lX", part[0], part[1], part[2]);
    return at;
}

void sphv_svg_put_value(FILE *out, const char *value, const char *end, int decimals)
{
    while (value < end) {
        const char *after = put_colour(out, value, end);
        if (after) {
            value = after;
            continue;
        }
        size_t digits = strspn(value, "0123456789");
        const char *point = value + digits;
        size_t fraction =
            digits && point < end && *point == '.' ? strspn(point + 1, "0123456789") : 0;
        if (fraction && point + 1 + fraction <= end) {
            put_number(out, strtod(value, NULL), decimals);
            value = point + 1 + fraction;
        } else if (digits) {
            fwrite(value, 1, digits, out);
            value += digits;
        } else {
            fputc(*value++, out);
        }
    }
}
