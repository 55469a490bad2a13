#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_math.h>
#include <stdlib.h>

#include "boundary_internal.h"

// Σ over the particles of a side. The many between the strips are summed by Gauss's rule for sums,
// Σ_{j<n} f(j) = Σ_i w_i f(x_i), exact for polynomials of degree 2g − 1. Its orthogonal polynomials
// are Gram's. In the strips moments are known of whole lines only. A few lines stand for
// themselves; of many some are taken, closer together towards the ends, with the smallest weights
// that are exact to a lower degree.

/// Lines of a strip that stand for themselves next to its end: the margin of the interior is there.
enum { STRIP_END = 3 };

bool sphv_sum_rule(int order, double count, double *place, double *weight)
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

/// Some of the lines 0 … count − 1, and their weights: exact to degree 2 order/3, so that they stay
/// small. \param order even and less than count/2
static bool choose_lines(int order, double count, double *place, double *weight)
{
    size_t degrees = (size_t)(2 * order / 3);
    for (int k = 0; k < order / 2; k++) {
        double at = round(0.5 * (count - 1) * (1 - cos(M_PI * k / (order - 1))));
        place[k] = k > 0 ? fmax(place[k - 1] + 1, at) : 0;
        place[order - 1 - k] = count - 1 - place[k];
    }
    gsl_matrix *gram = gsl_matrix_calloc(degrees, (size_t)order);
    gsl_matrix *normal = gsl_matrix_calloc(degrees, degrees);
    gsl_vector *sums = gsl_vector_calloc(degrees), *result = gsl_vector_alloc((size_t)order);
    bool done = gram && normal && sums && result;
    for (int i = 0; done && i < order; i++) {
        double before = 0, at = 1 / sqrt(count), b = 0, x = place[i] - 0.5 * (count - 1);
        for (size_t n = 0; n < degrees; n++) {
            double square = gsl_pow_2((double)n + 1);
            double next_b = sqrt(square * (count * count - square) / (4 * (4 * square - 1)));
            double next = (x * at - b * before) / next_b;
            gsl_matrix_set(gram, n, (size_t)i, at);
            before = at;
            at = next;
            b = next_b;
        }
    }
    if (done) {
        // Least norm: w = Gᵀ(G Gᵀ)⁻¹ c, c the sums of the polynomials: all but the first vanish.
        gsl_vector_set(sums, 0, sqrt(count));
        done = !gsl_blas_dgemm(CblasNoTrans, CblasTrans, 1, gram, gram, 0, normal) &&
               !gsl_linalg_cholesky_decomp1(normal) && !gsl_linalg_cholesky_svx(normal, sums) &&
               !gsl_blas_dgemv(CblasTrans, 1, gram, sums, 0, result);
        for (int i = 0; done && i < order; i++) weight[i] = gsl_vector_get(result, (size_t)i);
    }
    gsl_matrix_free(gram);
    gsl_matrix_free(normal);
    gsl_vector_free(sums);
    gsl_vector_free(result);
    return done;
}

/// Whether a coordinate is the margin away from both ends, or how likely where it is perturbed.
static double inside(const sphv_side *side, double x)
{
    double depth = fmin(x, 1 - x), spacings = (depth - side->margin) / side->spacing;
    if (side->periodic) return 1;
    if (!(side->amplitude > 0)) return depth >= side->margin * (1 - 1e-12) ? 1 : 0;
    if (side->jitter == SPHV_JITTER_UNIFORM)
        return fmin(1, fmax(0, 0.5 * (1 + spacings / side->amplitude)));
    return 0.5 * erfc(-spacings / (side->amplitude * M_SQRT2));
}

static void add_line(sphv_lines *lines, const sphv_side *side, double index, double weight)
{
    double last = (double)side->count - 1;
    sphv_line *line = &lines->line[lines->count++];
    line->x = (index + side->offset) * side->spacing;
    line->below = side->periodic ? side->reach : (int)fmin(side->reach, index);
    line->above = side->periodic ? side->reach : (int)fmin(side->reach, last - index);
    line->weight = weight;
    line->inside = inside(side, line->x);
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
    if (!sphv_sum_rule(order, to - from, place, weight)) return false;
    for (int i = 0; i < order; i++) add_line(lines, side, from + place[i], weight[i]);
    lines->exhaustive = false;
    return true;
}

/// Adds particles whose lines within reach differ, from … to − 1. The last `alone` of them, next to
/// what is not a strip, stand for themselves, the first when `alone` is negative.
static bool add_strip(sphv_lines *lines, const sphv_side *side, double from, double to, int order,
                      double alone)
{
    double place[SPHV_SUM_RULE], weight[SPHV_SUM_RULE];
    double first = from - fmin(0, alone), last = to - fmax(0, alone);
    bool chosen = last - first > order;
    if (!chosen) {
        for (double i = from; i < to; i++) add_line(lines, side, i, 1);
        return true;
    }
    if (!choose_lines(order, last - first, place, weight)) return false;
    for (double i = from; i < first; i++) add_line(lines, side, i, 1);
    for (int i = 0; i < order; i++) add_line(lines, side, first + place[i], weight[i]);
    for (double i = last; i < to; i++) add_line(lines, side, i, 1);
    lines->exhaustive = false;
    return true;
}

sphv_status sphv_lines_make(const sphv_side *side, int order, int strip_order, sphv_lines *out,
                            sphv_error *error)
{
    double count = (double)side->count;
    double strip = ceil(fmax(side->reach, side->margin / side->spacing) + 1);
    double from = fmin(count, fmax(strip, ceil(side->singular_until / side->spacing + 1)));
    double to = fmax(from, floor(count - strip));
    double panels = 2 + log2(count + 1);
    *out = (sphv_lines){.exhaustive = true};
    if (side->periodic) {
        from = strip = 0;
        to = count;
    }
    // Where strips meet the lines within reach are not smooth inside them.
    if (!(to > from)) strip_order = SPHV_STRIP_WHOLE;
    out->line = malloc((size_t)(from + (count - to) + panels * 2 * order + 1) * sizeof *out->line);
    bool done = out->line && add_strip(out, side, 0, fmin(strip, from), strip_order, STRIP_END) &&
                add_strip(out, side, fmin(strip, from), from, strip_order, STRIP_END);
    // Away from a singular point panels may double in length.
    for (double a = from; done && a < to;) {
        double b = side->singular_until > 0 ? fmin(to, 2 * a) : to;
        done = add_panel(out, side, a, b, order);
        a = b;
    }
    if (done) done = add_strip(out, side, to, count, strip_order, -STRIP_END);
    if (!done) {
        sphv_lines_free(out);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for a box's theory");
    }
    return SPHV_OK;
}

void sphv_lines_free(sphv_lines *lines)
{
    free(lines->line);
    *lines = (sphv_lines){0};
}
