#include "sphverify/box.h"

#include <math.h>

const sphv_name_row sphv_placements[] = {
    {"vertex", "x = i/(side - 1): particles on the edges too"},
    {"cell", "x = (i + 1/2)/side: particles in the middle of cells"},
    {NULL, NULL},
};

const sphv_name_row sphv_jitters[] = {
    {"normal", "of standard deviation amplitude times the spacing"},
    {"uniform", "even between plus and minus amplitude times the spacing"},
    {NULL, NULL},
};

static bool on_lattice(const sphv_box *box)
{
    return box->layout == SPHV_LATTICE || box->layout == SPHV_PERTURBED;
}

double sphv_box_spacing(const sphv_box *box)
{
    double side = (double)box->side;
    return on_lattice(box) && box->placement == SPHV_PLACEMENT_VERTEX ? 1 / (side - 1) : 1 / side;
}

sphv_status sphv_box_check(const sphv_box *box, sphv_error *error)
{
    if (box->dimension < 1 || box->dimension > SPHV_DIMENSIONS)
        return sphv_fail(error, SPHV_INVALID_INPUT, "a box of %d dimensions; allowed: 1 to %d",
                         box->dimension, SPHV_DIMENSIONS);
    bool vertex = on_lattice(box) && box->placement == SPHV_PLACEMENT_VERTEX;
    if (box->side < (vertex ? 2 : 1))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%zu particle%s along a side; allowed: at least %d%s", box->side,
                         box->side == 1 ? "" : "s", vertex ? 2 : 1,
                         vertex ? " with placement vertex" : "");
    // In doubles, where nothing overflows; the limit is far below 2^53.
    if (!(pow((double)box->side, box->dimension) <= SPHV_BOX_PARTICLES_MAX))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%zu particles along a side are too many in %d dimensions; allowed: %g in "
                         "all",
                         box->side, box->dimension, SPHV_BOX_PARTICLES_MAX);
    if (box->periodic && vertex)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "placement 'vertex' in a periodic box, whose opposite sides are one; "
                         "allowed: placement cell");
    if (!(box->amplitude >= 0 && box->amplitude <= SPHV_SIGMA_MAX))
        return sphv_fail(error, SPHV_INVALID_INPUT, "amplitude is %g; allowed: 0 to %g",
                         box->amplitude, SPHV_SIGMA_MAX);
    if (box->amplitude > 0 && box->layout != SPHV_PERTURBED)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "amplitude %g with layout '%s'; allowed: amplitude with layout perturbed",
                         box->amplitude, sphv_layouts[box->layout].name);
    if (box->periodic && box->reflected)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "reflected particles in a periodic box, which has no sides; allowed: one "
                         "of both");
    if (box->volume == SPHV_VOLUME_TESSELLATED && box->dimension != 1)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "volume 'tessellated' in %d dimensions; allowed: 1, or volume lattice, "
                         "equal, density or unit",
                         box->dimension);
    return SPHV_OK;
}
