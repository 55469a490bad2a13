#include <gsl/gsl_math.h>
#include <gsl/gsl_sf_gamma.h>

#include "internal.h"

/// −[s^power Ŵ′]^(order) at κ− from the Taylor series there (the bracket of eq. 13).
static double power_jump(const sphv_knot *knot, int power, int order)
{
    double sum = 0;
    for (int i = 0; i <= order && i + 1 < knot->terms; i++) {
        int j = order - i;
        if (j > power) continue;
        sum -= (i + 1) * knot->jump[i + 1] * gsl_sf_choose((unsigned)power, (unsigned)j) *
               gsl_pow_int(knot->position.value, power - j);
    }
    return sum * gsl_sf_fact((unsigned)order);
}

/// The Taylor term A^(2t+1) of the Euler–Maclaurin term p at the edge (eqs. 13–16): t = 0 is A′,
/// t = 1 is A‴. The sign is that of the mended eq. 11.
static double edge_term(const sphv_knot *edge, double K, double spacing, int p, int t)
{
    double taylor = gsl_pow_int(-K * K, t) / gsl_sf_fact((unsigned)(2 * t + 1));
    return 2 * gsl_pow_int(spacing, p) * sphv_periodic_bernoulli(p, 0.5, 0).value * taylor *
           power_jump(edge, 2 * t + 1, p - 1);
}

static double smoothing_term(const sphv_profile *profile, double K, int t)
{
    return gsl_pow_int(-K * K, t) / gsl_sf_fact((unsigned)(2 * t)) *
           profile->slope_moment[2 * t].value;
}

sphv_status sphv_predict_paper(const sphv_profile *profile, double h, sphv_number spacing,
                               sphv_prediction *out, sphv_error *error)
{
    double K = 2 * M_PI * h;
    sphv_lattice_place place = sphv_number_place(profile->support_exact, spacing);
    if (fabs(place.fraction - 0.5) > 1e-9) {
        double near = 2 * profile->support / (2 * (double)place.inside + 1);
        return sphv_fail(error, SPHV_NO_CLOSED_FORM,
                         "the paper's form has no value at spacing %.10g; allowed: spacings "
                         "2*support/(2n+1) such as %.10g, or the exact form",
                         spacing.value, near);
    }
    static const sphv_knot nothing = {{0, 0}, 0, 0, NULL}; // Ŵ ended before κ: no jump, no term
    const sphv_knot *edge = sphv_profile_edge(profile);
    if (!edge) edge = &nothing;
    // First even order at which the edge contributes: β + 2, or β + 1 for odd β.
    int first = edge->order < 2 ? 2 : edge->order + edge->order % 2;
    double discretisation = 0, neglected = 0;
    for (int k = 0; k < 4; k++) {
        int p = first + 2 * k;
        for (int t = 0; t < 4; t++) {
            double part = edge_term(edge, K, spacing.value, p, t);
            if (k < 2 && t < 2)
                discretisation += part;
            else
                neglected += fabs(part);
        }
    }
    double smoothing =
        profile->slope_excess + smoothing_term(profile, K, 1) + smoothing_term(profile, K, 2);
    double smoothing_neglected =
        fabs(smoothing_term(profile, K, 3)) + fabs(smoothing_term(profile, K, 4));
    out->smoothing = (sphv_result){smoothing, smoothing_neglected + 64 * SPHV_U * fabs(smoothing)};
    out->discretisation =
        (sphv_result){discretisation, neglected + 256 * SPHV_U * fabs(discretisation)};
    out->rigour = SPHV_RIGOUR_ASYMPTOTIC;
    out->terms = 2;
    out->modes = 0;
    return SPHV_OK;
}
