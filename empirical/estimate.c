#include "estimate.h"

#include <gsl/gsl_math.h>
#include <string.h>

#include "internal.h"

enum { ORDER_MAX = 2, MATRIX = ORDER_MAX + 1 };

/// Kernel value and slope at particle b, evaluated here unless the neighbourhood has them.
static void kernel_at(const sphv_profile *profile, const sphv_neighbourhood *around, int b,
                      double *value, double *slope)
{
    if (around->value) {
        *value = around->value[b];
        *slope = around->slope[b];
        return;
    }
    double s = around->s[b];
    sphv_result all[3];
    sphv_profile_values(profile, fabs(s), all);
    *value = all[0].value;
    *slope = s < 0 ? -all[1].value : s > 0 ? all[1].value : 0;
}

static sphv_estimate judge(double gradient, double condition)
{
    sphv_estimate estimate = {gradient, condition, SPHV_ESTIMATE_SOUND};
    if (!isfinite(condition))
        estimate.fault = SPHV_ESTIMATE_SINGULAR;
    else if (condition > 1 / sqrt(DBL_EPSILON))
        estimate.fault = SPHV_ESTIMATE_ILL_CONDITIONED;
    else if (!isfinite(gradient))
        estimate.fault = SPHV_ESTIMATE_NOT_FINITE;
    return estimate;
}

/// Eq. 1.
static sphv_estimate standard(const sphv_profile *profile, const sphv_neighbourhood *around,
                              const double *field)
{
    double sum = 0, value, slope;
    for (int b = 0; b < around->count; b++) {
        kernel_at(profile, around, b, &value, &slope);
        sum -= field[b] * slope * around->volume[b];
    }
    return judge(sum, 1);
}

/// Eqs. 27–28: W̃ = W/Σ W V, its gradient with the denominator differentiated, then L∇W̃. The field
/// is taken relative to the particle's own value: Σ∇W̃ V = 0 exactly.
static sphv_estimate bonet_lok(const sphv_profile *profile, const sphv_neighbourhood *around,
                               const double *field)
{
    double d = 0, d_slope = 0, value, slope, numerator = 0, moment = 0, size = 0;
    for (int b = 0; b < around->count; b++) {
        kernel_at(profile, around, b, &value, &slope);
        d += value * around->volume[b];
        d_slope += slope * around->volume[b];
    }
    for (int b = 0; b < around->count; b++) {
        kernel_at(profile, around, b, &value, &slope);
        double gradient = (value * d_slope - slope * d) / (d * d) * around->volume[b];
        numerator += (field[b] - field[around->self]) * gradient;
        moment += around->s[b] * gradient;
        size += fabs(around->s[b] * gradient);
    }
    // The condition of a 1 × 1 moment that is a sum: how much of it cancels.
    return judge(numerator / moment, moment == 0 ? INFINITY : size / fabs(moment));
}

/// Inverts a symmetric matrix by elimination with pivoting; false when it is singular.
static bool invert(int n, double m[MATRIX][MATRIX], double inverse[MATRIX][MATRIX])
{
    double a[MATRIX][2 * MATRIX] = {{0}};
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) a[i][j] = m[i][j];
        a[i][n + i] = 1;
    }
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(a[i][k]) > fabs(a[pivot][k])) pivot = i;
        if (a[pivot][k] == 0 || !isfinite(a[pivot][k])) return false;
        for (int j = 0; j < 2 * n; j++) {
            double swap = a[k][j];
            a[k][j] = a[pivot][j];
            a[pivot][j] = swap;
        }
        for (int i = 0; i < n; i++) {
            double factor = i == k ? 0 : a[i][k] / a[k][k];
            for (int j = 0; j < 2 * n; j++) a[i][j] -= factor * a[k][j];
        }
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) inverse[i][j] = a[i][n + j] / a[i][i];
    return true;
}

static double norm(int n, double m[MATRIX][MATRIX])
{
    double largest = 0;
    for (int j = 0; j < n; j++) {
        double column = 0;
        for (int i = 0; i < n; i++) column += fabs(m[i][j]);
        largest = fmax(largest, column);
    }
    return largest;
}

/// Eq. 26 of any order: f(x) = P(0)ᵀ M(x)⁻¹ b(x) and its derivative, M and b differentiated.
static sphv_estimate moving_least_squares(int order, const sphv_profile *profile,
                                          const sphv_neighbourhood *around, const double *field)
{
    int n = order + 1;
    double m[MATRIX][MATRIX] = {{0}}, dm[MATRIX][MATRIX] = {{0}};
    double b[MATRIX] = {0}, db[MATRIX] = {0}, inverse[MATRIX][MATRIX];
    for (int p = 0; p < around->count; p++) {
        double s = around->s[p], value, slope, power[2 * ORDER_MAX + 1] = {1};
        double difference = field[p] - field[around->self];
        kernel_at(profile, around, p, &value, &slope);
        value *= around->volume[p];
        slope *= around->volume[p];
        for (int k = 1; k <= 2 * order; k++) power[k] = power[k - 1] * s;
        for (int i = 0; i < n; i++) {
            double d_i = -(slope * power[i] + (i ? i * value * power[i - 1] : 0));
            b[i] += difference * value * power[i];
            db[i] += difference * d_i;
            for (int j = 0; j < n; j++) {
                int k = i + j;
                m[i][j] += value * power[k];
                dm[i][j] -= slope * power[k] + (k ? k * value * power[k - 1] : 0);
            }
        }
    }
    if (!invert(n, m, inverse)) return judge(NAN, INFINITY);
    double gradient = 0;
    for (int i = 0; i < n; i++) {
        double a = 0;
        for (int j = 0; j < n; j++) a += inverse[i][j] * b[j];
        gradient += inverse[0][i] * db[i];
        for (int j = 0; j < n; j++) gradient -= inverse[0][j] * dm[j][i] * a;
    }
    return judge(gradient, norm(n, m) * norm(n, inverse));
}

sphv_estimate sphv_estimate_gradient(sphv_method method, const sphv_profile *profile,
                                     const sphv_neighbourhood *around, const double *field)
{
    switch (method) {
    case SPHV_SPH:
        return standard(profile, around, field);
    case SPHV_BONET_LOK:
        return bonet_lok(profile, around, field);
    case SPHV_SHEPARD:
    case SPHV_RKPM_0:
        return moving_least_squares(0, profile, around, field);
    case SPHV_RKPM:
        return moving_least_squares(1, profile, around, field);
    case SPHV_RKPM_2:
        return moving_least_squares(2, profile, around, field);
    case SPHV_SPH_DIFFERENCE:
    case SPHV_CSPM:
    case SPHV_FPM:
    case SPHV_MSPH:
        break;
    }
    return judge(NAN, INFINITY);
}

double sphv_phase_error(const sphv_experiment *experiment, const sphv_neighbourhood *around,
                        sphv_phase phase, double *field, sphv_estimate *estimate)
{
    double K = 2 * M_PI * experiment->h;
    for (int b = 0; b < around->count; b++)
        field[b] = phase == SPHV_PHASE_SINE ? sin(K * around->s[b]) : cos(K * around->s[b]);
    *estimate = sphv_estimate_gradient(experiment->method, experiment->profile, around, field);
    return estimate->gradient / K - (phase == SPHV_PHASE_SINE ? 1 : 0);
}
