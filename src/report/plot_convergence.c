#include <math.h>
#include <stdlib.h>

#include "convergence_facts.h"
#include "plot.h"
#include "sphverify/estimate.h"
#include "text.h"

enum { WIDTH = 600, PLOT_HEIGHT = 470, LINE_HEIGHT = 25, LABEL_MAX = 40 };

/// What a curve shows at a level; NaN where it cannot be drawn.
static double drawn(const sphv_convergence_result *result, const sphv_rate_plot *plot, size_t curve,
                    size_t level, bool theory)
{
    sphv_series series = plot->series;
    series.scheme = plot->schemes[curve];
    double value = sphv_series_value(result, &series, level, theory);
    return series.metric == SPHV_METRIC_FAILED || value > 0 ? value : NAN;
}

static double place(const sphv_convergence_result *result, const sphv_rate_plot *plot, size_t curve,
                    size_t level)
{
    return sphv_stage_place(sphv_convergence_stage(result, level, plot->schemes[curve]),
                            plot->series.axis);
}

/// \return number of points written
static size_t write_curve(FILE *script, const sphv_convergence_result *result,
                          const sphv_rate_plot *plot, size_t curve, bool theory)
{
    size_t written = 0;
    fprintf(script, "$%s%zu << END\n", theory ? "theory" : "measured", curve);
    for (size_t i = 0; i < plot->series.count; i++) {
        size_t level = plot->series.first + i;
        double x = place(result, plot, curve, level), y = drawn(result, plot, curve, level, theory);
        if (!(x > 0) || !isfinite(y)) {
            fputc('\n', script);
            continue;
        }
        fprintf(script, "%.12g %.12g\n", x, y);
        written++;
    }
    fputs("END\n", script);
    return written;
}

struct range {
    double x_from, x_to, y_from, y_to;
};

static struct range range_of(const sphv_convergence_result *result, const sphv_rate_plot *plot)
{
    struct range range = {INFINITY, -INFINITY, INFINITY, -INFINITY};
    for (size_t c = 0; c < plot->scheme_count; c++)
        for (size_t i = 0; i < plot->series.count; i++)
            for (int theory = 0; theory < 2; theory++) {
                size_t level = plot->series.first + i;
                double x = place(result, plot, c, level), y = drawn(result, plot, c, level, theory);
                if (!(x > 0) || !isfinite(y)) continue;
                range.x_from = fmin(range.x_from, x);
                range.x_to = fmax(range.x_to, x);
                range.y_from = fmin(range.y_from, y);
                range.y_to = fmax(range.y_to, y);
            }
    return range;
}

static void write_axes(FILE *script, const sphv_convergence *scene, const sphv_rate_plot *plot,
                       const struct range *range)
{
    static const char *const names[] = {"N, number of particles", "n, number of neighbours",
                                        "h, smoothing length", "h/Δx"};
    char label[SPHV_SERIES_TEXT];
    fprintf(script, "set xlabel '%s' offset 0,0.75 noenhanced\nset ylabel ",
            names[plot->series.axis]);
    sphv_put_gnuplot(script, sphv_plot_axis_text(label, scene, plot), LABEL_MAX);
    fputs(" noenhanced\n", script);
    if (plot->series.axis == SPHV_AXIS_RATIO)
        fprintf(script, "set xrange [%.12g:%.12g]\n", range->x_from, range->x_to);
    else if (range->x_from < range->x_to)
        sphv_plot_log_axis(script, 'x', range->x_from / 1.15, range->x_to * 1.15);
    if (plot->series.metric == SPHV_METRIC_FAILED)
        fputs("set yrange [-0.03:1.03]\n", script);
    else if (plot->series.metric == SPHV_METRIC_H && range->y_from < range->y_to)
        sphv_plot_log_axis(script, 'y', range->y_from / 1.15, range->y_to * 1.15);
    else
        fputs("set logscale y\nset format y '10^{%T}'\n", script);
}

/// Power laws through the upper left corner of what is drawn, clipped to its height.
static void write_trends(FILE *script, const sphv_rate_plot *plot, const struct range *range)
{
    for (size_t t = 0; t < plot->trend_count; t++) {
        double p = plot->trends[t], top = range->y_to, x_to = range->x_to;
        if (p < 0) x_to = fmin(x_to, range->x_from * pow(range->y_from / top, 1 / p));
        fprintf(script, "$trend%zu << END\n%.12g %.12g\n%.12g %.12g\nEND\n", t, range->x_from, top,
                x_to, top * pow(x_to / range->x_from, p));
    }
}

static int longest_label(const sphv_convergence *scene, const sphv_rate_plot *plot)
{
    int longest = 0;
    for (size_t c = 0; c < plot->scheme_count; c++) {
        int length = sphv_text_length(scene->schemes[plot->schemes[c]].label);
        if (length > longest) longest = length;
    }
    return longest;
}

static int key_columns(const sphv_convergence *scene, const sphv_rate_plot *plot)
{
    int longest = longest_label(scene, plot);
    return longest > 26 ? 1 : longest > 12 ? 2 : 3;
}

/// gnuplot counts characters: it sets long labels too far apart, so that they need a column more,
/// and lets short ones touch.
static int key_width(const sphv_convergence *scene, const sphv_rate_plot *plot)
{
    int longest = longest_label(scene, plot);
    return longest > 12 ? -longest / 5 : 1;
}

/// `N⁻²`, or `N^(−1/2)` where the exponent is no integer.
static void write_power(FILE *script, const char *symbol, double power)
{
    static const char *const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    char text[SPHV_NUMBER_TEXT];
    fputs(symbol, script);
    if (power == floor(power) && fabs(power) < 10) {
        fprintf(script, "%s%s", power < 0 ? "⁻" : "", digits[(int)fabs(power)]);
        return;
    }
    for (int below = 2; below <= 12; below++) {
        double above = nearbyint(power * below);
        if (fabs(power * below - above) > 1e-9) continue;
        fprintf(script, "^(%s/%d)", sphv_number_text(text, above, 6), below);
        return;
    }
    fprintf(script, "^(%s)", sphv_number_text(text, power, 4));
}

static void write_plot(FILE *script, const sphv_convergence_result *result,
                       const sphv_rate_plot *plot)
{
    static const char *const symbols[] = {"N", "n", "h", "(h/Δx)"};
    const sphv_convergence *scene = result->scene;
    struct range range = range_of(result, plot);
    bool theory = false, trends = range.x_from < range.x_to;
    for (size_t c = 0; c < plot->scheme_count; c++) {
        write_curve(script, result, plot, c, false);
        if (write_curve(script, result, plot, c, true)) theory = true;
    }
    write_axes(script, scene, plot, &range);
    if (trends) write_trends(script, plot, &range);
    fprintf(script, "set key maxcols %d width %d font ',15'\nplot ", key_columns(scene, plot),
            key_width(scene, plot));
    for (size_t c = 0; c < plot->scheme_count; c++) {
        const sphv_plot_style *style = sphv_plot_style_of(c);
        fprintf(script,
                "%s$measured%zu with linespoints linecolor rgb '%s' dashtype %s linewidth 2 "
                "pointtype %d pointsize 0.6 title ",
                c ? ", " : "", c, style->colour, style->dash, style->filled);
        sphv_put_gnuplot(script, scene->schemes[plot->schemes[c]].label, LABEL_MAX);
        fputs(" noenhanced", script);
    }
    for (size_t c = 0; c < plot->scheme_count; c++) {
        const sphv_plot_style *style = sphv_plot_style_of(c);
        if (theory)
            fprintf(script,
                    ", $theory%zu with points linecolor rgb '%s' pointtype %d pointsize 1.1 "
                    "notitle",
                    c, style->colour, style->hollow);
    }
    for (size_t t = 0; trends && t < plot->trend_count; t++) {
        fprintf(script,
                ", $trend%zu with lines linecolor rgb '#707070' dashtype %zu linewidth 1.5 title '",
                t, t + 2);
        write_power(script, symbols[plot->series.axis], plot->trends[t]);
        fputc('\'', script);
    }
    if (theory)
        fputs(", keyentry with points linecolor rgb 'black' pointtype 6 pointsize 1.1 title "
              "'theory'",
              script);
    fputc('\n', script);
}

static sphv_status write_picture(FILE *script, const sphv_convergence *scene,
                                 const sphv_rate_plot *plot, sphv_error *error)
{
    const sphv_scheme *scheme = &scene->schemes[plot->schemes[0]];
    size_t level = plot->series.first;
    sphv_box box = sphv_scheme_box(scene, scheme, level);
    sphv_particles particles;
    // Positions alone are drawn.
    if (box.volume == SPHV_VOLUME_DENSITY) box.volume = SPHV_VOLUME_UNIT;
    sphv_status status = sphv_particles_make(&box, NULL, 0, &particles, error);
    if (status != SPHV_OK) return status;
    fputs("$particles << END\n", script);
    for (size_t a = 0; a < particles.count; a++)
        fprintf(script, "%.6g %.6g\n", particles.x[0][a], particles.x[1][a]);
    sphv_particles_free(&particles);
    fputs("END\nset xlabel 'x' offset 0,0.6\nset ylabel 'y'\nset size ratio -1\nset nokey\n"
          "set xrange [-0.03:1.03]\nset yrange [-0.03:1.03]\n"
          "plot $particles with points linecolor rgb '#0072B2' pointtype 7 pointsize 0.45\n",
          script);
    return SPHV_OK;
}

sphv_status sphv_plot_rates_as(const sphv_convergence_result *result, size_t plot, const char *id,
                               char **svg, sphv_error *error)
{
    const sphv_rate_plot *of = &result->scene->plots[plot];
    *svg = NULL;
    int entries = (int)(of->scheme_count + of->trend_count) + 1;
    int columns = key_columns(result->scene, of), rows = (entries + columns - 1) / columns;
    sphv_plot_script script;
    sphv_status status = sphv_plot_begin(
        &script, WIDTH, of->picture ? 560 : PLOT_HEIGHT + rows * LINE_HEIGHT, error);
    if (status != SPHV_OK) return status;
    if (of->picture) {
        status = write_picture(script.stream, result->scene, of, error);
        if (status != SPHV_OK) {
            fclose(script.stream);
            free(script.text);
            return status;
        }
    } else {
        write_plot(script.stream, result, of);
    }
    return sphv_plot_finish(&script, id, of->title, svg, error);
}

sphv_status sphv_plot_rates(const sphv_convergence_result *result, size_t plot, char **svg,
                            sphv_error *error)
{
    return sphv_plot_rates_as(result, plot, "rates", svg, error);
}
