#include "slips.h"

#include <math.h>
#include <string.h>

/// A = x is the sine of a wavelength that is long beside h: its smoothing error, (2πh)² μ_2/2, is
/// below the rounding of E here.
static const double linear_h = 1e-6;

/// 4/7, 4/11, 4/19, 4/31
static const int sign_n[SPHV_SIGN_ROWS] = {3, 5, 9, 15};

/// kh = 0.04π and Δs = 4/11
static const double knot_h = 0.02;
enum { KNOT_N = 5, FIT_FIRST = 5, FIT_LAST = 40 };
static const double fit_h = 1e-4;

const char *const sphv_slips_of_text[] = {
    "Eq. 12: the sign between the sum and the integral is printed as “=” and must be a minus.",
    "Eq. 14: the second bracket multiplies the third derivative of A, not the second; for an even "
    "kernel the terms with even derivatives cancel.",
    "Eq. 25: the leading smoothing term must use the corrected kernel.", NULL};

static const sphv_profile *find(const sphv_report *report, const char *name,
                                const sphv_kernel **kernel)
{
    *kernel = NULL;
    for (size_t i = 0; i < report->kernel_count && !*kernel; i++)
        if (strcmp(sphv_kernel_name(report->kernels[i]), name) == 0 &&
            sphv_kernel_profile(report->kernels[i], 1))
            *kernel = report->kernels[i];
    return *kernel ? sphv_kernel_profile(*kernel, 1) : NULL;
}

/// E_d as measured: E − E_s.
static sphv_status measure(const sphv_profile *profile, double h, sphv_number spacing,
                           sphv_result *out, sphv_error *error)
{
    sphv_measurement measured;
    sphv_status status = sphv_measure_lattice(profile, h, spacing, &measured, error);
    if (status != SPHV_OK) return status;
    sphv_result smoothing = sphv_smoothing_error(profile, h);
    *out = (sphv_result){measured.total.value - smoothing.value,
                         measured.total.bound + smoothing.bound +
                             0x1p-52 * fabs(measured.total.value)};
    return SPHV_OK;
}

static sphv_status compute_sign(const sphv_profile *profile, sphv_sign_slip *row, int n,
                                sphv_error *error)
{
    sphv_number spacing = sphv_profile_special_spacing(profile, n);
    sphv_prediction paper;
    sphv_status status = measure(profile, linear_h, spacing, &row->measured, error);
    if (status == SPHV_OK)
        status = sphv_predict_lattice(profile, linear_h, spacing, SPHV_FORM_PAPER, &paper, error);
    if (status != SPHV_OK) return status;
    int edge = profile->knot_count - 1, c = (profile->boundary_smoothness + 1);
    row->n = n;
    row->spacing = spacing.value;
    row->mended = paper.discretisation;
    row->printed = (sphv_result){-row->mended.value, row->mended.bound};
    row->first_term = sphv_euler_maclaurin_term(profile, edge, linear_h, spacing, c + c % 2);
    row->mended_verdict = sphv_compare(row->mended, row->measured, row->mended.value);
    row->printed_verdict = sphv_compare(row->printed, row->measured, row->mended.value);
    return SPHV_OK;
}

static sphv_status fit_order(const sphv_profile *profile, sphv_result *order, sphv_error *error)
{
    double x[FIT_LAST + 1], y[FIT_LAST + 1];
    size_t count = 0;
    for (int n = FIT_FIRST; n <= FIT_LAST; n++) {
        sphv_number spacing = sphv_profile_special_spacing(profile, n);
        sphv_result measured;
        sphv_status status = measure(profile, fit_h, spacing, &measured, error);
        if (status != SPHV_OK) return status;
        x[count] = spacing.value;
        y[count++] = measured.value;
    }
    *order = sphv_fit_slope(x, y, count);
    return SPHV_OK;
}

static sphv_status compute_knot(const sphv_profile *profile, sphv_knot_slip *slip,
                                sphv_error *error)
{
    sphv_number spacing = sphv_profile_special_spacing(profile, KNOT_N);
    sphv_prediction paper;
    slip->h = knot_h;
    slip->spacing = spacing.value;
    slip->first_order = 2;
    slip->knot_count =
        profile->knot_count < SPHV_SLIP_KNOTS ? profile->knot_count : SPHV_SLIP_KNOTS;
    for (int k = 0; k < slip->knot_count; k++) {
        slip->position[k] = profile->knots[k].position.value;
        for (int i = 0; i < SPHV_KNOT_TERMS; i++)
            slip->term[k][i] =
                sphv_euler_maclaurin_term(profile, k, knot_h, spacing, slip->first_order + i);
    }
    sphv_status status = measure(profile, knot_h, spacing, &slip->measured, error);
    if (status == SPHV_OK)
        status = sphv_predict_lattice(profile, knot_h, spacing, SPHV_FORM_PAPER, &paper, error);
    if (status == SPHV_OK) status = fit_order(profile, &slip->fitted_order, error);
    if (status != SPHV_OK) return status;
    slip->exact = sphv_discretisation_error(profile, knot_h, spacing, NULL, NULL);
    slip->paper = paper.discretisation;
    slip->exact_verdict = sphv_compare(slip->exact, slip->measured, slip->exact.value);
    slip->paper_verdict = sphv_compare(slip->paper, slip->measured, slip->paper.value);
    int c = (profile->boundary_smoothness + 1);
    slip->paper_order = c + c % 2;
    slip->predicted_order = sphv_predicted_order(profile, true, NULL);
    return SPHV_OK;
}

sphv_status sphv_slips_compute(const sphv_report *report, sphv_slips *slips, sphv_error *error)
{
    *slips = (sphv_slips){0};
    sphv_status status = SPHV_OK;
    const sphv_profile *profile = find(report, "quinlan-w10", &slips->sign_kernel);
    for (int i = 0; profile && status == SPHV_OK && i < SPHV_SIGN_ROWS; i++)
        status = compute_sign(profile, &slips->sign[i], sign_n[i], error);
    profile = find(report, "cubic-spline", &slips->knot_kernel);
    if (profile && status == SPHV_OK) status = compute_knot(profile, &slips->knot, error);
    return status;
}
