#include "families.h"

#include <float.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_sf_gamma.h>
#include <string.h>

#include "sphverify/kernel.h"

static const double unit_roundoff = DBL_EPSILON / 2;

/// A number computed in a few operations of which the largest intermediate has this size.
static sphv_result few(double value, double roundings, double size)
{
    return (sphv_result){value, roundings * unit_roundoff * size};
}

/// e^{−q²}; the rounding of q² is carried over, so the result is good to 2 ulp for any q.
static double gaussian(double q)
{
    double square = q * q, lost = fma(q, q, -square);
    return exp(-square) * (1 - lost);
}

static void gaussian_values(const sphv_form *form, double q, sphv_result out[3])
{
    (void)form;
    double w = gaussian(q);
    out[0] = few(w, 4, w);
    out[1] = few(-2 * q * w, 6, 2 * q * w);
    out[2] = few((4 * q * q - 2) * w, 8, (4 * q * q + 2) * w);
}

/// e^{−q²}: y′ = −2qy gives (n+1) y_{n+1} = −2 (q y_n + y_{n−1}).
static void gaussian_jet(const sphv_form *form, double q, int order, double *jet)
{
    (void)form;
    jet[0] = gaussian(q);
    for (int n = 0; n < order; n++)
        jet[n + 1] = -2 * (q * jet[n] + (n > 0 ? jet[n - 1] : 0)) / (n + 1);
}

/// Cramér's inequality: |d^n e^{−s²}/ds^n| ≤ 1.0865 √(2^n n!) e^{−s²/2}.
static double gaussian_bound(const sphv_form *form, int n)
{
    (void)form;
    return n < 0 ? 0 : 1.0865 * exp(0.5 * (n * M_LN2 - gsl_sf_lnfact((unsigned)n)));
}

/// Multiplies w, w′, w″ at q by (constant + square·q²), `square` known to a relative error.
static void values_times_quadratic(double constant, double square, double square_error, double q,
                                   sphv_result w[3])
{
    double factor[3] = {constant + square * q * q, 2 * square * q, 2 * square};
    double size = fabs(constant) + fabs(square) * q * q;
    double error[3] = {3 * unit_roundoff * size + square_error * fabs(square) * q * q,
                       (square_error + unit_roundoff) * fabs(factor[1]),
                       square_error * fabs(factor[2])};
    static const double binomial[3][3] = {{1, 0, 0}, {1, 1, 0}, {1, 2, 1}};
    for (int n = 2; n >= 0; n--) {
        double sum = 0, bound = 0;
        for (int i = 0; i <= n; i++) { // Leibniz: factor^(i) w^(n−i)
            double part = binomial[n][i] * factor[i] * w[n - i].value;
            sum += part;
            bound += binomial[n][i] * (fabs(factor[i]) * w[n - i].bound +
                                       error[i] * (fabs(w[n - i].value) + w[n - i].bound)) +
                     5 * unit_roundoff * fabs(part);
        }
        w[n] = (sphv_result){sum, bound};
    }
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
static void super_gaussian_values(const sphv_form *form, double q, sphv_result out[3])
{
    gaussian_values(form, q, out);
    values_times_quadratic(1 + 0.5 * form->dimension, -1, 0, q, out);
}

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

/// cos and sin of π·part/whole for 0 ≤ part ≤ whole/2, both good to 3.5 roundings relatively: the
/// smaller of them is taken from whole/2 − part, exact in the upper half by Sterbenz.
static void quarter_turn(double part, double whole, double *cosine, double *sine)
{
    double rest = 0.5 * whole - part;
    bool upper = part > 0.25 * whole;
    double angle = M_PI * ((upper ? rest : part) / whole);
    *cosine = upper ? sin(angle) : cos(angle);
    *sine = upper ? cos(angle) : sin(angle);
}

/// 4 cos(πq/κ) + cos(2πq/κ) + 3 = 8 cos⁴(πq/2κ), which does not cancel at the edge.
static void double_cosine_values(const sphv_form *form, double q, sphv_result out[3])
{
    double c, s, rate = M_PI / form->support;
    quarter_turn(q, 2 * form->support, &c, &s);
    double c2 = c * c, s2 = s * s;
    out[0] = few(8 * c2 * c2, 18, 8 * c2 * c2);
    out[1] = few(-16 * rate * c2 * c * s, 22, 16 * rate * c2 * c * s);
    out[2] = few(8 * rate * rate * c2 * (3 * s2 - c2), 26, 8 * rate * rate * c2 * (3 * s2 + c2));
}

/// cos(a + nπ/2) for a = π·turns, exact at multiples of a half turn.
static double cos_quarter(double turns, int n)
{
    double x = fmod(turns, 2) + 0.5 * (n % 4);
    x = fmod(x, 2);
    if (x > 1) x = 2 - x;
    return x > 0.75 ? -cos(M_PI * (1 - x)) : x < 0.25 ? cos(M_PI * x) : sin(M_PI * (0.5 - x));
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

/// S(θ) = sin θ/θ, S′ and S″ by Taylor's series, for 0 ≤ θ ≤ 1: the terms alternate and shrink, and
/// 12 of them leave 1e-24.
static void sinc_series(double theta, sphv_result out[3])
{
    static const double factorial[] = {1,
                                       6,
                                       120,
                                       5040,
                                       362880,
                                       39916800,
                                       6227020800,
                                       1307674368000,
                                       355687428096000,
                                       121645100408832000,
                                       51090942171709440000.,
                                       25852016738884976640000.}; // (2k + 1)!
    double x = theta * theta, sum[3] = {0, 0, 0};
    for (int k = 11; k >= 0; k--) {
        double c = 1 / factorial[k];
        sum[0] = c - x * sum[0];
        if (k > 0) sum[1] = 2 * k * c - x * sum[1];
        if (k > 0) sum[2] = 2 * k * (2 * k - 1) * c - x * sum[2];
    }
    // The last step of each Horner sum dominates; θ is known to 3 roundings, which move S^(n) by
    // θ S^(n+1) of them, and |S‴| ≤ 1/4.
    out[0] = few(sum[0], 2 + x * sum[1] * 3, 1);
    out[1] = few(-theta * sum[1], 5 * sum[1] + 3 * sum[2], theta);
    out[2] = few(-sum[2], 4 * sum[2] + 0.75 * theta, 1);
}

/// The same for 1 < θ = πq/κ ≤ π, by S′ = (cos θ − S)/θ and S″ = −S − 2S′/θ. Beyond π/2 sine and
/// cosine are those of π − θ, so S is good relatively up to its zero at κ. Each angle carries 2.4
/// roundings, which move S = sin θ/θ by at most as many below π/2 and the cosine by 3.7.
static void sinc_closed(double q, double support, double theta, sphv_result out[3])
{
    bool upper = q > 0.5 * support;
    double angle = upper ? M_PI * ((support - q) / support) : theta;
    double value = sin(angle) / theta, cosine = upper ? -cos(angle) : cos(angle);
    double slope = (cosine - value) / theta;
    out[0] = few(value, upper ? 8 : 5, value);
    out[1] = (sphv_result){slope, (out[0].bound + 6 * unit_roundoff) / theta +
                                      5 * unit_roundoff * fabs(slope)};
    out[2] = (sphv_result){-value - 2 * slope / theta,
                           out[0].bound + 2 * out[1].bound / theta +
                               6 * unit_roundoff * (value + 2 * fabs(slope) / theta)};
}

/// S(q)^m with S(q) = sin(πq/κ)/(πq/κ).
static void sinc_values(const sphv_form *form, double q, sphv_result out[3])
{
    double rate = M_PI / form->support, theta = M_PI * (q / form->support);
    sphv_result s[3];
    if (theta <= 1)
        sinc_series(theta, s);
    else
        sinc_closed(q, form->support, theta, s);
    int m = form->exponent;
    double lower = m > 1 ? gsl_pow_int(s[0].value, m - 2) : 0,
           power = m > 1 ? lower * s[0].value : 1;
    double relative = s[0].bound / fmax(s[0].value, DBL_MIN);
    out[0].value = power * s[0].value;
    out[0].bound = out[0].value * m * (relative + unit_roundoff);
    out[1].value = rate * m * power * s[1].value;
    out[1].bound = rate * m * power *
                   (s[1].bound + fabs(s[1].value) * ((m - 1) * relative + (m + 5) * unit_roundoff));
    double square = (m - 1) * lower * s[1].value * s[1].value, bend = power * s[2].value;
    out[2].value = rate * rate * m * (square + bend);
    out[2].bound = rate * rate * m *
                   (2 * (m - 1) * lower * fabs(s[1].value) * s[1].bound + power * s[2].bound +
                    (square + fabs(bend)) * (m * relative + (m + 10) * unit_roundoff));
}

/// The jet of S(q) = ∫_0^1 cos(πqt/κ) dt, differentiated below the integral: accurate for every q
/// and order, where dividing the sine's Taylor series by q is not. GSL keeps the 64-point rule.
static void sinc_jet(const sphv_form *form, double q, int order, double *jet)
{
    double rate = M_PI / form->support, base[SPHV_JET_MAX + 1] = {0};
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(64);
    for (size_t i = 0; rule && i < 64; i++) {
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
    if (!rule) base[0] = NAN;
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
    {"gaussian", "e^(-q^2)", false, true, true, gaussian_values, gaussian_jet, gaussian_bound},
    {"super-gaussian", "(1 + d/2 - q^2) e^(-q^2)", false, true, true, super_gaussian_values,
     super_gaussian_jet, super_gaussian_bound},
    {"double-cosine", "4 cos(pi q/k) + cos(2 pi q/k) + 3", false, false, false,
     double_cosine_values, double_cosine_jet, double_cosine_bound},
    {"sinc", "(sin(pi q/k)/(pi q/k))^m", true, false, false, sinc_values, sinc_jet, sinc_bound},
    {NULL, NULL, false, false, false, NULL, NULL, NULL},
};

const sphv_family *sphv_family_find(const char *name)
{
    for (const sphv_family *family = sphv_families; family->name; family++)
        if (strcmp(family->name, name) == 0) return family;
    return NULL;
}

void sphv_form_values(const sphv_form *form, double q, sphv_result out[3])
{
    form->family->values(form, q, out);
    if (form->transform != 0)
        values_times_quadratic(1, -form->transform, form->transform_error, q, out);
    for (int n = 0; n < 3; n++) {
        out[n].value *= form->scale;
        out[n].bound =
            out[n].bound * form->scale + fabs(out[n].value) * (form->scale_error + unit_roundoff);
        // w(q/κ): moving κ by e moves w^(n) by at most (n w^(n) + κ w^(n+1)) e/κ.
        if (form->support_error > 0)
            out[n].bound += form->support_error * (n ? 2 : 1) *
                            (n * sphv_form_derivative_bound(form, n) / form->support +
                             (n + 1) * sphv_form_derivative_bound(form, n + 1));
    }
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
