/// Sums on an unperturbed lattice. Moments depend on the distances to the sides alone: prefix sums
/// over the offsets. Sums over a field are Σ K(b − a) A_b − A_a Σ K: Fourier transforms, two fields
/// as real and imaginary parts of one, and two kernels at once, whose transforms are real or
/// imaginary by their symmetry.
#include <stdlib.h>
#include <string.h>

#include "../internal.h"
#include "lattice_table.h"
#include "transform.h"

/// A radial function times a monomial.
typedef struct summand {
    int k, monomial;
} summand;

enum { KERNELS = 128 }; ///< of the highest level in three dimensions: 35 + 56 + 31

typedef struct route {
    const sphv_evaluation *evaluation;
    sphv_lattice_table table;
    sphv_transform transform;
    summand moment[KERNELS], field[KERNELS];
    size_t fields;
    double *moments;  ///< [moment * classes + class]
    double *bound[3]; ///< per class: what its sums are wrong by, in units of κ^(|α| − m)
    double *counts;   ///< per class: neighbours
    double *centre;   ///< middle of each field's range
    double **sums;    ///< Σ K(b − a)(A_b − centre), [field * per_field + kernel]
    double transform_error[3]; ///< of those, in units of κ^(|α| − m) and the field's spread
    size_t done, steps;
} route;

static const sphv_monomial *monomial_of(const route *of, const summand *kernel)
{
    return &sphv_monomials(of->table.dimension)[kernel->monomial];
}

static sphv_offset_function function_of(const route *of, const summand *kernel)
{
    return (sphv_offset_function){of->table.p[kernel->k], of->table.volume,
                                  monomial_of(of, kernel)};
}

/// κ^(|α| − m).
static double reach_of(const route *of, const summand *kernel)
{
    int extra = monomial_of(of, kernel)->degree - of->table.lowest[kernel->k];
    return pow(of->evaluation->request->profile->support, extra);
}

/// Lists what the layout asks for, each in its place.
static void list_kernels(route *of)
{
    const sphv_sum_layout *layout = &of->evaluation->layout;
    const sphv_sum_set *set = &sphv_sum_sets[layout->level];
    for (int k = 0; k < 3; k++) {
        int first = layout->first_monomial[k], first_field = layout->first_field_monomial[k];
        int end = (int)sphv_monomial_count(layout->dimension, set->moment[k].to);
        int end_field = (int)sphv_monomial_count(layout->dimension, set->field[k].to);
        for (int j = first; layout->moment_at[k] >= 0 && j < end; j++)
            of->moment[layout->moment_at[k] + j - first] = (summand){k, j};
        for (int j = first_field; layout->field_at[k] >= 0 && j < end_field; j++)
            of->field[layout->field_at[k] + j - first_field] = (summand){k, j};
    }
}

/// Sums over each class: moments, sizes, errors and neighbours.
static sphv_status sum_classes(route *of)
{
    const sphv_lattice_table *table = &of->table;
    int moments = of->evaluation->layout.moments, failed = 0;
    double *sizes[3] = {NULL, NULL, NULL};
    of->moments = malloc(((size_t)moments * table->classes + 1) * sizeof *of->moments);
    of->counts = malloc(table->classes * sizeof *of->counts);
    bool enough = of->moments && of->counts;
    for (int k = 0; k < 3; k++) {
        sizes[k] = calloc(table->classes, sizeof *sizes[k]);
        of->bound[k] = calloc(table->classes, sizeof *of->bound[k]);
        enough = enough && sizes[k] && of->bound[k];
    }
    // The moments, then the neighbours, then sizes and errors of each radial function
#pragma omp parallel for schedule(dynamic) reduction(+ : failed)
    for (int j = 0; j < moments + 7; j++) {
        int k = (j - moments - 1) / 2;
        bool error = j > moments && (j - moments - 1) % 2;
        sphv_offset_function function = {NULL, 1, NULL};
        double *out = of->counts;
        if (!enough || (j > moments && table->degree[k] < 0)) continue;
        if (j < moments) {
            function = function_of(of, &of->moment[j]);
            out = of->moments + (size_t)j * table->classes;
        } else if (j > moments) {
            function.octant = error ? table->error[k] : table->size[k];
            function.factor = fabs(table->volume);
            out = error ? of->bound[k] : sizes[k];
        }
        failed += sphv_cuboid_sums(table, &function, out) != SPHV_OK;
    }
    double prefix = sphv_cuboid_error(table);
    for (int k = 0; k < 3 && enough; k++) {
        double total = 0;
        if (table->degree[k] < 0) continue;
        for (size_t n = 0; n < table->octant; n++) total += table->size[k][n] + table->error[k][n];
        total *= fabs(table->volume) * (1 << table->dimension);
        // Beside the summands' errors: prefix sums, of which sums over a field take one more; A −
        // c, the own value's product and difference, and the roundings of results: 8u
        for (size_t c = 0; c < table->classes; c++)
            of->bound[k][c] =
                1.001 * (of->bound[k][c] + 8 * SPHV_U * sizes[k][c] + 3 * prefix * total);
    }
    for (int k = 0; k < 3; k++) free(sizes[k]);
    return enough && !failed ? SPHV_OK : SPHV_RESOURCE_FAILURE;
}

/// Place in the cube of lattice place or wrapped offset n of a cube with `base` places a side.
static size_t cube_index(const route *of, size_t n, size_t base, size_t shift)
{
    size_t index = 0, stride = 1;
    for (int i = 0; i < of->table.dimension; i++, n /= base, stride *= of->transform.size)
        index += (n % base + shift) % of->transform.size * stride;
    return index;
}

/// The power of two that brings a number between 1/2 and 1; 1 for zero.
static double normalising(double number)
{
    int exponent;
    if (number == 0) return 1;
    frexp(number, &exponent);
    return ldexp(1, exponent < -1000 ? 1000 : -exponent);
}

/// Transforms of fields first and, if there is one, first + 1, as real and imaginary part.
/// \param scale per field: what it was multiplied by. \return ‖.‖₂, an upper bound
static sphv_status transform_fields(route *of, size_t first, double *cube, double scale[2],
                                    double *norm)
{
    const sphv_request *request = of->evaluation->request;
    size_t count = of->evaluation->particles->count, side = of->table.side;
    double square = 0;
    memset(cube, 0, 2 * of->transform.points * sizeof *cube);
    for (size_t f = first; f < first + 2 && f < of->fields; f++) {
        double centre = of->centre[f];
        scale[f - first] = normalising(of->evaluation->spread[f]);
        for (size_t n = 0; n < count; n++) {
            double value = (request->fields[f][n] - centre) * scale[f - first];
            cube[2 * cube_index(of, n, side, 0) + (f - first)] = value;
            square += value * value;
        }
    }
    *norm = 1.0001 * sqrt(square);
    return sphv_transform_forward(&of->transform, cube, side);
}

/// Real transforms of kernels first and, if there is one, first + 1, as real and imaginary part:
/// that of G(o) = K(−o) where the monomial is even, i times it where it is odd.
static sphv_status transform_kernels(route *of, size_t first, size_t count, double *cube,
                                     double scale[2], double *norm)
{
    const sphv_lattice_table *table = &of->table;
    double squares = 0;
    memset(cube, 0, 2 * of->transform.points * sizeof *cube);
    for (size_t s = 0; s < 2 && first + s < count; s++) {
        sphv_offset_function function = function_of(of, &of->field[first + s]);
        bool odd = function.monomial->degree % 2;
        double square = 0;
        // i times a real number, and that times i again, or not: where it belongs, and its sign
        size_t part = (s + odd) % 2;
        double sign = odd && s ? -1 : 1;
        for (int pass = 0; pass < 2; pass++) {
            if (pass) scale[s] = normalising(sqrt(square));
            for (size_t n = 0; n < table->cells; n++) {
                long offset[SPHV_DIMENSIONS] = {0};
                size_t rest = n;
                for (int i = table->dimension - 1; i >= 0; i--, rest /= table->width)
                    offset[i] = (long)table->reach - (long)(rest % table->width);
                double value = sphv_offset_value(table, &function, offset);
                if (pass == 0) {
                    square += value * value;
                } else {
                    size_t at = cube_index(of, n, table->width, of->transform.size - table->reach);
                    cube[2 * at + part] += sign * scale[s] * value;
                }
            }
        }
        squares += square * scale[s] * scale[s];
    }
    *norm = 1.0001 * sqrt(2 * squares); // of sums of two in one part as well
    return sphv_transform_forward(&of->transform, cube, of->transform.size);
}

/// Ẑ = Â·Ĝ of one kernel of a pair, or of both as Ĝ_0 + iĜ_1.
static void multiply(const route *of, const double *field, const double *pair, const bool odd[2],
                     int which, double *out)
{
#pragma omp parallel for schedule(static)
    for (size_t n = 0; n < of->transform.points; n++) {
        double g[2] = {0, 0}; // the transform of the kernel or kernels
        for (int s = 0; s < 2; s++) {
            if (which >= 0 && which != s) continue;
            double turned[2] = {odd[s] ? 0 : pair[2 * n + s], odd[s] ? -pair[2 * n + s] : 0};
            bool second = which < 0 && s == 1;
            g[0] += second ? -turned[1] : turned[0];
            g[1] += second ? turned[0] : turned[1];
        }
        double re = field[2 * n], im = field[2 * n + 1];
        out[2 * n] = re * g[0] - im * g[1];
        out[2 * n + 1] = re * g[1] + im * g[0];
    }
}

/// Keeps a part of a cube as the sums of one field and kernel.
static void keep(route *of, const double *cube, int part, size_t field, size_t kernel, double scale)
{
    double *out = of->sums[field * (size_t)of->evaluation->layout.per_field + kernel];
    double factor = 1 / ((double)of->transform.points * scale);
#pragma omp parallel for schedule(static)
    for (size_t n = 0; n < of->evaluation->particles->count; n++)
        out[n] = cube[2 * cube_index(of, n, of->table.side, 0) + part] * factor;
}

static void note_error(route *of, size_t field, const summand *kernel, double norms, double scale)
{
    // Three transforms, and 8u for the product, the division and the parts
    double error = 1.01 * (3 * sphv_transform_error(&of->transform) + 8 * SPHV_U) * norms / scale;
    double unit = reach_of(of, kernel) * of->evaluation->spread[field];
    if (unit > 0)
        of->transform_error[kernel->k] = fmax(of->transform_error[kernel->k], error / unit);
}

static void advance(route *of)
{
    sphv_evaluation_advance(of->evaluation, &of->done, of->steps);
}

/// Sums of one or two fields with one or two kernels.
static sphv_status convolve_pair(route *of, size_t field, const double *fields,
                                 const double field_scale[2], size_t first, const double *kernels,
                                 const double kernel_scale[2], double norms, double *work)
{
    size_t count = (size_t)of->evaluation->layout.per_field;
    size_t pair = first + 1 < count ? 2 : 1;
    bool odd[2] = {monomial_of(of, &of->field[first])->degree % 2,
                   pair == 2 && monomial_of(of, &of->field[first + 1])->degree % 2};
    bool single = field + 1 == of->fields;
    sphv_status status = SPHV_OK;
    for (size_t s = 0; s < (single ? 1 : pair) && status == SPHV_OK; s++) {
        multiply(of, fields, kernels, odd, single ? -1 : (int)s, work);
        status = sphv_transform_backward(&of->transform, work, of->table.side);
        for (size_t part = 0; part < (single ? pair : 2) && status == SPHV_OK; part++) {
            size_t f = field + (single ? 0 : part), kernel = first + (single ? part : s);
            double scale = field_scale[f - field] * kernel_scale[kernel - first];
            keep(of, work, (int)part, f, kernel, scale);
            note_error(of, f, &of->field[kernel], norms, scale);
        }
        advance(of);
    }
    return status;
}

static sphv_status convolve(route *of)
{
    size_t pairs = (of->fields + 1) / 2, kernels = (size_t)of->evaluation->layout.per_field;
    size_t cube = 2 * of->transform.points;
    double *fields = malloc((pairs * cube + 1) * sizeof *fields);
    double *kernel = malloc(cube * sizeof *kernel), *work = malloc(cube * sizeof *work);
    double(*scale)[2] = calloc(pairs + 1, sizeof *scale);
    double *norm = calloc(pairs + 1, sizeof *norm);
    sphv_status status =
        fields && kernel && work && scale && norm ? SPHV_OK : SPHV_RESOURCE_FAILURE;
    for (size_t p = 0; p < pairs && status == SPHV_OK; p++) {
        status = transform_fields(of, 2 * p, fields + p * cube, scale[p], &norm[p]);
        advance(of);
    }
    for (size_t s = 0; pairs > 0 && s < kernels && status == SPHV_OK; s += 2) {
        double kernel_scale[2] = {1, 1}, kernel_norm = 0;
        status = transform_kernels(of, s, kernels, kernel, kernel_scale, &kernel_norm);
        advance(of);
        for (size_t p = 0; p < pairs && status == SPHV_OK; p++)
            status = convolve_pair(of, 2 * p, fields + p * cube, scale[p], s, kernel, kernel_scale,
                                   kernel_norm * norm[p], work);
    }
    free(fields);
    free(kernel);
    free(work);
    free(scale);
    free(norm);
    return status;
}

/// Neighbours at the support's edge, decided as every route does.
static unsigned count_ties(const route *of, size_t n, const size_t place[SPHV_DIMENSIONS])
{
    const sphv_particles *particles = of->evaluation->particles;
    double reach = of->evaluation->request->profile->support * of->evaluation->request->h;
    unsigned count = 0;
    for (size_t t = 0; t < of->table.ties; t++) {
        const int *offset = of->table.tie[t];
        double d[SPHV_DIMENSIONS] = {0, 0, 0};
        size_t b = 0;
        bool there = true;
        for (int i = 0; i < particles->dimension; i++) {
            long at = (long)place[i] + offset[i];
            there = there && at >= 0 && at < (long)of->table.side;
            b = b * of->table.side + (size_t)at;
        }
        for (int i = 0; there && i < particles->dimension; i++)
            d[i] = particles->x[i][b] - particles->x[i][n];
        if (there) count += sphv_square(particles->dimension, d) < reach * reach;
    }
    return count;
}

/// All sums of the block's i-th particle, which is particle n.
static void assemble(const route *of, sphv_worker *worker, size_t i, size_t n)
{
    const sphv_sum_layout *layout = &of->evaluation->layout;
    const sphv_lattice_table *table = &of->table;
    size_t place[SPHV_DIMENSIONS], c = sphv_lattice_class(table, n, place);
    double *sums = worker->block.sums + i;
    size_t stride = worker->block.stride;
    for (int j = 0; j < layout->moments; j++)
        sums[(size_t)j * stride] = of->moments[(size_t)j * table->classes + c];
    // The bounds as multiples of a rounding of u
    for (int k = 0; k < 3; k++)
        sums[(size_t)(layout->size_at + k) * stride] =
            (of->bound[k][c] + of->transform_error[k]) / SPHV_U;
    for (size_t f = 0; f < of->fields; f++) {
        double own = of->evaluation->request->fields[f][n] - of->centre[f];
        for (int s = 0; s < layout->per_field; s++) {
            int moment = sphv_moment_index(layout, of->field[s].k, of->field[s].monomial);
            double whole = of->moments[(size_t)moment * table->classes + c];
            size_t at = (size_t)layout->moments + 3 + f * (size_t)layout->per_field + (size_t)s;
            sums[at * stride] =
                of->sums[f * (size_t)layout->per_field + (size_t)s][n] - own * whole;
        }
    }
    worker->particle[i] = n;
    worker->neighbours[i] = (unsigned)of->counts[c] + count_ties(of, n, place);
    worker->rounding[i] = SPHV_U;
}

static sphv_status finish(route *of)
{
    size_t count = of->evaluation->particles->count;
    size_t blocks = (count + SPHV_BLOCK - 1) / SPHV_BLOCK;
    sphv_status status = SPHV_OK;
#pragma omp parallel
    {
        sphv_worker worker;
        bool ready = sphv_worker_make(&worker, of->evaluation) == SPHV_OK;
        if (!ready) {
#pragma omp atomic write
            status = SPHV_RESOURCE_FAILURE;
        }
#pragma omp for schedule(dynamic)
        for (size_t block = 0; block < blocks; block++) {
            size_t first = block * SPHV_BLOCK;
            size_t n = count - first < SPHV_BLOCK ? count - first : SPHV_BLOCK;
            for (size_t i = 0; ready && i < n; i++) assemble(of, &worker, i, first + i);
            if (ready) sphv_worker_finish_block(&worker, first, n);
            advance(of);
        }
#pragma omp critical(sphv_convolution)
        sphv_worker_free(&worker);
    }
    return status;
}

static bool reserve(route *of)
{
    const sphv_request *request = of->evaluation->request;
    size_t count = of->evaluation->particles->count;
    size_t arrays = of->fields * (size_t)of->evaluation->layout.per_field;
    of->centre = calloc(of->fields + 1, sizeof *of->centre);
    of->sums = calloc(arrays + 1, sizeof *of->sums);
    bool enough = of->centre && of->sums;
    for (size_t a = 0; a < arrays && enough; a++)
        enough = (of->sums[a] = malloc(count * sizeof **of->sums)) != NULL;
    for (size_t f = 0; f < of->fields && enough; f++) {
        double least = request->fields[f][0], most = least;
        for (size_t n = 1; n < count; n++) {
            least = fmin(least, request->fields[f][n]);
            most = fmax(most, request->fields[f][n]);
        }
        of->centre[f] = least == most ? least : 0.5 * least + 0.5 * most;
    }
    return enough;
}

static void release(route *of)
{
    size_t arrays = of->fields * (size_t)of->evaluation->layout.per_field;
    for (size_t a = 0; of->sums && a < arrays; a++) free(of->sums[a]);
    for (int k = 0; k < 3; k++) free(of->bound[k]);
    free(of->sums);
    free(of->moments);
    free(of->counts);
    free(of->centre);
    sphv_transform_free(&of->transform);
    sphv_lattice_table_free(&of->table);
}

static sphv_status run(route *of)
{
    // A field that is wrapped round the cube must not come within reach again.
    size_t size = sphv_transform_size(of->table.side + of->table.reach);
    size_t pairs = (of->fields + 1) / 2, kernels = (size_t)of->evaluation->layout.per_field;
    size_t blocks = (of->evaluation->particles->count + SPHV_BLOCK - 1) / SPHV_BLOCK;
    size_t backward = (of->fields / 2) * kernels + (of->fields % 2) * ((kernels + 1) / 2);
    of->steps = pairs + (pairs ? (kernels + 1) / 2 : 0) + backward + blocks;
    list_kernels(of);
    sphv_status status = sphv_transform_make(&of->transform, of->table.dimension, size);
    if (status == SPHV_OK && !reserve(of)) status = SPHV_RESOURCE_FAILURE;
    if (status == SPHV_OK) status = sum_classes(of);
    if (status == SPHV_OK) status = convolve(of);
    if (status == SPHV_OK) status = finish(of);
    return status;
}

sphv_status sphv_evaluate_convolution(const sphv_evaluation *evaluation, sphv_error *error)
{
    route of = {.evaluation = evaluation, .fields = evaluation->request->field_count};
    for (size_t f = 0; f < of.fields; f++)
        if (!isfinite(evaluation->spread[f]))
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "the values of field %zu lie too far apart; allowed: a range up to "
                             "1e308",
                             f + 1);
    sphv_status status = sphv_lattice_table_make(evaluation, &of.table, error);
    if (status != SPHV_OK) return status;
    status = run(&of);
    evaluation->out->tested += (double)of.table.octant;
    release(&of);
    if (status != SPHV_OK)
        return sphv_fail(error, status, "out of memory for sums by Fourier transform");
    return SPHV_OK;
}
