// Text from outside stays text in every format.
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "report/svg.h"
#include "report/svg_path.h"
#include "report/text.h"

static char *written(void (*put)(FILE *stream, const char *text), const char *text)
{
    char *out;
    size_t size;
    FILE *stream = open_memstream(&out, &size);
    assert_non_null(stream);
    put(stream, text);
    fclose(stream);
    return out;
}

static void assert_written(void (*put)(FILE *stream, const char *text), const char *text,
                           const char *expected)
{
    char *out = written(put, text);
    assert_string_equal(out, expected);
    free(out);
}

static void put_gnuplot_ten(FILE *stream, const char *text)
{
    sphv_put_gnuplot(stream, text, 10);
}

static void html_shows_markup_as_text(void **state)
{
    (void)state;
    assert_written(sphv_put_html, "<b a=\"1\" c='2'>&amp;</b>",
                   "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;amp;&lt;/b&gt;");
    assert_written(sphv_put_html, "λ/√2 ≤ 1", "λ/√2 ≤ 1");
}

static void markdown_shows_markup_as_text(void **state)
{
    (void)state;
    assert_written(sphv_put_markdown, "a|b *c* _d_ `e` [f](g) <h> ![i]\n# j",
                   "a&#124;b \\*c\\* \\_d\\_ \\`e\\` \\[f\\](g) &lt;h&gt; !\\[i\\] \\# j");
    assert_written(sphv_put_markdown, "E: see http://x.y", "E: see http&#58;//x.y");
}

static void csv_quotes_what_would_break_a_row(void **state)
{
    (void)state;
    assert_written(sphv_put_csv, "plain", "plain");
    assert_written(sphv_put_csv, "a,\"b\"\nc", "\"a,\"\"b\"\" c\"");
    assert_written(sphv_put_csv, "=1+1", "\"'=1+1\"");
}

static void gnuplot_strings_cannot_be_left(void **state)
{
    (void)state;
    assert_written(put_gnuplot_ten, "it's", "\"it\\047\" . \"s\"");
    assert_written(put_gnuplot_ten, "\"`\\λ", "\"\\042\" . \"\\140\" . \"\\134\" . \"λ\"");
    assert_written(put_gnuplot_ten, "h/λ = 0.5", "\"h/λ = 0.5\"");
    assert_written(put_gnuplot_ten, "a\nb\tc", "\"a b c\"");
    assert_written(put_gnuplot_ten, "1234567890", "\"1234567890\"");
    assert_written(put_gnuplot_ten, "12345678901", "\"123456789…\"");
}

/// No sequence of bytes may come through as anything but valid UTF-8 without control characters.
static void any_bytes_become_valid_text(void **state)
{
    (void)state;
    assert_written(sphv_put_html, "a\xFFz", "a\xEF\xBF\xBDz");
    assert_written(sphv_put_html, "\xC0\xAF", "\xEF\xBF\xBD\xEF\xBF\xBD"); // overlong '/'
    assert_written(sphv_put_html, "\xED\xA0\x80", "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");
    assert_written(sphv_put_html, "\xE2\x82", "\xEF\xBF\xBD\xEF\xBF\xBD"); // cut short
    assert_written(sphv_put_html, "\x1B[31m\x7F\xC2\x85", " [31m  ");
    assert_written(sphv_put_html, "\xE2\x80\xA8", " ");
    random_start("any_bytes_become_valid_text");
    for (int run = 0; run < (quick() ? 500 : 20000); run++) {
        char text[24] = "", c[5];
        for (int i = 0; i < 23; i++) text[i] = (char)random_integer(1, 255);
        const char *at = text;
        int characters = 0;
        while (sphv_text_next(&at, c)) {
            characters++;
            const char *again = c;
            char same[5];
            assert_true(sphv_text_next(&again, same)); // what comes out is accepted as it is
            assert_string_equal(same, c);
            assert_string_equal(again, "");
            assert_true((unsigned char)c[0] >= 0x20);
        }
        assert_ptr_equal(at, text + strlen(text));
        assert_true(characters > 0 && characters <= 23);
    }
}

static void numbers_read_well(void **state)
{
    (void)state;
    static const struct {
        double value;
        int digits;
        const char *text;
    } cases[] = {
        {1.5, 3, "1.5"},
        {-2.5e-7, 3, "−2.5e−7"},
        {1e100, 3, "1e100"},
        {-0.0, 3, "0"},
        {1e-10, 3, "1e−10"},
        {100.05, 5, "100.05"},
        {NAN, 3, "–"},
        {-INFINITY, 3, "–"},
        {1.05e+05, 17, "105000"},
        {-0.012345, 2, "−0.012"},
        {1e5, 2, "1e5"},
    };
    char text[SPHV_NUMBER_TEXT];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_string_equal(sphv_number_text(text, cases[i].value, cases[i].digits), cases[i].text);
    // The longest there is fits.
    assert_true(strlen(sphv_number_text(text, -1.2345678901234567e-300, 17)) < sizeof text);
}

static void a_picture_is_made_fit_for_a_page(void **state)
{
    (void)state;
    // A symbol that nothing refers to, repetitions of what the root says, empty groups, a colour in
    // words, a line with a point on the way that it does not need and one that it does.
    static const char document[] =
        "<?xml version=\"1.0\"?>\n<svg \n viewBox=\"0 0 600 400\"\n xmlns=\"x\">\n"
        "<title>Gnuplot</title><desc>by</desc><rect x=\"0\" width=\"9\" fill=\"none\"/><defs><path "
        "id='gpPt0' stroke='black' d='M0,0\n\t"
        "L1.125,1'/><rect id='gpPt1' x='1'/></defs><g fill=\"none\"> \n</g><g id=\"plot\" ><g "
        "color=\"black\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"2.00\"><path "
        "stroke='rgb(  0, 114, 178)' d='M10.00,20.00 L15.00,20.04 L20.00,20.00\n\t L20.00,30.26 "
        "M1,1 L1,1 Z '/></g></g><g color=\"black\"><use xlink:href='#gpPt0' "
        "transform='translate(1.26,2.00) scale(3.83)'/><text> id='no' black 1.250 &lt;b><tspan "
        "font-family=\"sans-serif\" >x</tspan><tspan dy=\"1.50px\"></tspan></text></g>\n</svg>\n";
    char *svg;
    sphv_error error;
    assert_ok(sphv_svg_embed(document, "k7", "a <b> & 'c'", &svg, &error), error);
    assert_string_equal(
        svg, "<svg xmlns=\"http://www.w3.org/2000/svg\" "
             "xmlns:xlink=\"http://www.w3.org/1999/xlink\" viewBox=\"0 0 600 400\" role=\"img\" "
             "fill=\"none\" stroke=\"currentColor\" font-family=\"sans-serif\" font-size=\"17\" "
             "aria-labelledby=\"k7-title\"><title id=\"k7-title\">a &lt;b&gt; &amp; &#39;c&#39;"
             "</title><defs><path id='k7-gpPt0' stroke='currentColor' d='M0,0\n\tL1.125,1'/></defs>"
             "<g stroke-width=\"2\"><path stroke='#0072B2' d='M10 20l10 0 0 10.3M1 1l0 0z'/></g>"
             "<use xlink:href='#k7-gpPt0' transform='translate(1.3,2) scale(3.8)'/>"
             "<text> id='no' black 1.250 &lt;b>x</text></svg>");
    free(svg);
    static const char *const broken[] = {"",
                                         "no picture",
                                         "<svg>",
                                         "<svg></svg>",
                                         "<svg viewBox=\"0 0 1 1\">",
                                         "<svg viewBox=\"0 0 1"};
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++)
        assert_failed(sphv_svg_embed(broken[i], "k", "t", &svg, &error), &error,
                      SPHV_RESOURCE_FAILURE, "no complete picture");
}

/// Wherever a path goes, what is drawn in its place stays within a sixth of a unit of it: a tenth
/// for the points left out, and half the diagonal of the grid of tenths.
static void a_shorter_path_stays_on_the_curve(void **state)
{
    (void)state;
    enum { POINTS = 400 };
    double x[POINTS], y[POINTS];
    char *path, *shorter;
    size_t size;
    random_start("a_shorter_path_stays_on_the_curve");
    FILE *out = open_memstream(&path, &size);
    assert_non_null(out);
    for (int i = 0; i < POINTS; i++) {
        x[i] = round(100 * (1.13 * i + (double)random_integer(-1, 1))) / 100;
        y[i] = round(100 * (200 + 150 * sin(i / 9.0) * exp(-i / 90.0))) / 100;
        fprintf(out, "%s%.2f,%.2f ", i ? "L" : "M", x[i], y[i]);
    }
    fclose(out);
    out = open_memstream(&shorter, &size);
    assert_non_null(out);
    sphv_svg_put_path(out, path, path + strlen(path));
    fclose(out);
    assert_true(strlen(shorter) < strlen(path) / 2);
    // Read back: M x y, then l with relative pairs.
    double at[2], before[2];
    int used = 0, kept = 0, next = 0;
    assert_int_equal(sscanf(shorter, "M%lf%lf%n", &at[0], &at[1], &used), 2);
    const char *rest = shorter + used;
    assert_int_equal(*rest++, 'l');
    for (; *rest; kept++) {
        double step[2];
        memcpy(before, at, sizeof at);
        assert_int_equal(sscanf(rest, "%lf%lf%n", &step[0], &step[1], &used), 2);
        rest += used;
        for (int k = 0; k < 2; k++) at[k] += step[k];
        // Points of the curve up to the one that this end stands for lie on the line to it.
        double length = hypot(step[0], step[1]);
        do {
            double along = ((x[next] - before[0]) * step[0] + (y[next] - before[1]) * step[1]) /
                           fmax(length * length, 1e-9);
            along = fmin(1, fmax(0, along));
            double off =
                hypot(x[next] - before[0] - along * step[0], y[next] - before[1] - along * step[1]);
            assert_true(off <= 0.1 + 0.0708);
        } while (hypot(x[next] - at[0], y[next] - at[1]) > 0.0708 && ++next < POINTS);
        assert_true(next < POINTS);
    }
    assert_int_equal(next, POINTS - 1);
    assert_true(kept < POINTS);
    free(path);
    free(shorter);
    // What is not understood is left alone.
    static const char *const others[] = {"M0,-1.33 h2 v3", "L1,2", "M1,", "M1,2 L", "", "M1,nan"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        out = open_memstream(&shorter, &size);
        assert_non_null(out);
        sphv_svg_put_path(out, others[i], others[i] + strlen(others[i]));
        fclose(out);
        assert_string_equal(shorter, others[i]);
        free(shorter);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(html_shows_markup_as_text),
        cmocka_unit_test(markdown_shows_markup_as_text),
        cmocka_unit_test(csv_quotes_what_would_break_a_row),
        cmocka_unit_test(gnuplot_strings_cannot_be_left),
        cmocka_unit_test(any_bytes_become_valid_text),
        cmocka_unit_test(numbers_read_well),
        cmocka_unit_test(a_picture_is_made_fit_for_a_page),
        cmocka_unit_test(a_shorter_path_stays_on_the_curve),
    };
    return run_group(tests);
}
