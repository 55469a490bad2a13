// Convergence scenes: bad files, a run against numbers worked out another way, and how cells,
// groups and claims are judged.
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/directory.h"
#include "scene/convergence_internal.h"
#include "sphverify/convergence.h"
#include "sphverify/report.h"

/// The small scene of tests/data as text.
static char *small_text(void)
{
    return file_read(data_directory(), "../tests/data/scenes/convergence-small.yaml");
}

/// The text with one part exchanged.
static char *changed(const char *part, const char *by)
{
    char *text = small_text(), *out = calloc(1, 24000), *at = strstr(text, part);
    if (!at || !out) fail_msg("the scene lacks '%s'", part);
    *at = '\0';
    snprintf(out, 24000, "%s%s%s", text, by, at + strlen(part));
    free(text);
    return out;
}

static sphv_status load_text(char *text, sphv_any_scene *out, sphv_error *error)
{
    char *folder = folder_make(), *path = file_write(folder, "s.yaml", text);
    sphv_status status = sphv_any_scene_load(data_directory(), path, out, error);
    free(path);
    folder_remove(folder);
    free(text);
    return status;
}

static void test_bad_files(void **state)
{
    (void)state;
    static const struct {
        const char *part, *by, *message;
    } cases[] = {
        {"kind: convergence", "kind: divergence",
         ":1: unknown kind; allowed: convergence, or none"},
        {"kind: convergence", "kind: [convergence]", "unknown kind"},
        {"dimension: 2", "dimension: 4", "4 dimensions; allowed: 1 to 3"},
        {"dimension: 2", "dimension: two", "allowed: an integer"},
        {"[256, 576, 1024]", "[256, 577, 1024]", ":7: 577 particles in 2 dimensions"},
        {"[256, 576, 1024]", "[256, -4, 1024]", ":7: -4 particles"},
        {"[256, 576, 1024]", "[1, 576, 1024]", "1 particle along a side"},
        {"[256, 576, 1024]", "[1e300, 576, 1024]", ":7: 1e300"},
        {"[256, 576, 1024]", "[256, 576, 1024]\nratios: [1]", "3 numbers of particles"},
        {"[256, 576, 1024]", "[256]\nratios: [0]", "h/Δx = 0"},
        {"[256, 576, 1024]", "[256]\nratios: [1]", "allowed: 'of: ratio'"},
        {"layout: lattice,", "layout: ring,", "unknown name 'ring'; allowed: lattice"},
        {"amplitude: 0.1", "amplitude: -1", "amplitude is -1"},
        {"volume: equal", "volume: tessellated", "volume 'tessellated' in 2 dimensions"},
        {"{id: plane, field", "{id: f2, field", "field 'f2' again"},
        {"{id: plane, field", "{id: a_b, field", "field id 'a_b'"},
        {"1 - 2*x + y", "1 - 2*x + w", ":13: "},
        {"{id: fpm, label", "{id: sph, label", "scheme 'sph' again"},
        {"kernel: sigalotti-wendland-c4, method: fpm", "kernel: none, method: fpm", "none"},
        {"method: msph", "method: fft", "unknown method 'fft'"},
        {"box: disordered", "box: square", "no box 'square'"},
        {"{factor: 1.3, of: spacing}", "{factor: 1e9, of: spacing}", "scheme 'msph': h = "},
        {"{factor: 1.3, of: spacing}", "{factor: -1, of: spacing}", "scheme 'msph': h = "},
        {"{factor: 1.3, of: spacing}", "{factor: 1/0, of: spacing}", "1/0"},
        {"{factor: 1.3, of: spacing}", "{factor: 1.3, of: particles}", "'exponent' is missing"},
        {"{factor: 1.3, of: spacing}", "{of: spacing, exponent: 2}", "'exponent' is given"},
        {"columns: [fpm, msph, wide]", "columns: [fpm, count, wide]", "'count' has no method"},
        {"columns: [wide], per", "columns: [fpm], per", "in two groups"},
        {"columns: [fpm, msph], tol", "columns: [fpm], tol", "column 'msph' is in no group"},
        {"tolerance: 0.3, rms", "tolerance: 0, rms", "not positive"},
        {"\"-1\", none], limits", "\"-1\"], limits", "allowed: one a column"},
        {"{quantity: f2_x,", "{quantity: f2_w,", "no quantity 'f2_w'"},
        {"quantity: f2_xy\n      scheme: msph", "quantity: f2_xy\n      scheme: fpm", "no printed"},
        {"powers: [5/2, 2]", "powers: [5/2]", "1 powers in 2 dimensions"},
        {"powers: [5/2, 2]", "powers: [-1, 2]", "power -1"},
        {"last: 2, matches", "last: 9, matches", "levels 1 to 9; allowed: 1 to 3"},
        {"neighbours: [112, 208, 300]", "neighbours: [112, 208]", "2 neighbours and 3 h"},
        {"measure: slope", "measure: weight", "unknown name 'weight'; allowed: slope"},
        {"metric: failed, last", "metric: failed, quantity: f2, last", "takes no a"},
        {"{id: whole", "{id: exact", "claim 'exact' again"},
        {"tolerance: 1e-12", "tolerance: -1", "tolerance -1"},
        {"{id: counts, title", "{id: values, title", "plot 'values' again"},
        {"{id: counts, title", "{id: ../x, title", "'../x' is not a name"},
        {"picture: true, schemes: [disordered]", "picture: true", "needs 'schemes'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sphv_any_scene scene;
        sphv_error error = {SPHV_OK, ""};
        sphv_status status = load_text(changed(cases[i].part, cases[i].by), &scene, &error);
        if (status == SPHV_OK) fail_msg("accepted: %s", cases[i].by);
        if (!strstr(error.message, cases[i].message))
            fail_msg("'%s' lacks '%s'", error.message, cases[i].message);
        assert_failed(status, &error, SPHV_INVALID_INPUT, "");
        assert_null(scene.scene);
        assert_null(scene.convergence);
    }
}

struct run {
    sphv_any_scene scene;
    sphv_convergence_result *result;
};

static void run_text(struct run *run, char *text)
{
    sphv_error error = {SPHV_OK, ""};
    run->result = NULL;
    assert_ok(load_text(text, &run->scene, &error), error);
    assert_non_null(run->scene.convergence);
    assert_ok(sphv_convergence_run(run->scene.convergence, NULL, NULL, &run->result, &error),
              error);
}

static void run_free(struct run *run)
{
    sphv_convergence_result_free(run->result);
    sphv_any_scene_free(&run->scene);
}

/// The small scene as it is, run once.
static struct run small;

static int run_small(void **state)
{
    (void)state;
    run_text(&small, small_text());
    return 0;
}

static int free_small(void **state)
{
    (void)state;
    run_free(&small);
    return 0;
}

/// RMSE of FPM's value of f2 at one level through the brute-force route.
static double rmse_of_brute_force(const sphv_convergence *scene, size_t level, size_t scheme)
{
    const sphv_scheme *of = &scene->schemes[scheme];
    sphv_box box = sphv_scheme_box(scene, of, level);
    sphv_particles particles;
    sphv_estimates estimates;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_particles_make(&box, NULL, 0, &particles, &error), error);
    double *exact = calloc(particles.count, sizeof *exact), sum = 0;
    assert_non_null(exact);
    for (size_t a = 0; a < particles.count; a++) {
        double x = particles.x[0][a], y = particles.x[1][a];
        exact[a] = x * x * sqrt(x) * (20 * pow(y, 5) + 8 * x * pow(y, 3) + x * x * y * y + 1);
    }
    const double *fields[] = {exact};
    sphv_request request = {of->profile, sphv_scheme_h(scene, of, level), 1, &of->method, 1,
                            fields,      SPHV_ROUTE_BRUTE_FORCE};
    assert_ok(sphv_estimate_particles(&particles, &request, NULL, NULL, &estimates, &error), error);
    for (size_t a = 0; a < particles.count; a++) {
        double off = estimates.methods[0].estimate[0][a] - exact[a];
        sum += off * off;
    }
    sum = sqrt(sum / (double)particles.count);
    sphv_estimates_free(&estimates);
    sphv_particles_free(&particles);
    free(exact);
    return sum;
}

static void test_a_run(void **state)
{
    (void)state;
    const sphv_convergence *scene = small.scene.convergence;
    const sphv_convergence_result *result = small.result;
    assert_int_equal(scene->level_count, 3);
    assert_int_equal(scene->scheme_count, 6);
    // value, gradient and second derivatives of two fields, and one with a wrong exact value
    assert_int_equal(scene->target_count, 13);
    // SPH and FPM share a pass, the two with h = N^(-1/6) another
    assert_int_equal(scene->schemes[1].pass, 0);
    assert_int_equal(scene->schemes[2].pass, 2);
    assert_int_equal(scene->schemes[4].pass, 3);
    assert_int_equal(result->listed_neighbours, 3);
    assert_int_equal(result->listed_h, 3);
    for (size_t l = 0; l < 3; l++) {
        const sphv_rate_point *point = sphv_convergence_point(result, l, 1, 0);
        const sphv_stage *stage = sphv_convergence_stage(result, l, 1);
        assert_true(point->there);
        assert_int_equal(point->whole.counted, stage->particles);
        assert_true(point->interior.counted > 0 && point->interior.counted < stage->particles);
        // both routes and the formula of the field written out here round differently
        assert_close(point->whole.rmse, rmse_of_brute_force(scene, l, 1),
                     point->whole.bound + 1e-13);
        assert_true(point->predicted[0]);
        assert_int_not_equal(point->verdict[0], SPHV_DISAGREES);
        // SPH has no second derivatives, MSPH has
        assert_false(sphv_convergence_point(result, l, 0, 3)->there);
        assert_true(sphv_convergence_point(result, l, 2, 3)->there);
        assert_false(sphv_convergence_point(result, l, 4, 0)->there);
    }
    // rates by hand from the first and last level bracket the fit of a convex or concave curve
    double first = sphv_convergence_point(result, 0, 1, 0)->whole.rmse,
           last = sphv_convergence_point(result, 2, 1, 0)->whole.rmse;
    assert_close(result->cells[0].slope, log(last / first) / log(1024.0 / 256), 0.05);
    // h = factor/(√N − 1)
    assert_close(result->cells[0].slope_h, log(last / first) / log(15.0 / 31), 0.05);
    assert_int_equal(result->cells[0].verdict, SPHV_CELL_REPRODUCED);
    assert_true(isnan(result->cells[0].per_neighbour));
    assert_int_equal(result->cells[2].verdict, SPHV_CELL_PER_NEIGHBOUR);
    assert_close(result->cells[2].per_neighbour - result->cells[2].slope,
                 log(112.0 / 300) / log(1024.0 / 256), 0.02);
    assert_int_equal(result->cells[7].verdict, SPHV_CELL_NOT_REPRODUCED);
    assert_false(result->cells[7].surprising || result->cells[7].evidence_surprises);
    assert_close(result->cells[7].evidence[0], 0, 0.3);
    assert_int_equal(result->groups[0].cells, 5);
    assert_int_equal(result->groups[0].reproduced, 4);
    for (size_t c = 0; c < 3; c++) assert_false(result->claims[c].surprising);
    assert_int_equal(result->claims[2].verdict, SPHV_DISAGREES);
    assert_int_equal(result->verdict, SPHV_AGREES);
}

/// What the scene does not expect makes it disagree, one thing at a time: what was measured and
/// predicted stays, and is judged by the expectations of another file.
static void test_surprises_are_noticed(void **state)
{
    (void)state;
    static const struct {
        const char *part, *by;
    } cases[] = {
        {"printed: [\"-1\", \"-1.75\", \"-0.97\"]", "printed: [\"-2\", \"-1.75\", \"-0.97\"]"},
        {"per_neighbour: true, tolerance: 0.2", "tolerance: 0.2"},
        {"rms: 0.3", "rms: 1e-6"},
        {"last: 2, matches: false", "last: 2"},
        {"112, 208", "111, 208"},
        {"\"0.397\"", "\"0.395\""},
        {"expected: 0, tolerance: 1e-12", "expected: 1, tolerance: 1e-12"},
        {", refuted: It is of second order.", ""},
        {"expected: -1.5,", "expected: -1,"},
    };
    sphv_convergence_result *result = small.result;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sphv_any_scene scene;
        sphv_error error = {SPHV_OK, ""};
        assert_ok(load_text(changed(cases[i].part, cases[i].by), &scene, &error), error);
        assert_int_equal(scene.convergence->target_count, result->scene->target_count);
        result->scene = scene.convergence;
        sphv_convergence_judge(result);
        if (result->verdict != SPHV_DISAGREES) fail_msg("unnoticed: %s", cases[i].by);
        result->scene = small.scene.convergence;
        sphv_any_scene_free(&scene);
        sphv_convergence_judge(result);
        assert_int_equal(result->verdict, SPHV_AGREES);
    }
}

/// The shipped files load, whatever they cost to run.
static void test_shipped_scenes_load(void **state)
{
    (void)state;
    sphv_file_list files;
    sphv_error error = {SPHV_OK, ""};
    size_t convergence = 0;
    assert_ok(sphv_file_list_read(data_directory(), "scenes", ".yaml", &files, &error), error);
    for (size_t i = 0; i < files.count; i++) {
        sphv_any_scene scene;
        assert_ok(sphv_any_scene_load(data_directory(), files.paths[i], &scene, &error), error);
        convergence += scene.convergence != NULL;
        sphv_any_scene_free(&scene);
    }
    sphv_file_list_free(&files);
    assert_true(convergence >= 3);
}

static char *stream_text(void (*write)(FILE *, const sphv_convergence_result *),
                         const sphv_convergence_result *result)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    write(stream, result);
    assert_int_equal(fclose(stream), 0);
    return text;
}

/// Every row has as many fields as the head, and the RMSE comes back to the last bit.
static void test_csv(void **state)
{
    (void)state;
    char *text = stream_text(sphv_convergence_csv, small.result), *rest = text, *line;
    size_t columns = 0, rows = 0, found = 0;
    while ((line = strsep(&rest, "\n")) && *line) {
        size_t fields = 1;
        bool quoted = false;
        for (const char *c = line; *c; c++) {
            if (*c == '"') quoted = !quoted;
            fields += *c == ',' && !quoted;
        }
        if (!rows) columns = fields;
        assert_int_equal(fields, columns);
        if (strncmp(line, "fpm,", 4) == 0 && strstr(line, ",256,") && strstr(line, ",f2,all,")) {
            assert_close(strtod(strstr(line, ",f2,all,") + 8, NULL),
                         sphv_convergence_point(small.result, 0, 1, 0)->whole.rmse, 0);
            found++;
        }
        rows++;
    }
    assert_int_equal(found, 1);
    // two regions of six quantities by three first-order schemes on 3 levels, and of twelve by
    // MSPH, for two fields; 'counted' has one row a level
    assert_int_equal(rows, 1 + 3 * (2 * 2 * (4 * 3 + 6) + 1));
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_files),
        cmocka_unit_test(test_a_run),
        cmocka_unit_test(test_surprises_are_noticed),
        cmocka_unit_test(test_shipped_scenes_load),
        cmocka_unit_test(test_csv),
    };
    tests_begin();
    return cmocka_run_group_tests(tests, run_small, free_small);
}
