#include <gsl/gsl_math.h>
#include <stdlib.h>
#include <string.h>

#include "boundary_particle.h"

// Norms over the particles of a box: sums over lines of particles in each direction, by rules of
// two orders.

enum { N = SPHV_QUANTITIES_MAX };

/// Σ weight (e², bound², 1) of all and of interior particles.
struct norms {
    double square[2][N], bound[2][N], count[2];
    double margin[3][N]; ///< Σ weight P(1 − P) e^(2n), P the probability of being interior
    double excluded;
};

static void add_errors(const sphv_particle_errors *errors, int quantities, double weight,
                       double inside, struct norms *to)
{
    for (int part = 0; part < (inside > 0 ? 2 : 1); part++) {
        if (part == 1) weight *= inside;
        to->count[part] += weight;
        for (int q = 0; q < quantities; q++) {
            to->square[part][q] += weight * gsl_pow_2(errors->value[q]);
            to->bound[part][q] += weight * gsl_pow_2(errors->bound[q]);
        }
    }
    // In the interior or not: what the chance of it adds to the variance of sums.
    for (int q = 0; q < quantities && inside > 0 && inside < 1; q++)
        for (int n = 0; n < 3; n++)
            to->margin[n][q] += weight * (1 - inside) * gsl_pow_int(errors->value[q], 2 * n);
}

/// What a particle adds for every method.
static void add_particle(sphv_box_theory *theory, const sphv_line *const *line, struct norms *to)
{
    double x[SPHV_DIMENSIONS] = {0}, weight = 1, inside = 1;
    int below[SPHV_DIMENSIONS], above[SPHV_DIMENSIONS];
    sphv_particle_errors errors;
    for (int i = 0; i < theory->d; i++) {
        x[i] = line[i]->x;
        weight *= line[i]->weight;
        below[i] = line[i]->below;
        above[i] = line[i]->above;
        inside *= line[i]->inside;
    }
    sphv_theory_cut(theory, below, above);
    if (!line[0]->singular) sphv_theory_take_derivatives(theory, line);
    for (size_t m = 0; m < theory->count; m++) {
        const sphv_method_theory *of = &theory->of[m];
        if (!(of->shape.condition <= 1 / sqrt(DBL_EPSILON))) {
            to[m].excluded += weight;
            continue;
        }
        if (line[0]->singular)
            sphv_singular_errors(theory, of, line, x, &errors);
        else
            sphv_series_errors(theory, of, &errors);
        add_errors(&errors, of->quantities, weight, inside, &to[m]);
    }
}

static void add_all(sphv_box_theory *theory, const sphv_lines lines[SPHV_DIMENSIONS],
                    struct norms *to)
{
    const sphv_line *at[SPHV_DIMENSIONS] = {0};
    int counts[SPHV_DIMENSIONS] = {1, 1, 1};
    double reach = theory->h * theory->profile->support, tail[SPHV_TAIL];
    for (int i = 0; i < theory->d; i++) counts[i] = lines[i].count;
    for (int i = 0; i < counts[0]; i++) {
        at[0] = &lines[0].line[i];
        bool singular = at[0]->singular;
        if (singular) sphv_theory_take_line(theory, at[0]);
        sphv_taylor_tail(theory->field.field, singular, singular ? 0 : at[0]->x, reach, tail);
        for (size_t m = 0; m < theory->count; m++) {
            sphv_method_theory *of = &theory->of[m];
            if (singular)
                of->rest_tail = tail[of->rest_degree];
            else
                of->tail = tail[of->degree];
        }
        for (int j = 0; j < counts[1]; j++)
            for (int k = 0; k < counts[2]; k++) {
                if (theory->d > 1) at[1] = &lines[1].line[j];
                if (theory->d > 2) at[2] = &lines[2].line[k];
                add_particle(theory, at, to);
            }
    }
}

/// Scaled derivatives of every term's factor at every line of one coordinate. \param out receives
/// memory to be freed
static bool take_factors(const sphv_box_theory *theory, int coordinate, sphv_lines *lines,
                         double **out)
{
    const sphv_field *field = theory->field.field;
    int orders = theory->degree + 1;
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
            for (int i = 0; i < theory->d; i++)
                if (i != coordinate)
                    alone.term[0].factor[i] = (sphv_factor){SPHV_FACTOR_POWER, 0, 0};
            x[coordinate] = line->x;
            for (int n = 0; n < orders; n++, scale *= theory->h) {
                int order[SPHV_DIMENSIONS] = {0};
                order[coordinate] = n;
                at[n] = scale * sphv_field_derivative(&alone, order, x);
            }
        }
    }
    return true;
}

/// Sums over the box with panels of `order` nodes.
static sphv_status sum_box(sphv_box_theory *theory, const sphv_box *box, int order,
                           struct norms *to, bool *exhaustive, sphv_error *error)
{
    sphv_lines lines[SPHV_DIMENSIONS] = {{0}};
    double *factors[SPHV_DIMENSIONS] = {0};
    sphv_status status = SPHV_OK;
    memset(to, 0, theory->count * sizeof *to);
    *exhaustive = true;
    for (int i = 0; i < theory->d && status == SPHV_OK; i++) {
        sphv_side side = {.count = box->side,
                          .spacing = sphv_box_spacing(box),
                          .offset = box->placement == SPHV_PLACEMENT_CELL ? 0.5 : 0,
                          .reach = theory->octants->reach,
                          .periodic = box->periodic,
                          .margin = theory->h * theory->profile->support,
                          .amplitude = box->amplitude,
                          .jitter = box->jitter,
                          .singular_until = -1};
        if (i == 0 && theory->field.singular) side.singular_until = 2 * side.margin;
        // On panels that double in length rules converge like 5.8^(−2 order).
        status = sphv_lines_make(&side, side.singular_until > 0 ? order / 2 : order, order,
                                 &lines[i], error);
        if (status == SPHV_OK && !take_factors(theory, i, &lines[i], &factors[i]))
            status =
                sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for a box's theory");
        *exhaustive = *exhaustive && lines[i].exhaustive;
    }
    if (status == SPHV_OK) add_all(theory, lines, to);
    for (int i = 0; i < SPHV_DIMENSIONS; i++) {
        free(factors[i]);
        sphv_lines_free(&lines[i]);
    }
    return status;
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

static void conclude(const sphv_method_theory *of, bool narrow, const struct norms *fine,
                     const struct norms *coarse, sphv_box_prediction *out)
{
    out->quantities = (size_t)of->quantities;
    out->excluded = fine->excluded;
    for (int q = 0; q < of->quantities; q++) {
        finish(fine, coarse, 0, q, &out->rmse[q]);
        finish(fine, coarse, 1, q, &out->interior[q]);
        out->exists[q] = fine->count[0] > 0 && isfinite(out->rmse[q].value);
        out->interior_scatter[q] = margin_scatter(fine, q, out->interior[q].value);
    }
    out->rigour = narrow ? SPHV_RIGOUR_ASYMPTOTIC : SPHV_RIGOUR_EXACT;
}

sphv_status sphv_theory_predict(sphv_box_theory *theory, const sphv_box *box,
                                sphv_box_prediction *const *out, sphv_error *error)
{
    bool exhaustive = true;
    struct norms *fine = calloc(2 * theory->count, sizeof *fine), *coarse = fine;
    sphv_status status = sphv_theory_start(theory, error);
    if (!fine) status = sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for norms");
    if (status == SPHV_OK) status = sum_box(theory, box, SPHV_SUM_RULE, fine, &exhaustive, error);
    if (status == SPHV_OK && !exhaustive) {
        coarse = fine + theory->count;
        status = sum_box(theory, box, 3 * SPHV_SUM_RULE / 4, coarse, &exhaustive, error);
    }
    for (size_t m = 0; m < theory->count && status == SPHV_OK; m++)
        conclude(&theory->of[m], theory->field.narrow, &fine[m], &coarse[m], out[m]);
    sphv_theory_end(theory);
    free(fine);
    return status;
}
