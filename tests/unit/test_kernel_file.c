/// Kernel files: what is accepted, and one line for each thing that is not.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

/// A good file in which one line is replaced; lines are numbered as the errors count them.
static const char *const good[] = {
    "name: test-kernel",                                        // 1
    "title: A kernel",                                          // 2
    "source: Here",                                             // 3
    "support: 2",                                               // 4
    "pieces:",                                                  // 5
    "  - {until: 1, coefficients: ['1', '0', '-3/2', '3/4']}",  // 6
    "  - {until: 2, coefficients: ['2', '-3', '3/2', '-1/4']}", // 7
    "dimensions: [1, 2, 3]",                                    // 8
    "constants: {1d: '2/3'}",                                   // 9
    "claims: {boundary_smoothness: 2, monotone: true}",         // 10
};
enum { LINES = sizeof good / sizeof *good };

static void test_the_good_file(void **state)
{
    (void)state;
    char *text = text_with_line(good, LINES, 0, "");
    sphv_kernel *kernel = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(kernel_from_text(text, &kernel, &error), error);
    free(text);
    assert_string_equal(sphv_kernel_name(kernel), "test-kernel");
    assert_string_equal(sphv_kernel_title(kernel), "A kernel");
    assert_string_equal(sphv_kernel_source(kernel), "Here");
    assert_non_null(strstr(sphv_kernel_path(kernel), "k.yaml"));
    const sphv_kernel_claims *claims = sphv_kernel_get_claims(kernel);
    assert_string_equal(claims->constant[0], "2/3");
    assert_null(claims->constant[1]);
    assert_int_equal(*claims->boundary_smoothness, 2);
    assert_int_equal(*claims->monotone, 1);
    assert_null(claims->non_negative);
    assert_null(claims->smoothing_order);
    assert_close(sphv_kernel_profile(kernel, 1)->constant.value, 2.0 / 3, 0);
    sphv_kernel_free(kernel);
    sphv_kernel_free(NULL);
}

static void test_bad_lines(void **state)
{
    (void)state;
    static const struct {
        int line;
        const char *replacement, *part;
    } cases[] = {
        {1, "name: ''", ":1:"},
        {1, "name: ../../etc/passwd", ":1: '../../etc/passwd' is not a name"},
        {1, "name: 'a b'", ":1:"},
        {1, "name: -x", ":1:"},
        {1, "name: .x", ":1:"},
        {1, "name: \"<script>\"", ":1:"},
        {1, "# no name", "lacks the key 'name'"},
        {2, "# no title", "lacks the key 'title'"},
        {3, "sauce: Here", ":3: unknown key 'sauce'"},
        {4, "support: 0", ":4:"},
        {4, "support: -2", ":4:"},
        {4, "support: 1e9", ":4:"},
        {4, "support: 1e-9", ":4:"},
        {4, "support: .nan", ":4:"},
        {4, "support: .inf", ":4:"},
        {4, "support: two", ":4:"},
        {4, "support: 1/0", ":4: '1/0' divides by zero"},
        {4, "support: 3", ":7: the last piece ends at 2"},
        {4, "support:", ":4:"},
        {6, "  - {until: 0, coefficients: ['1']}", ":6: pieces overlap"},
        {6, "  - {until: -1, coefficients: ['1']}", ":6: pieces overlap"},
        {6, "  - {until: 2, coefficients: ['1']}", ":7: pieces overlap"},
        {6, "  - {until: 3, coefficients: ['1']}", ":7: pieces overlap"},
        {6, "  - {until: nan, coefficients: ['1']}", ":6:"},
        {6, "  - {until: 1, coefficients: []}", ":6:"},
        {6, "  - {until: 1, coefficients: ['1', 'x']}", ":6: 'x' is not a number"},
        {6, "  - {until: 1, coefficients: ['1', nan]}", ":6: 'nan' is not a number"},
        {6, "  - {until: 1, coefficients: ['1', '1e61']}", ":6: coefficient 1e61"},
        {6, "  - {until: 1, coefficients: ['1', '1e-61']}", ":6: coefficient 1e-61"},
        {6, "  - {until: 1e-400, coefficients: ['1']}", ":6: the piece until 1e-400 is too short"},
        {6, "  - {until: 1.9999999, coefficients: ['1']}", ":7: the piece until 2 is too short"},
        {6, "  - {until: 1, coefficients: ['1', '1/0']}", ":6: '1/0' divides by zero"},
        {6, "  - {until: 1}", ":6:"},
        {6, "  - {coefficients: ['1']}", ":6:"},
        {6, "  - {until: 1, coefficients: ['1'], from: 0}", ":6: unknown key 'from'"},
        {6, "  - [1, 2]", ":6:"},
        {6, "  - 7", ":6:"},
        {8, "dimensions: []", ":8:"},
        {8, "dimensions: [0]", ":8: dimension 0"},
        {8, "dimensions: [4]", ":8: dimension 4"},
        {8, "dimensions: [1, 1]", ":8: dimension 1"},
        {8, "dimensions: [1, 2, 3, 1]", ":8:"},
        {8, "dimensions: 1", ":8:"},
        {8, "dimensions: [one]", ":8:"},
        {8, "# no dimensions", "lacks the key 'dimensions'"},
        {8, "dimensions: [1]\nfamily: gaussian", ":9: the shape is given twice"},
        {8, "dimensions: [1]\nexponent: 3", ":9: 'exponent' with 'pieces'"},
        {8, "dimensions: [1]\ntransform: sixth-order", ":9: unknown transform 'sixth-order'"},
        {8, "dimensions: [1]\nderivative:\n  - {until: 1, coefficients: ['0']}",
         ":10: the last piece"},
        {9, "constants: {4d: '1'}", ":9: unknown key '4d'"},
        {9, "constants: ['1']", ":9:"},
        {10, "claims: {beta: 2}", ":10: unknown key 'beta'"},
        {10, "claims: {boundary_smoothness: many}", ":10:"},
        {10, "claims: {monotone: yes please}", ":10:"},
        {10, "claims: {monotone: true", "not YAML"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *text = text_with_line(good, LINES, cases[i].line, cases[i].replacement);
        sphv_kernel *kernel = NULL;
        sphv_error error = {SPHV_OK, ""};
        sphv_status status = kernel_from_text(text, &kernel, &error);
        free(text);
        if (status == SPHV_OK) fail_msg("accepted: %s", cases[i].replacement);
        assert_failed(status, &error, SPHV_INVALID_INPUT, cases[i].part);
        assert_non_null(strstr(error.message, "k.yaml:"));
        assert_null(kernel);
    }
}

static void refuse(const char *text, const char *part)
{
    sphv_kernel *kernel = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_failed(kernel_from_text(text, &kernel, &error), &error, SPHV_INVALID_INPUT, part);
}

static void test_bad_shapes(void **state)
{
    (void)state;
    refuse("name: x\ntitle: x\nsupport: 2\ndimensions: [1]\n", "nowhere");
    refuse("name: x\ntitle: x\nsupport: 2\ndimensions: [1]\nfamily: sausage\n",
           ":5: unknown family 'sausage'; allowed: gaussian");
    refuse("name: x\ntitle: x\nsupport: 2\ndimensions: [1]\nfamily: sinc\n", "needs 'exponent'");
    refuse("name: x\ntitle: x\nsupport: 2\ndimensions: [1]\nfamily: sinc\nexponent: 0\n",
           ":6: exponent 0");
    refuse("name: x\ntitle: x\nsupport: 2\ndimensions: [1]\nfamily: sinc\nexponent: 13\n",
           ":6: exponent 13");
    refuse("name: x\ntitle: x\nsupport: 3\ndimensions: [1]\nfamily: gaussian\nexponent: 2\n",
           "takes no 'exponent'");
    refuse("name: x\ntitle: x\nsupport: 50\ndimensions: [1]\nfamily: gaussian\n", "up to 12");
    refuse("name: x\ntitle: x\nsupport: 3\ndimensions: [1]\nfamily: gaussian\n"
           "derivative:\n  - {until: 3, coefficients: ['0']}\n",
           "own derivative");
    refuse("name: x\ntitle: x\nsupport: 2\ndimensions: [1]\npieces:\n"
           "  - {until: 2, coefficients: ['0']}\n",
           "not positive");
    refuse("name: x\ntitle: x\nsupport: 2\ndimensions: [1]\npieces:\n"
           "  - {until: 2, coefficients: ['-1']}\n",
           "not positive");
    // q^40 below 0.01: its integral is 1e-142, beyond what a constant may repair
    refuse(
        "name: x\ntitle: x\nsupport: 0.01\ndimensions: [1]\npieces:\n"
        "  - {until: 0.01, coefficients: [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, "
        "0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1e-60]}\n",
        "allowed: 1e-100 to 1e100");
    // (1 − 3q²/5·…): ∫ q² w = 0 in three dimensions, so no constant normalises it
    refuse("name: x\ntitle: x\nsupport: 1\ndimensions: [3]\npieces:\n"
           "  - {until: 1, coefficients: ['1', '0', '-5/3']}\n",
           "not positive");
}

/// A kernel that is legal in one dimension only is refused in the others, with the reason.
static void test_refused_dimensions(void **state)
{
    (void)state;
    sphv_kernel *kernel = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(kernel_from_text("name: x\ntitle: x\nsupport: 1\ndimensions: [1, 3]\npieces:\n"
                               "  - {until: 1, coefficients: ['1', '0', '-5/3']}\n",
                               &kernel, &error),
              error);
    assert_non_null(sphv_kernel_profile(kernel, 1));
    assert_null(sphv_kernel_profile(kernel, 3));
    assert_non_null(strstr(sphv_kernel_refusal(kernel, 3), "not positive"));
    assert_null(sphv_kernel_profile(kernel, 2));
    assert_non_null(strstr(sphv_kernel_refusal(kernel, 2), "does not declare"));
    assert_string_equal(sphv_kernel_refusal(kernel, 1), "");
    sphv_kernel_free(kernel);
}

static void test_a_gradient_of_its_own(void **state)
{
    (void)state;
    sphv_kernel *kernel = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(kernel_from_text("name: x\ntitle: x\nsupport: 1\ndimensions: [1, 2]\npieces:\n"
                               "  - {until: 1, coefficients: ['1', '-1']}\nderivative:\n"
                               "  - {until: 1, coefficients: ['-2']}\n",
                               &kernel, &error),
              error);
    for (int d = 1; d <= 2; d++) {
        const sphv_profile *gradient = sphv_kernel_gradient(kernel, d),
                           *profile = sphv_kernel_profile(kernel, d);
        assert_non_null(gradient);
        // normalised by the kernel's constant: −2 C_d where the truth is −C_d
        assert_within_bounds(sphv_profile_derivative(gradient, 0, 0.5),
                             2 * sphv_profile_derivative(profile, 1, 0.5).value);
    }
    assert_null(sphv_kernel_gradient(kernel, 3));
    sphv_kernel_free(kernel);
}

static void test_catalogue_names_and_paths(void **state)
{
    (void)state;
    sphv_kernel *kernel = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_failed(sphv_catalogue_find(data_directory(), "cubic-spleen", &kernel, &error), &error,
                  SPHV_INVALID_INPUT, "unknown kernel 'cubic-spleen'; allowed: a path");
    assert_failed(sphv_catalogue_find(data_directory(), "./nothing.yaml", &kernel, &error), &error,
                  SPHV_INVALID_INPUT, "./nothing.yaml: cannot be opened");
    assert_failed(sphv_catalogue_find("/nowhere", "cubic-spline", &kernel, &error), &error,
                  SPHV_INVALID_INPUT, "/nowhere");
    assert_failed(sphv_catalogue_find(data_directory(), "", &kernel, &error), &error,
                  SPHV_INVALID_INPUT, "unknown kernel ''");
    char name[3000];
    memset(name, 'x', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    assert_failed(sphv_catalogue_find(data_directory(), name, &kernel, &error), &error,
                  SPHV_INVALID_INPUT, "unknown kernel");
    sphv_catalogue catalogue;
    assert_failed(sphv_catalogue_load("/nowhere", &catalogue, &error), &error, SPHV_INVALID_INPUT,
                  "/nowhere");
    assert_ok(sphv_catalogue_load(data_directory(), &catalogue, &error), error);
    for (size_t i = 0; i < catalogue.count; i++) {
        // a kernel is found by the name that its file states
        assert_ok(sphv_catalogue_find(data_directory(), sphv_kernel_name(catalogue.kernels[i]),
                                      &kernel, &error),
                  error);
        assert_string_equal(sphv_kernel_title(kernel), sphv_kernel_title(catalogue.kernels[i]));
        sphv_kernel_free(kernel);
    }
    sphv_catalogue_free(&catalogue);
}

/// One bad file among good ones ends the loading, with that file's name.
static void test_a_bad_file_in_the_catalogue(void **state)
{
    (void)state;
    char *folder = folder_make(), *kernels = NULL, command[600];
    assert_true(asprintf(&kernels, "%s/kernels", folder) > 0);
    snprintf(command, sizeof command, "cp -R '%s/kernels' '%s'", data_directory(), kernels);
    assert_int_equal(system(command), 0);
    char *path = file_write(kernels, "zz-bad.yaml", "name: zz-bad\n");
    sphv_catalogue catalogue;
    sphv_error error = {SPHV_OK, ""};
    assert_failed(sphv_catalogue_load(folder, &catalogue, &error), &error, SPHV_INVALID_INPUT,
                  "zz-bad.yaml:1: 'the file' lacks the key");
    assert_int_equal(catalogue.count, 0);
    free(path);
    free(kernels);
    folder_remove(folder);
}

/// A family with the fourth-order transform has a vanishing second moment; so have pieces.
static void test_fourth_order_transform(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "name: x\ntitle: x\nsupport: 2\ndimensions: [1, 2, 3]\ntransform: fourth-order\npieces:\n"
        "  - {until: 2, coefficients: ['1', '0', '-1/2', '0', '1/16']}\n",
        "name: x\ntitle: x\nsupport: 2\ndimensions: [1, 2, 3]\ntransform: fourth-order\n"
        "family: double-cosine\n"};
    for (int i = 0; i < 2; i++) {
        sphv_kernel *kernel = NULL;
        sphv_error error = {SPHV_OK, ""};
        assert_ok(kernel_from_text(texts[i], &kernel, &error), error);
        for (int d = 1; d <= 3; d++) {
            const sphv_profile *profile = sphv_kernel_profile(kernel, d);
            assert_non_null(profile);
            assert_within_bounds(profile->moment[0], 1);
            // two moments of order 1 cancel; each carries its bound
            assert_close(profile->moment[2].value, 0, profile->moment[2].bound + 0x1p-50);
            assert_true(fabs(profile->moment[4].value) > 0.01);
        }
        sphv_kernel_free(kernel);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_good_file),
        cmocka_unit_test(test_bad_lines),
        cmocka_unit_test(test_bad_shapes),
        cmocka_unit_test(test_refused_dimensions),
        cmocka_unit_test(test_a_gradient_of_its_own),
        cmocka_unit_test(test_catalogue_names_and_paths),
        cmocka_unit_test(test_a_bad_file_in_the_catalogue),
        cmocka_unit_test(test_fourth_order_transform),
    };
    return run_group(tests);
}
