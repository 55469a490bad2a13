#include "families.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_sf_gamma.h>
#include <string.h>

#include "sphverify/kernel.h"

/// e^{−q²}: y′ = −2qy gives (n+1) y_{n+1} = −2 (q y_n + y_{n−1}).
static void gaussian_jet(const sphv_form *form, double q, int order, double *jet)
{
    (void)form;
    jet[0] = exp(-q * q);
    for (int n = 0; n < order; n++)
        jet[n + 1] = -2 * (q * jet[n] + (n > 0 ? jet[n - 1] : 0)) / (n + 1);
}

/// Cramér's inequality: |d^n e^{−s²}/ds^n| ≤ 1.0865 √(2^n n!) e^{−s²/2}.
static double gaussian_bound(const sphv_form *form, int n)
{
    (void)form;
    return n < 0 ? 0 : 1.0865 * exp(0.5 * (n * M_LN2 - gsl_sf_lnfact((unsigned)n)));
}

/// Multiplies a jet about q by (constant + square·q²).
static void times_quadratic(double constant, double square, double q, int order, double *jet)
{
    for (int n = order; n >= 0; n--) {
        double sum = (constant + square * q * q) * jet[n];
        if (n > 0) sum += 2 * square * q * jet[n - 1];
        if (n > 1) sum += square * jet[n - 2];
        jet[n] = sum;
    }
}

static double quadratic_bound(double constant, double square, double support, double b0, double b1,
                              double b2)
{
    return (fabs(constant) + fabs(square) * support * support) * b0 +
           2 * fabs(square) * support * b1 + fabs(square) * b2;
}

/// (1 + d/2 − q²) e^{−q²}, the fourth-order Gaussian of Gingold and Monaghan 1982.
static void super_gaussian_jet(const sphv_form *form, double q, int order, double *jet)
{
    gaussian_jet(form, q, order, jet);
    times_quadratic(1 + 0.5 * form->dimension, -1, q, order, jet);
}

static double super_gaussian_bound(const sphv_form *form, int n)
{
    return quadratic_bound(1 + 0.5 * form->dimension, -1, form->support, gaussian_bound(form, n),
                           gaussian_bound(form, n - 1), gaussian_bound(form, n - 2));
}

/// cos(a + nπ/2) for a = π·turns, exact at multiples of a half turn.
static double cos_quarter(double turns, int n)
{
    double x = fmod(turns, 2) + 0.5 * (n % 4);
    x = fmod(x, 2);
    if (x > 1) x = 2 - x;
    return x > 0.75   ? -cos(M_PI * (1 - x))
           : x < 0.25 ? cos(M_PI * x)
                      : sin(M_PI * (0.5 - x));
}

/// 4 cos(πq/κ) + cos(2πq/κ) + 3.
static void double_cosine_jet(const sphv_form *form, double q, int order, double *jet)
{
    double slow = M_PI / form->support, fast = 2 * slow;
    double slow_power = 1, fast_power = 1;
    for (int n = 0; n <= order; n++) {
        jet[n] = 4 * slow_power * cos_quarter(q / form->support, n) +
                 fast_power * cos_quarter(2 * q / form->support, n) + (n == 0 ? 3 : 0);
        slow_power *= slow / (n + 1);
        fast_power *= fast / (n + 1);
    }
}

static double double_cosine_bound(const sphv_form *form, int n)
{
    double slow = M_PI / form->support, factorial = exp(-gsl_sf_lnfact((unsigned)n));
    return (4 * gsl_pow_int(slow, n) + gsl_pow_int(2 * slow, n)) * factorial + (n == 0 ? 3 : 0);
}

/// S(q)^m with S(q) = sin(πq/κ)/(πq/κ) = ∫_0^1 cos(πqt/κ) dt, differentiated below the integral:
/// accurate for every q and order, where dividing the sine's Taylor series by q is not.
static void sinc_jet(const sphv_form *form, double q, int order, double *jet)
{
    double rate = M_PI / form->support, base[SPHV_JET_MAX + 1] = {0};
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(64);
    for (size_t i = 0; i < 64; i++) {
        double t, weight;
        gsl_integration_glfixed_point(0, 1, i, &t, &weight, rule);
        double power = weight, wave[4];
        wave[0] = cos(rate * q * t);
        wave[1] = -sin(rate * q * t);
        wave[2] = -wave[0];
        wave[3] = -wave[1];
        for (int n = 0; n <= order; n++) {
            base[n] += power * wave[n % 4];
            power *= rate * t / (n + 1);
        }
    }
    gsl_integration_glfixed_table_free(rule);
    memset(jet, 0, (size_t)(order + 1) * sizeof *jet);
    jet[0] = 1;
    for (int round = 0; round < form->exponent; round++)
        for (int n = order; n >= 0; n--) {
            double sum = 0;
            for (int i = 0; i <= n; i++) sum += jet[i] * base[n - i];
            jet[n] = sum;
        }
}

/// Bernstein's inequality: S^m has spectrum in [−mπ/κ, mπ/κ] and modulus at most 1.
static double sinc_bound(const sphv_form *form, int n)
{
    return exp(n * log(form->exponent * M_PI / form->support) - gsl_sf_lnfact((unsigned)n));
}

const sphv_family sphv_families[] = {
    {"gaussian", "e^(-q^2)", false, true, true, gaussian_jet, gaussian_bound},
    {"super-gaussian", "(1 + d/2 - q^2) e^(-q^2)", false, true, true, super_gaussian_jet,
     super_gaussian_bound},
    {"double-cosine", "4 cos(pi q/k) + cos(2 pi q/k) + 3", false, false, false, double_cosine_jet,
     double_cosine_bound},
    {"sinc", "(sin(pi q/k)/(pi q/k))^m", true, false, false, sinc_jet, sinc_bound},
    {NULL, NULL, false, false, false, NULL, NULL},
};

const sphv_family *sphv_family_find(const char *name)
{
    for (const sphv_family *family = sphv_families; family->name; family++)
        if (strcmp(family->name, name) == 0) return family;
    return NULL;
}

void sphv_form_jet(const sphv_form *form, double q, int order, double *jet)
{
    form->family->jet(form, q, order, jet);
    if (form->transform != 0) times_quadratic(1, -form->transform, q, order, jet);
    for (int n = 0; n <= order; n++) jet[n] *= form->scale;
}

double sphv_form_derivative_bound(const sphv_form *form, int n)
{
    const sphv_family *family = form->family;
    double bound = family->derivative_bound(form, n);
    if (form->transform != 0)
        bound = quadratic_bound(1, -form->transform, form->support, bound,
                                n > 0 ? family->derivative_bound(form, n - 1) : 0,
                                n > 1 ? family->derivative_bound(form, n - 2) : 0);
    return fabs(form->scale) * bound;
}
