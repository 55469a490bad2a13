#include <gsl/gsl_math.h>
#include <stdlib.h>
#include <string.h>

#include "boundary_jitter.h"

// A particle and its neighbours, and of each what all methods need at the places that their
// expectations are made of: its own, and those displaced by a node of a rule. A particle displaced
// by −δ sees a neighbour where it would be displaced by δ, so the same places serve both.

const sphv_displacement *sphv_jitter_at(const sphv_jitter_cloud *cloud, double x)
{
    double near = 1e-6 * cloud->dx;
    if (!cloud->box->reflected) return &cloud->free;
    return fabs(x) < near ? &cloud->low : fabs(1 - x) < near ? &cloud->high : &cloud->free;
}

sphv_status sphv_jitter_cloud_make(sphv_jitter_cloud *cloud, size_t neighbours, sphv_error *error)
{
    cloud->neighbour = malloc(neighbours * sizeof *cloud->neighbour);
    cloud->slots = malloc(neighbours * SPHV_JITTER_SLOTS * sizeof *cloud->slots);
    cloud->count = 0;
    return cloud->neighbour && cloud->slots
               ? SPHV_OK
               : sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for a box's theory");
}

void sphv_jitter_cloud_free(sphv_jitter_cloud *cloud)
{
    free(cloud->neighbour);
    free(cloud->slots);
    cloud->neighbour = NULL;
    cloud->slots = NULL;
}

sphv_jitter_neighbour *sphv_jitter_next(sphv_jitter_cloud *cloud, double weight)
{
    sphv_jitter_neighbour *b = &cloud->neighbour[cloud->count];
    sphv_jitter_slot *slot = cloud->slots + cloud->count * SPHV_JITTER_SLOTS;
    *b = (sphv_jitter_neighbour){.weight = weight, .slot = slot};
    int slots = 1 + 6 * cloud->d + 2 * cloud->d * (cloud->d - 1);
    for (int i = 0; i < slots; i++) slot[i].known = slot[i].known_value = false;
    return b;
}

/// p_k(|s|) and the monomials of s.
static void take_basis(const sphv_jitter_cloud *cloud, const double *s, sphv_jitter_slot *out)
{
    double square = 0, power[SPHV_DIMENSIONS][SPHV_SHAPE_DEGREE + 2];
    for (int i = 0; i < cloud->d; i++) square += s[i] * s[i];
    double q = sqrt(square);
    out->known = true;
    out->inside = q < cloud->profile->support;
    if (!out->inside) return;
    sphv_radial_functions(cloud->profile, q, out->p);
    if (q > 0) out->p[2] /= square;
    for (int i = 0; i < SPHV_DIMENSIONS; i++) {
        power[i][0] = 1;
        for (int n = 1; n < SPHV_SHAPE_DEGREE + 2; n++)
            power[i][n] = i < cloud->d ? power[i][n - 1] * s[i] : 0;
    }
    const sphv_monomial *table = sphv_monomials(cloud->d);
    for (size_t m = 0; m < cloud->monomials; m++)
        out->monomial[m] =
            power[0][table[m].power[0]] * power[1][table[m].power[1]] * power[2][table[m].power[2]];
}

/// Which slot a displacement belongs to; −1: none.
static int slot_of(const sphv_jitter_cloud *cloud, sphv_jitter_move by)
{
    double q = cloud->free.at[2], along = fabs(by.along);
    if (by.across != 0) {
        if (along != q || fabs(by.across) != q || by.across_coordinate > by.coordinate) return -1;
        int pair = by.coordinate * (by.coordinate - 1) / 2 + by.across_coordinate;
        return 1 + 6 * cloud->d + 4 * pair + 2 * (by.along > 0) + (by.across > 0);
    }
    if (along == 0) return 0;
    int kind = along == q ? 0 : along == cloud->low.at[2] ? 1 : along == 2 * q ? 2 : -1;
    return kind < 0 ? -1 : 1 + 6 * by.coordinate + 2 * kind + (by.along > 0);
}

const sphv_jitter_slot *sphv_jitter_look(const sphv_jitter_cloud *cloud,
                                         const sphv_jitter_neighbour *b, sphv_jitter_move by,
                                         bool value, sphv_jitter_slot *scratch)
{
    int number = slot_of(cloud, by);
    sphv_jitter_slot *slot = number < 0 ? scratch : &b->slot[number];
    double place[SPHV_DIMENSIONS], dx = cloud->dx;
    if (number < 0) slot->known = slot->known_value = false;
    if (!slot->known) {
        memcpy(place, b->s, sizeof place);
        if (by.across != 0) place[by.across_coordinate] += by.across * cloud->ds;
        place[by.coordinate] += by.along * cloud->ds;
        take_basis(cloud, place, slot);
    }
    if (value && slot->inside && !slot->known_value) {
        memcpy(place, b->x, sizeof place);
        if (by.across != 0) place[by.across_coordinate] += by.across * dx;
        place[by.coordinate] += by.along * dx;
        slot->value = sphv_field_derivative(cloud->field, (int[SPHV_DIMENSIONS]){0}, place);
        slot->known_value = true;
    }
    return slot;
}

void sphv_jitter_self(const sphv_jitter_cloud *cloud, sphv_jitter_slot *out)
{
    take_basis(cloud, (double[SPHV_DIMENSIONS]){0}, out);
}
