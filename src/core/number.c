#include "sphverify/number.h"

#include <math.h>

#include "rational.h"

sphv_number sphv_number_from_double(double value)
{
    return (sphv_number){value, 0};
}

sphv_number sphv_number_from_ratio(long numerator, long denominator)
{
    mpq_t exact;
    mpq_init(exact);
    mpz_set_si(mpq_numref(exact), numerator);
    mpz_set_si(mpq_denref(exact), denominator);
    mpq_canonicalize(exact);
    sphv_number number = sphv_rational_number(exact);
    mpq_clear(exact);
    return number;
}

sphv_status sphv_number_parse(const char *text, sphv_number *out, sphv_error *error)
{
    mpq_t exact;
    mpq_init(exact);
    sphv_status status = sphv_rational_parse(text, exact, error);
    if (status == SPHV_OK) {
        *out = sphv_rational_number(exact);
        if (!isfinite(out->value) || (out->value == 0 && mpq_sgn(exact) != 0))
            status =
                sphv_fail(error, SPHV_INVALID_INPUT,
                          "'%s' is out of range; allowed: magnitudes from 1e-308 to 1e308", text);
    }
    mpq_clear(exact);
    return status;
}

/// knot − j·step, with the product split exactly by a fused multiply-add.
static double offset_from(sphv_number knot, sphv_number step, double j)
{
    double product = j * step.value;
    double product_error = fma(j, step.value, -product);
    return ((knot.value - product) - product_error) + (knot.residual - j * step.residual);
}

sphv_lattice_place sphv_number_place(sphv_number knot, sphv_number step)
{
    const double nearly_nothing = 0x1p-90 * knot.value;
    double j = floor(knot.value / step.value);
    double offset = offset_from(knot, step, j);
    if (offset < -nearly_nothing) {
        j -= 1;
        offset = offset_from(knot, step, j);
    } else if (offset_from(knot, step, j + 1) >= -nearly_nothing) {
        j += 1;
        offset = offset_from(knot, step, j);
    }
    sphv_lattice_place place = {0};
    place.on_lattice = fabs(offset) <= nearly_nothing;
    place.fraction = place.on_lattice ? 0 : fmin(offset / step.value, 1 - 0x1p-53);
    place.inside = (long)j - (place.on_lattice ? 1 : 0);
    if (place.inside < 0) place.inside = 0;
    return place;
}
