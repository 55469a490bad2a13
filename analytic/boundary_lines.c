#include <gsl/gsl_eigen.h>
#include <gsl/gsl_math.h>
#include <stdlib.h>

#include "boundary_internal.h"

// Σ over the particles of a side. Those of the strips, where the error is not smooth, stand for
// themselves; the many between them are summed by Gauss's rule for sums, Σ_{j<n} f(j) = Σ_i w_i
// f(x_i), exact for polynomials of degree 2g − 1. Its orthogonal polynomials are Gram's.

/// \param place, weight receive `order` numbers, places from 0 to count − 1
static bool sum_rule(int order, double count, double *place, double *weight)
{
    bool done = false;
    gsl_matrix *jacobi = gsl_matrix_calloc((size_t)order, (size_t)order);
    gsl_matrix *vectors = gsl_matrix_alloc((size_t)order, (size_t)order);
    gsl_vector *values = gsl_vector_alloc((size_t)order);
    gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc((size_t)order);
    if (jacobi && vectors && values && work) {
        for (int k = 1; k < order; k++) {
            // Without the common diagonal (n − 1)/2, for which the places are shifted instead.
            double square = (double)k * k;
            double b = sqrt(square * (count - k) * (count + k) / (4 * (4 * square - 1)));
            gsl_matrix_set(jacobi, (size_t)k, (size_t)k - 1, b);
            gsl_matrix_set(jacobi, (size_t)k - 1, (size_t)k, b);
        }
        done = gsl_eigen_symmv(jacobi, values, vectors, work) == 0;
        for (int i = 0; done && i < order; i++) {
            place[i] = 0.5 * (count - 1) + gsl_vector_get(values, (size_t)i);
            weight[i] = count * gsl_pow_2(gsl_matrix_get(vectors, 0, (size_t)i));
        }
    }
    gsl_matrix_free(jacobi);
    gsl_matrix_free(vectors);
    gsl_vector_free(values);
    gsl_eigen_symmv_free(work);
    return done;
}

static void add_line(sphv_lines *lines, const sphv_side *side, double index, double weight)
{
    double last = (double)side->count - 1;
    sphv_line *line = &lines->line[lines->count++];
    line->x = (index + side->offset) * side->spacing;
    line->below = side->periodic ? side->reach : (int)fmin(side->reach, index);
    line->above = side->periodic ? side->reach : (int)fmin(side->reach, last - index);
    line->weight = weight;
    line->interior = side->periodic || fmin(line->x, 1 - line->x) >= side->margin * (1 - 1e-12);
    line->singular = line->x <= side->singular_until;
}

/// Adds the particles from … to − 1, all alike but for the field.
static bool add_panel(sphv_lines *lines, const sphv_side *side, double from, double to, int order)
{
    double place[SPHV_SUM_RULE], weight[SPHV_SUM_RULE];
    if (to - from <= 2 * order) {
        for (double i = from; i < to; i++) add_line(lines, side, i, 1);
        return true;
    }
    if (!sum_rule(order, to - from, place, weight)) return false;
    for (int i = 0; i < order; i++) add_line(lines, side, from + place[i], weight[i]);
    lines->exhaustive = false;
    return true;
}

sphv_status sphv_lines_make(const sphv_side *side, int order, sphv_lines *out, sphv_error *error)
{
    double count = (double)side->count, strip = fmax(side->reach, side->margin / side->spacing) + 1;
    double from = fmin(count, ceil(fmax(strip, side->singular_until / side->spacing + 1)));
    double to = fmax(from, floor(count - strip));
    double panels = 2 + log2(count + 1);
    *out = (sphv_lines){.exhaustive = true};
    if (side->periodic) {
        from = 0;
        to = count;
    }
    out->line = malloc((size_t)(from + (count - to) + panels * 2 * order + 1) * sizeof *out->line);
    bool done = out->line != NULL;
    if (done)
        for (double i = 0; i < from; i++) add_line(out, side, i, 1);
    // Away from a singular point panels may double in length.
    for (double a = from; done && a < to;) {
        double b = side->singular_until > 0 ? fmin(to, 2 * a) : to;
        done = add_panel(out, side, a, b, order);
        a = b;
    }
    if (!done) {
        sphv_lines_free(out);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for a box's theory");
    }
    for (double i = to; i < count; i++) add_line(out, side, i, 1);
    return SPHV_OK;
}

void sphv_lines_free(sphv_lines *lines)
{
    free(lines->line);
    *lines = (sphv_lines){0};
}
