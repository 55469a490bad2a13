#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "profile.h"
#include "quadrature.h"

/// Beyond this many units of q a truncated family's tail is below 1e-40 of its value at κ.
static const double tail_length = 12;
static const double panel = 0.25;
static const double unit_roundoff = DBL_EPSILON / 2;

static void values(const void *context, double q, sphv_result out[3])
{
    sphv_form_values(context, q, out);
}

/// ∫ q^(first + j) w dq, j = 0 … count − 1
static sphv_status integrate(const sphv_form *form, double from, double to, int first, int count,
                             sphv_result *out)
{
    return sphv_quadrature_moments(values, form, from, to, panel, first, count, out);
}

static double sphere(int dimension)
{
    return sphv_sphere_factor(dimension) * sphv_sphere_pi(dimension);
}

static double relative(sphv_result of)
{
    return of.bound / fabs(of.value) + unit_roundoff;
}

/// Finds transform and scale so that the whole kernel has unit integral.
/// \return SPHV_INVALID_INPUT when it has no positive one
static sphv_status normalise(sphv_form *form, bool fourth_order, sphv_result *constant)
{
    int d = form->dimension;
    double end = form->support + (form->family->truncated ? tail_length : 0);
    form->scale = 1;
    form->scale_error = form->transform = form->transform_error = 0;
    sphv_result power[5]; // ∫ q^(d−1+j) w dq
    sphv_status status = integrate(form, 0, end, d - 1, 5, power);
    if (status != SPHV_OK) return status;
    if (fourth_order) {
        if (!(fabs(power[4].value) > 4 * power[4].bound)) return SPHV_INVALID_INPUT;
        form->transform = power[2].value / power[4].value;
        // Where ∫q²w vanishes there is nothing to do, and a relative error would mean nothing.
        form->transform_error = form->transform != 0 ? relative(power[2]) + relative(power[4]) : 0;
        status = integrate(form, 0, end, d - 1, 1, power);
        if (status != SPHV_OK) return status;
    }
    if (!(power[0].value > 4 * power[0].bound)) return SPHV_INVALID_INPUT;
    constant->value = 1 / (sphere(d) * power[0].value);
    form->scale_error = relative(power[0]) + 3 * unit_roundoff;
    constant->bound = constant->value * form->scale_error;
    form->scale = constant->value;
    return SPHV_OK;
}

static sphv_status moments(sphv_profile *profile)
{
    const sphv_form *form = profile->form;
    int d = profile->dimension;
    double area = sphere(d);
    sphv_result edge[3] = {{0, 0}}, tail = {0, 0};
    if (profile->boundary_smoothness < 0) sphv_form_values(form, profile->support, edge);
    sphv_status status =
        integrate(form, 0, profile->support, d - 1, SPHV_MOMENT_MAX + 1, profile->moment);
    if (status == SPHV_OK && form->family->truncated)
        status = integrate(form, profile->support, profile->support + tail_length, d - 1, 1, &tail);
    if (status != SPHV_OK) return status;
    profile->excess = -area * tail.value;
    profile->slope_excess = profile->excess - area * pow(profile->support, d) * edge[0].value / d;
    for (int j = 0; j <= SPHV_MOMENT_MAX; j++) {
        sphv_result *m = &profile->moment[j], *slope = &profile->slope_moment[j];
        m->value *= area;
        m->bound = m->bound * area + 3 * unit_roundoff * fabs(m->value);
        double lever = area * pow(profile->support, j + d) / (j + d);
        slope->value = m->value - lever * edge[0].value;
        slope->bound = m->bound +
                       lever * (edge[0].bound + 8 * unit_roundoff * fabs(edge[0].value)) +
                       unit_roundoff * fabs(slope->value);
    }
    return SPHV_OK;
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
               fabs(jump[order]) <= 64 * DBL_EPSILON * profile->pieces[0].derivative_bound[order])
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
    out->pieces[0] = (sphv_piece){.outer = out->support, .degree = -1, .derivative_bound = bound};
    out->piece_count = 1;
    sphv_status status = edge_knot(out, error);
    if (status == SPHV_OK && moments(out) != SPHV_OK)
        status = sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
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
    own->support_error = fabs(support.residual);
    sphv_status status = normalise(own, fourth_order, &out->constant);
    if (status == SPHV_RESOURCE_FAILURE)
        sphv_fail(error, status, "out of memory");
    else if (status != SPHV_OK)
        sphv_fail(error, status,
                  "the integral of w is not positive; allowed: kernels that can be normalised");
    if (status == SPHV_OK) status = compile(out, own, error);
    if (status != SPHV_OK) sphv_profile_free(out);
    return status;
}
