#include <gsl/gsl_math.h>
#include <stdlib.h>
#include <string.h>

#include "boundary_jitter.h"
#include "boundary_particle.h"

enum { N = SPHV_QUANTITIES_MAX };

/// Σ weight (e², bound², 1) of all and of interior particles.
struct norms {
    double square[2][N], bound[2][N], count[2];
    double margin[3][N]; ///< Σ weight P(1 − P) e^(2n), P the probability of being interior
    double excluded;
};

static void add_particle(sphv_box_theory *of, const sphv_line *const *line, struct norms *to)
{
    double x[SPHV_DIMENSIONS] = {0}, weight = 1, inside = 1;
    int below[SPHV_DIMENSIONS], above[SPHV_DIMENSIONS];
    sphv_particle_errors errors;
    for (int i = 0; i < of->d; i++) {
        x[i] = line[i]->x;
        weight *= line[i]->weight;
        below[i] = line[i]->below;
        above[i] = line[i]->above;
        inside *= line[i]->inside;
    }
    sphv_theory_cut(of, below, above);
    if (!(of->shape.condition <= 1 / sqrt(DBL_EPSILON))) {
        to->excluded += weight;
        return;
    }
    if (line[0]->singular)
        sphv_singular_errors(of, line, x, &errors);
    else
        sphv_series_errors(of, line, &errors);
    for (int part = 0; part < (inside > 0 ? 2 : 1); part++) {
        if (part == 1) weight *= inside;
        to->count[part] += weight;
        for (int q = 0; q < of->quantities; q++) {
            to->square[part][q] += weight * gsl_pow_2(errors.value[q]);
            to->bound[part][q] += weight * gsl_pow_2(errors.bound[q]);
        }
    }
    // In the interior or not: what the chance of it adds to the variance of sums.
    for (int q = 0; q < of->quantities && inside > 0 && inside < 1; q++)
        for (int n = 0; n < 3; n++)
            to->margin[n][q] += weight * (1 - inside) * gsl_pow_int(errors.value[q], 2 * n);
}

static void add_all(sphv_box_theory *of, const sphv_lines lines[SPHV_DIMENSIONS], struct norms *to)
{
    const sphv_line *at[SPHV_DIMENSIONS] = {0};
    int counts[SPHV_DIMENSIONS] = {1, 1, 1};
    double reach = of->h * of->profile->support, tail[SPHV_TAIL];
    for (int i = 0; i < of->d; i++) counts[i] = lines[i].count;
    of->rest_tail = 0;
    for (int i = 0; i < counts[0]; i++) {
        at[0] = &lines[0].line[i];
        if (at[0]->singular) {
            sphv_theory_take_line(of, at[0]);
            sphv_taylor_tail(of->field.field, true, 0, reach, tail);
            of->rest_tail = tail[of->rest_degree];
        } else {
            sphv_taylor_tail(of->field.field, false, at[0]->x, reach, tail);
            of->tail = tail[of->degree];
        }
        for (int j = 0; j < counts[1]; j++)
            for (int k = 0; k < counts[2]; k++) {
                if (of->d > 1) at[1] = &lines[1].line[j];
                if (of->d > 2) at[2] = &lines[2].line[k];
                add_particle(of, at, to);
            }
    }
}

/// Scaled derivatives of every term's factor at every line of one coordinate. \param out receives
/// memory to be freed
static bool take_factors(const sphv_box_theory *of, int coordinate, sphv_lines *lines, double **out)
{
    const sphv_field *field = of->field.field;
    int orders = of->degree + 1;
    double *at = *out =
        calloc((size_t)lines->count * (size_t)field->terms * (size_t)orders, sizeof *at);
    if (!at) return false;
    for (int j = 0; j < lines->count; j++) {
        sphv_line *line = &lines->line[j];
        line->factor = at;
        for (int t = 0; t < field->terms; t++, at += orders) {
            sphv_field alone = *field;
            double x[SPHV_DIMENSIONS] = {0}, scale = 1;
            if (coordinate == 0 && line->singular) continue;
            alone.terms = 1;
            alone.term[0] = field->term[t];
            alone.term[0].coefficient = 1;
            for (int i = 0; i < of->d; i++)
                if (i != coordinate)
                    alone.term[0].factor[i] = (sphv_factor){SPHV_FACTOR_POWER, 0, 0};
            x[coordinate] = line->x;
            for (int n = 0; n < orders; n++, scale *= of->h) {
                int order[SPHV_DIMENSIONS] = {0};
                order[coordinate] = n;
                at[n] = scale * sphv_field_derivative(&alone, order, x);
            }
        }
    }
    return true;
}

/// Sums over the box with panels of `order` nodes.
static sphv_status sum_box(sphv_box_theory *of, const sphv_box *box, int order, struct norms *to,
                           bool *exhaustive, sphv_error *error)
{
    sphv_lines lines[SPHV_DIMENSIONS] = {{0}};
    double *factors[SPHV_DIMENSIONS] = {0};
    sphv_status status = SPHV_OK;
    *to = (struct norms){0};
    *exhaustive = true;
    for (int i = 0; i < of->d && status == SPHV_OK; i++) {
        sphv_side side = {.count = box->side,
                          .spacing = sphv_box_spacing(box),
                          .offset = box->placement == SPHV_PLACEMENT_CELL ? 0.5 : 0,
                          .reach = of->octants->reach,
                          .periodic = box->periodic,
                          .margin = of->h * of->profile->support,
                          .amplitude = box->amplitude,
                          .jitter = box->jitter,
                          .singular_until = -1};
        if (i == 0 && of->field.singular) side.singular_until = 2 * side.margin;
        // On panels that double in length rules converge like 5.8^(−2 order).
        status = sphv_lines_make(&side, side.singular_until > 0 ? order / 2 : order, order,
                                 &lines[i], error);
        if (status == SPHV_OK && !take_factors(of, i, &lines[i], &factors[i]))
            status =
                sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for a box's theory");
        *exhaustive = *exhaustive && lines[i].exhaustive;
    }
    if (status == SPHV_OK) add_all(of, lines, to);
    for (int i = 0; i < SPHV_DIMENSIONS; i++) {
        free(factors[i]);
        sphv_lines_free(&lines[i]);
    }
    return status;
}

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
static int choose_degree(const sphv_box_theory *of)
{
    double tail[SPHV_TAIL], reach = of->h * of->profile->support;
    int last = SPHV_MONOMIAL_DEGREE_MAX - sphv_shape_degree(of->method), degree = 4;
    sphv_taylor_tail(of->field.field, false, of->field.singular ? 2 * reach : 1, reach, tail);
    double least = 1e-14 * gsl_pow_int(fmin(1, of->h), 2) * (tail[0] + 1e-300);
    while (degree < last && tail[degree] > least) degree++;
    return degree;
}

static void finish(const struct norms *fine, const struct norms *coarse, int part, int quantity,
                   sphv_result *out)
{
    double count = fine->count[part];
    *out = (sphv_result){0, 0};
    if (!(count > 0)) return;
    out->value = sqrt(fine->square[part][quantity] / count);
    // The norm of the bounds bounds the norm's error; the nodes' by a coarser rule, and rounding.
    out->bound = sqrt(fine->bound[part][quantity] / count) +
                 fabs(out->value - sqrt(coarse->square[part][quantity] / coarse->count[part])) +
                 64 * SPHV_U * out->value;
}

/// Standard deviation of the interior's norm that comes from particles at its margin.
static double margin_scatter(const struct norms *from, int quantity, double norm)
{
    if (!(norm > 0)) return 0;
    double square = norm * norm, sum = from->margin[2][quantity];
    sum += square * (square * from->margin[0][quantity] - 2 * from->margin[1][quantity]);
    return sqrt(fmax(0, sum)) / from->count[1] / (2 * norm);
}

static sphv_status predict(sphv_box_theory *of, const sphv_box *box, sphv_box_prediction *out,
                           sphv_error *error)
{
    struct norms fine = {0}, coarse = {0};
    bool exhaustive = true;
    sphv_status status = sphv_theory_start(of, error);
    if (status == SPHV_OK) status = sum_box(of, box, SPHV_SUM_RULE, &fine, &exhaustive, error);
    if (status == SPHV_OK && exhaustive) coarse = fine;
    if (status == SPHV_OK && !exhaustive)
        status = sum_box(of, box, 3 * SPHV_SUM_RULE / 4, &coarse, &exhaustive, error);
    sphv_theory_end(of);
    if (status != SPHV_OK) return status;
    out->quantities = (size_t)of->quantities;
    out->excluded = fine.excluded;
    for (int q = 0; q < of->quantities; q++) {
        finish(&fine, &coarse, 0, q, &out->rmse[q]);
        finish(&fine, &coarse, 1, q, &out->interior[q]);
        out->exists[q] = fine.count[0] > 0 && isfinite(out->rmse[q].value);
        out->interior_scatter[q] = margin_scatter(&fine, q, out->interior[q].value);
    }
    out->rigour = of->field.narrow ? SPHV_RIGOUR_ASYMPTOTIC : SPHV_RIGOUR_EXACT;
    return SPHV_OK;
}

sphv_status sphv_predict_box_from(const sphv_box *box, const sphv_profile *profile, double h,
                                  sphv_method method, const sphv_field *field,
                                  sphv_moment_source source, sphv_box_prediction *out,
                                  sphv_error *error)
{
    *out = (sphv_box_prediction){0};
    sphv_status status = check(box, profile, h, method, field, error);
    if (status != SPHV_OK) return status;
    sphv_octants octants;
    sphv_box_theory of = {.profile = profile,
                          .octants = &octants,
                          .method = method,
                          .d = box->dimension,
                          .quantities = (int)sphv_method_quantities(method, box->dimension),
                          .h = h,
                          .volume = volume_ratio(box)};
    status = sphv_field_theory_make(field, &of.field, error);
    sphv_jitter_sums jitter;
    if (status == SPHV_OK && box->amplitude > 0)
        status = sphv_jitter_start(box, profile, h, of.volume, source == SPHV_MOMENTS_EVERY, method,
                                   field, &jitter, error);
    if (status != SPHV_OK) return status;
    if (box->amplitude > 0 && !jitter.wide)
        return sphv_predict_jitter(&jitter, &of.field, out, error);
    of.degree = choose_degree(&of);
    int degree = of.degree + sphv_shape_degree(method);
    if (of.field.singular) {
        of.rest_degree = (int)fmin(of.field.rest_degree, of.degree);
        degree = (int)fmax(degree, of.rest_degree + sphv_shape_degree(method));
    }
    status = sphv_octants_make(profile, sphv_box_spacing(box) / h,
                               source == SPHV_MOMENTS_CONTINUUM ? 4 : 1, degree, &octants, error);
    if (status != SPHV_OK) return status;
    status = predict(&of, box, out, error);
    sphv_octants_free(&octants);
    if (status == SPHV_OK && box->amplitude > 0) status = sphv_widen_jitter(&jitter, out, error);
    return status;
}

sphv_status sphv_predict_box(const sphv_box *box, const sphv_profile *profile, double h,
                             sphv_method method, const sphv_field *field, sphv_box_prediction *out,
                             sphv_error *error)
{
    return sphv_predict_box_from(box, profile, h, method, field, SPHV_MOMENTS_LATTICE, out, error);
}
