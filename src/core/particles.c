#include "sphverify/particles.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const sphv_method_row sphv_methods[] = {
    {"sph", -1, -1, {0, 0, 0}, false, false, "Quinlan, Basa and Lastiwka 2006, eq. 1"},
    {"shepard", 0, 0, {1, 1, 1}, true, false, "Shepard 1968; eq. 27 differentiated"},
    {"bonet-lok", 1, 0, {1, 2, 3}, true, false, "Bonet and Lok 1999; eqs. 27-28"},
    {"rkpm", 1, 1, {2, 3, 4}, true, false, "Liu, Jun and Zhang 1995; eq. 26"},
    {"rkpm-0", 0, 0, {1, 1, 1}, true, false, "Liu, Jun and Zhang 1995, order 0"},
    {"rkpm-2", 2, 2, {3, 6, 10}, true, false, "Liu, Jun and Zhang 1995, order 2"},
    {"sph-difference", 0, -1, {0, 0, 0}, false, false, "Monaghan 1992"},
    {"cspm", 1, 0, {1, 2, 3}, true, false, "Chen, Beraun and Jih 1999"},
    {"fpm", 1, 1, {2, 3, 4}, true, false, "Liu and Liu 2006"},
    {"msph", 2, 2, {3, 6, 10}, true, true, "Zhang and Batra 2004"},
    {NULL, 0, 0, {0, 0, 0}, false, false, NULL},
};

size_t sphv_method_quantities(sphv_method method, int dimension)
{
    size_t gradient = (size_t)dimension + 1;
    return sphv_methods[method].second ? gradient * (gradient + 1) / 2 : gradient;
}

size_t sphv_method_least(sphv_method method, int dimension)
{
    size_t count = 1; // binomial coefficient of d + consistency over d
    for (int i = 1; i <= sphv_methods[method].consistency; i++)
        count = count * (size_t)(dimension + i) / (size_t)i;
    return count;
}

const sphv_name_row sphv_layouts[] = {
    {"lattice", "evenly spaced"},
    {"perturbed", "lattice with normal perturbations of standard deviation sigma"},
    {"quasi-random", "Sobol sequence"},
    {"random", "independent and uniform"},
    {NULL, NULL},
};

const sphv_name_row sphv_volumes[] = {
    {"lattice", "the mean spacing"},
    {"tessellated", "half the distance between both neighbours"},
    {"density", "mass over the summed density"},
    {"unit", "one"},
    {"equal", "volume of the box over the number of particles"},
    {NULL, NULL},
};

static const char *method_name(int i)
{
    return sphv_methods[i].name;
}

static const char *layout_name(int i)
{
    return sphv_layouts[i].name;
}

static const char *volume_name(int i)
{
    return sphv_volumes[i].name;
}

static sphv_status parse(const char *(*name_at)(int i), const char *kind, const char *name,
                         int *out, sphv_error *error)
{
    char allowed[256] = "";
    size_t used = 0;
    for (int i = 0; name_at(i); i++) {
        if (strcmp(name_at(i), name) == 0) {
            *out = i;
            return SPHV_OK;
        }
        used += (size_t)snprintf(allowed + used, sizeof allowed - used, "%s%s", i ? ", " : "",
                                 name_at(i));
    }
    return sphv_fail(error, SPHV_INVALID_INPUT, "unknown %s '%.60s'; allowed: %s", kind, name,
                     allowed);
}

sphv_status sphv_method_parse(const char *name, sphv_method *out, sphv_error *error)
{
    int index = 0;
    sphv_status status = parse(method_name, "method", name, &index, error);
    if (status == SPHV_OK) *out = (sphv_method)index;
    return status;
}

sphv_status sphv_layout_parse(const char *name, sphv_layout *out, sphv_error *error)
{
    int index = 0;
    sphv_status status = parse(layout_name, "layout", name, &index, error);
    if (status == SPHV_OK) *out = (sphv_layout)index;
    return status;
}

sphv_status sphv_volume_parse(const char *name, sphv_volume *out, sphv_error *error)
{
    int index = 0;
    sphv_status status = parse(volume_name, "volume rule", name, &index, error);
    if (status == SPHV_OK) *out = (sphv_volume)index;
    return status;
}

sphv_status sphv_experiment_check(const sphv_experiment *experiment, sphv_error *error)
{
    if (experiment->profile->dimension != 1)
        return sphv_fail(error, SPHV_NO_CLOSED_FORM, "no experiment in %d dimensions; allowed: 1",
                         experiment->profile->dimension);
    if (!(experiment->h > 0 && isfinite(experiment->h)))
        return sphv_fail(error, SPHV_INVALID_INPUT, "h is %g; allowed: a positive number",
                         experiment->h);
    if (!(experiment->spacing.value > 0 && isfinite(experiment->spacing.value)))
        return sphv_fail(error, SPHV_INVALID_INPUT, "spacing is %g; allowed: a positive number",
                         experiment->spacing.value);
    if ((experiment->layout == SPHV_RANDOM || experiment->layout == SPHV_QUASI_RANDOM) &&
        experiment->h * experiment->spacing.value < 1 / SPHV_SCATTERED_MAX)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%.3g particles a wavelength are too many to keep for layout '%s'; "
                         "allowed: up to %g",
                         1 / (experiment->h * experiment->spacing.value),
                         sphv_layouts[experiment->layout].name, SPHV_SCATTERED_MAX);
    if (!(experiment->sigma >= 0 && experiment->sigma <= SPHV_SIGMA_MAX))
        return sphv_fail(error, SPHV_INVALID_INPUT, "sigma is %g; allowed: 0 to %g",
                         experiment->sigma, SPHV_SIGMA_MAX);
    if (experiment->sigma > 0 && experiment->layout != SPHV_PERTURBED)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "sigma %g with layout '%s'; allowed: sigma with layout perturbed",
                         experiment->sigma, sphv_layouts[experiment->layout].name);
    if (experiment->volume == SPHV_VOLUME_UNIT && !sphv_methods[experiment->method].scale_free)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "volume 'unit' with method '%s'; allowed: volume lattice, tessellated or "
                         "density, or a normalised method",
                         sphv_methods[experiment->method].name);
    if (experiment->volume == SPHV_VOLUME_EQUAL)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "volume 'equal' without a box: an endless line has no volume to share; "
                         "allowed: lattice, tessellated, density, unit");
    if (!(experiment->width > 0) || experiment->realisations_min < 2 ||
        experiment->realisations_max < experiment->realisations_min)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "width %g with %d to %d realisations; allowed: a positive width, at least "
                         "2 realisations",
                         experiment->width, experiment->realisations_min,
                         experiment->realisations_max);
    return SPHV_OK;
}
