/// Kernel files: any bytes are refused in one line, or are a kernel whose every number is finite
/// and whose theory and measurement do not contradict each other.
#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

#include "sphverify/compare.h"
#include "target.h"

static void require_sound(const sphv_profile *profile)
{
    FUZZ_REQUIRE(isfinite(profile->support) && profile->support > 0);
    FUZZ_REQUIRE(isfinite(profile->constant.value) && profile->constant.bound >= 0);
    FUZZ_REQUIRE(isfinite(profile->excess) && isfinite(profile->slope_excess));
    for (int j = 0; j <= 8; j++)
        FUZZ_REQUIRE(isfinite(profile->moment[j].value) &&
                     isfinite(profile->slope_moment[j].value));
    for (int i = 0; i <= 8; i++)
        for (int n = 0; n <= 3; n++) {
            sphv_result value = sphv_profile_derivative(profile, n, 0.125 * i * profile->support);
            FUZZ_REQUIRE(isfinite(value.value) && value.bound >= 0);
        }
}

static void require_consistent(const sphv_profile *profile)
{
    static const double spacings[] = {0.49, 0.2, 0.07};
    for (int i = 0; i < 3; i++) {
        sphv_number spacing = sphv_number_from_double(spacings[i] * profile->support);
        sphv_point point;
        sphv_error error = {SPHV_OK, ""};
        sphv_status status = sphv_evaluate_point(profile, 0.05, spacing, SPHV_FORM_EXACT, false,
                                                 NULL, NULL, &point, &error);
        if (status != SPHV_OK) continue;
        // a contradiction between two right halves is a bound that is wrong
        FUZZ_REQUIRE(point.verdict != SPHV_DISAGREES);
        FUZZ_REQUIRE(point.verdict == SPHV_INCONCLUSIVE || isfinite(point.analytic.total.value));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    gsl_set_error_handler_off();
    sphv_kernel *kernel = NULL;
    sphv_error error = {SPHV_OK, ""};
    sphv_status status = sphv_kernel_load(fuzz_file(data, size), &kernel, &error);
    if (status != SPHV_OK) {
        FUZZ_REQUIRE(kernel == NULL && error.status == status);
        FUZZ_REQUIRE(error.message[0] != '\0' && !strpbrk(error.message, "\n\r\033"));
        return 0;
    }
    for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
        const sphv_profile *profile = sphv_kernel_profile(kernel, d);
        if (!profile) continue;
        require_sound(profile);
        if (d == 1) require_consistent(profile);
    }
    sphv_kernel_free(kernel);
    return 0;
}
