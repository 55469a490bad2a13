#include <gsl/gsl_math.h>
#include <gsl/gsl_sf_gamma.h>

#include "internal.h"

enum { TERMS_MAX = SPHV_JET_MAX - 4, MODES_MAX = 4096 };
static const double remainder_wanted = 1e-18;
static const double bound_wanted = 1e-13; ///< of E_d, or of 1 % where E_d is smaller

/// sin(Ks)/K's derivatives at s: K^(n−1) sin(Ks + nπ/2).
static double sine_derivative(double K, double s, int n)
{
    switch (n % 4) {
    case 0:
        return n ? gsl_pow_int(K, n - 1) * sin(K * s) : sphv_sine_over(K, s);
    case 1:
        return gsl_pow_int(K, n - 1) * cos(K * s);
    case 2:
        return -gsl_pow_int(K, n - 1) * sin(K * s);
    default:
        return -gsl_pow_int(K, n - 1) * cos(K * s);
    }
}

/// f^(order)(knot−) − f^(order)(knot+) with f = −sin(Ks)/K · Ŵ′, by Leibniz; `magnitude` receives
/// the sum of the moduli of its parts.
double sphv_gradient_jump(const sphv_knot *knot, double K, int order, double *magnitude)
{
    double sum = 0, binomial = 1;
    *magnitude = 0;
    double factorial = 1; // (i+1)! turns Taylor coefficients of Ŵ into derivatives of Ŵ′
    for (int i = 0; i <= order && i + 1 < knot->terms; i++) {
        factorial *= i + 1;
        double part = binomial * factorial * knot->jump[i + 1] *
                      sine_derivative(K, knot->position.value, order - i);
        double size =
            binomial * factorial * fabs(knot->jump[i + 1]) *
            (i == order ? fmin(knot->position.value, 1 / K) : gsl_pow_int(K, order - i - 1));
        sum -= part;
        *magnitude += size;
        binomial *= (order - i) / (i + 1.0);
    }
    return sum;
}

/// One term of the series at a pair of knots ±κ_i, or at the single knot 0.
static sphv_result term(const sphv_knot *knot, double K, double spacing, sphv_lattice_place place,
                        int p, int modes)
{
    double pair = knot->position.value > 0 ? 2 : 1;
    sphv_result bernoulli = sphv_periodic_bernoulli(p, place.fraction, modes);
    if (p == 1 && place.on_lattice) {
        // A particle on a knot takes the outer value, not the mean that B̄_1(0) = 0 stands for.
        bernoulli.value += 0.5;
    }
    double magnitude;
    double jump = sphv_gradient_jump(knot, K, p - 1, &magnitude);
    double power = pair * (p % 2 ? -1 : 1) * gsl_pow_int(spacing, p);
    double size = 4 / gsl_pow_int(2 * M_PI * (p < 6 ? 1 : modes + 1), p);
    return (sphv_result){
        power * bernoulli.value * jump,
        fabs(power) * magnitude *
            (bernoulli.bound + (24 + 6 * p + 6 * K * knot->position.value) * SPHV_U * size)};
}

/// Σ over pieces (both sides of the origin) of length · sup|Ŵ^(n)|/n!.
static void sum_derivative_sizes(const sphv_profile *profile, double *size)
{
    for (int n = 0; n <= SPHV_JET_MAX; n++) size[n] = 0;
    for (int i = 0; i < profile->piece_count; i++)
        for (int n = 0; n <= SPHV_JET_MAX; n++)
            size[n] += 2 * (profile->pieces[i].outer - profile->pieces[i].inner) *
                       profile->pieces[i].derivative_bound[n];
}

/// log ∫|f^(p)|/p! ds, from size[n] = ∫ sup|Ŵ^(n)|/n! and |d^m(sin Ks/K)/ds^m| ≤ K^(m−1).
static double log_integral(const double *size, double K, double support, int p)
{
    double largest = -INFINITY, parts[SPHV_JET_MAX], sum = 0;
    for (int i = 0; i <= p; i++) {
        double sine = i == p ? log(fmin(support, 1 / K))
                             : (p - i - 1) * log(K) - gsl_sf_lnfact((unsigned)(p - i));
        parts[i] = size[i + 1] > 0 ? log((i + 1) * size[i + 1]) + sine : -INFINITY;
        largest = fmax(largest, parts[i]);
    }
    if (largest == -INFINITY) return -INFINITY;
    for (int i = 0; i <= p; i++) sum += exp(parts[i] - largest);
    return largest + log(sum);
}

/// log of the remainder's bound, Δs^p sup|B̄_p without modes|/p! ∫|f^(p)|, with
/// |B̄_p without modes|/p! ≤ 2 Σ_{j>M} (2πj)^−p ≤ 2 (2π(M+1))^−p (1 + (M+1)/(p−1)).
static double log_remainder(const double *size, double K, double support, double spacing, int p,
                            int modes)
{
    return log_integral(size, K, support, p) + gsl_sf_lnfact((unsigned)p) +
           p * log(spacing / (2 * M_PI * (modes + 1))) + log(2 * (1 + (modes + 1.0) / (p - 1)));
}

double sphv_gradient_variation(const sphv_profile *profile, double K, int order)
{
    double size[SPHV_JET_MAX + 1];
    sum_derivative_sizes(profile, size);
    return exp(log_integral(size, K, profile->support, order) + gsl_sf_lnfact((unsigned)order));
}

/// From `fewest` on, the fewest modes, then the fewest terms, whose remainder is below what is
/// wanted.
static double choose_lengths(const sphv_profile *profile, double K, double spacing, int fewest,
                             int *terms, int *modes)
{
    static const int lengths[] = {6, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 60, 76, TERMS_MAX};
    double size[SPHV_JET_MAX + 1], best = INFINITY;
    sum_derivative_sizes(profile, size);
    for (int m = fewest; m <= MODES_MAX; m = m < 4 ? m + 1 : m + m / 4)
        for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
            double remainder =
                exp(log_remainder(size, K, profile->support, spacing, lengths[i], m));
            if (remainder < best) {
                best = remainder;
                *terms = lengths[i];
                *modes = m;
            }
            if (remainder <= remainder_wanted) return remainder;
        }
    return best;
}

/// The series with at least `fewest` modes taken out of it and evaluated on their own.
static sphv_result series(const sphv_profile *profile, double K, sphv_number spacing, int fewest,
                          int *terms, int *modes)
{
    sphv_result sum = {0, choose_lengths(profile, K, spacing.value, fewest, terms, modes)};
    for (int i = 0; i < profile->knot_count; i++) {
        const sphv_knot *knot = &profile->knots[i];
        sphv_lattice_place place = sphv_number_place(knot->position, spacing);
        for (int p = knot->order > 1 ? knot->order : 1; p <= *terms; p++) {
            sphv_result part = term(knot, K, spacing.value, place, p, *modes);
            sum.value += part.value;
            sum.bound += part.bound;
        }
    }
    for (int m = *modes; m >= 1; m--) {
        sphv_result mode = sphv_gradient_mode(profile, K, 2 * M_PI * m / spacing.value);
        sum.value += 2 * mode.value;
        sum.bound += 2 * mode.bound;
    }
    sum.bound += 4 * SPHV_U * fabs(sum.value);
    return sum;
}

sphv_result sphv_discretisation_error(const sphv_profile *profile, double h, sphv_number spacing,
                                      int *terms, int *modes)
{
    double K = 2 * M_PI * h;
    int p_last = 0, m_last = 0;
    sphv_result sum = series(profile, K, spacing, 0, &p_last, &m_last);
    if (sum.bound > bound_wanted * fmax(fabs(sum.value), 0.01)) {
        // Where Δs is close to κ, terms of high degree cancel; with their slowest modes taken out
        // they are smaller. What each mode costs in rounding decides which is the better.
        int p_more = 0, m_more = 0;
        sphv_result more = series(profile, K, spacing, m_last + 1, &p_more, &m_more);
        if (more.bound < sum.bound) {
            sum = more;
            p_last = p_more;
            m_last = m_more;
        }
    }
    if (terms) *terms = p_last;
    if (modes) *modes = m_last;
    return sum;
}

double sphv_euler_maclaurin_term(const sphv_profile *profile, int knot, double h,
                                 sphv_number spacing, int p)
{
    const sphv_knot *at = &profile->knots[knot];
    return term(at, 2 * M_PI * h, spacing.value, sphv_number_place(at->position, spacing), p, 0)
        .value;
}

int sphv_predicted_order(const sphv_profile *profile, bool special_spacing, int *deciding_knot)
{
    int order = 0;
    for (int i = 0; i < profile->knot_count; i++) {
        const sphv_knot *knot = &profile->knots[i];
        // Ŵ^(c) jumps, so f^(c−1) does and p = c leads, unless B̄_p vanishes for odd p: at the
        // origin always, at κ where a special spacing makes the fraction 1/2.
        bool even_only = knot->position.value == 0 ||
                         (special_spacing && knot->position.value == profile->support);
        int p = knot->order > 1 ? knot->order : 1;
        if (even_only && p % 2) p++;
        if (order == 0 || p < order) {
            order = p;
            if (deciding_knot) *deciding_knot = i;
        }
    }
    return order;
}
