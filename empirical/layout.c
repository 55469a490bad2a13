#include "layout.h"

#include <gsl/gsl_math.h>
#include <gsl/gsl_qrng.h>
#include <gsl/gsl_sort.h>
#include <stdlib.h>

#include "internal.h"
#include "random.h"

/// Uniform or quasi-random positions of density 1/Δx on [−reach, 1 + reach), sorted.
static sphv_status scatter(sphv_cloud *cloud, double reach, sphv_error *error)
{
    const sphv_experiment *of = cloud->experiment;
    double length = 1 + 2 * reach;
    cloud->stored = (long)ceil(length / cloud->step);
    cloud->x = malloc((size_t)cloud->stored * sizeof *cloud->x);
    gsl_qrng *sobol = of->layout == SPHV_QUASI_RANDOM ? gsl_qrng_alloc(gsl_qrng_sobol, 1) : NULL;
    if (!cloud->x || (of->layout == SPHV_QUASI_RANDOM && !sobol)) {
        gsl_qrng_free(sobol);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    // Each realisation of a quasi-random layout is the sequence shifted by a random amount.
    double shift = sphv_uniform(of->seed, cloud->realisation, -1);
    for (long i = 0; i < cloud->stored; i++) {
        double u;
        if (sobol) {
            gsl_qrng_get(sobol, &u);
            u = fmod(u + shift, 1);
        } else {
            u = sphv_uniform(of->seed, cloud->realisation, i);
        }
        cloud->x[i] = -reach + length * u;
    }
    gsl_qrng_free(sobol);
    gsl_sort(cloud->x, 1, (size_t)cloud->stored);
    while (cloud->first < cloud->stored && cloud->x[cloud->first] < 0) cloud->first++;
    long end = cloud->first;
    while (end < cloud->stored && cloud->x[end] < 1) end++;
    cloud->particles = end - cloud->first;
    return SPHV_OK;
}

sphv_status sphv_cloud_make(sphv_cloud *cloud, const sphv_experiment *experiment, int realisation,
                            sphv_error *error)
{
    *cloud = (sphv_cloud){.experiment = experiment, .realisation = realisation};
    cloud->step = experiment->h * experiment->spacing.value;
    cloud->particles = (long)ceil(1 / cloud->step);
    if (experiment->layout == SPHV_LATTICE || experiment->layout == SPHV_PERTURBED) return SPHV_OK;
    // Two supports, for density volumes, and some particles more for the outermost volumes.
    double reach = 2 * experiment->profile->support * experiment->h + 64 * cloud->step;
    return scatter(cloud, reach, error);
}

void sphv_cloud_free(sphv_cloud *cloud)
{
    free(cloud->x);
    cloud->x = NULL;
}

void sphv_neighbourhood_free(sphv_neighbourhood *neighbourhood)
{
    free(neighbourhood->s);
    free(neighbourhood->volume);
    free(neighbourhood->centroid);
    free(neighbourhood->value);
    free(neighbourhood->slope);
    free(neighbourhood->bend);
    *neighbourhood = (sphv_neighbourhood){0};
}

static sphv_status reserve(sphv_neighbourhood *out, long count)
{
    double **const arrays[] = {&out->s,     &out->volume, &out->centroid,
                               &out->value, &out->slope,  &out->bend};
    if (count <= out->capacity) return SPHV_OK;
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        double *larger = realloc(*arrays[i], (size_t)count * sizeof *larger);
        if (!larger) return SPHV_RESOURCE_FAILURE;
        *arrays[i] = larger;
    }
    out->capacity = (int)count;
    return SPHV_OK;
}

/// A perturbed lattice is nearly sorted: insertion costs one comparison a particle.
static void sort_keeping_self(sphv_neighbourhood *out)
{
    for (int i = 1; i < out->count; i++) {
        double value = out->s[i];
        int j = i, own = i == out->self;
        for (; j > 0 && out->s[j - 1] > value; j--) {
            out->s[j] = out->s[j - 1];
            if (j - 1 == out->self) out->self = j;
        }
        out->s[j] = value;
        if (own) out->self = j;
    }
}

/// Positions, relative to particle `index`, of all that can lie within `radius` (units of h).
static sphv_status gather(const sphv_cloud *cloud, long index, double radius,
                          sphv_neighbourhood *out)
{
    const sphv_experiment *of = cloud->experiment;
    double spacing = of->spacing.value;
    if (cloud->x) {
        long self = cloud->first + index, low = self, high = self;
        double origin = cloud->x[self], reach = radius * of->h;
        while (low > 0 && cloud->x[low] > origin - reach) low--;
        while (high < cloud->stored - 1 && cloud->x[high] < origin + reach) high++;
        if (reserve(out, high - low + 1) != SPHV_OK) return SPHV_RESOURCE_FAILURE;
        out->count = (int)(high - low + 1);
        out->self = (int)(self - low);
        out->origin = origin;
        for (long i = low; i <= high; i++) out->s[i - low] = (cloud->x[i] - origin) / of->h;
        return SPHV_OK;
    }
    bool perturbed = of->layout == SPHV_PERTURBED && of->sigma > 0;
    long margin = 1 + (perturbed ? (long)ceil(2 * SPHV_NORMAL_MAX * of->sigma) : 0);
    long side = (long)ceil(radius / spacing) + margin;
    if (reserve(out, 2 * side + 1) != SPHV_OK) return SPHV_RESOURCE_FAILURE;
    out->count = (int)(2 * side + 1);
    out->self = (int)side;
    double own = perturbed ? of->sigma * sphv_normal(of->seed, cloud->realisation, index) : 0;
    out->origin = ((double)index + own) * cloud->step;
    for (long j = -side; j <= side; j++) {
        double shift =
            perturbed ? of->sigma * sphv_normal(of->seed, cloud->realisation, index + j) - own : 0;
        out->s[j + side] = j == 0 ? 0 : ((double)j + shift) * spacing;
    }
    if (perturbed) sort_keeping_self(out);
    return SPHV_OK;
}

/// Where the support ends. On an unperturbed lattice a particle can stand on the edge itself, where
/// W = 0 already; rounding of its distance must not decide that.
static double reach_of(const sphv_experiment *of)
{
    bool exact = of->layout == SPHV_LATTICE || (of->layout == SPHV_PERTURBED && of->sigma == 0);
    return of->profile->support * (exact ? 1 - 1e-12 : 1);
}

/// V_b = m/ρ_b with m/Δx = ρ_0: the sum over all particles within the support of b.
static void density_volumes(const sphv_experiment *of, sphv_neighbourhood *out)
{
    double support = reach_of(of);
    int low = 0, high = 0;
    for (int b = 0; b < out->count; b++) {
        double sum = 0;
        while (out->s[b] - out->s[low] >= support) low++;
        while (high < out->count && out->s[high] - out->s[b] < support) high++;
        for (int c = low; c < high; c++)
            sum += sphv_profile_derivative(of->profile, 0, fabs(out->s[c] - out->s[b])).value;
        out->volume[b] = 1 / sum;
    }
}

static void assign_volumes(const sphv_experiment *of, sphv_neighbourhood *out)
{
    for (int b = 0; b < out->count; b++) {
        double left = out->s[b ? b - 1 : b], right = out->s[b + 1 < out->count ? b + 1 : b];
        out->centroid[b] = 0.25 * (left + 2 * out->s[b] + right);
    }
    switch (of->volume) {
    case SPHV_VOLUME_LATTICE:
    case SPHV_VOLUME_UNIT:
    case SPHV_VOLUME_EQUAL: // of boxes only: refused by sphv_experiment_check
        for (int b = 0; b < out->count; b++) out->volume[b] = of->spacing.value;
        break;
    case SPHV_VOLUME_TESSELLATED:
        for (int b = 0; b < out->count; b++)
            out->volume[b] = 0.5 * (out->s[b + 1 < out->count ? b + 1 : b] - out->s[b ? b - 1 : b]);
        break;
    case SPHV_VOLUME_DENSITY:
        density_volumes(of, out);
        break;
    }
}

/// Drops the particles beyond the support.
static void trim(const sphv_experiment *of, sphv_neighbourhood *out)
{
    int kept = 0, self = 0;
    for (int b = 0; b < out->count; b++) {
        if (!(fabs(out->s[b]) < reach_of(of))) continue;
        if (b == out->self) self = kept;
        out->s[kept] = out->s[b];
        out->centroid[kept] = out->centroid[b];
        out->volume[kept++] = out->volume[b];
    }
    out->count = kept;
    out->self = self;
}

static void evaluate_kernel(const sphv_experiment *of, sphv_neighbourhood *out)
{
    for (int b = 0; b < out->count; b++) {
        sphv_result all[3];
        sphv_profile_values(of->profile, fabs(out->s[b]), all);
        out->value[b] = all[0].value;
        out->slope[b] = out->s[b] < 0 ? -all[1].value : out->s[b] > 0 ? all[1].value : 0;
        out->bend[b] = all[2].value;
    }
}

sphv_status sphv_cloud_neighbourhood(const sphv_cloud *cloud, long index, sphv_neighbourhood *out)
{
    const sphv_experiment *of = cloud->experiment;
    double support = of->profile->support;
    double radius = support * (of->volume == SPHV_VOLUME_DENSITY ? 2 : 1);
    // Tessellated volumes need one more particle at either end, however far it is.
    if (of->volume == SPHV_VOLUME_TESSELLATED) radius += 4 * of->spacing.value;
    sphv_status status = gather(cloud, index, radius, out);
    if (status != SPHV_OK) return status;
    assign_volumes(of, out);
    trim(of, out);
    evaluate_kernel(of, out);
    return SPHV_OK;
}
