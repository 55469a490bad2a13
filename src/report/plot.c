#include "plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "child.h"
#include "svg.h"

static const double seconds_allowed = 20;

const sphv_plot_style *sphv_plot_style_of(size_t curve)
{
    static const sphv_plot_style styles[] = {
        {"#0072B2", "solid", 7, 6},  {"#D55E00", "'-'", 5, 4},        {"#009E73", "'.'", 9, 8},
        {"#CC79A7", "'-.'", 13, 12}, {"#B8860B", "'_'", 11, 10},      {"#56B4E9", "'-..'", 15, 14},
        {"#7A5195", "(20,6)", 7, 6}, {"#8C564B", "(12,4,3,4)", 5, 4},
    };
    return &styles[curve % (sizeof styles / sizeof *styles)];
}

sphv_status sphv_plot_begin(sphv_plot_script *script, int width, int height, sphv_error *error)
{
    script->stream = open_memstream(&script->text, &script->size);
    if (!script->stream) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    fprintf(script->stream,
            "set encoding utf8\n"
            "set terminal svg size %d,%d dynamic enhanced font 'sans-serif,17' butt\n"
            "set border 31 linewidth 1\n"
            "set tics nomirror scale 0.8\n"
            "set grid linewidth 0.5 linecolor rgb '#a0a0a0'\n"
            "set key noenhanced bmargin center horizontal Left reverse samplen 2.5 spacing 1.15 "
            "width -2\n",
            width, height);
    return SPHV_OK;
}

void sphv_plot_log_axis(FILE *script, char axis, double from, double to)
{
    fprintf(script, "set logscale %c\n", axis);
    if (!(from > 0 && to > from && isfinite(to))) return;
    fprintf(script, "set %crange [%.12g:%.12g]\n", axis, from, to);
    double decades = log10(to / from);
    int first = (int)floor(log10(from)), last = (int)ceil(log10(to));
    fprintf(script, "set %ctics (", axis);
    const char *comma = "";
    int step = decades > 8 ? (int)ceil(decades / 6) : 1;
    for (int decade = first; decade <= last; decade++)
        for (int half = 2; half < 20; half++) {
            // between whole ones where there would be too few
            if (half % 2 && (decades > 0.8 || half > 7)) continue;
            int m = half / 2;
            double value = 0.5 * half * pow(10, decade);
            if (value < from * (1 - 1e-9) || value > to * (1 + 1e-9)) continue;
            bool labelled =
                half == 2 ? decade % step == 0
                          : decades < 0.8 || (m == 5 && decades < 3) || (m == 2 && decades < 2);
            if (labelled && decades < 4)
                fprintf(script, "%s'%g' %.12g", comma, value, value);
            else if (labelled)
                fprintf(script, "%s'10^{%d}' %.12g", comma, decade, value);
            else if (step == 1 || half == 2)
                fprintf(script, "%s'' %.12g %d", comma, value, half == 2 ? 0 : 1);
            else
                continue;
            comma = ", ";
        }
    fputs(")\n", script);
}

sphv_status sphv_plot_finish(sphv_plot_script *script, const char *id, const char *title,
                             char **svg, sphv_error *error)
{
    *svg = NULL;
    if (fclose(script->stream) != 0) {
        free(script->text);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    // -d: without the user's start-up files.
    static char program[] = "gnuplot", defaults[] = "-d", standard_input[] = "-";
    char *arguments[] = {program, defaults, standard_input, NULL};
    char *document;
    sphv_status status = sphv_child_run(arguments, script->text, strlen(script->text),
                                        seconds_allowed, &document, NULL, error);
    free(script->text);
    if (status != SPHV_OK) return status;
    status = sphv_svg_embed(document, id, title, svg, error);
    free(document);
    return status;
}

sphv_status sphv_plot_scene(const sphv_scene_result *result, char **svg, sphv_error *error)
{
    return sphv_plot_scene_as(result, "scene", svg, error);
}

sphv_status sphv_plot_kernel(const sphv_kernel *kernel, char **svg, sphv_error *error)
{
    return sphv_plot_kernel_as(kernel, "kernel", svg, error);
}
