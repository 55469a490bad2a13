// Plots and CSV, with names and titles that try to be code.
#include "report_support.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/// Fails unless tags nest and attributes are quoted; good enough to tell XML from soup.
static void assert_well_formed(const char *xml)
{
    char open[64][32];
    int depth = 0, elements = 0;
    for (const char *c = xml; (c = strchr(c, '<'));) {
        size_t length = strcspn(++c, " >/");
        const char *end = c;
        for (char quote = 0; *end && (quote || *end != '>'); end++) {
            if (quote && *end == quote)
                quote = 0;
            else if (!quote && (*end == '"' || *end == '\''))
                quote = *end;
            assert_int_not_equal(*end, '<');
        }
        assert_int_equal(*end, '>');
        if (*c == '/') {
            length = strcspn(c + 1, " >");
            assert_true(depth > 0);
            depth--;
            assert_int_equal(strlen(open[depth]), length);
            assert_memory_equal(open[depth], c + 1, length);
        } else if (end[-1] != '/') {
            assert_true(depth < 64 && length > 0 && length < 32);
            memcpy(open[depth], c, length);
            open[depth++][length] = '\0';
            elements++;
        }
        c = end;
    }
    assert_int_equal(depth, 0);
    assert_true(elements > 3);
}

static void plots_take_any_text_as_text(void **state)
{
    (void)state;
    if (!have_gnuplot()) skip();
    char *folder = folder_make(), *was = getcwd(NULL, 0);
    assert_int_equal(chdir(folder), 0);
    // Escapes must not swallow a digit that follows, nor anything be lost.
    static const char *const texts[] = {NASTY,
                                        "1.05 '1\"2\\3`4@5#6$7{8}9!0%1^2_3",
                                        "h/λ = 0.05",
                                        "\\",
                                        "'",
                                        "''",
                                        "{",
                                        "}",
                                        "`",
                                        "\xFF\x01\xC3",
                                        ""};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        for (int abscissa = SPHV_OVER_Q; abscissa <= (i ? 0 : (int)SPHV_OVER_SPACING); abscissa++) {
            struct stage stage;
            char *svg;
            sphv_error error;
            stage_make(&stage, (sphv_abscissa)abscissa, texts[i]);
            assert_ok(sphv_plot_scene(stage.result, &svg, &error), error);
            assert_well_formed(svg);
            assert_null(strstr(svg, "<script"));
            assert_null(strstr(svg, "<?xml"));
            assert_non_null(strstr(svg, "role=\"img\""));
            // The legend shows the beginning of both labels as they are.
            if (i == 0) assert_int_equal(count(svg, "'; system(\"touch touched\") # `touch"), 2);
            if (i == 1 || i == 2) assert_true(count(svg, texts[i]) >= 2);
            // Both curves have their 30 points: none is lost behind a broken line.
            assert_true(count(svg, "<path") >= 2);
            assert_untouched();
            free(svg);
            stage_free(&stage);
        }
    assert_int_equal(chdir(was), 0);
    free(was);
    folder_remove(folder);
}

static void a_kernel_is_drawn_in_its_dimensions(void **state)
{
    (void)state;
    if (!have_gnuplot()) skip();
    static const char *const names[] = {"quinlan-w8", "gaussian", "monaghan-m4-prime"};
    for (size_t i = 0; i < 3; i++) {
        sphv_kernel *kernel = load_kernel(names[i]);
        char *svg;
        sphv_error error;
        assert_ok(sphv_plot_kernel(kernel, &svg, &error), error);
        assert_well_formed(svg);
        // In the legends of both panels of the transform.
        assert_int_equal(count(svg, ">3D<"), sphv_kernel_profile(kernel, 3) ? 2 : 0);
        assert_int_equal(count(svg, ">2D<"), 2);
        // Forty of them leave room for the tables in a page of 2.5 MB.
        assert_true(strlen(svg) < 40000);
        free(svg);
        sphv_kernel_free(kernel);
    }
}

/// A field of a CSV line, unquoted when it is a plain number.
static double csv_number(const char *line, int column)
{
    while (column--) {
        if (*line == '"')
            for (line++; *line != '"' || line[1] == '"'; line++) line += *line == '"';
        line = strchr(line, ',');
        assert_non_null(line++);
    }
    return strtod(line, NULL);
}

static void csv_holds_every_digit(void **state)
{
    (void)state;
    struct stage stage;
    stage_make(&stage, SPHV_OVER_SPACING, "a,\"b\"\nc");
    char *csv;
    size_t size;
    FILE *stream = open_memstream(&csv, &size);
    assert_non_null(stream);
    sphv_scene_csv(stream, stage.result);
    fclose(stream);
    char *line = strchr(csv, '\n') + 1;
    assert_int_equal(count(csv, "\n"),
                     1 + stage.result->sample_count[0] + stage.result->sample_count[1]);
    for (size_t c = 0; c < 2; c++)
        for (size_t i = 0; i < stage.result->sample_count[c]; i++) {
            const sphv_sample *sample = &stage.result->samples[c][i];
            assert_true(csv_number(line, 3) == sample->h);
            assert_true(csv_number(line, 4) == sample->spacing.value);
            assert_true(csv_number(line, 8) == sample->point.analytic.total.value);
            assert_true(csv_number(line, 9) == sample->point.analytic.total.bound);
            assert_true(csv_number(line, 11) == sample->point.empirical.total.value);
            if (sample->n >= 0) assert_true(csv_number(line, 18) == sample->paper.total.value);
            line = strchr(line, '\n') + 1;
        }
    assert_string_equal(line, "");
    free(csv);
    stage_free(&stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plots_take_any_text_as_text),
        cmocka_unit_test(a_kernel_is_drawn_in_its_dimensions),
        cmocka_unit_test(csv_holds_every_digit),
    };
    return run_group(tests);
}
