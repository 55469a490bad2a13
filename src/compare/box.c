#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sphverify/compare.h"

/// Arrays over the particles of one box.
struct box_arrays {
    sphv_particles particles;
    sphv_estimates estimates;
    double *field; ///< [quantity * count + particle]: the field and its exact derivatives
};

static sphv_status fill_field(const sphv_box_question *of, size_t quantities,
                              struct box_arrays *arrays, sphv_error *error)
{
    size_t count = arrays->particles.count;
    int dimension = of->box.dimension;
    int degree = quantities > (size_t)dimension + 1 ? 2 : 1;
    arrays->field = malloc((count ? count : 1) * quantities * sizeof *arrays->field);
    if (!arrays->field) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    for (size_t i = 0; i < count; i++) {
        double x[SPHV_DIMENSIONS] = {0}, values[SPHV_QUANTITIES_MAX];
        for (int k = 0; k < dimension; k++) x[k] = arrays->particles.x[k][i];
        sphv_field_derivatives(&of->field, degree, x, values);
        for (size_t q = 0; q < quantities; q++) arrays->field[q * count + i] = values[q];
        if (!isfinite(values[0]))
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "field '%s' is not finite at particle %zu, x = %g; allowed: particles "
                             "where the field exists",
                             of->field.name, i, x[0]);
    }
    return SPHV_OK;
}

static sphv_status measure(const sphv_box_question *of, struct box_arrays *arrays,
                           sphv_progress progress, void *context, sphv_box_point *out,
                           sphv_error *error)
{
    sphv_status status =
        sphv_particles_make(&of->box, of->profile, of->h, &arrays->particles, error);
    if (status == SPHV_OK) status = fill_field(of, out->quantities, arrays, error);
    if (status != SPHV_OK) return status;
    const double *field = arrays->field;
    sphv_request request = {.profile = of->profile,
                            .h = of->h,
                            .method_count = 1,
                            .methods = &of->method,
                            .field_count = 1,
                            .fields = &field,
                            .route = SPHV_ROUTE_AUTOMATIC};
    status = sphv_estimate_particles(&arrays->particles, &request, progress, context,
                                     &arrays->estimates, error);
    if (status != SPHV_OK) return status;
    const sphv_estimates *estimates = &arrays->estimates;
    size_t count = arrays->particles.count;
    for (size_t q = 0; q < out->quantities; q++) {
        const double *exact = field + q * count;
        out->norms[q] = sphv_error_norms(&arrays->particles, estimates, 0, 0, q, exact, 0);
        out->interior[q] = sphv_error_norms(&arrays->particles, estimates, 0, 0, q, exact,
                                            of->profile->support * of->h);
    }
    out->particles = count;
    out->pairs = estimates->pairs;
    out->seconds = estimates->seconds;
    out->neighbours_least = count ? estimates->neighbours[0] : 0;
    for (size_t i = 0; i < count; i++) {
        size_t n = estimates->neighbours[i];
        double condition = estimates->methods[0].condition[i];
        if (n < out->neighbours_least) out->neighbours_least = n;
        if (n > out->neighbours_most) out->neighbours_most = n;
        if (isfinite(condition)) out->worst_condition = fmax(out->worst_condition, condition);
    }
    return SPHV_OK;
}

/// Size of the quantities of each degree: the largest RMSE among them or, where errors are nothing
/// but rounding, the largest value of the field's derivatives.
static void find_scales(const sphv_box_question *of, const struct box_arrays *arrays,
                        const sphv_box_point *point, double scale[3])
{
    const sphv_monomial *monomials = sphv_monomials(of->box.dimension);
    double bound[3] = {0}, largest[3] = {0};
    size_t count = arrays->particles.count;
    for (int degree = 0; degree < 3; degree++) scale[degree] = 0;
    for (size_t q = 0; q < point->quantities; q++) {
        int degree = monomials[q].degree;
        scale[degree] = fmax(scale[degree], point->norms[q].rmse);
        bound[degree] = fmax(bound[degree], point->norms[q].bound);
        for (size_t i = 0; i < count; i++) {
            double exact = fabs(arrays->field[q * count + i]);
            if (isfinite(exact)) largest[degree] = fmax(largest[degree], exact);
        }
    }
    for (int degree = 0; degree < 3; degree++)
        if (scale[degree] <= bound[degree]) scale[degree] = largest[degree];
}

sphv_status sphv_evaluate_box(const sphv_box_question *question, sphv_progress progress,
                              void *context, sphv_box_point *out, sphv_error *error)
{
    memset(out, 0, sizeof *out);
    out->quantities = sphv_method_quantities(question->method, question->box.dimension);
    sphv_status status = sphv_box_check(&question->box, error);
    if (status == SPHV_OK && question->box.periodic && !sphv_field_is_periodic(&question->field))
        status = sphv_fail(error, SPHV_INVALID_INPUT,
                           "field '%s' does not repeat over the box; allowed without a boundary: "
                           "sine, constants",
                           question->field.name);
    if (status != SPHV_OK) return status;
    status = sphv_predict_box(&question->box, question->profile, question->h, question->method,
                              &question->field, &out->analytic, error);
    out->predicted = status == SPHV_OK;
    // A perturbed box may have a theory of its interior alone.
    for (size_t q = 0; q < out->analytic.quantities; q++)
        out->analytic.exists[q] = out->analytic.exists[q] && isfinite(out->analytic.rmse[q].value);
    if (status != SPHV_OK && status != SPHV_NO_CLOSED_FORM) return status;
    struct box_arrays arrays = {0};
    double scale[3];
    status = measure(question, &arrays, progress, context, out, error);
    if (status == SPHV_OK) find_scales(question, &arrays, out, scale);
    sphv_estimates_free(&arrays.estimates);
    sphv_particles_free(&arrays.particles);
    free(arrays.field);
    if (status != SPHV_OK) return status;
    out->verdict = SPHV_INCONCLUSIVE; // where there is nothing to compare
    for (size_t q = 0; out->predicted && q < out->quantities; q++)
        if (out->analytic.exists[q] && out->norms[q].counted > 0) out->verdict = SPHV_AGREES;
    for (size_t q = 0; q < out->quantities; q++) {
        const sphv_norms *norms = &out->norms[q];
        out->verdicts[q] = SPHV_INCONCLUSIVE;
        out->interval[q] = norms->bound;
        if (!out->predicted || !out->analytic.exists[q] || norms->counted == 0) continue;
        out->interval[q] =
            sphv_norm_interval(norms->rmse, norms->bound, out->analytic.rigour, norms->counted,
                               out->neighbours_most, out->analytic.scatter[q]);
        out->verdicts[q] = sphv_compare_norm(
            out->analytic.rmse[q], out->analytic.rigour, norms->rmse, norms->bound, norms->counted,
            out->neighbours_most, out->analytic.scatter[q],
            scale[sphv_monomials(question->box.dimension)[q].degree]);
        out->verdict = sphv_verdict_worse(out->verdict, out->verdicts[q]);
    }
    return SPHV_OK;
}
