// What the report says of disordered particles: experiments, seeds, failures, and volume rules.
#include "support.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "report/scene_facts.h"
#include "report/volume_rules.h"
#include "sphverify/report.h"

/// Error over Δx/h where the noise decides it: of order 7/2 with tessellated volumes and 3/2 with
/// volumes Δx, so that a claim made from one slope does not hold for the other.
static const char scene_head[] =
    "name: disorder\n"
    "title: Disorder\n"
    "source: none\n"
    "abscissa: {quantity: spacing, scale: log, from: 1/5, to: 6/5, points: 8, markers: 4}\n"
    "realisations: {least: 8, most: 8, width: 0.9, seed: 7}\n"
    "curves:\n";
static const char tessellated[] =
    "  - {id: t, label: T, kernel: quinlan-w10, method: sph, layout: perturbed, volume: "
    "tessellated, sigma: 0.1, h: 0.005}\n";
static const char lattice[] =
    "  - {id: l, label: L, kernel: quinlan-w10, method: sph, layout: perturbed, volume: lattice, "
    "sigma: 0.1, h: 0.005}\n";
static const char uniform[] = "  - {id: u, label: U, kernel: quinlan-w10, h: 0.005}\n";
/// Supports of two particles: the second-order matrix is singular wherever it is asked for.
static const char failing[] =
    "  - {id: f, label: F, kernel: quinlan-w10, method: rkpm-2, layout: random, volume: unit, h: "
    "0.005}\n";

struct run {
    sphv_scene *scene;
    sphv_scene_result *result;
};

static struct run run_scene(const char *curves, const char *claims)
{
    char text[4096], *folder = folder_make();
    snprintf(text, sizeof text, "%s%s%s", scene_head, curves, claims);
    char *path = file_write(folder, "disorder.yaml", text);
    struct run run = {NULL, NULL};
    sphv_error error;
    assert_ok(sphv_scene_load(data_directory(), path, &run.scene, &error), error);
    assert_ok(sphv_scene_run(run.scene, NULL, NULL, &run.result, &error), error);
    free(path);
    folder_remove(folder);
    return run;
}

static void run_free(struct run *run)
{
    sphv_scene_result_free(run->result);
    sphv_scene_free(run->scene);
}

static void claim_text(char text[512], const char *curve, double expected, double tolerance)
{
    snprintf(text, 512,
             "claims:\n  - {id: c, statement: S, measure: slope, curve: %s, from: 1/4, to: 1, "
             "expected: %.12g, tolerance: %.12g, reason: none}\n",
             curve, expected, tolerance);
}

static sphv_rule_comparison compare(const struct run *run)
{
    sphv_scene_result *scenes[] = {run->result};
    sphv_report report = {.scene_count = 1, .scenes = scenes};
    sphv_rule_comparison rules;
    sphv_error error;
    assert_ok(sphv_volume_rules_compute(&report, &rules, &error), error);
    return rules;
}

/// Slopes of both curves, each judged on its own curve.
static void measured_slopes(double slope[SPHV_RULES])
{
    char curves[1024], claims[512];
    snprintf(curves, sizeof curves, "%s%s", tessellated, lattice);
    claim_text(claims, "t", 1, 1);
    struct run run = run_scene(curves, claims);
    slope[SPHV_RULE_TESSELLATED] = run.result->claims[0].empirical;
    sphv_claim claim = run.scene->claims[0];
    claim.curve = 1;
    slope[SPHV_RULE_LATTICE] = sphv_claim_judge(run.result, &claim).empirical;
    run_free(&run);
    assert_true(fabs(slope[0] - slope[1]) > 0.5);
}

/// Whichever rule the claim was made from, and whichever of the curves the scene holds, the same
/// rule is found to reproduce it.
static void the_rule_of_the_claim_is_found(void **state)
{
    (void)state;
    double slope[SPHV_RULES];
    measured_slopes(slope);
    static const char *const ids[] = {"t", "l"};
    char both[1024], claims[512];
    snprintf(both, sizeof both, "%s%s", tessellated, lattice);
    const char *const held[] = {both, tessellated, lattice};
    for (int truth = 0; truth < SPHV_RULES; truth++)
        for (int curves = 0; curves < 3; curves++) {
            int stated = curves == 0 ? SPHV_RULE_TESSELLATED : curves - 1;
            claim_text(claims, ids[stated], slope[truth], 0.25);
            struct run run = run_scene(held[curves], claims);
            sphv_rule_comparison rules = compare(&run);
            assert_int_equal(rules.count, 1);
            assert_int_equal(rules.reproducing, truth);
            assert_int_equal(rules.telling, 1);
            assert_int_equal(rules.holding[truth], 1);
            assert_int_equal(rules.holding[1 - truth], 0);
            char searched[80];
            snprintf(searched, sizeof searched, "reproduced by %s.", sphv_rule_name[truth]);
            assert_non_null(strstr(rules.conclusion, searched));
            // The missing curve is the other with its rule changed: the same particles, to the bit.
            for (int rule = 0; rule < SPHV_RULES; rule++)
                assert_true(rules.rows[0].found[rule].empirical == slope[rule]);
            sphv_volume_rules_free(&rules);
            run_free(&run);
        }
}

static void claims_that_cannot_tell_are_said_not_to(void **state)
{
    (void)state;
    char claims[512], curves[1024];
    claim_text(claims, "t", 2, 2); // holds with both
    struct run run = run_scene(tessellated, claims);
    sphv_rule_comparison rules = compare(&run);
    assert_int_equal(rules.count, 1);
    assert_int_equal(rules.holding[0], 1);
    assert_int_equal(rules.holding[1], 1);
    assert_int_equal(rules.telling, 0);
    assert_int_equal(rules.reproducing, -1);
    assert_non_null(strstr(rules.conclusion, "do not tell"));
    sphv_volume_rules_free(&rules);
    run_free(&run);
    // On a lattice there is no rule to compare, and a claim about both compares them already.
    snprintf(curves, sizeof curves, "%s%s%s", uniform, tessellated, lattice);
    run = run_scene(curves,
                    "claims:\n"
                    "  - {id: u, statement: S, measure: slope, curve: u, expected: 0, tolerance: "
                    "9, reason: none}\n"
                    "  - {id: r, statement: S, measure: ratio, curve: l, reference: t, expected: "
                    "5, tolerance: 9, reason: none}\n");
    rules = compare(&run);
    assert_int_equal(rules.count, 0);
    sphv_volume_rules_free(&rules);
    run_free(&run);
    // Stated for both rules, a claim is listed once.
    run = run_scene(curves,
                    "claims:\n"
                    "  - {id: a, statement: S, measure: slope, curve: t, expected: 2, tolerance: "
                    "9, reason: none}\n"
                    "  - {id: b, statement: S, measure: slope, curve: l, from: 0.3, expected: 2, "
                    "tolerance: 9, reason: none}\n"
                    "  - {id: c, statement: S, measure: slope, curve: l, expected: 3, tolerance: "
                    "9, reason: none}\n");
    rules = compare(&run);
    assert_int_equal(rules.count, 2);
    assert_string_equal(rules.rows[0].claim->id, "a");
    assert_string_equal(rules.rows[1].claim->id, "c");
    sphv_volume_rules_free(&rules);
    run_free(&run);
}

static void faults_are_counted_by_method_and_reason(void **state)
{
    (void)state;
    char curves[1024];
    snprintf(curves, sizeof curves, "%s%s%s", uniform, tessellated, failing);
    struct run run = run_scene(curves, "");
    sphv_scene_result *scenes[] = {run.result, run.result};
    sphv_report report = {.scene_count = 2, .scenes = scenes};
    size_t count;
    sphv_method_facts *methods = sphv_method_facts_collect(&report, &count);
    assert_non_null(methods);
    assert_int_equal(count, 2); // sph and rkpm-2, in the order of the table
    assert_string_equal(methods[0].name, "sph");
    assert_int_equal(methods[0].curves, 4);
    assert_string_equal(methods[1].name, "rkpm-2");
    assert_int_equal(methods[1].curves, 2);
    // Each estimate of every sample is in the sum, twice, since the scene stands there twice.
    long estimates[2] = {0, 0}, faults[3] = {0, 0, 0};
    double worst = 0;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < run.result->sample_count[c]; i++) {
            const sphv_point *point = &run.result->samples[c][i].point;
            estimates[c == 2] += 2 * point->empirical.particles;
            if (c != 2) continue;
            faults[0] += 2 * point->disorder.singular;
            faults[1] += 2 * point->disorder.ill_conditioned;
            faults[2] += 2 * point->disorder.not_finite;
            worst = fmax(worst, point->disorder.worst_condition);
        }
    assert_int_equal(methods[0].faults.estimates, estimates[0]);
    assert_int_equal(methods[0].faults.singular, 0);
    assert_int_equal(methods[1].faults.estimates, estimates[1]);
    assert_int_equal(methods[1].faults.singular, faults[0]);
    assert_int_equal(methods[1].faults.ill_conditioned, faults[1]);
    assert_int_equal(methods[1].faults.not_finite, faults[2]);
    assert_true(faults[0] + faults[1] > 0);
    assert_true(methods[1].faults.worst_condition == worst);
    assert_string_equal(methods[1].faults.worst_scene, run.scene->name);
    sphv_curve_facts facts = sphv_curve_facts_collect(run.result, 2);
    assert_true(facts.statistical && facts.random && isnan(facts.sigma));
    assert_int_equal(facts.realisations_most, 8);
    facts = sphv_curve_facts_collect(run.result, 0);
    assert_true(!facts.statistical && !facts.random);
    char text[120];
    sphv_faults_text(text, sizeof text,
                     &(sphv_fault_counts){.singular = 3, .not_finite = 2, .worst_condition = NAN});
    assert_string_equal(text, "singular 3, not finite 2");
    sphv_faults_text(text, sizeof text, &(sphv_fault_counts){.estimates = 5});
    assert_string_equal(text, "none");
    free(methods);
    run_free(&run);
}

static const char *text_at(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

static void assert_curve(const json_t *curve, const struct run *run, size_t c)
{
    const json_t *sample, *samples = json_object_get(curve, "samples");
    assert_int_equal(json_array_size(samples), run->result->sample_count[c]);
    size_t i;
    json_array_foreach(samples, i, sample)
    {
        const sphv_point *point = &run->result->samples[c][i].point;
        const json_t *analytic = json_object_get(sample, "analytic");
        const json_t *empirical = json_object_get(sample, "empirical");
        const json_t *faults = json_object_get(sample, "faults");
        assert_true(json_number_value(json_object_get(empirical, "l2_bound")) ==
                    point->empirical.l2.bound);
        if (isfinite(point->analytic.l2.bound))
            assert_true(json_number_value(json_object_get(analytic, "l2_bound")) ==
                        point->analytic.l2.bound);
        else
            assert_true(json_is_null(json_object_get(analytic, "l2_bound")));
        assert_int_equal(json_integer_value(json_object_get(sample, "realisations")),
                         point->disorder.realisations);
        assert_int_equal(json_integer_value(json_object_get(faults, "estimates")),
                         point->disorder.particles);
        assert_int_equal(json_integer_value(json_object_get(faults, "singular")),
                         point->disorder.singular);
    }
}

static void the_pages_tell_the_experiment(void **state)
{
    (void)state;
    char curves[1024], claims[512], *folder = folder_make();
    snprintf(curves, sizeof curves, "%s%s", tessellated, failing);
    claim_text(claims, "t", 2.5, 1);
    struct run run = run_scene(curves, claims);
    sphv_scene_result *scenes[] = {run.result};
    sphv_report report = {.scene_count = 1, .scenes = scenes};
    bool plots_missing;
    sphv_error error;
    char *path = strdup(getenv("PATH") ? getenv("PATH") : "");
    setenv("PATH", folder, 1); // the plots are looked at elsewhere
    sphv_status status = sphv_report_write(&report, folder, &plots_missing, &error);
    setenv("PATH", path, 1);
    free(path);
    assert_ok(status, error);
    char *html = file_read(folder, "index.html"), *markdown = file_read(folder, "report.md"),
         *text = file_read(folder, "report.json");
    json_error_t reason;
    json_t *json = json_loads(text, 0, &reason);
    assert_non_null(json);
    const json_t *scene = json_array_get(json_object_get(json, "scenes"), 0);
    assert_true(json_is_true(json_object_get(scene, "statistical")));
    const json_t *found = json_object_get(scene, "curves"), *first = json_array_get(found, 0);
    assert_string_equal(text_at(first, "method"), "sph");
    assert_string_equal(text_at(first, "layout"), "perturbed");
    assert_string_equal(text_at(first, "volume"), "tessellated");
    assert_true(json_number_value(json_object_get(first, "sigma")) == 0.1);
    assert_int_equal(json_integer_value(json_object_get(first, "seed")), 7);
    for (size_t c = 0; c < 2; c++) assert_curve(json_array_get(found, c), &run, c);
    const json_t *disorder = json_object_get(json, "disorder");
    assert_int_equal(json_array_size(json_object_get(disorder, "methods")), 2);
    const json_t *rules = json_object_get(disorder, "volume_rules");
    assert_int_equal(json_array_size(json_object_get(rules, "claims")), 1);
    // Page and Markdown: the experiment, the seed, no column about the paper's form.
    assert_non_null(strstr(html, "<td>sph<td>perturbed<td>tessellated<td>0.1<td>7<td>8<td"));
    assert_non_null(strstr(html, "<td>rkpm-2<td>random<td>unit<td>–<td>7<td>8<td"));
    assert_non_null(strstr(html, text_at(rules, "conclusion")));
    assert_null(strstr(strstr(html, "id=\"scene-0\""), "Paper’s form: points"));
    assert_non_null(strstr(markdown, "| sph | perturbed | tessellated | 0.1 | 7 | 8 | "));
    assert_non_null(strstr(markdown, text_at(rules, "conclusion")));
    json_decref(json);
    free(text);
    free(html);
    free(markdown);
    folder_remove(folder);
    run_free(&run);
}

/// A field of a CSV line without quotes.
static void field(const char *line, int column, char out[64])
{
    while (column--) line = strchr(line, ',') + 1;
    snprintf(out, 64, "%.*s", (int)strcspn(line, ",\n"), line);
}

static int column_of(const char *header, const char *name)
{
    char text[64];
    for (int column = 0; column < 40; column++) {
        field(header, column, text);
        if (strcmp(text, name) == 0) return column;
    }
    fail_msg("no column %s", name);
    return -1;
}

static void csv_tells_the_experiment_of_every_point(void **state)
{
    (void)state;
    char curves[1024], *csv, text[64];
    size_t size;
    snprintf(curves, sizeof curves, "%s%s", uniform, tessellated);
    struct run run = run_scene(curves, "");
    FILE *stream = open_memstream(&csv, &size);
    assert_non_null(stream);
    sphv_scene_csv(stream, run.result);
    fclose(stream);
    static const char *const names[] = {"method", "layout", "volume",
                                        "sigma",  "seed",   "realisations"};
    static const char *const words[2][6] = {{"sph", "lattice", "lattice", "", "", ""},
                                            {"sph", "perturbed", "tessellated", NULL, "7", "8"}};
    const char *line = strchr(csv, '\n') + 1;
    for (size_t c = 0; c < 2; c++)
        for (size_t i = 0; i < run.result->sample_count[c]; i++, line = strchr(line, '\n') + 1) {
            const sphv_point *point = &run.result->samples[c][i].point;
            for (size_t k = 0; k < 6; k++) {
                field(line, column_of(csv, names[k]), text);
                if (words[c][k]) assert_string_equal(text, words[c][k]);
            }
            field(line, column_of(csv, "empirical_l2_bound"), text);
            assert_true(strtod(text, NULL) == point->empirical.l2.bound);
            field(line, column_of(csv, "analytic_l2_bound"), text);
            assert_true(strtod(text, NULL) == point->analytic.l2.bound);
            if (c == 0) continue;
            field(line, column_of(csv, "sigma"), text);
            assert_true(strtod(text, NULL) == 0.1);
            field(line, column_of(csv, "estimates"), text);
            assert_int_equal(strtol(text, NULL, 10), point->disorder.particles);
            field(line, column_of(csv, "worst_condition"), text);
            assert_true(strtod(text, NULL) == point->disorder.worst_condition);
        }
    assert_string_equal(line, "");
    free(csv);
    run_free(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rule_of_the_claim_is_found),
        cmocka_unit_test(claims_that_cannot_tell_are_said_not_to),
        cmocka_unit_test(faults_are_counted_by_method_and_reason),
        cmocka_unit_test(the_pages_tell_the_experiment),
        cmocka_unit_test(csv_tells_the_experiment_of_every_point),
    };
    return run_group(tests);
}
