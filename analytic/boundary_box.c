#include <gsl/gsl_math.h>
#include <stdlib.h>
#include <string.h>

#include "boundary_internal.h"

// The error at a particle: with the shape function of its support as it is cut,
//
//     h^|β| (estimate − ∂^βA) = Σ_γ h^|γ| ∂^γA (Σ_{k,α} weight[k][α] M_k,α+γ − [γ = β] γ!)/γ!,
//
// the sum over all γ but those that the method reproduces. Where the field is singular in its first
// coordinate the series is in the others only, and moments are taken of φ(x + h s_1) s^α.

enum { SERIES = 969, N = SPHV_QUANTITIES_MAX }; ///< monomials of degree <= 16 in three dimensions

struct theory {
    const sphv_profile *profile;
    const sphv_octants *octants;
    sphv_field_theory field;
    sphv_method method;
    int d, quantities, degree; ///< of the Taylor series
    int rest_degree;           ///< of the series in the other coordinates alone
    double h, volume;          ///< V/Δx^d
    double tail, rest_tail;    ///< remainders at the current first coordinate
    double *moment[SPHV_RADIALS];
    double *series[N]; ///< response to h^|γ| ∂^γA, without the quantity itself
    double *line_moment[SPHV_FIELD_TERMS_MAX][SPHV_RADIALS][SPHV_SHAPE_DEGREE + 1];
    double *memory;
    int below[SPHV_DIMENSIONS], above[SPHV_DIMENSIONS];
    bool known; ///< moments, shape and responses are those of `below` and `above`
    sphv_shape shape;
    double size[N]; ///< bound of Σ v|shape function|
};

/// The errors of one particle, and what is not known of them.
struct errors {
    double value[N], bound[N];
    bool regular;
};

/// Products that several loops need: the monomial of α + γ, kept as a table.
static size_t sum_of(int d, size_t a, size_t b)
{
    const sphv_monomial *table = sphv_monomials(d);
    int power[SPHV_DIMENSIONS];
    for (int i = 0; i < SPHV_DIMENSIONS; i++) power[i] = table[a].power[i] + table[b].power[i];
    return sphv_monomial_index(d, power);
}

static sphv_status start(struct theory *of, sphv_error *error)
{
    size_t monomials = of->octants->monomials, tails = of->octants->tails;
    size_t rests = of->octants->rests, lines = 0;
    if (of->field.singular)
        lines =
            (size_t)of->field.field->terms * SPHV_RADIALS * (SPHV_SHAPE_DEGREE + 1) * tails * rests;
    of->memory = calloc((SPHV_RADIALS + N) * monomials + lines, sizeof *of->memory);
    if (!of->memory)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for a box's theory");
    double *at = of->memory;
    for (int k = 0; k < SPHV_RADIALS; k++, at += monomials) of->moment[k] = at;
    for (int q = 0; q < N; q++, at += monomials) of->series[q] = at;
    if (lines)
        for (int t = 0; t < of->field.field->terms; t++)
            for (int k = 0; k < SPHV_RADIALS; k++)
                for (int a = 0; a <= SPHV_SHAPE_DEGREE; a++, at += tails * rests)
                    of->line_moment[t][k][a] = at;
    return SPHV_OK;
}

/// Moments, shape function and responses where the support is cut so.
static void cut(struct theory *of, const int *below, const int *above)
{
    size_t bytes = (size_t)of->d * sizeof *below;
    if (of->known && !memcmp(of->below, below, bytes) && !memcmp(of->above, above, bytes)) return;
    memcpy(of->below, below, bytes);
    memcpy(of->above, above, bytes);
    of->known = true;
    sphv_octants_moments(of->octants, below, above, of->moment);
    for (int k = 0; k < SPHV_RADIALS; k++)
        for (size_t m = 0; m < of->octants->monomials; m++) of->moment[k][m] *= of->volume;
    sphv_shape_make(of->method, of->d, (const double *const *)of->moment, &of->shape);
    const sphv_monomial *table = sphv_monomials(of->d);
    size_t count = sphv_monomial_count(of->d, of->degree);
    for (int q = 0; q < of->quantities; q++) {
        int exact = sphv_shape_exactness(of->method, table[q].degree);
        memset(of->series[q], 0, count * sizeof *of->series[q]);
        of->size[q] = 0;
        for (int k = 0; k < SPHV_RADIALS; k++)
            for (size_t m = 0; m < SPHV_SHAPE_TERMS; m++) {
                double weight = of->shape.weight[q][k][m];
                if (weight == 0) continue;
                double size = k == 1 && m == 0 ? of->octants->flat : of->octants->size[k];
                int power = k == 1 && m == 0 ? 0 : table[m].degree - k;
                of->size[q] +=
                    fabs(weight) * of->volume * size * gsl_pow_int(of->profile->support, power);
                for (size_t g = sphv_monomial_count(of->d, exact); g < count; g++)
                    of->series[q][g] += weight * of->moment[k][sum_of(of->d, m, g)];
            }
        for (size_t g = sphv_monomial_count(of->d, exact); g < count; g++) {
            if (g == 0) of->series[q][g] -= of->shape.self[q];
            of->series[q][g] = of->series[q][g] / table[g].factorial - (g == (size_t)q ? 1 : 0);
        }
    }
}

/// Errors of a particle where the field has a Taylor series.
static void series_errors(struct theory *of, const double *x, struct errors *out)
{
    double derivative[SERIES], scale[SPHV_MONOMIAL_DEGREE_MAX + 1] = {1}, size = 0;
    const sphv_monomial *table = sphv_monomials(of->d);
    size_t count = sphv_monomial_count(of->d, of->degree);
    sphv_field_derivatives(of->field.field, of->degree, x, derivative);
    for (int n = 1; n <= of->degree; n++) scale[n] = scale[n - 1] * of->h;
    for (size_t g = 0; g < count; g++) {
        derivative[g] *= scale[table[g].degree];
        size += fabs(derivative[g]) / table[g].factorial *
                gsl_pow_int(of->profile->support, table[g].degree);
    }
    double rounding = of->octants->rounding * (1 + of->shape.condition) * size;
    for (int q = 0; q < of->quantities; q++) {
        double sum = 0;
        for (size_t g = count; g-- > 0;) sum += of->series[q][g] * derivative[g];
        out->value[q] = sum / scale[table[q].degree];
        out->bound[q] = of->size[q] * (of->tail + rounding) / scale[table[q].degree];
    }
}

/// The first coordinate's part of the moments of φ_t(x + h s_1) s^α, for every tail.
static void take_line(struct theory *of, const sphv_line *line)
{
    const sphv_octants *octants = of->octants;
    size_t width = octants->tails * octants->rests;
    int degree = sphv_shape_degree(of->method);
    for (int t = 0; t < of->field.field->terms; t++) {
        sphv_field first = *of->field.field;
        first.terms = 1;
        first.term[0] = of->field.field->term[t];
        first.term[0].coefficient = 1;
        for (int i = 1; i < of->d; i++)
            first.term[0].factor[i] = (sphv_factor){SPHV_FACTOR_POWER, 0, 0};
        for (int k = 0; k < SPHV_RADIALS; k++)
            for (int a = 0; a <= degree; a++)
                memset(of->line_moment[t][k][a], 0, width * sizeof(double));
        for (int node = 0; node < 2 * octants->nodes; node++) {
            int at = node / 2, side = node % 2 ? -1 : 1;
            if (at / octants->nodes_per_line > (side < 0 ? line->below : line->above)) continue;
            double s = side * octants->place[at], x[SPHV_DIMENSIONS] = {line->x + of->h * s};
            // The cells of the outermost particles reach beyond the box; the field is 0 there.
            if (x[0] < 0) continue;
            double power = octants->share[at] * of->volume *
                           sphv_field_derivative(&first, (int[SPHV_DIMENSIONS]){0}, x);
            for (int a = 0; a <= degree; a++, power *= s)
                for (int k = 0; k < SPHV_RADIALS; k++) {
                    const double *row = octants->row[k] + at * width;
                    double *to = of->line_moment[t][k][a];
                    for (size_t m = 0; m < width; m++) to[m] += power * row[m];
                }
        }
    }
}

/// Σ over the octants of the other coordinates of a line moment; γ a monomial of these.
static double combine(const struct theory *of, const double *line_moment, size_t gamma)
{
    int others = of->d - 1;
    double sum = 0;
    for (int octant = 0; octant < 1 << others; octant++) {
        size_t tail = 0;
        int odd = 0;
        for (int i = 0; i < others; i++) {
            bool down = octant >> i & 1;
            tail = tail * ((size_t)of->octants->reach + 1) +
                   (size_t)(down ? of->below[1 + i] : of->above[1 + i]);
            if (down) odd += sphv_monomials(others)[gamma].power[i];
        }
        double part = line_moment[tail * of->octants->rests + gamma];
        sum += odd % 2 ? -part : part;
    }
    return sum;
}

/// Sum over neighbours of v p_k s^α A, from the line moments and a series in the other coordinates.
static double field_moment(const struct theory *of, const double *x, int k, size_t alpha)
{
    int others = of->d - 1, origin[SPHV_DIMENSIONS] = {0};
    const int *power = sphv_monomials(of->d)[alpha].power;
    double sum = 0;
    if (others == 0) {
        for (int t = 0; t < of->field.field->terms; t++)
            sum += of->field.field->term[t].coefficient * of->line_moment[t][k][power[0]][0];
        return sum;
    }
    const sphv_monomial *table = sphv_monomials(others);
    size_t rest = sphv_monomial_index(others, (int[SPHV_DIMENSIONS]){power[1], power[2], 0});
    for (int t = 0; t < of->field.field->terms; t++) {
        sphv_field term = *of->field.field;
        term.terms = 1;
        term.term[0] = of->field.field->term[t];
        term.term[0].factor[0] = (sphv_factor){SPHV_FACTOR_POWER, 0, 0};
        for (size_t g = 0; g < sphv_monomial_count(others, of->rest_degree); g++) {
            int order[SPHV_DIMENSIONS] = {origin[0], table[g].power[0], table[g].power[1]};
            double derivative = sphv_field_derivative(&term, order, x);
            if (derivative == 0) continue;
            sum += derivative * gsl_pow_int(of->h, table[g].degree) / table[g].factorial *
                   combine(of, of->line_moment[t][k][power[0]], sum_of(others, rest, g));
        }
    }
    return sum;
}

/// Errors of a particle where the field is singular in its first coordinate.
static void singular_errors(struct theory *of, const double *x, struct errors *out)
{
    double sums[SPHV_RADIALS][SPHV_SHAPE_TERMS];
    bool known[SPHV_RADIALS][SPHV_SHAPE_TERMS] = {{false}};
    const sphv_monomial *table = sphv_monomials(of->d);
    double own = sphv_field_derivative(of->field.field, (int[SPHV_DIMENSIONS]){0}, x);
    double largest = 0;
    for (int t = 0; t < of->field.field->terms; t++)
        largest += fabs(of->field.field->term[t].coefficient);
    double rounding = of->octants->rounding * (1 + of->shape.condition) * largest;
    for (int q = 0; q < of->quantities; q++) {
        double sum = -of->shape.self[q] * own, scale = gsl_pow_int(of->h, table[q].degree);
        for (int k = 0; k < SPHV_RADIALS; k++)
            for (size_t m = 0; m < SPHV_SHAPE_TERMS; m++) {
                if (of->shape.weight[q][k][m] == 0) continue;
                if (!known[k][m]) sums[k][m] = field_moment(of, x, k, m);
                known[k][m] = true;
                sum += of->shape.weight[q][k][m] * sums[k][m];
            }
        out->value[q] = sum / scale - sphv_field_derivative(of->field.field, table[q].power, x);
        out->bound[q] = of->size[q] * (of->rest_tail + rounding) / scale;
    }
}

/// Σ weight (e², bound², 1) of all and of interior particles.
struct norms {
    double square[2][N], bound[2][N], count[2];
    double excluded;
};

static void add_particle(struct theory *of, const sphv_line *const *line, struct norms *to)
{
    double x[SPHV_DIMENSIONS] = {0}, weight = 1;
    int below[SPHV_DIMENSIONS], above[SPHV_DIMENSIONS];
    bool interior = true;
    struct errors errors;
    for (int i = 0; i < of->d; i++) {
        x[i] = line[i]->x;
        weight *= line[i]->weight;
        below[i] = line[i]->below;
        above[i] = line[i]->above;
        interior = interior && line[i]->interior;
    }
    cut(of, below, above);
    if (!(of->shape.condition <= 1 / sqrt(DBL_EPSILON))) {
        to->excluded += weight;
        return;
    }
    if (line[0]->singular)
        singular_errors(of, x, &errors);
    else
        series_errors(of, x, &errors);
    for (int part = 0; part < (interior ? 2 : 1); part++) {
        to->count[part] += weight;
        for (int q = 0; q < of->quantities; q++) {
            to->square[part][q] += weight * gsl_pow_2(errors.value[q]);
            to->bound[part][q] += weight * gsl_pow_2(errors.bound[q]);
        }
    }
}

static void add_all(struct theory *of, const sphv_lines lines[SPHV_DIMENSIONS], struct norms *to)
{
    const sphv_line *at[SPHV_DIMENSIONS] = {0};
    int counts[SPHV_DIMENSIONS] = {1, 1, 1};
    double reach = of->h * of->profile->support, tail[SPHV_TAIL];
    for (int i = 0; i < of->d; i++) counts[i] = lines[i].count;
    of->rest_tail = 0;
    for (int i = 0; i < counts[0]; i++) {
        at[0] = &lines[0].line[i];
        if (at[0]->singular) {
            take_line(of, at[0]);
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

/// Sums over the box with panels of `order` nodes.
static sphv_status sum_box(struct theory *of, const sphv_box *box, int order, struct norms *to,
                           bool *exhaustive, sphv_error *error)
{
    sphv_lines lines[SPHV_DIMENSIONS] = {{0}};
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
                          .singular_until = -1};
        if (i == 0 && of->field.singular) side.singular_until = 2 * side.margin;
        status = sphv_lines_make(&side, order, &lines[i], error);
        *exhaustive = *exhaustive && lines[i].exhaustive;
    }
    if (status == SPHV_OK) add_all(of, lines, to);
    for (int i = 0; i < of->d; i++) sphv_lines_free(&lines[i]);
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
    if (box->layout != SPHV_LATTICE)
        return sphv_fail(error, SPHV_NO_CLOSED_FORM,
                         "no theory of boxes for layout '%s'; allowed: lattice",
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
static int choose_degree(const struct theory *of)
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

static sphv_status predict(struct theory *of, const sphv_box *box, sphv_box_prediction *out,
                           sphv_error *error)
{
    struct norms fine, coarse;
    bool exhaustive;
    sphv_status status = start(of, error);
    if (status == SPHV_OK) status = sum_box(of, box, SPHV_SUM_RULE, &fine, &exhaustive, error);
    if (status == SPHV_OK && exhaustive) coarse = fine;
    if (status == SPHV_OK && !exhaustive)
        status = sum_box(of, box, 3 * SPHV_SUM_RULE / 4, &coarse, &exhaustive, error);
    free(of->memory);
    if (status != SPHV_OK) return status;
    out->quantities = (size_t)of->quantities;
    out->excluded = fine.excluded;
    for (int q = 0; q < of->quantities; q++) {
        finish(&fine, &coarse, 0, q, &out->rmse[q]);
        finish(&fine, &coarse, 1, q, &out->interior[q]);
        out->exists[q] = fine.count[0] > 0 && isfinite(out->rmse[q].value);
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
    struct theory of = {.profile = profile,
                        .octants = &octants,
                        .method = method,
                        .d = box->dimension,
                        .quantities = (int)sphv_method_quantities(method, box->dimension),
                        .h = h,
                        .volume = volume_ratio(box)};
    status = sphv_field_theory_make(field, &of.field, error);
    if (status != SPHV_OK) return status;
    of.degree = choose_degree(&of);
    int degree = of.degree + sphv_shape_degree(method);
    if (of.field.singular) {
        of.rest_degree = (int)fmin(of.field.rest_degree, of.degree);
        degree = (int)fmax(degree, of.rest_degree + sphv_shape_degree(method));
    }
    status = sphv_octants_make(profile, sphv_box_spacing(box) / h,
                               source == SPHV_MOMENTS_LATTICE ? 1 : 4, degree, &octants, error);
    if (status != SPHV_OK) return status;
    status = predict(&of, box, out, error);
    sphv_octants_free(&octants);
    return status;
}

sphv_status sphv_predict_box(const sphv_box *box, const sphv_profile *profile, double h,
                             sphv_method method, const sphv_field *field, sphv_box_prediction *out,
                             sphv_error *error)
{
    return sphv_predict_box_from(box, profile, h, method, field, SPHV_MOMENTS_LATTICE, out, error);
}
