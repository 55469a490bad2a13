#include <stdlib.h>

#include "oracle_internal.h"

/// out = ∫_0^κ q^power w dq for piecewise polynomials.
static void polynomial_moment(const oracle *kernel, int power, mpq_t out)
{
    mpq_t from, to, part;
    mpq_inits(from, to, part, NULL);
    mpq_set_ui(out, 0, 1);
    for (int i = 0; i < kernel->pieces; i++)
        for (int k = 0; k <= kernel->degree[i]; k++) {
            mpq_set(part, kernel->coefficient[i][k]);
            mpq_set_ui(from, i > 0, 1);
            mpq_set_ui(to, 1, 1);
            for (int e = 0; e < k + power + 1; e++) {
                mpq_mul(to, to, kernel->until[i]);
                if (i) mpq_mul(from, from, kernel->until[i - 1]);
            }
            mpq_sub(to, to, from);
            mpq_mul(part, part, to);
            mpq_set_ui(to, 1, (unsigned long)(k + power + 1));
            mpq_mul(part, part, to);
            mpq_add(out, out, part);
        }
    mpq_clears(from, to, part, NULL);
}

/// Taylor coefficients of (sin x/x)^m in x²: entire, so 160 of them at 320 bits serve x ≤ π, m
/// ≤ 12.
void oracle_sinc_series(oracle *kernel)
{
    mpfr_t base[SERIES], sum, product;
    mpfr_inits2(BITS, sum, product, (mpfr_ptr)NULL);
    for (int k = 0; k < SERIES; k++) {
        mpfr_init2(base[k], BITS);
        mpfr_fac_ui(base[k], (unsigned long)(2 * k + 1), MPFR_RNDN);
        mpfr_si_div(base[k], k % 2 ? -1 : 1, base[k], MPFR_RNDN);
        mpfr_set_ui(kernel->series[k], k == 0, MPFR_RNDN);
    }
    for (int round = 0; round < kernel->exponent; round++)
        for (int n = SERIES - 1; n >= 0; n--) {
            mpfr_set_zero(sum, 1);
            for (int k = 0; k <= n; k++) {
                mpfr_mul(product, kernel->series[k], base[n - k], MPFR_RNDN);
                mpfr_add(sum, sum, product, MPFR_RNDN);
            }
            mpfr_set(kernel->series[n], sum, MPFR_RNDN);
        }
    for (int k = 0; k < SERIES; k++) mpfr_clear(base[k]);
    mpfr_clears(sum, product, (mpfr_ptr)NULL);
}

/// out = ∫_0^∞ q^(2m) e^{−q²} dq = √π (2m)!/(4^m m!)/2
static void gaussian_moment(int m, mpfr_t out)
{
    mpfr_t part;
    mpfr_init2(part, BITS);
    mpfr_const_pi(out, MPFR_RNDN);
    mpfr_sqrt(out, out, MPFR_RNDN);
    mpfr_fac_ui(part, (unsigned long)(2 * m), MPFR_RNDN);
    mpfr_mul(out, out, part, MPFR_RNDN);
    mpfr_fac_ui(part, (unsigned long)m, MPFR_RNDN);
    mpfr_div(out, out, part, MPFR_RNDN);
    mpfr_div_2ui(out, out, (unsigned long)(2 * m + 1), MPFR_RNDN);
    mpfr_clear(part);
}

/// out = ∫_0^1 t^power cos(mπt) dt for power 0, 2, 4 and m = 1, 2, by parts, with c = cos mπ.
static void cosine_moment(int power, int m, mpfr_t out)
{
    mpfr_t rate, part;
    mpfr_inits2(BITS, rate, part, (mpfr_ptr)NULL);
    mpfr_const_pi(rate, MPFR_RNDN);
    mpfr_mul_si(rate, rate, m, MPFR_RNDN);
    mpfr_sqr(rate, rate, MPFR_RNDN);
    long c = m % 2 ? -1 : 1;
    mpfr_set_zero(out, 1);
    if (power >= 2) {
        mpfr_si_div(out, power * c, rate, MPFR_RNDN);
    }
    if (power == 4) {
        mpfr_sqr(part, rate, MPFR_RNDN);
        mpfr_si_div(part, -24 * c, part, MPFR_RNDN);
        mpfr_add(out, out, part, MPFR_RNDN);
    }
    mpfr_clears(rate, part, (mpfr_ptr)NULL);
}

/// out = ∫ q^power w dq over 0 … κ, or 0 … ∞ for the truncated families; power even. Without the
/// transform.
static void moment(const oracle *kernel, int power, mpfr_t out)
{
    mpfr_t part;
    mpfr_init2(part, BITS);
    if (kernel->shape == PIECEWISE) {
        mpq_t exact;
        mpq_init(exact);
        polynomial_moment(kernel, power, exact);
        mpfr_set_q(out, exact, MPFR_RNDN);
        mpq_clear(exact);
    } else if (kernel->shape == GAUSSIAN) {
        gaussian_moment(power / 2, out);
    } else if (kernel->shape == SUPER_GAUSSIAN) {
        gaussian_moment(power / 2, out);
        mpfr_mul_d(out, out, 1.5, MPFR_RNDN);
        gaussian_moment(power / 2 + 1, part);
        mpfr_sub(out, out, part, MPFR_RNDN);
    } else {
        if (kernel->shape == DOUBLE_COSINE) {
            cosine_moment(power, 1, out);
            mpfr_mul_ui(out, out, 4, MPFR_RNDN);
            cosine_moment(power, 2, part);
            mpfr_add(out, out, part, MPFR_RNDN);
            mpfr_set_ui(part, 3, MPFR_RNDN);
            mpfr_div_ui(part, part, (unsigned long)(power + 1), MPFR_RNDN);
            mpfr_add(out, out, part, MPFR_RNDN);
        } else {
            mpfr_t pi, square;
            mpfr_inits2(BITS, pi, square, (mpfr_ptr)NULL);
            mpfr_const_pi(pi, MPFR_RNDN);
            mpfr_sqr(square, pi, MPFR_RNDN);
            mpfr_set_zero(out, 1);
            for (int k = SERIES - 1; k >= 0; k--) {
                mpfr_mul(out, out, square, MPFR_RNDN);
                mpfr_div_ui(part, kernel->series[k], (unsigned long)(2 * k + power + 1), MPFR_RNDN);
                mpfr_add(out, out, part, MPFR_RNDN);
            }
            mpfr_clears(pi, square, (mpfr_ptr)NULL);
        }
        mpfr_set_q(part, kernel->support, MPFR_RNDN);
        mpfr_pow_ui(part, part, (unsigned long)(power + 1), MPFR_RNDN);
        mpfr_mul(out, out, part, MPFR_RNDN);
    }
    mpfr_clear(part);
}

bool oracle_normalise(oracle *kernel)
{
    mpfr_t part;
    mpfr_init2(part, BITS);
    mpfr_set_zero(kernel->transform, 1);
    if (kernel->transformed) {
        moment(kernel, 2, kernel->transform);
        moment(kernel, 4, part);
        mpfr_div(kernel->transform, kernel->transform, part, MPFR_RNDN);
    }
    moment(kernel, 2, part);
    mpfr_mul(part, part, kernel->transform, MPFR_RNDN);
    moment(kernel, 0, kernel->constant);
    mpfr_sub(kernel->constant, kernel->constant, part, MPFR_RNDN);
    mpfr_mul_ui(kernel->constant, kernel->constant, 2, MPFR_RNDN);
    bool good = mpfr_sgn(kernel->constant) > 0;
    mpfr_ui_div(kernel->constant, 1, kernel->constant, MPFR_RNDN);
    mpfr_clear(part);
    return good;
}

/// w and w′ of a piecewise polynomial, by Horner in exact rationals.
static void polynomial_jet(const oracle *kernel, const mpq_t q, mpfr_t value, mpfr_t slope)
{
    int i = 0;
    while (i < kernel->pieces - 1 && mpq_cmp(q, kernel->until[i]) >= 0) i++;
    mpq_t w, dw;
    mpq_inits(w, dw, NULL);
    for (int k = kernel->degree[i]; k >= 0; k--) {
        mpq_mul(dw, dw, q);
        mpq_add(dw, dw, w);
        mpq_mul(w, w, q);
        mpq_add(w, w, kernel->coefficient[i][k]);
    }
    mpfr_set_q(value, w, MPFR_RNDN);
    mpfr_set_q(slope, dw, MPFR_RNDN);
    mpq_clears(w, dw, NULL);
}

/// w and w′ of the closed forms.
static void closed_jet(const oracle *kernel, const mpq_t q, mpfr_t value, mpfr_t slope)
{
    mpfr_t x, rate, sine, cosine, part;
    mpfr_inits2(BITS, x, rate, sine, cosine, part, (mpfr_ptr)NULL);
    mpfr_set_q(x, q, MPFR_RNDN);
    if (kernel->shape == GAUSSIAN || kernel->shape == SUPER_GAUSSIAN) {
        mpfr_sqr(part, x, MPFR_RNDN);
        mpfr_neg(value, part, MPFR_RNDN);
        mpfr_exp(value, value, MPFR_RNDN);
        mpfr_mul(slope, value, x, MPFR_RNDN);
        mpfr_mul_si(slope, slope, -2, MPFR_RNDN); // (e^{−q²})′
        if (kernel->shape == SUPER_GAUSSIAN) {
            // w = (3/2 − q²)e, w′ = (3/2 − q²)e′ − 2q e, and e′ = −2q e
            mpfr_d_sub(part, 1.5, part, MPFR_RNDN);
            mpfr_mul(value, value, part, MPFR_RNDN);
            mpfr_add_ui(part, part, 1, MPFR_RNDN);
            mpfr_mul(slope, slope, part, MPFR_RNDN);
        }
    } else {
        mpfr_const_pi(rate, MPFR_RNDN);
        mpfr_set_q(part, kernel->support, MPFR_RNDN);
        mpfr_div(rate, rate, part, MPFR_RNDN);
        mpfr_mul(x, x, rate, MPFR_RNDN);
        mpfr_sin_cos(sine, cosine, x, MPFR_RNDN);
        if (kernel->shape == DOUBLE_COSINE) {
            // 4c + cos 2x + 3 = 4c + 2c² + 2, derivative −4s(1 + c) rate
            mpfr_add_ui(part, cosine, 1, MPFR_RNDN);
            mpfr_mul(slope, sine, part, MPFR_RNDN);
            mpfr_mul_si(slope, slope, -4, MPFR_RNDN);
            mpfr_sqr(value, part, MPFR_RNDN);
            mpfr_mul_ui(value, value, 2, MPFR_RNDN); // 2(1 + c)²
        } else if (mpfr_zero_p(x)) {
            mpfr_set_ui(value, 1, MPFR_RNDN);
            mpfr_set_zero(slope, 1);
        } else {
            // S = s/x, S′ = (c − S)/x; (S^m)′ = m S^(m−1) S′
            mpfr_div(part, sine, x, MPFR_RNDN);
            mpfr_sub(slope, cosine, part, MPFR_RNDN);
            mpfr_div(slope, slope, x, MPFR_RNDN);
            mpfr_pow_ui(value, part, (unsigned long)(kernel->exponent - 1), MPFR_RNDN);
            mpfr_mul(slope, slope, value, MPFR_RNDN);
            mpfr_mul_si(slope, slope, kernel->exponent, MPFR_RNDN);
            mpfr_mul(value, value, part, MPFR_RNDN);
        }
        mpfr_mul(slope, slope, rate, MPFR_RNDN);
    }
    mpfr_clears(x, rate, sine, cosine, part, (mpfr_ptr)NULL);
}

void oracle_slope(oracle *kernel, const mpq_t q, mpfr_t slope)
{
    if (mpq_cmp(q, kernel->support) >= 0) {
        mpfr_set_zero(slope, 1);
        return;
    }
    mpfr_t value, x, part;
    mpfr_inits2(BITS, value, x, part, (mpfr_ptr)NULL);
    if (kernel->shape == PIECEWISE)
        polynomial_jet(kernel, q, value, slope);
    else
        closed_jet(kernel, q, value, slope);
    if (kernel->transformed) {
        // (w(1 − a q²))′ = w′(1 − a q²) − 2 a q w
        mpfr_set_q(x, q, MPFR_RNDN);
        mpfr_mul(part, kernel->transform, x, MPFR_RNDN);
        mpfr_mul(value, value, part, MPFR_RNDN);
        mpfr_mul_ui(value, value, 2, MPFR_RNDN);
        mpfr_mul(part, part, x, MPFR_RNDN);
        mpfr_ui_sub(part, 1, part, MPFR_RNDN);
        mpfr_mul(slope, slope, part, MPFR_RNDN);
        mpfr_sub(slope, slope, value, MPFR_RNDN);
    }
    mpfr_mul(slope, slope, kernel->constant, MPFR_RNDN);
    mpfr_clears(value, x, part, (mpfr_ptr)NULL);
}

void oracle_forget_slopes(oracle *kernel)
{
    for (size_t j = 0; j < kernel->slope_count; j++) mpfr_clear(kernel->slope[j]);
    free(kernel->slope);
    kernel->slope = NULL;
    kernel->slope_count = 0;
}

/// The slopes at all particles of a lattice, kept for the next h.
static void find_slopes(oracle *kernel, const mpq_t spacing)
{
    if (mpq_equal(kernel->spacing, spacing)) return;
    oracle_forget_slopes(kernel);
    mpq_set(kernel->spacing, spacing);
    mpq_t q;
    mpq_init(q);
    mpq_div(q, kernel->support, spacing);
    kernel->slope = calloc((size_t)mpq_get_d(q) + 2, sizeof *kernel->slope);
    if (!kernel->slope) abort();
    for (mpq_set(q, spacing); mpq_cmp(q, kernel->support) < 0; mpq_add(q, q, spacing)) {
        mpfr_init2(kernel->slope[kernel->slope_count], BITS);
        oracle_slope(kernel, q, kernel->slope[kernel->slope_count++]);
    }
    mpq_clear(q);
}

/// The sines follow from sin (j+1)θ = 2 cos θ sin jθ − sin (j−1)θ: over n particles roundings grow
/// n²-fold, and that of cos θ by 1/θ²: some 80 bits of 320 at the least h and the finest lattice.
void oracle_lattice_error_mpfr(oracle *kernel, double h, const mpq_t spacing, mpfr_t error)
{
    mpfr_t K, twice_cosine, last, sine, next, sum;
    mpfr_inits2(BITS, K, twice_cosine, last, sine, next, sum, (mpfr_ptr)NULL);
    find_slopes(kernel, spacing);
    mpfr_const_pi(K, MPFR_RNDN);
    mpfr_mul_ui(K, K, 2, MPFR_RNDN);
    mpfr_mul_d(K, K, h, MPFR_RNDN);
    mpfr_mul_q(sine, K, spacing, MPFR_RNDN);
    mpfr_sin_cos(sine, twice_cosine, sine, MPFR_RNDN);
    mpfr_mul_ui(twice_cosine, twice_cosine, 2, MPFR_RNDN);
    mpfr_set_zero(last, 1);
    mpfr_set_zero(sum, 1);
    for (size_t j = 0; j < kernel->slope_count; j++) {
        mpfr_mul(next, kernel->slope[j], sine, MPFR_RNDN);
        mpfr_sub(sum, sum, next, MPFR_RNDN);
        mpfr_fms(next, twice_cosine, sine, last, MPFR_RNDN);
        mpfr_swap(last, sine);
        mpfr_swap(sine, next);
    }
    mpfr_mul_q(sum, sum, spacing, MPFR_RNDN);
    mpfr_mul_ui(sum, sum, 2, MPFR_RNDN);
    mpfr_div(sum, sum, K, MPFR_RNDN);
    mpfr_sub_ui(error, sum, 1, MPFR_RNDN);
    mpfr_clears(K, twice_cosine, last, sine, next, sum, (mpfr_ptr)NULL);
}

double oracle_lattice_error(oracle *kernel, double h, const mpq_t spacing)
{
    mpfr_t error;
    mpfr_init2(error, BITS);
    oracle_lattice_error_mpfr(kernel, h, spacing, error);
    double rounded = mpfr_get_d(error, MPFR_RNDN);
    mpfr_clear(error);
    return rounded;
}
