#include <math.h>
#include <stdlib.h>

#include "plot.h"
#include "text.h"

enum {
    BARS_MAX = 32,
    WIDTH = 600,
    PLOT_HEIGHT = 470,
    LINE_HEIGHT = 25,
    LABEL_MAX = 52,
    TWO_COLUMNS = 22
};

/// Points nearer than this, in units of the axis, would run into one blot.
static const double clear_of_last = 0.03;

/// Bounds below this part of the value are not drawn.
static const double narrowest_bar = 0.1;

/// What is drawn upwards at a sample: the norm of the error, or Ŵ itself over q.
static double height_of(const sphv_scene *scene, const sphv_prediction *prediction)
{
    return scene->abscissa == SPHV_OVER_Q ? prediction->total.value : prediction->l2.value;
}

static bool drawable(const sphv_scene *scene, double x, double y)
{
    return isfinite(x) && isfinite(y) && (!scene->logarithmic || x > 0) &&
           (scene->abscissa == SPHV_OVER_Q || y > 0);
}

static double position_on_axis(const sphv_scene *scene, double x)
{
    return scene->logarithmic ? log(x / scene->from) / log(scene->to / scene->from)
                              : (x - scene->from) / (scene->to - scene->from);
}

static void write_curve(FILE *script, const sphv_scene_result *result, size_t curve)
{
    fprintf(script, "$measured%zu << END\n", curve);
    for (size_t i = 0; i < result->sample_count[curve]; i++) {
        const sphv_sample *sample = &result->samples[curve][i];
        double y = result->scene->abscissa == SPHV_OVER_Q ? sample->point.empirical.total.value
                                                          : sample->point.empirical.l2.value;
        if (drawable(result->scene, sample->x, y))
            fprintf(script, "%.12g %.12g\n", sample->x, y);
        else
            fputc('\n', script);
    }
    fputs("END\n", script);
}

/// \return number of points written
static size_t write_points(FILE *script, const sphv_scene_result *result, size_t curve, bool paper)
{
    size_t written = 0;
    double last = -INFINITY;
    fprintf(script, "$%s%zu << END\n", paper ? "paper" : "exact", curve);
    for (size_t i = 0; i < result->sample_count[curve]; i++) {
        const sphv_sample *sample = &result->samples[curve][i];
        if (!sample->marked || (paper && sample->n < 0)) continue;
        double y = height_of(result->scene, paper ? &sample->paper : &sample->point.analytic);
        double place = position_on_axis(result->scene, sample->x);
        if (!drawable(result->scene, sample->x, y) || place - last < clear_of_last) continue;
        fprintf(script, "%.12g %.12g\n", sample->x, y);
        last = place;
        written++;
    }
    fputs("END\n", script);
    return written;
}

/// The theory's bound as a vertical bar, where it is wide enough to be told from the point. As
/// lines, since gnuplot blanks what lies under its error bars.
/// \return number of bars written
static size_t write_bars(FILE *script, const sphv_scene_result *result, size_t curve)
{
    size_t written = 0;
    fprintf(script, "$bars%zu << END\n", curve);
    for (size_t i = 0; i < result->sample_count[curve]; i++) {
        const sphv_sample *sample = &result->samples[curve][i];
        sphv_result l2 = sample->point.analytic.l2;
        if (!sample->marked || !drawable(result->scene, sample->x, l2.value)) continue;
        if (!isfinite(l2.bound) || l2.bound < narrowest_bar * l2.value) continue;
        // Down to zero has no place on a logarithmic axis: to a tenth of the value.
        fprintf(script, "%.12g %.12g\n%.12g %.12g\n\n", sample->x,
                fmax(l2.value - l2.bound, l2.value / 10), sample->x,
                fmin(l2.value + l2.bound, 10 * l2.value));
        written++;
    }
    fputs("END\n", script);
    return written;
}

static void write_axes(FILE *script, const sphv_scene_result *result)
{
    const sphv_scene *scene = result->scene;
    static const char *const labels[] = {
        [SPHV_OVER_Q] = "q = r/h",
        [SPHV_OVER_H] = "h/λ, smoothing length in wavelengths",
        [SPHV_OVER_SPACING] = "Δx/h, particle spacing in smoothing lengths",
    };
    fprintf(script, "set xlabel '%s' offset 0,0.75 noenhanced\n", labels[scene->abscissa]);
    if (scene->logarithmic)
        sphv_plot_log_axis(script, 'x', scene->from, scene->to);
    else
        fprintf(script, "set xrange [%.12g:%.12g]\n", scene->from, scene->to);
    if (scene->abscissa == SPHV_OVER_Q) {
        fputs("set ylabel 'Ŵ = h W' noenhanced\n", script);
        return;
    }
    fprintf(script,
            "set ylabel 'L₂ norm of the error%s' noenhanced\n"
            "set logscale y\nset format y '10^{%%T}'\n",
            scene->statistical ? "" : ", |E|/√2");
}

/// The legend stands below the plot and so covers nothing.
static void write_legend(FILE *script, const sphv_scene_result *result, bool exact, bool paper)
{
    const sphv_scene *scene = result->scene;
    for (size_t c = 0; c < scene->curve_count; c++) {
        const sphv_plot_style *style = sphv_plot_style_of(c);
        fprintf(script,
                ", keyentry with linespoints linecolor rgb '%s' dashtype %s linewidth 2 "
                "pointtype %d pointsize 0.6 title ",
                style->colour, style->dash, style->filled);
        sphv_put_gnuplot(script, scene->curves[c].label, LABEL_MAX);
        fputs(" noenhanced", script);
    }
    fprintf(script, ", keyentry with lines linecolor rgb 'black' linewidth 2 title '%s'",
            scene->statistical ? "measured mean" : "empirical");
    if (exact)
        fprintf(script,
                ", keyentry with points linecolor rgb 'black' pointtype 7 pointsize 0.6 "
                "title '%s'",
                scene->statistical ? "expected by theory" : "analytic");
    if (paper)
        fputs(", keyentry with points linecolor rgb 'black' pointtype 6 pointsize 1.05 "
              "title 'paper’s form'",
              script);
}

static int legend_columns(const sphv_scene *scene)
{
    for (size_t c = 0; c < scene->curve_count; c++)
        if (sphv_text_length(scene->curves[c].label) > TWO_COLUMNS) return 1;
    return 2;
}

static void write_plot(FILE *script, const sphv_scene_result *result)
{
    const sphv_scene *scene = result->scene;
    bool exact = false, paper = false, bars[BARS_MAX] = {false};
    for (size_t c = 0; c < scene->curve_count; c++) {
        write_curve(script, result, c);
        if (write_points(script, result, c, false)) exact = true;
        if (scene->abscissa != SPHV_OVER_Q && write_points(script, result, c, true)) paper = true;
        if (scene->statistical && c < BARS_MAX) bars[c] = write_bars(script, result, c) > 0;
    }
    write_axes(script, result);
    fprintf(script, "set key maxcols %d width -2 font ',15'\nplot ", legend_columns(scene));
    for (size_t c = 0; c < scene->curve_count; c++) {
        const sphv_plot_style *style = sphv_plot_style_of(c);
        fprintf(script,
                "%s$measured%zu with lines linecolor rgb '%s' dashtype %s linewidth 2 notitle",
                c ? ", " : "", c, style->colour, style->dash);
        if (c < BARS_MAX && bars[c])
            fprintf(script, ", $bars%zu with lines linecolor rgb '%s' linewidth 1 notitle", c,
                    style->colour);
        fprintf(script,
                ", $exact%zu with points linecolor rgb '%s' pointtype %d pointsize 0.6 notitle", c,
                style->colour, style->filled);
        if (paper)
            fprintf(
                script,
                ", $paper%zu with points linecolor rgb '%s' pointtype %d pointsize 1.05 notitle", c,
                style->colour, style->hollow);
    }
    write_legend(script, result, exact, paper);
    fputc('\n', script);
}

sphv_status sphv_plot_scene_as(const sphv_scene_result *result, const char *id, char **svg,
                               sphv_error *error)
{
    const sphv_scene *scene = result->scene;
    *svg = NULL;
    int entries = (int)scene->curve_count + 3;
    int rows = (entries + legend_columns(scene) - 1) / legend_columns(scene);
    sphv_plot_script script;
    sphv_status status = sphv_plot_begin(&script, WIDTH, PLOT_HEIGHT + rows * LINE_HEIGHT, error);
    if (status != SPHV_OK) return status;
    write_plot(script.stream, result);
    return sphv_plot_finish(&script, id, scene->title, svg, error);
}
