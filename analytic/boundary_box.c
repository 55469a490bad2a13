#include <gsl/gsl_math.h>
#include <stdlib.h>

#include "boundary_jitter.h"
#include "boundary_particle.h"

static double volume_ratio(const sphv_box *box)
{
    double spacing = sphv_box_spacing(box);
    switch (box->volume) {
    case SPHV_VOLUME_UNIT:
        return gsl_pow_int(1 / spacing, box->dimension);
    case SPHV_VOLUME_EQUAL:
        return gsl_pow_int(1 / (spacing * (double)box->side), box->dimension);
    default:
        return 1;
    }
}

static sphv_status check(const sphv_box *box, const sphv_profile *profile, double h,
                         sphv_method method, const sphv_field *field, sphv_error *error)
{
    sphv_status status = sphv_box_check(box, error);
    if (status != SPHV_OK) return status;
    if (!(h > 0 && isfinite(h)))
        return sphv_fail(error, SPHV_INVALID_INPUT, "h is %g; allowed: a positive number", h);
    if (profile->dimension != box->dimension || field->dimension != box->dimension)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "a kernel of %d and a field of %d dimensions in a box of %d; allowed: the "
                         "same everywhere",
                         profile->dimension, field->dimension, box->dimension);
    if (box->layout != SPHV_LATTICE && box->layout != SPHV_PERTURBED)
        return sphv_fail(error, SPHV_NO_CLOSED_FORM,
                         "no theory of boxes for layout '%s'; allowed: lattice or perturbed",
                         sphv_layouts[box->layout].name);
    if (box->volume == SPHV_VOLUME_DENSITY || box->volume == SPHV_VOLUME_TESSELLATED)
        return sphv_fail(error, SPHV_NO_CLOSED_FORM,
                         "no theory of boxes for volume '%s'; allowed: lattice, equal or unit",
                         sphv_volumes[box->volume].name);
    if (box->volume == SPHV_VOLUME_UNIT && !sphv_methods[method].scale_free)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "volume 'unit' with method '%s'; allowed: volume lattice or equal",
                         sphv_methods[method].name);
    if (profile->support * h <= sphv_box_spacing(box))
        return sphv_fail(error, SPHV_NO_CLOSED_FORM, "no neighbour within %g at a spacing of %g",
                         profile->support * h, sphv_box_spacing(box));
    if (box->periodic &&
        2 * floor(profile->support * h / sphv_box_spacing(box)) + 1 > (double)box->side)
        return sphv_fail(error, SPHV_NO_CLOSED_FORM, "the support is wider than the periodic box");
    return SPHV_OK;
}

/// The lowest degree of a series whose remainder is beyond rounding, or the highest there is.
static int choose_degree(const sphv_box_theory *theory, sphv_method method)
{
    double tail[SPHV_TAIL], reach = theory->h * theory->profile->support;
    int last = SPHV_MONOMIAL_DEGREE_MAX - sphv_shape_degree(method), degree = 4;
    sphv_taylor_tail(theory->field.field, false, theory->field.singular ? 2 * reach : 1, reach,
                     tail);
    double least = 1e-14 * gsl_pow_int(fmin(1, theory->h), 2) * (tail[0] + 1e-300);
    while (degree < last && tail[degree] > least) degree++;
    return degree;
}

/// Adds a method. \return the degree of the moments that it needs
static int add_method(sphv_box_theory *theory, sphv_method method)
{
    sphv_method_theory *of = &theory->of[theory->count++];
    int shape_degree = sphv_shape_degree(method);
    *of = (sphv_method_theory){.method = method,
                               .quantities = (int)sphv_method_quantities(method, theory->d),
                               .degree = choose_degree(theory, method)};
    if (theory->field.singular) of->rest_degree = (int)fmin(theory->field.rest_degree, of->degree);
    theory->degree = (int)fmax(theory->degree, of->degree);
    theory->rest_degree = (int)fmax(theory->rest_degree, of->rest_degree);
    theory->shape_degree = (int)fmax(theory->shape_degree, shape_degree);
    theory->second = theory->second || method == SPHV_MSPH;
    return of->degree + shape_degree;
}

/// Predictions of methods that have a theory, from the moments they share.
static sphv_status predict_group(sphv_box_theory *theory, const sphv_box *box,
                                 sphv_moment_source source, int degree,
                                 sphv_box_prediction *const *out, sphv_error *error)
{
    sphv_octants octants;
    int nodes = source == SPHV_MOMENTS_CONTINUUM ? 4 : 1;
    sphv_status status = sphv_octants_make(theory->profile, sphv_box_spacing(box) / theory->h,
                                           nodes, degree, &octants, error);
    if (status != SPHV_OK) return status;
    theory->octants = &octants;
    status = sphv_theory_predict(theory, box, out, error);
    theory->octants = NULL;
    sphv_octants_free(&octants);
    return status;
}

/// What is asked for, but for the methods.
struct question {
    const sphv_box *box;
    const sphv_profile *profile;
    double h;
    const sphv_field *field;
    sphv_moment_source source;
};

static sphv_status predict_alike(const struct question *of, size_t count,
                                 const sphv_method *methods, sphv_box_prediction *const *out,
                                 sphv_error *error)
{
    const sphv_box *box = of->box;
    sphv_box_theory theory = {
        .profile = of->profile, .d = box->dimension, .h = of->h, .volume = volume_ratio(box)};
    sphv_box_prediction *to[SPHV_BOX_METHODS_MAX];
    sphv_jitter_group *jitter = NULL;
    int degree = 0;
    sphv_status status = sphv_field_theory_make(of->field, &theory.field, error), last = SPHV_OK;
    if (status != SPHV_OK) return status;
    if (box->amplitude > 0) {
        jitter = malloc(sizeof *jitter);
        if (!jitter)
            return sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for a box's theory");
        sphv_jitter_start(box, of->profile, of->h, theory.volume, of->source == SPHV_MOMENTS_EVERY,
                          of->field, jitter);
    }
    for (size_t m = 0; m < count; m++) {
        if (jitter && (last = sphv_jitter_add(jitter, methods[m], error)) != SPHV_OK) continue;
        to[theory.count] = out[m];
        degree = (int)fmax(degree, add_method(&theory, methods[m]));
    }
    if (theory.count == 0)
        status = last;
    else if (jitter && !jitter->cloud.wide)
        status = sphv_predict_jitter(jitter, &theory.field, to, error);
    else
        status = predict_group(&theory, box, of->source, degree, to, error);
    if (status == SPHV_OK && jitter && jitter->cloud.wide && theory.count > 0)
        status = sphv_widen_jitter(jitter, to, error);
    free(jitter);
    return status;
}

/// Bonet and Lok's value is Shepard's and their gradient, whatever the particles, that of `fpm`.
static sphv_status predict_bonet_lok(const struct question *of, sphv_box_prediction *out,
                                     sphv_error *error)
{
    static const sphv_method methods[] = {SPHV_FPM, SPHV_SHEPARD};
    sphv_box_prediction value = {0}, *const both[] = {out, &value};
    sphv_status status = predict_alike(of, 2, methods, both, error);
    if (status != SPHV_OK) return status;
    out->rmse[0] = value.rmse[0];
    out->interior[0] = value.interior[0];
    out->scatter[0] = value.scatter[0];
    out->interior_scatter[0] = value.interior_scatter[0];
    out->exists[0] = value.exists[0];
    return SPHV_OK;
}

/// \return SPHV_NO_CLOSED_FORM where there is one for none of the methods
static sphv_status predict_methods(const struct question *of, size_t count,
                                   const sphv_method *methods, sphv_box_prediction *out,
                                   sphv_error *error)
{
    sphv_method alike[SPHV_BOX_METHODS_MAX];
    sphv_box_prediction *to[SPHV_BOX_METHODS_MAX];
    size_t others = 0;
    sphv_status status = SPHV_OK;
    for (size_t m = 0; m < count && status == SPHV_OK; m++) {
        if (of->box->amplitude > 0 && methods[m] == SPHV_BONET_LOK) {
            status = predict_bonet_lok(of, &out[m], error);
        } else {
            to[others] = &out[m];
            alike[others++] = methods[m];
        }
    }
    if (status == SPHV_OK && others > 0) status = predict_alike(of, others, alike, to, error);
    return status;
}

sphv_status sphv_predict_box_from(const sphv_box *box, const sphv_profile *profile, double h,
                                  sphv_method method, const sphv_field *field,
                                  sphv_moment_source source, sphv_box_prediction *out,
                                  sphv_error *error)
{
    *out = (sphv_box_prediction){0};
    sphv_status status = check(box, profile, h, method, field, error);
    if (status != SPHV_OK) return status;
    struct question question = {box, profile, h, field, source};
    return predict_methods(&question, 1, &method, out, error);
}

sphv_status sphv_predict_box(const sphv_box *box, const sphv_profile *profile, double h,
                             sphv_method method, const sphv_field *field, sphv_box_prediction *out,
                             sphv_error *error)
{
    return sphv_predict_box_from(box, profile, h, method, field, SPHV_MOMENTS_LATTICE, out, error);
}

sphv_status sphv_predict_box_methods(const sphv_box *box, const sphv_profile *profile, double h,
                                     size_t count, const sphv_method *methods,
                                     const sphv_field *field, sphv_box_prediction *out,
                                     sphv_error *error)
{
    sphv_status status = SPHV_OK;
    if (count > SPHV_BOX_METHODS_MAX)
        return sphv_fail(error, SPHV_INVALID_INPUT, "%zu methods at once; allowed: %d", count,
                         SPHV_BOX_METHODS_MAX);
    for (size_t m = 0; m < count; m++) out[m] = (sphv_box_prediction){0};
    for (size_t m = 0; m < count && status == SPHV_OK; m++)
        status = check(box, profile, h, methods[m], field, error);
    struct question question = {box, profile, h, field, SPHV_MOMENTS_LATTICE};
    if (status == SPHV_OK) status = predict_methods(&question, count, methods, out, error);
    // Together they may need moments of so high a degree that there are too many.
    for (size_t m = 0; m < count && count > 1 && status == SPHV_NO_CLOSED_FORM; m++) {
        sphv_status one = sphv_predict_box(box, profile, h, methods[m], field, &out[m], error);
        if (one == SPHV_OK) continue;
        out[m] = (sphv_box_prediction){0};
        if (one != SPHV_NO_CLOSED_FORM) return one;
    }
    return status == SPHV_NO_CLOSED_FORM ? SPHV_OK : status;
}
