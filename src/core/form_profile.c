#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "profile.h"
#include "quadrature.h"

/// Beyond this many units of q a truncated family's tail is below 1e-40 of its value at κ.
static const double tail_length = 12;
static const double panel = 0.25;

struct integrand {
    const sphv_form *form;
    int order, power;
};

static double integrand(double q, void *context)
{
    const struct integrand *of = context;
    double jet[2];
    sphv_form_jet(of->form, q, of->order, jet);
    return jet[of->order] * pow(q, of->power);
}

/// ∫ q^power d^order w/dq^order dq
static sphv_result integrate(const sphv_form *form, int order, int power, double from, double to)
{
    struct integrand of = {form, order, power};
    return sphv_quadrature(integrand, &of, from, to, panel);
}

static double sphere(int dimension)
{
    return sphv_sphere_factor(dimension) * sphv_sphere_pi(dimension);
}

/// Finds transform and scale so that the whole kernel has unit integral; false when it has none.
static bool normalise(sphv_form *form, bool fourth_order, sphv_result *constant)
{
    int d = form->dimension;
    double end = form->support + (form->family->truncated ? tail_length : 0);
    form->scale = 1;
    form->transform = 0;
    if (fourth_order)
        form->transform =
            integrate(form, 0, d + 1, 0, end).value / integrate(form, 0, d + 3, 0, end).value;
    sphv_result whole = integrate(form, 0, d - 1, 0, end);
    if (!(whole.value > 4 * whole.bound)) return false;
    constant->value = 1 / (sphere(d) * whole.value);
    constant->bound = constant->value * (whole.bound / whole.value + 2 * DBL_EPSILON);
    form->scale = constant->value;
    return true;
}

static void moments(sphv_profile *profile)
{
    const sphv_form *form = profile->form;
    int d = profile->dimension;
    double area = sphere(d), edge[2];
    sphv_form_jet(form, profile->support, 0, edge);
    if (profile->boundary_smoothness >= 0) edge[0] = 0;
    if (form->family->truncated)
        profile->excess = -area * integrate(form, 0, d - 1, profile->support,
                                            profile->support + tail_length)
                                      .value;
    profile->slope_excess =
        profile->excess - area * pow(profile->support, d) * edge[0] / d;
    for (int j = 0; j <= SPHV_MOMENT_MAX; j++) {
        sphv_result m = integrate(form, 0, j + d - 1, 0, profile->support);
        profile->moment[j] = (sphv_result){area * m.value, area * m.bound};
        double boundary = area * pow(profile->support, j + d) * edge[0] / (j + d);
        profile->slope_moment[j] =
            (sphv_result){profile->moment[j].value - boundary,
                          profile->moment[j].bound + 32 * DBL_EPSILON * fabs(boundary)};
    }
}

/// The edge, the only knot of an even entire function cut at κ.
static sphv_status edge_knot(sphv_profile *profile, sphv_error *error)
{
    double *jump = calloc(SPHV_JET_MAX + 1, sizeof *jump);
    if (!jump) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    sphv_knot *edge = &profile->knots[0];
    sphv_form_jet(profile->form, profile->support, SPHV_JET_MAX, jump);
    int order = 0;
    if (!profile->form->family->relative_accuracy)
        while (order < SPHV_JET_MAX &&
               fabs(jump[order]) <=
                   64 * DBL_EPSILON * profile->pieces[0].derivative_bound[order])
            jump[order++] = 0;
    *edge = (sphv_knot){profile->support_exact, order, SPHV_JET_MAX + 1, jump};
    profile->knot_count = 1;
    profile->boundary_smoothness = order - 1;
    return SPHV_OK;
}

static sphv_status compile(sphv_profile *out, sphv_form *form, sphv_error *error)
{
    out->pieces = calloc(1, sizeof *out->pieces);
    out->knots = calloc(1, sizeof *out->knots);
    double *bound = calloc(SPHV_JET_MAX + 1, sizeof *bound);
    if (!out->pieces || !out->knots || !bound) {
        free(bound);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    for (int n = 0; n <= SPHV_JET_MAX; n++) bound[n] = sphv_form_derivative_bound(form, n);
    out->pieces[0] = (sphv_piece){0, out->support, -1, NULL, NULL, bound};
    out->piece_count = 1;
    sphv_status status = edge_knot(out, error);
    if (status == SPHV_OK) moments(out);
    return status;
}

sphv_status sphv_profile_from_form(sphv_profile *out, const sphv_form *form, sphv_number support,
                                   bool fourth_order, sphv_error *error)
{
    memset(out, 0, sizeof *out);
    sphv_form *own = malloc(sizeof *own);
    if (!own) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    *own = *form;
    out->form = own;
    out->dimension = form->dimension;
    out->support_exact = support;
    out->support = support.value;
    sphv_status status = SPHV_OK;
    if (!normalise(own, fourth_order, &out->constant))
        status = sphv_fail(error, SPHV_INVALID_INPUT,
                           "the integral of w is not positive; allowed: kernels that can be "
                           "normalised");
    if (status == SPHV_OK) status = compile(out, own, error);
    if (status != SPHV_OK) sphv_profile_free(out);
    return status;
}
