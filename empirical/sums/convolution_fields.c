/// The sums over fields of a convolution, by Fourier transforms.
#include <stdlib.h>
#include <string.h>

#include "../internal.h"
#include "convolution.h"

/// Place in the cube of lattice place or wrapped offset n of a cube with `base` places a side.
static size_t cube_index(const sphv_convolution *of, size_t n, size_t base, size_t shift)
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
static sphv_status transform_fields(sphv_convolution *of, size_t first, double *cube,
                                    double scale[2], double *norm)
{
    const sphv_request *request = of->evaluation->request;
    size_t count = of->evaluation->particles->count, side = of->table.side;
    double square = 0;
    memset(cube, 0, 2 * of->transform.points * sizeof *cube);
    for (size_t f = first; f < first + 2 && f < of->fields; f++) {
        double centre = of->centre[f];
        scale[f - first] = normalising(of->evaluation->spread[f]);
        for (size_t n = 0; n < count; n += side) {
            double *line = cube + 2 * cube_index(of, n, side, 0) + (f - first);
            for (size_t i = 0; i < side; i++) {
                double value = (request->fields[f][n + i] - centre) * scale[f - first];
                line[2 * i] = value;
                square += value * value;
            }
        }
    }
    *norm = 1.0001 * sqrt(square);
    return sphv_transform_forward(&of->transform, cube, side);
}

/// Real transforms of kernels first and, if there is one, first + 1, as real and imaginary part:
/// that of G(o) = K(−o) where the monomial is even, i times it where it is odd.
static sphv_status transform_kernels(sphv_convolution *of, size_t first, size_t count, double *cube,
                                     double scale[2], double *norm)
{
    const sphv_lattice_table *table = &of->table;
    double squares = 0;
    memset(cube, 0, 2 * of->transform.points * sizeof *cube);
    for (size_t s = 0; s < 2 && first + s < count; s++) {
        sphv_offset_function function = sphv_kernel_function(of, &of->field[first + s]);
        bool odd = function.monomial->degree % 2;
        double largest = 0;
        // i times a real number, and that times i again, or not: where it belongs, and its sign
        size_t part = (s + odd) % 2;
        double sign = odd && s ? -1 : 1;
        for (int pass = 0; pass < 2; pass++) {
            if (pass) scale[s] = normalising(largest);
            for (size_t n = 0; n < table->cells; n++) {
                long offset[SPHV_DIMENSIONS] = {0};
                size_t rest = n;
                for (int i = table->dimension - 1; i >= 0; i--, rest /= table->width)
                    offset[i] = (long)table->reach - (long)(rest % table->width);
                double value = sphv_offset_value(table, &function, offset);
                if (pass == 0) {
                    largest = fmax(largest, fabs(value));
                } else {
                    size_t at = cube_index(of, n, table->width, of->transform.size - table->reach);
                    value *= scale[s];
                    cube[2 * at + part] += sign * value;
                    squares += value * value;
                }
            }
        }
    }
    *norm = 1.0001 * sqrt(2 * squares); // of sums of two in one part as well
    return sphv_transform_forward(&of->transform, cube, of->transform.size);
}

/// Ẑ = Â·Ĝ of one kernel of a pair, or of both as Ĝ_0 + iĜ_1.
static void multiply(const sphv_convolution *of, const double *field, const double *pair,
                     const bool odd[2], int which, double *out)
{
#pragma omp parallel for schedule(static) if (of->transform.points > SPHV_PARALLEL_MIN)
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

/// Keeps a part of a cube as the sums of one field and kernel. The scales are undone one by one:
/// their product may overflow.
static void keep(sphv_convolution *of, const double *cube, int part, size_t field, size_t kernel,
                 double field_scale, double kernel_scale)
{
    double *out = of->sums[field * (size_t)of->evaluation->layout.per_field + kernel];
    double factor = 1 / (double)of->transform.points / kernel_scale;
    size_t side = of->table.side;
#pragma omp parallel for schedule(static) if (of->transform.points > SPHV_PARALLEL_MIN)
    for (size_t n = 0; n < of->evaluation->particles->count; n += side) {
        const double *line = cube + 2 * cube_index(of, n, side, 0) + part;
        for (size_t i = 0; i < side; i++) out[n + i] = line[2 * i] * factor / field_scale;
    }
}

/// \param norms of the scaled field and kernel
static void note_error(sphv_convolution *of, size_t field, const sphv_sum_kernel *kernel,
                       double norms, double field_scale, double kernel_scale)
{
    // Three transforms, and 8u for the product, the divisions and the parts
    double relative = 1.01 * (3 * sphv_transform_error(&of->transform) + 8 * SPHV_U);
    double spread = of->evaluation->spread[field] * field_scale;
    double error = relative * norms / kernel_scale / sphv_kernel_reach(of, kernel);
    if (spread > 0) // else all is 0
        of->transform_error[kernel->k] = fmax(of->transform_error[kernel->k], error / spread);
}

/// Sums of one or two fields with one or two kernels.
static sphv_status convolve_pair(sphv_convolution *of, size_t field, const double *fields,
                                 const double field_scale[2], size_t first, const double *kernels,
                                 const double kernel_scale[2], double norms, double *work)
{
    size_t count = (size_t)of->evaluation->layout.per_field;
    size_t pair = first + 1 < count ? 2 : 1;
    bool odd[2] = {sphv_kernel_monomial(of, &of->field[first])->degree % 2,
                   pair == 2 && sphv_kernel_monomial(of, &of->field[first + 1])->degree % 2};
    bool single = field + 1 == of->fields;
    sphv_status status = SPHV_OK;
    for (size_t s = 0; s < (single ? 1 : pair) && status == SPHV_OK; s++) {
        multiply(of, fields, kernels, odd, single ? -1 : (int)s, work);
        status = sphv_transform_backward(&of->transform, work, of->table.side);
        for (size_t part = 0; part < (single ? pair : 2) && status == SPHV_OK; part++) {
            size_t f = field + (single ? 0 : part), kernel = first + (single ? part : s);
            double scale = field_scale[f - field], kernels_scale = kernel_scale[kernel - first];
            keep(of, work, (int)part, f, kernel, scale, kernels_scale);
            note_error(of, f, &of->field[kernel], norms, scale, kernels_scale);
        }
        sphv_evaluation_advance(of->evaluation, &of->done, of->steps);
    }
    return status;
}

sphv_status sphv_convolve_fields(sphv_convolution *of)
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
        sphv_evaluation_advance(of->evaluation, &of->done, of->steps);
    }
    for (size_t s = 0; pairs > 0 && s < kernels && status == SPHV_OK; s += 2) {
        double kernel_scale[2] = {1, 1}, kernel_norm = 0;
        status = transform_kernels(of, s, kernels, kernel, kernel_scale, &kernel_norm);
        sphv_evaluation_advance(of->evaluation, &of->done, of->steps);
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
