/// Scene files and running them: each bad line has its message, and a run judges its claims.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sphverify/scene.h"
#include "support.h"

static const char *const good[] = {
    "name: small",                                                                        // 1
    "title: A small scene",                                                               // 2
    "source: Here",                                                                       // 3
    "abscissa: {quantity: spacing, scale: log, from: 4/25, to: 4/13, points: 20}",        // 4
    "curves:",                                                                            // 5
    "  - {id: w10, label: W10, kernel: quinlan-w10, h: 0.0001}",                          // 6
    "  - {id: cubic, label: Cubic, kernel: cubic-spline, h: 0.0001}",                     // 7
    "claims:",                                                                            // 8
    "  - {id: order, statement: Sixth order, measure: slope, curve: w10, special: true,", // 9
    "     expected: 6, tolerance: 0.2, reason: next terms}",                              // 10
};
enum { LINES = sizeof good / sizeof *good };

static sphv_status load(const char *text, sphv_scene **out, sphv_error *error)
{
    char *folder = folder_make(), *path = file_write(folder, "s.yaml", text);
    sphv_status status = sphv_scene_load(data_directory(), path, out, error);
    free(path);
    folder_remove(folder);
    return status;
}

static sphv_status load_changed(int line, const char *replacement, sphv_scene **out,
                                sphv_error *error)
{
    char *text = text_with_line(good, LINES, line, replacement);
    sphv_status status = load(text, out, error);
    free(text);
    return status;
}

static void test_bad_lines(void **state)
{
    (void)state;
    static const struct {
        int line;
        const char *replacement, *part;
    } cases[] = {
        {1, "name: a/b", ":1: 'a/b' is not a name"},
        {1, "# none", "lacks the key 'name'"},
        {3, "origin: Here", ":3: unknown key 'origin'"},
        {4, "abscissa: {quantity: mass, scale: log, from: 1, to: 2, points: 20}", ":4:"},
        {4, "abscissa: {quantity: h, scale: cubic, from: 1, to: 2, points: 20}", ":4:"},
        {4, "abscissa: {quantity: h, scale: log, from: 0, to: 2, points: 20}", ":4: range 0 to 2"},
        {4, "abscissa: {quantity: h, scale: log, from: 2, to: 1, points: 20}", ":4: range 2 to 1"},
        {4, "abscissa: {quantity: h, scale: log, from: -1, to: 1, points: 20}",
         ":4: range -1 to 1"},
        {4, "abscissa: {quantity: h, scale: log, from: .nan, to: 1, points: 20}", ":4: '.nan'"},
        {4, "abscissa: {quantity: h, scale: log, from: 1, to: 1e999, points: 20}", ":4: '1e999'"},
        {4, "abscissa: {quantity: h, scale: log, from: 1, to: 2, points: 1}", ":4: 1 points"},
        {4, "abscissa: {quantity: h, scale: log, from: 1, to: 2, points: 900000}", ":4: 900000"},
        {4, "abscissa: {quantity: h, scale: log, from: 1, to: 2, points: 9, markers: 10}",
         ":4: 10 markers"},
        {6, "  - {id: w10, label: W10, kernel: no-such-kernel, h: 0.0001}", "no-such-kernel"},
        {6, "  - {id: w10, label: W10, kernel: quinlan-w10, h: 0}", ":6:"},
        {6, "  - {id: w10, label: W10, kernel: quinlan-w10, h: nan}", ":6: 'nan'"},
        {6, "  - {id: w10, label: W10, kernel: quinlan-w10, h: 1e30}", ":6:"},
        {6, "  - {id: w10, label: W10, kernel: quinlan-w10}", ":6:"},
        {7, "  - {id: w10, label: Cubic, kernel: cubic-spline, h: 0.1}", ":7: curve 'w10' again"},
        {10,
         "     expected: 6, tolerance: 0.2, reason: x}\n"
         "  - {id: order, statement: x, measure: slope, curve: w10, expected: 1, tolerance: 1, "
         "reason: x}",
         ":11: claim 'order' again"},
        {9, "  - {id: order, statement: x, measure: weight, curve: w10,", ":9: unknown measure"},
        {9, "  - {id: order, statement: x, measure: slope, curve: w11,", ":9: no curve 'w11'"},
        {9, "  - {id: order, statement: x, measure: ratio, curve: w10,",
         ":9: measure 'ratio' needs"},
        {9, "  - {id: order, statement: x, measure: slope, curve: w10, reference: cubic,",
         ":9: measure 'slope' takes no"},
        {10, "     expected: 6, tolerance: -0.2, reason: next terms}", ":10: tolerance -0.2"},
        {10, "     expected: six, tolerance: 0.2, reason: next terms}", ":10: 'six'"},
        {10, "     expected: 6, tolerance: inf, reason: next terms}", ":10: 'inf'"},
        {10, "     expected: 6, tolerance: 0.2}", "lacks the key 'reason'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sphv_scene *scene = NULL;
        sphv_error error = {SPHV_OK, ""};
        sphv_status status = load_changed(cases[i].line, cases[i].replacement, &scene, &error);
        if (status == SPHV_OK) fail_msg("accepted: %s", cases[i].replacement);
        assert_failed(status, &error, SPHV_INVALID_INPUT, cases[i].part);
        assert_null(scene);
    }
}

static sphv_scene_result *run(const sphv_scene *scene)
{
    sphv_scene_result *result = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_scene_run(scene, NULL, NULL, &result, &error), error);
    return result;
}

static void test_a_run(void **state)
{
    (void)state;
    sphv_scene *scene = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(load_changed(0, "", &scene, &error), error);
    assert_string_equal(scene->name, "small");
    assert_int_equal(scene->curve_count, 2);
    assert_int_equal(scene->claim_count, 1);
    sphv_scene_result *result = run(scene), *again = run(scene);
    assert_int_equal(result->verdict, SPHV_AGREES);
    assert_int_equal(result->disagreeing + result->inconclusive, 0);
    size_t points = 0, special = 0;
    for (size_t c = 0; c < 2; c++) {
        assert_int_equal(result->sample_count[c], again->sample_count[c]);
        for (size_t i = 0; i < result->sample_count[c]; i++) {
            const sphv_sample *sample = &result->samples[c][i];
            if (i > 0 && !(sample->x > result->samples[c][i - 1].x))
                fail_msg("x goes from %.17g to %.17g", result->samples[c][i - 1].x, sample->x);
            assert_close(sample->h, 0.0001, 0);
            special += sample->n >= 0;
            // any number of threads gives the same bits
            assert_close(sample->point.empirical.total.value,
                         again->samples[c][i].point.empirical.total.value, 0);
            assert_close(sample->point.analytic.total.value,
                         again->samples[c][i].point.analytic.total.value, 0);
        }
        points += result->sample_count[c];
    }
    assert_int_equal(result->agreeing, points);
    // the special spacings 4/13 … 4/25, the ends of the range among them, each once, stand among
    // the points of both curves
    assert_int_equal(special, 2 * 7);
    assert_false(result->claims[0].surprising);
    assert_close(result->claims[0].empirical, 6, 0.2);
    assert_close(result->claims[0].analytic, result->claims[0].empirical, 1e-6);
    sphv_scene_result_free(result);
    sphv_scene_result_free(again);
    sphv_scene_free(scene);
    sphv_scene_free(NULL);
    sphv_scene_result_free(NULL);
}

/// A claim that is wrong must come out as surprising, and make the scene disagree.
static void test_a_wrong_claim_is_noticed(void **state)
{
    (void)state;
    sphv_scene *scene = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(
        load_changed(10, "     expected: 5, tolerance: 0.2, reason: a guess}", &scene, &error),
        error);
    sphv_scene_result *result = run(scene);
    assert_int_equal(result->disagreeing, 0);
    assert_true(result->claims[0].surprising);
    assert_int_equal(result->claims[0].verdict, SPHV_DISAGREES);
    assert_int_equal(result->verdict, SPHV_DISAGREES);
    sphv_scene_result_free(result);
    sphv_scene_free(scene);
}

/// A claim that is said to be refuted, but holds, is a surprise too.
static void test_a_wrong_refutation_is_noticed(void **state)
{
    (void)state;
    sphv_scene *scene = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(load_changed(10, "     expected: 6, tolerance: 0.2, reason: x, refuted: it holds}",
                           &scene, &error),
              error);
    sphv_scene_result *result = run(scene);
    assert_true(result->claims[0].surprising);
    assert_int_equal(result->verdict, SPHV_DISAGREES);
    sphv_scene_result_free(result);
    sphv_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_lines),
        cmocka_unit_test(test_a_run),
        cmocka_unit_test(test_a_wrong_claim_is_noticed),
        cmocka_unit_test(test_a_wrong_refutation_is_noticed),
    };
    return run_group(tests);
}
