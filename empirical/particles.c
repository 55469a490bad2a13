#include <gsl/gsl_math.h>
#include <gsl/gsl_qrng.h>
#include <gsl/gsl_sort.h>
#include <stdlib.h>

#include "internal.h"
#include "random.h"
#include "sphverify/estimate.h"

void sphv_particles_free(sphv_particles *particles)
{
    for (int i = 0; i < SPHV_DIMENSIONS; i++) free(particles->x[i]);
    free(particles->volume);
    *particles = (sphv_particles){0};
}

static sphv_status reserve(sphv_particles *out, sphv_error *error)
{
    bool complete = (out->volume = malloc(out->count * sizeof(double))) != NULL;
    for (int i = 0; i < out->dimension; i++)
        complete = (out->x[i] = malloc(out->count * sizeof(double))) != NULL && complete;
    if (complete) return SPHV_OK;
    return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory for %zu particles", out->count);
}

/// Folds the line onto [0, 1], a mirror at every whole number: for any distance at once.
static double reflect(double x)
{
    double within = fmod(fabs(x), 2);
    return within > 1 ? 2 - within : within;
}

/// Folds the line onto [0, 1), which is a circle.
static double wrap(double x)
{
    double within = x - floor(x);
    return within < 1 ? within : 0;
}

/// How far particle `index` is moved along a coordinate, in Δx.
static double displacement(const sphv_box *box, int coordinate, long index)
{
    if (box->layout != SPHV_PERTURBED || box->amplitude == 0) return 0;
    double random = box->jitter == SPHV_JITTER_NORMAL
                        ? sphv_normal(box->seed, coordinate, index)
                        : 2 * sphv_uniform(box->seed, coordinate, index) - 1;
    return box->amplitude * random;
}

/// Lattices, perturbed or not; the first coordinate runs slowest.
static void place_lattice(const sphv_box *box, sphv_particles *out)
{
    const bool vertex = box->placement == SPHV_PLACEMENT_VERTEX;
    const double intervals = (double)box->side - (vertex ? 1 : 0), offset = vertex ? 0 : 0.5;
#pragma omp parallel for schedule(static)
    for (size_t n = 0; n < out->count; n++) {
        size_t rest = n;
        for (int i = out->dimension - 1; i >= 0; i--, rest /= box->side) {
            double step = (double)(rest % box->side) + offset;
            double x = (step + displacement(box, i, (long)n)) / intervals;
            out->x[i][n] = box->periodic ? wrap(x) : box->reflected ? reflect(x) : x;
        }
    }
}

static void place_random(const sphv_box *box, sphv_particles *out)
{
#pragma omp parallel for schedule(static)
    for (size_t n = 0; n < out->count; n++)
        for (int i = 0; i < out->dimension; i++) out->x[i][n] = sphv_uniform(box->seed, i, (long)n);
}

/// Sobol's sequence, shifted round the box by a random amount in each coordinate.
static sphv_status place_sobol(const sphv_box *box, sphv_particles *out, sphv_error *error)
{
    gsl_qrng *sobol = gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)out->dimension);
    if (!sobol) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    for (size_t n = 0; n < out->count; n++) {
        double point[SPHV_DIMENSIONS];
        gsl_qrng_get(sobol, point);
        for (int i = 0; i < out->dimension; i++)
            out->x[i][n] = wrap(point[i] + sphv_uniform(box->seed, i, -1));
    }
    gsl_qrng_free(sobol);
    return SPHV_OK;
}

static void fill_volumes(sphv_particles *out, double volume)
{
    for (size_t n = 0; n < out->count; n++) out->volume[n] = volume;
}

/// Cells between the midpoints of neighbours on the line. Those at the ends reach to the side of
/// the box, or to their particle where it lies outside; in a periodic box they share what is left.
static sphv_status tessellate(sphv_particles *out, sphv_error *error)
{
    const double *x = out->x[0];
    size_t last = out->count - 1, *order = malloc(out->count * sizeof *order);
    if (!order) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    gsl_sort_index(order, x, 1, out->count);
    double seam = 0.5 * (x[order[0]] + x[order[last]] - 1);
    double start = out->periodic ? seam : fmin(0, x[order[0]]);
    double end = out->periodic ? seam + 1 : fmax(1, x[order[last]]);
    for (size_t n = 0; n <= last; n++) {
        double from = n ? 0.5 * (x[order[n - 1]] + x[order[n]]) : start;
        double to = n < last ? 0.5 * (x[order[n]] + x[order[n + 1]]) : end;
        out->volume[order[n]] = to - from;
    }
    free(order);
    return SPHV_OK;
}

/// V_b = m/ρ_b with ρ_b = Σ_c m W(x_b − x_c): the standard estimate of the field 1 with unit
/// volumes is the number density ρ/m.
static sphv_status weigh_by_density(const sphv_profile *profile, double h, sphv_particles *out,
                                    sphv_error *error)
{
    if (!profile || !(h > 0 && isfinite(h)))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "volumes by density without a kernel and a positive h; allowed: both, or "
                         "another volume rule");
    double *ones = malloc(out->count * sizeof *ones);
    if (!ones) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    for (size_t n = 0; n < out->count; n++) ones[n] = 1;
    fill_volumes(out, 1);
    const sphv_method method = SPHV_SPH;
    const double *const fields[] = {ones};
    sphv_request request = {.profile = profile,
                            .h = h,
                            .method_count = 1,
                            .methods = &method,
                            .field_count = 1,
                            .fields = fields};
    sphv_estimates estimates = {0};
    sphv_status status = sphv_estimate_particles(out, &request, NULL, NULL, &estimates, error);
    if (status == SPHV_OK) {
        // Alone within its support a particle has a fault, but its density is known.
        double alone = sphv_profile_derivative(profile, 0, 0).value / pow(h, out->dimension);
        for (size_t n = 0; n < out->count && status == SPHV_OK; n++) {
            double density =
                estimates.neighbours[n] > 1 ? estimates.methods[0].estimate[0][n] : alone;
            out->volume[n] = 1 / density;
            if (!(density > 0 && isfinite(out->volume[n]) && out->volume[n] > 0))
                status = sphv_fail(error, SPHV_INVALID_INPUT,
                                   "density %g at particle %zu gives no volume; allowed: a kernel "
                                   "and h whose sum is positive, or another volume rule",
                                   density, n);
        }
        sphv_estimates_free(&estimates);
    }
    free(ones);
    return status;
}

static sphv_status weigh(const sphv_box *box, const sphv_profile *profile, double h,
                         sphv_particles *out, sphv_error *error)
{
    switch (box->volume) {
    case SPHV_VOLUME_LATTICE:
        fill_volumes(out, gsl_pow_int(out->spacing, out->dimension));
        break;
    case SPHV_VOLUME_EQUAL:
        fill_volumes(out, 1 / (double)out->count);
        break;
    case SPHV_VOLUME_UNIT:
        fill_volumes(out, 1);
        break;
    case SPHV_VOLUME_TESSELLATED:
        return tessellate(out, error);
    case SPHV_VOLUME_DENSITY:
        return weigh_by_density(profile, h, out, error);
    }
    return SPHV_OK;
}

sphv_status sphv_particles_make(const sphv_box *box, const sphv_profile *profile, double h,
                                sphv_particles *out, sphv_error *error)
{
    *out = (sphv_particles){0};
    sphv_status status = sphv_box_check(box, error);
    if (status != SPHV_OK) return status;
    if (profile && profile->dimension != box->dimension)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "a kernel of %d dimensions in a box of %d; allowed: the same",
                         profile->dimension, box->dimension);
    bool lattice = box->layout == SPHV_LATTICE || box->layout == SPHV_PERTURBED;
    out->dimension = box->dimension;
    out->spacing = sphv_box_spacing(box);
    out->periodic = box->periodic;
    if (lattice && box->amplitude == 0) out->lattice_side = box->side;
    out->count = 1;
    for (int i = 0; i < box->dimension; i++) out->count *= box->side;
    status = reserve(out, error);
    if (status == SPHV_OK && lattice) place_lattice(box, out);
    if (status == SPHV_OK && box->layout == SPHV_RANDOM) place_random(box, out);
    if (status == SPHV_OK && box->layout == SPHV_QUASI_RANDOM)
        status = place_sobol(box, out, error);
    if (status == SPHV_OK) status = weigh(box, profile, h, out, error);
    if (status != SPHV_OK) sphv_particles_free(out);
    return status;
}
