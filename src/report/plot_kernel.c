#include <math.h>
#include <stdlib.h>

#include "plot.h"

enum { WIDTH = 600, HEIGHT = 1180, POINTS = 160, WAVENUMBERS = 240 };

/// The transform is drawn to this wavenumber times κ, some six lobes of a compact kernel.
static const double highest_wavenumber = 40;
static const double lowest_drawn = 1e-10;

/// Ŵ, Ŵ′, Ŵ″ over q, piece by piece, so that jumps at knots show as vertical lines.
static void write_derivatives(FILE *script, const sphv_profile *profile)
{
    fputs("$profile << END\n", script);
    for (int p = 0; p < profile->piece_count; p++) {
        const sphv_piece *piece = &profile->pieces[p];
        double width = piece->outer - piece->inner;
        int points = 8 + (int)(POINTS * width / profile->support);
        for (int i = 0; i <= points; i++) {
            double q = i == points ? piece->outer : piece->inner + width * i / points;
            double jet[3];
            sphv_profile_jet(profile, p, q, 2, jet);
            fprintf(script, "%.10g %.10g %.10g %.10g\n", q, jet[0], jet[1], 2 * jet[2]);
        }
    }
    fprintf(script, "%.10g 0 0 0\n%.10g 0 0 0\nEND\n", profile->support, 1.08 * profile->support);
}

struct transform {
    double wavenumber[WAVENUMBERS + 1], value[WAVENUMBERS + 1], bound[WAVENUMBERS + 1];
};

static void compute_transform(const sphv_profile *profile, struct transform *transform)
{
    sphv_result whole = sphv_fourier_transform(profile, 0);
    for (int i = 0; i <= WAVENUMBERS; i++) {
        transform->wavenumber[i] = highest_wavenumber / profile->support * i / WAVENUMBERS;
        sphv_result value = sphv_fourier_transform(profile, transform->wavenumber[i]);
        transform->value[i] = value.value / whole.value;
        transform->bound[i] = value.bound / fabs(whole.value);
    }
}

/// The modulus where the transform has the wanted sign beyond its bound; blank lines elsewhere
/// break the line.
static void write_modulus(FILE *script, const struct transform *transform, int dimension, int sign)
{
    fprintf(script, "$%s%d << END\n", sign > 0 ? "positive" : "negative", dimension);
    for (int i = 0; i <= WAVENUMBERS; i++) {
        double value = sign * transform->value[i];
        if (value > fmax(lowest_drawn, transform->bound[i]))
            fprintf(script, "%.10g %.10g\n", transform->wavenumber[i], value);
        else
            fputc('\n', script);
    }
    fputs("END\n", script);
}

static void write_transform(FILE *script, const struct transform *transform, int dimension)
{
    fprintf(script, "$transform%d << END\n", dimension);
    for (int i = 0; i <= WAVENUMBERS; i++)
        if (isfinite(transform->value[i]))
            fprintf(script, "%.10g %.10g\n", transform->wavenumber[i], transform->value[i]);
    fputs("END\n", script);
    write_modulus(script, transform, dimension, 1);
    write_modulus(script, transform, dimension, -1);
}

static void write_panels(FILE *script, const sphv_profile *profile, const bool legal[])
{
    int first = profile->dimension;
    fputs("set key width 2\nset multiplot layout 3,1\n", script);
    fprintf(script,
            "set xlabel 'q = r/h' offset 0,0.4 noenhanced\nset ylabel 'Ŵ and derivatives, %dD' "
            "noenhanced\n"
            "set xrange [0:%.10g]\nplot ",
            first, 1.08 * profile->support);
    static const char *const names[] = {"Ŵ", "Ŵ′", "Ŵ″"};
    for (size_t i = 0; i < 3; i++)
        fprintf(script,
                "%s$profile using 1:%zu with lines linecolor rgb '%s' dashtype %s linewidth 2 "
                "title '%s'",
                i ? ", " : "", i + 2, sphv_plot_style_of(i)->colour, sphv_plot_style_of(i)->dash,
                names[i]);

    fprintf(script,
            "\nset xlabel 'Ωh, wavenumber in units of 1/h' offset 0,0.4 noenhanced\n"
            "set ylabel 'Fourier transform Ŵ_F(Ω)/Ŵ_F(0)' enhanced\nset xrange [0:%.10g]\n"
            "set xzeroaxis linewidth 1\nplot ",
            highest_wavenumber / profile->support);
    const char *comma = "";
    for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
        const sphv_plot_style *style = sphv_plot_style_of((size_t)d - 1);
        if (!legal[d - 1]) continue;
        fprintf(script,
                "%s$transform%d with lines linecolor rgb '%s' dashtype %s linewidth 2 title '%dD'",
                comma, d, style->colour, style->dash, d);
        comma = ", ";
    }

    fputs("\nset xlabel 'Ωh, wavenumber in units of 1/h (dotted: negative)' noenhanced\n"
          "set ylabel '|Ŵ_F(Ω)|/Ŵ_F(0)' enhanced\nset logscale y\nset format y '10^{%T}'\n"
          "set yrange [1e-10:2]\nplot ",
          script);
    comma = "";
    for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
        const sphv_plot_style *style = sphv_plot_style_of((size_t)d - 1);
        if (!legal[d - 1]) continue;
        fprintf(script,
                "%s$positive%d with linespoints linecolor rgb '%s' linewidth 1.5 pointtype %d "
                "pointsize 0.5 pointinterval 24 title '%dD', "
                "$negative%d with lines linecolor rgb '%s' dashtype '.' linewidth 2 notitle",
                comma, d, style->colour, style->filled, d, d, style->colour);
        comma = ", ";
    }
    fputs("\nunset multiplot\n", script);
}

sphv_status sphv_plot_kernel_as(const sphv_kernel *kernel, const char *id, char **svg,
                                sphv_error *error)
{
    *svg = NULL;
    sphv_plot_script script;
    sphv_status status = sphv_plot_begin(&script, WIDTH, HEIGHT, error);
    if (status != SPHV_OK) return status;
    const sphv_profile *profile = NULL;
    bool legal[SPHV_DIMENSIONS] = {false};
    for (int d = SPHV_DIMENSIONS; d >= 1; d--) {
        const sphv_profile *candidate = sphv_kernel_profile(kernel, d);
        if (!candidate) continue;
        profile = candidate;
        legal[d - 1] = true;
        struct transform transform;
        compute_transform(candidate, &transform);
        write_transform(script.stream, &transform, d);
    }
    if (profile) {
        write_derivatives(script.stream, profile);
        write_panels(script.stream, profile, legal);
    }
    return sphv_plot_finish(&script, id, sphv_kernel_title(kernel), svg, error);
}
