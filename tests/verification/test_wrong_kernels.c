/// Kernels that are wrong on purpose: the comparison of theory from the right file with measurement
/// of the wrong one must notice each, at the points of the paper's figures.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sphverify/compare.h"
#include "support.h"

/// How a kernel file is spoilt: one text replaced.
struct defect {
    const char *kernel, *what, *from, *to;
};

static const struct defect defects[] = {
    {"cubic-spline", "coefficient wrong in the fifth digit", "\"3/4\"", "\"0.75001\""},
    {"cubic-spline", "coefficient wrong by 1e-6", "\"-1/4\"", "\"-0.250001\""},
    {"cubic-spline", "sign", "\"-3/2\", \"3/4\"", "\"3/2\", \"3/4\""},
    {"cubic-spline", "knot moved", "until: 1,", "until: 1.01,"},
    {"quinlan-w10", "coefficient wrong in the fifth digit", "\"5/8\"", "\"0.62501\""},
    {"quinlan-w10", "truncated", "support: 2\n", "support: 1.9\n"},
    {"quinlan-w8", "coefficient wrong in the fifth digit", "\"1/500\"", "\"0.0020002\""},
    {"gaussian", "truncated earlier", "support: 3\n", "support: 2\n"},
};
enum { DEFECTS = sizeof defects / sizeof *defects };

static sphv_kernel *load_spoilt(const struct defect *defect)
{
    static char changed[20000];
    char path[600];
    snprintf(path, sizeof path, "kernels/%s.yaml", defect->kernel);
    char *text = file_read(data_directory(), path);
    const char *at = strstr(text, defect->from);
    if (!at) fail_msg("%s does not hold '%s'", path, defect->from);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, defect->to,
             at + strlen(defect->from));
    free(text);
    // the last piece must end where the support does
    char *until = strstr(changed, "until: 2,");
    if (until && strstr(changed, "support: 1.9")) {
        memmove(until + 11, until + 9, strlen(until + 9) + 1);
        memcpy(until, "until: 1.9,", 11);
    }
    sphv_kernel *kernel = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(kernel_from_text(changed, &kernel, &error), error);
    return kernel;
}

/// Theory of one kernel against measurement of another at one point.
static sphv_verdict cross(const sphv_profile *theory, const sphv_profile *measured, double h,
                          sphv_number spacing)
{
    sphv_prediction prediction;
    sphv_measurement measurement;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_predict_lattice(theory, h, spacing, SPHV_FORM_EXACT, &prediction, &error),
              error);
    assert_ok(sphv_measure_lattice(measured, h, spacing, &measurement, &error), error);
    return sphv_compare(prediction.total, measurement.total, fabs(prediction.total.value));
}

static void test_each_defect_is_noticed(void **state)
{
    (void)state;
    for (int i = 0; i < DEFECTS; i++) {
        sphv_kernel *right = load_kernel(defects[i].kernel), *wrong = load_spoilt(&defects[i]);
        const sphv_profile *sound = sphv_kernel_profile(right, 1),
                           *spoilt = sphv_kernel_profile(wrong, 1);
        for (int n = 2; n <= 40; n++) {
            sphv_number spacing = sphv_profile_special_spacing(sound, n);
            if (cross(sound, spoilt, 0.02, spacing) != SPHV_DISAGREES)
                fail_msg("%s with %s goes unnoticed at n = %d", defects[i].kernel, defects[i].what,
                         n);
            // and the sound kernel raises nothing, nor does the spoilt one against its own theory
            assert_int_equal(cross(sound, sound, 0.02, spacing), SPHV_AGREES);
            assert_int_equal(cross(spoilt, spoilt, 0.02, spacing), SPHV_AGREES);
        }
        sphv_kernel_free(right);
        sphv_kernel_free(wrong);
    }
}

/// A constant rounded to six digits, as in the paper's Table 1: the whole estimate scales with it.
static void test_a_rounded_constant_is_noticed(void **state)
{
    (void)state;
    sphv_kernel *kernel = load_kernel("quinlan-w10");
    const sphv_profile *profile = sphv_kernel_profile(kernel, 1);
    sphv_number spacing = sphv_profile_special_spacing(profile, 10);
    sphv_prediction prediction;
    sphv_measurement measured;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_predict_lattice(profile, 0.02, spacing, SPHV_FORM_EXACT, &prediction, &error),
              error);
    assert_ok(sphv_measure_lattice(profile, 0.02, spacing, &measured, &error), error);
    double rounded = 0.676758 / (693.0 / 1024);
    measured.total.value = (1 + measured.total.value) * rounded - 1;
    assert_int_equal(sphv_compare(prediction.total, measured.total, fabs(prediction.total.value)),
                     SPHV_DISAGREES);
    sphv_kernel_free(kernel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_defect_is_noticed),
        cmocka_unit_test(test_a_rounded_constant_is_noticed),
    };
    return run_group(tests);
}
