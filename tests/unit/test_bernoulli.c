/// Periodic Bernoulli functions by three routes: the library's, the exact polynomials B_p(x) over
/// rationals, and the Fourier series with a bounded tail.
#include <gmp.h>
#include <math.h>
#include <stdlib.h>

#include "sphverify/theory.h"
#include "support.h"

enum { ORDER = 40 };

/// Bernoulli numbers by Σ_{k<n} C(n+1, k) B_k = −(n+1) B_n.
static void bernoulli_numbers(mpq_t *number, int last)
{
    mpq_t part;
    mpz_t choose;
    mpq_init(part);
    mpz_init(choose);
    for (int n = 0; n <= last; n++) {
        mpq_init(number[n]);
        mpq_set_ui(number[n], n == 0, 1);
        if (n == 0) continue;
        for (int k = 0; k < n; k++) {
            mpz_bin_uiui(choose, (unsigned long)(n + 1), (unsigned long)k);
            mpq_set_z(part, choose);
            mpq_mul(part, part, number[k]);
            mpq_sub(number[n], number[n], part);
        }
        mpq_set_ui(part, 1, (unsigned long)(n + 1));
        mpq_mul(number[n], number[n], part);
    }
    mpq_clear(part);
    mpz_clear(choose);
}

/// B_p(θ)/p! = Σ_k C(p, k) B_k θ^(p−k)/p!, exact but for the last rounding.
static double exact_polynomial(mpq_t *number, int p, double theta)
{
    mpq_t x, sum, part;
    mpz_t whole;
    mpq_inits(x, sum, part, NULL);
    mpz_init(whole);
    mpq_set_d(x, theta);
    for (int k = 0; k <= p; k++) { // Horner in θ: the coefficient of θ^(p−k) is C(p, k) B_k
        mpq_mul(sum, sum, x);
        mpz_bin_uiui(whole, (unsigned long)p, (unsigned long)k);
        mpq_set_z(part, whole);
        mpq_mul(part, part, number[k]);
        mpq_add(sum, sum, part);
    }
    mpz_fac_ui(whole, (unsigned long)p);
    mpq_set_z(part, whole);
    mpq_div(sum, sum, part);
    double value = mpq_get_d(sum);
    mpq_clears(x, sum, part, NULL);
    mpz_clear(whole);
    return value;
}

static void test_against_exact_polynomials(void **state)
{
    (void)state;
    random_start("Bernoulli polynomials");
    mpq_t number[ORDER + 1];
    bernoulli_numbers(number, ORDER);
    for (int p = 1; p <= ORDER; p++)
        for (int i = 0; i < 40; i++) {
            static const double awkward[] = {0, 0.25, 0.5, 0.75, 0x1p-60, 0.5 + 0x1p-50, 1.0 / 3};
            double theta = i < 7 ? awkward[i] : random_uniform(0, 1);
            if (p == 1 && theta == 0) continue; // the mean of both sides, tested below
            sphv_result value = sphv_periodic_bernoulli(p, theta, 0);
            double expected = exact_polynomial(number, p, theta);
            assert_within_bounds(value, expected);
            // the bound itself must stay a few units in the last place of the function's size
            assert_true(value.bound <= 200 * 0x1p-53 * 4 / pow(2 * M_PI, p));
        }
    for (int n = 0; n <= ORDER; n++) mpq_clear(number[n]);
}

static void test_known_values(void **state)
{
    (void)state;
    static const struct {
        int p;
        double theta, value; // B_p(θ)/p!
    } known[] = {{1, 0.25, -0.25},      {2, 0, 1.0 / 12},         {2, 0.5, -1.0 / 24},
                 {3, 0.25, 1.0 / 128},  {3, 0.75, -1.0 / 128},    {4, 0, -1.0 / 720},
                 {4, 0.5, 7.0 / 5760},  {6, 0.5, -31.0 / 967680}, {6, 0, 1.0 / 30240},
                 {4, 0.25, 7.0 / 92160}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        assert_within_bounds(sphv_periodic_bernoulli(known[i].p, known[i].theta, 0),
                             known[i].value);
    assert_close(sphv_periodic_bernoulli(1, 0, 0).value, 0, 0);
    for (int p = 1; p <= 31; p += 2) // odd orders vanish where the edge is half-way
        assert_close(sphv_periodic_bernoulli(p, 0.5, 0).value, 0, 0);
}

/// B̄_p(1 − θ) = (−1)^p B̄_p(θ)
static void test_reflection(void **state)
{
    (void)state;
    random_start("reflection");
    for (int p = 1; p <= 96; p++)
        for (int i = 0; i < 10; i++) {
            double theta = (double)random_integer(1, 1 << 20) / (double)((1 << 20) + 1);
            theta = ldexp(nearbyint(ldexp(theta, 30)), -30); // so that 1 − θ is exact
            sphv_result a = sphv_periodic_bernoulli(p, theta, 0),
                        b = sphv_periodic_bernoulli(p, 1 - theta, 0);
            assert_close(a.value, p % 2 ? -b.value : b.value, a.bound + b.bound);
        }
}

/// The Fourier series −2 Σ cos(2πjθ − pπ/2)/(2πj)^p, summed here with its tail bounded.
static sphv_result fourier(int p, double theta, int modes)
{
    enum { LAST = 20000 };
    double sum = 0, size = 0;
    for (int j = LAST; j > modes; j--) {
        double term = -2 * cos(2 * M_PI * fmod(j * theta, 1) - p * M_PI_2) / pow(2 * M_PI * j, p);
        sum += term;
        size += 2 / pow(2 * M_PI * j, p);
    }
    double tail = 2 / pow(2 * M_PI, p) * pow(LAST, 1 - p) / (p - 1);
    // phase jθ − p/4 in turns loses (jθ + p)u; the sum itself LAST u at worst for j^-p, p ≥ 2
    return (sphv_result){sum, tail + size * (64 + 8 * p) * 0x1p-53 + (p == 2 ? 1e-15 : 0)};
}

static void test_against_the_fourier_series(void **state)
{
    (void)state;
    random_start("Fourier series");
    for (int p = 3; p <= 60; p += 1)
        for (int modes = 0; modes <= 5; modes += p < 20 ? 1 : 5) {
            double theta = random_uniform(0, 1);
            sphv_result a = sphv_periodic_bernoulli(p, theta, modes), b = fourier(p, theta, modes);
            assert_close(a.value, b.value, a.bound + b.bound);
        }
}

/// Taking modes away and adding them back is the identity.
static void test_modes_are_subtracted(void **state)
{
    (void)state;
    random_start("modes");
    for (int p = 1; p <= 12; p++)
        for (int modes = 1; modes <= 64; modes *= 4) {
            double theta = random_uniform(0.01, 0.99);
            sphv_result with = sphv_periodic_bernoulli(p, theta, modes),
                        whole = sphv_periodic_bernoulli(p, theta, 0);
            double taken = 0;
            for (int j = modes; j >= 1; j--)
                taken -= 2 * cos(2 * M_PI * fmod(j * theta, 1) - p * M_PI_2) / pow(2 * M_PI * j, p);
            // the cosines here carry (2π + p)u each
            assert_close(with.value, whole.value - taken,
                         with.bound + whole.bound + 16 * (modes + p) * 0x1p-53 / pow(2 * M_PI, p));
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_exact_polynomials),
        cmocka_unit_test(test_known_values),
        cmocka_unit_test(test_reflection),
        cmocka_unit_test(test_against_the_fourier_series),
        cmocka_unit_test(test_modes_are_subtracted),
    };
    return run_group(tests);
}
