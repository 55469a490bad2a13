#include "radial.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_sf_bessel.h>

/// Beyond this many units of q the tail of a truncated family is below rounding.
static const double tail_length = 9;
enum { INTERVALS = 200 };

struct integrand {
    const sphv_profile *profile;
    bool beyond; ///< the closed form itself, which the profile cuts off at κ
    sphv_radial_weight weight;
    double argument;
};

double sphv_weight_one(double q, double unused)
{
    (void)q;
    (void)unused;
    return 1;
}

double sphv_weight_power(double q, double exponent)
{
    return pow(q, exponent);
}

static double wave_1(double q, double wavenumber)
{
    return cos(wavenumber * q);
}

static double wave_2(double q, double wavenumber)
{
    return gsl_sf_bessel_J0(wavenumber * q);
}

static double wave_3(double q, double wavenumber)
{
    double x = wavenumber * q;
    return fabs(x) < 1e-4 ? 1 - x * x / 6 : sin(x) / x;
}

sphv_radial_weight sphv_weight_wave(int dimension)
{
    static const sphv_radial_weight waves[] = {wave_1, wave_2, wave_3};
    return waves[dimension - 1];
}

/// Σ_{j≥1} (−x²/4)^j/(j! (d/2)_j), which is cos x − 1, J0(x) − 1 and sin(x)/x − 1.
static double less_one(double x, int dimension)
{
    double term = 1, sum = 0;
    for (int j = 1; j < 30; j++) {
        term *= -0.25 * x * x / (j * (0.5 * dimension + j - 1));
        sum += term;
        if (fabs(term) < 1e-18 * fabs(sum)) break;
    }
    return sum;
}

static double less_one_1(double q, double wavenumber)
{
    return less_one(wavenumber * q, 1);
}

static double less_one_2(double q, double wavenumber)
{
    return less_one(wavenumber * q, 2);
}

static double less_one_3(double q, double wavenumber)
{
    return less_one(wavenumber * q, 3);
}

sphv_radial_weight sphv_weight_wave_less_one(int dimension)
{
    static const sphv_radial_weight waves[] = {less_one_1, less_one_2, less_one_3};
    return waves[dimension - 1];
}

static double evaluate(double q, void *context)
{
    const struct integrand *of = context;
    int d = of->profile->dimension;
    double w;
    if (of->beyond)
        sphv_form_jet(of->profile->form, q, 0, &w);
    else
        w = sphv_profile_derivative(of->profile, 0, q).value;
    double area = d == 1 ? 2 : d == 2 ? 2 * M_PI * q : 4 * M_PI * q * q;
    return area * w * of->weight(q, of->argument);
}

static double magnitude(double q, void *context)
{
    return fabs(evaluate(q, context));
}

static void add_interval(struct integrand *of, double from, double to,
                         gsl_integration_workspace *space, sphv_result *sum)
{
    gsl_function f = {evaluate, of}, size = {magnitude, of};
    double value = 0, error = INFINITY, whole = 0, unused;
    size_t evaluations;
    gsl_integration_qng(&size, from, to, 1e-3, 1e-2, &whole, &unused, &evaluations);
    // 50 ε is the least that GSL accepts; a cancelling integral is measured against ∫|f|.
    const double least = 52 * GSL_DBL_EPSILON;
    gsl_integration_qag(&f, from, to, least * fabs(whole), least, INTERVALS, GSL_INTEG_GAUSS31,
                        space, &value, &error);
    sum->value += value;
    // Evaluation adds a few ε of ∫|f| to GSL's estimate.
    sum->bound += error + 16 * GSL_DBL_EPSILON * fabs(whole);
}

sphv_result sphv_radial_integral(const sphv_profile *profile, bool whole, sphv_radial_weight weight,
                                 double argument)
{
    struct integrand of = {profile, false, weight, argument};
    sphv_result sum = {0, 0};
    gsl_integration_workspace *space = gsl_integration_workspace_alloc(INTERVALS);
    if (!space) return (sphv_result){NAN, INFINITY};
    for (int i = 0; i < profile->piece_count; i++)
        add_interval(&of, profile->pieces[i].inner, profile->pieces[i].outer, space, &sum);
    if (whole) {
        of.beyond = true;
        double half = profile->support + 0.5 * tail_length;
        add_interval(&of, profile->support, half, space, &sum);
        add_interval(&of, half, half + 0.5 * tail_length, space, &sum);
    }
    gsl_integration_workspace_free(space);
    return sum;
}
