#include <gsl/gsl_math.h>
#include <gsl/gsl_sf_zeta.h>

#include "internal.h"

/// From this order on the Fourier series needs fewer than 700 (modes + 1) terms for full accuracy;
/// below it the polynomial is well conditioned.
enum { FOURIER_FROM = 6, FOURIER_FROM_WITHOUT_MODES = 11 };

/// cos(2πx − pπ/2) for x ≥ 0, exact zeros where x is a multiple of 1/4.
static double shifted_cosine(double x, int p)
{
    double turns = fmod(x - 0.25 * (p % 4) + 1, 1);
    double away = fabs(turns - 0.5); // cos(2π turns) = −cos(2π away), even about a half turn
    return away < 0.125   ? -cos(2 * M_PI * away)
           : away > 0.375 ? cos(2 * M_PI * (0.5 - away))
                          : sin(2 * M_PI * (away - 0.25));
}

/// One Fourier mode of B̄_p(θ)/p!: −2 cos(2πjθ − pπ/2)/(2πj)^p.
static double mode(int p, double fraction, double j)
{
    return -2 * shifted_cosine(fmod(j * fraction, 1), p) / gsl_pow_int(2 * M_PI * j, p);
}

/// B_p(θ)/p! = Σ_k B_k(1/2)/k! x^(p−k)/(p−k)!, x = θ − 1/2, with
/// B_2m(1/2)/(2m)! = (−1)^m 2η(2m)/(2π)^(2m) and the odd ones zero.
static double polynomial(int p, double fraction)
{
    double x = fraction - 0.5, sum = 0, power = 1;
    double weight[FOURIER_FROM_WITHOUT_MODES];
    for (int i = 0; i <= p; i++) {
        weight[i] = power;
        power *= x / (i + 1);
    }
    for (int m = p / 2; m >= 0; m--) {
        double half =
            m == 0 ? 1 : (m % 2 ? -2 : 2) * gsl_sf_eta_int(2 * m) / gsl_pow_int(2 * M_PI, 2 * m);
        sum += half * weight[p - 2 * m];
    }
    return sum;
}

/// B̄_p at the fractions 0 and 1/2 is a zeta or eta value.
static bool closed_value(int p, double fraction, double *value)
{
    if (fraction != 0 && fraction != 0.5) return false;
    double size = fraction == 0 ? -gsl_sf_zeta_int(p == 1 ? 2 : p) : gsl_sf_eta_int(p);
    *value = p % 2 ? 0 : (p % 4 ? -2 : 2) * size / gsl_pow_int(2 * M_PI, p);
    return true;
}

sphv_result sphv_periodic_bernoulli(int p, double fraction, int modes)
{
    double size = 4 / gsl_pow_int(2 * M_PI, p);
    double sum = 0;
    if (modes == 0 && closed_value(p, fraction, &sum))
        return (sphv_result){sum, 16 * SPHV_U * fabs(sum)};
    if (p < (modes ? FOURIER_FROM : FOURIER_FROM_WITHOUT_MODES)) {
        // p = 1 at fraction 0 is the mean of both sides of the saw-tooth.
        sum = p == 1 && fraction == 0 ? 0 : polynomial(p, fraction);
        for (int j = modes; j >= 1; j--) sum -= mode(p, fraction, j);
        return (sphv_result){sum, (16 + 8 * modes) * SPHV_U * size};
    }
    double last = ceil((modes + 1) * pow(10, 17.0 / p));
    for (double j = last; j > modes; j--) sum += mode(p, fraction, j);
    double own_size = size / gsl_pow_int(modes + 1, p);
    return (sphv_result){sum, (16 + 2 * p) * SPHV_U * own_size};
}
