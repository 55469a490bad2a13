#include "boundary_particle.h"

#include <gsl/gsl_math.h>
#include <stdlib.h>
#include <string.h>

// The error at a particle: with the shape function of its support as it is cut,
//
//     h^|β| (estimate − ∂^βA) = Σ_γ h^|γ| ∂^γA (Σ_{k,α} weight[k][α] M_k,α+γ − [γ = β] γ!)/γ!,
//
// the sum over all γ but those that the method reproduces. Where the field is singular in its first
// coordinate the series is in the others only, and moments are taken of φ(x + h s_1) s^α.

/// Where the product of two monomials stands.
static size_t sum_of(int d, size_t a, size_t b)
{
    const sphv_monomial *table = sphv_monomials(d);
    int power[SPHV_DIMENSIONS];
    for (int i = 0; i < SPHV_DIMENSIONS; i++) power[i] = table[a].power[i] + table[b].power[i];
    return sphv_monomial_index(d, power);
}

static bool start_method(const sphv_box_theory *theory, sphv_method_theory *of)
{
    size_t series = sphv_monomial_count(theory->d, of->degree);
    size_t terms = sphv_monomial_count(theory->d, sphv_shape_degree(of->method));
    of->memory = calloc(SPHV_QUANTITIES_MAX * series, sizeof *of->memory);
    of->products = calloc(terms * series, sizeof *of->products);
    if (!of->memory || !of->products) return false;
    for (size_t m = 0; m < terms; m++) {
        of->product[m] = of->products + m * series;
        for (size_t g = 0; g < series; g++) of->product[m][g] = sum_of(theory->d, m, g);
    }
    for (int q = 0; q < SPHV_QUANTITIES_MAX; q++) of->series[q] = of->memory + (size_t)q * series;
    return true;
}

sphv_status sphv_theory_start(sphv_box_theory *theory, sphv_error *error)
{
    size_t monomials = theory->octants->monomials, tails = theory->octants->tails;
    size_t rests = theory->octants->rests, lines = 0;
    const sphv_field *field = theory->field.field;
    if (theory->field.singular)
        lines = (size_t)field->terms * SPHV_RADIALS * (SPHV_SHAPE_DEGREE + 1) * tails * rests;
    size_t series = sphv_monomial_count(theory->d, theory->degree);
    theory->memory = calloc(SPHV_RADIALS * monomials + 2 * series + lines, sizeof *theory->memory);
    bool done = theory->memory != NULL;
    for (size_t m = 0; m < theory->count && done; m++) done = start_method(theory, &theory->of[m]);
    if (!done)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for a box's theory");
    double *at = theory->memory;
    for (int k = 0; k < SPHV_RADIALS; k++, at += monomials) theory->moment[k] = at;
    theory->derivative = at;
    theory->reciprocal = at + series;
    at += 2 * series;
    const sphv_monomial *table = sphv_monomials(theory->d);
    for (size_t g = 0; g < series; g++) theory->reciprocal[g] = 1 / table[g].factorial;
    if (lines)
        for (int t = 0; t < field->terms; t++)
            for (int k = 0; k < SPHV_RADIALS; k++)
                for (int a = 0; a <= SPHV_SHAPE_DEGREE; a++, at += tails * rests)
                    theory->line_moment[t][k][a] = at;
    return SPHV_OK;
}

/// A method's shape function and responses from the moments.
static void take_shape(const sphv_box_theory *theory, sphv_method_theory *of)
{
    const sphv_octants *octants = theory->octants;
    sphv_shape_make(of->method, theory->d, (const double *const *)theory->moment, &of->shape);
    const sphv_monomial *table = sphv_monomials(theory->d);
    size_t count = sphv_monomial_count(theory->d, of->degree);
    for (int q = 0; q < of->quantities; q++) {
        int exact = sphv_shape_exactness(of->method, table[q].degree);
        size_t first = sphv_monomial_count(theory->d, exact);
        memset(of->series[q], 0, count * sizeof *of->series[q]);
        of->size[q] = 0;
        for (int k = 0; k < SPHV_RADIALS; k++)
            for (size_t m = 0; m < SPHV_SHAPE_TERMS; m++) {
                double weight = of->shape.weight[q][k][m];
                if (weight == 0) continue;
                double size = k == 1 && m == 0 ? octants->flat : octants->size[k];
                int power = k == 1 && m == 0 ? 0 : table[m].degree - k;
                of->size[q] += fabs(weight) * theory->volume * size *
                               gsl_pow_int(theory->profile->support, power);
                const double *moment = theory->moment[k];
                const size_t *product = of->product[m];
                for (size_t g = first; g < count; g++)
                    of->series[q][g] += weight * moment[product[g]];
            }
        for (size_t g = first; g < count; g++) {
            if (g == 0) of->series[q][g] -= of->shape.self[q];
            of->series[q][g] *= theory->reciprocal[g];
        }
        if (first <= (size_t)q) of->series[q][q] -= 1;
    }
}

void sphv_theory_cut(sphv_box_theory *theory, const int *below, const int *above)
{
    size_t bytes = (size_t)theory->d * sizeof *below;
    if (theory->known && !memcmp(theory->below, below, bytes) &&
        !memcmp(theory->above, above, bytes))
        return;
    memcpy(theory->below, below, bytes);
    memcpy(theory->above, above, bytes);
    theory->known = true;
    double *needed[SPHV_RADIALS] = {theory->moment[0], theory->moment[1],
                                    theory->second ? theory->moment[2] : NULL};
    sphv_octants_moments(theory->octants, below, above, needed);
    for (int k = 0; k < SPHV_RADIALS; k++)
        for (size_t m = 0; m < theory->octants->monomials; m++)
            theory->moment[k][m] *= theory->volume;
    for (size_t m = 0; m < theory->count; m++) take_shape(theory, &theory->of[m]);
}

/// Relative error of Σ v|shape function|. With u = B⁻¹F, errors of moments and of the elimination
/// make |B⁻¹|(|δF| + |δB||u|): the sizes again, without the condition number; 8 covers both and the
/// elimination's. A differentiated matrix, rkpm's, brings another inverse.
static double rounding_of(const sphv_box_theory *theory, const sphv_method_theory *of)
{
    bool differentiated = of->method == SPHV_RKPM || of->method == SPHV_RKPM_2;
    return theory->octants->rounding * (differentiated ? 8 + of->shape.condition : 8);
}

/// h^|γ| ∂^γ of the field, or of one of its terms (`first` = 1: in the other coordinates alone).
static double term_derivative(const sphv_box_theory *theory, const sphv_line *const *line,
                              int first, int term, const int *order)
{
    double product = theory->field.field->term[term].coefficient;
    for (int i = first; i < theory->d; i++)
        product *= line[i]->factor[term * (theory->degree + 1) + order[i]];
    return product;
}

void sphv_theory_take_derivatives(sphv_box_theory *theory, const sphv_line *const *line)
{
    double size = 0, reach[SPHV_MONOMIAL_DEGREE_MAX + 1] = {1};
    const sphv_monomial *table = sphv_monomials(theory->d);
    size_t count = sphv_monomial_count(theory->d, theory->degree);
    for (int n = 1; n <= theory->degree; n++) reach[n] = reach[n - 1] * theory->profile->support;
    for (size_t g = 0; g < count; g++) {
        double sum = 0;
        for (int t = 0; t < theory->field.field->terms; t++)
            sum += term_derivative(theory, line, 0, t, table[g].power);
        size += fabs(sum) / table[g].factorial * reach[table[g].degree];
        theory->derivative[g] = sum;
        theory->size[table[g].degree] = size;
    }
}

void sphv_series_errors(const sphv_box_theory *theory, const sphv_method_theory *of,
                        sphv_particle_errors *out)
{
    double scale[SPHV_MONOMIAL_DEGREE_MAX + 1] = {1};
    const sphv_monomial *table = sphv_monomials(theory->d);
    size_t count = sphv_monomial_count(theory->d, of->degree);
    for (int n = 1; n <= of->degree; n++) scale[n] = scale[n - 1] * theory->h;
    double rounding = rounding_of(theory, of) * theory->size[of->degree];
    for (int q = 0; q < of->quantities; q++) {
        double sum = 0;
        for (size_t g = count; g-- > 0;) sum += of->series[q][g] * theory->derivative[g];
        out->value[q] = sum / scale[table[q].degree];
        out->bound[q] = of->size[q] * (of->tail + rounding) / scale[table[q].degree];
    }
}

/// Adds a node of the first coordinate to the moments of one term. \param value  v φ(x + h s_1)
static void add_node(sphv_box_theory *theory, int term, int at, double s, double value)
{
    const sphv_octants *octants = theory->octants;
    int degree = theory->shape_degree;
    size_t needed = octants->tails;
    if (theory->d > 1) needed *= sphv_monomial_count(theory->d - 1, theory->rest_degree + degree);
    for (int k = 0; k < SPHV_RADIALS; k++) {
        // p_0 comes with one power less than p_1, and p_2 in msph alone.
        int last = k == 0 ? degree - 1 : k == 1 || theory->second ? degree : -1;
        const double *row = octants->row[k] + at * octants->tails * octants->rests;
        double power = value;
        for (int a = 0; a <= last; a++, power *= s) {
            double *to = theory->line_moment[term][k][a];
            for (size_t m = 0; m < needed; m++) to[m] += power * row[m];
        }
    }
}

/// The first coordinate's part of the moments of φ_t(x + h s_1) s^α, for every tail.
void sphv_theory_take_line(sphv_box_theory *theory, const sphv_line *line)
{
    const sphv_octants *octants = theory->octants;
    size_t bytes = octants->tails * octants->rests * sizeof(double);
    for (int t = 0; t < theory->field.field->terms; t++) {
        sphv_field first = *theory->field.field;
        first.terms = 1;
        first.term[0] = theory->field.field->term[t];
        first.term[0].coefficient = 1;
        for (int i = 1; i < theory->d; i++)
            first.term[0].factor[i] = (sphv_factor){SPHV_FACTOR_POWER, 0, 0};
        for (int k = 0; k < SPHV_RADIALS; k++)
            for (int a = 0; a <= SPHV_SHAPE_DEGREE; a++)
                memset(theory->line_moment[t][k][a], 0, bytes);
        for (int node = 0; node < 2 * octants->nodes; node++) {
            int at = node / 2, side = node % 2 ? -1 : 1;
            if (at / octants->nodes_per_line > (side < 0 ? line->below : line->above)) continue;
            double s = side * octants->place[at], x[SPHV_DIMENSIONS] = {line->x + theory->h * s};
            // The cells of the outermost particles reach beyond the box; the field is 0 there.
            if (x[0] < 0) continue;
            add_node(theory, t, at, s,
                     octants->share[at] * theory->volume *
                         sphv_field_derivative(&first, (int[SPHV_DIMENSIONS]){0}, x));
        }
    }
}

/// Σ over the octants of the other coordinates of a line moment; γ a monomial of these.
static double combine(const sphv_box_theory *theory, const double *line_moment, size_t gamma)
{
    int others = theory->d - 1;
    double sum = 0;
    for (int octant = 0; octant < 1 << others; octant++) {
        size_t tail = 0;
        int odd = 0;
        for (int i = 0; i < others; i++) {
            bool down = octant >> i & 1;
            tail = tail * ((size_t)theory->octants->reach + 1) +
                   (size_t)(down ? theory->below[1 + i] : theory->above[1 + i]);
            if (down) odd += sphv_monomials(others)[gamma].power[i];
        }
        double part = line_moment[gamma * theory->octants->tails + tail];
        sum += odd % 2 ? -part : part;
    }
    return sum;
}

/// Sum over neighbours of v p_k s^α A, from the line moments and a series in the other coordinates.
static double field_moment(const sphv_box_theory *theory, int rest_degree,
                           const sphv_line *const *line, int k, size_t alpha)
{
    int others = theory->d - 1;
    const int *power = sphv_monomials(theory->d)[alpha].power;
    double sum = 0;
    if (others == 0) {
        for (int t = 0; t < theory->field.field->terms; t++)
            sum +=
                theory->field.field->term[t].coefficient * theory->line_moment[t][k][power[0]][0];
        return sum;
    }
    const sphv_monomial *table = sphv_monomials(others);
    size_t rest = sphv_monomial_index(others, (int[SPHV_DIMENSIONS]){power[1], power[2], 0});
    size_t rests = sphv_monomial_count(others, rest_degree);
    for (int t = 0; t < theory->field.field->terms; t++) {
        for (size_t g = 0; g < rests; g++) {
            int order[SPHV_DIMENSIONS] = {0, table[g].power[0], table[g].power[1]};
            double derivative = term_derivative(theory, line, 1, t, order);
            if (derivative == 0) continue;
            sum += derivative / table[g].factorial *
                   combine(theory, theory->line_moment[t][k][power[0]], sum_of(others, rest, g));
        }
    }
    return sum;
}

/// Errors of a particle where the field is singular in its first coordinate.
void sphv_singular_errors(const sphv_box_theory *theory, const sphv_method_theory *of,
                          const sphv_line *const *line, const double *x, sphv_particle_errors *out)
{
    double sums[SPHV_RADIALS][SPHV_SHAPE_TERMS];
    bool known[SPHV_RADIALS][SPHV_SHAPE_TERMS] = {{false}};
    const sphv_monomial *table = sphv_monomials(theory->d);
    const sphv_field *field = theory->field.field;
    double own = sphv_field_derivative(field, (int[SPHV_DIMENSIONS]){0}, x), largest = 0;
    for (int t = 0; t < field->terms; t++) largest += fabs(field->term[t].coefficient);
    double rounding = rounding_of(theory, of) * largest;
    for (int q = 0; q < of->quantities; q++) {
        double sum = -of->shape.self[q] * own, scale = gsl_pow_int(theory->h, table[q].degree);
        for (int k = 0; k < SPHV_RADIALS; k++)
            for (size_t m = 0; m < SPHV_SHAPE_TERMS; m++) {
                if (of->shape.weight[q][k][m] == 0) continue;
                if (!known[k][m]) sums[k][m] = field_moment(theory, of->rest_degree, line, k, m);
                known[k][m] = true;
                sum += of->shape.weight[q][k][m] * sums[k][m];
            }
        out->value[q] = sum / scale - sphv_field_derivative(field, table[q].power, x);
        out->bound[q] = of->size[q] * (of->rest_tail + rounding) / scale;
    }
}

void sphv_theory_end(sphv_box_theory *theory)
{
    free(theory->memory);
    for (size_t m = 0; m < theory->count; m++) {
        free(theory->of[m].memory);
        free(theory->of[m].products);
    }
}
