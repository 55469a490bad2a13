#include <gsl/gsl_math.h>
#include <string.h>

#include "disorder.h"

static int order_of(sphv_method method)
{
    return method == SPHV_RKPM ? 1 : method == SPHV_RKPM_2 ? 2 : 0;
}

double sphv_disorder_reach(const sphv_experiment *experiment)
{
    return experiment->profile->support * (experiment->sigma == 0 ? 1 - 1e-12 : 1);
}

int sphv_sums_count(sphv_method method)
{
    int order = order_of(method);
    switch (method) {
    case SPHV_SPH:
    case SPHV_SPH_DIFFERENCE:
        return 1;
    case SPHV_CSPM:
        return 2;
    case SPHV_BONET_LOK:
    case SPHV_FPM:
        return 6;
    case SPHV_MSPH:
        return 12;
    default:
        return 2 * (2 * order + 1) + 2 * (order + 1);
    }
}

/// sin x − x and cos x − 1 + x²/2 without cancellation.
static double sine_beyond_linear(double x)
{
    double t = x * x;
    if (t > 0.5) return sin(x) - x;
    return -x * t / 6 * (1 - t / 20 * (1 - t / 42 * (1 - t / 72 * (1 - t / 110 * (1 - t / 156)))));
}

static double cosine_beyond_square(double x)
{
    double t = x * x;
    if (t > 0.5) return cos(x) - 1 + t / 2;
    return t * t / 24 * (1 - t / 30 * (1 - t / 56 * (1 - t / 90 * (1 - t / 132 * (1 - t / 182)))));
}

/// The field less the polynomial that the method reproduces exactly: the estimate of that part
/// carries no error, so only the rest needs to be summed.
static double rest_of_field(sphv_method method, sphv_phase phase, double x)
{
    int consistency = sphv_methods[method].consistency;
    if (phase == SPHV_PHASE_SINE) return consistency >= 1 ? sine_beyond_linear(x) : sin(x);
    if (consistency >= 2) return cosine_beyond_square(x);
    return consistency >= 0 ? -2 * sin(x / 2) * sin(x / 2) : cos(x);
}

/// The tests W, W′ and W″ times s^j, then times the field. A kernel with a kink at 0 has no W″
/// there, and the particle's own share counts as 0.
static void taylor_summand(const sphv_profile *profile, double w, double g, double s, double t,
                           double *z)
{
    bool kink = s == 0 && sphv_profile_derivative(profile, 1, 0).value != 0;
    double test[3] = {w, g, kink ? 0 : sphv_profile_derivative(profile, 2, fabs(s)).value};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) z[3 * i + j] = test[i] * gsl_pow_int(s, j);
        z[9 + i] = test[i] * t;
    }
}

void sphv_sums_summand(sphv_method method, const sphv_profile *profile, double K, sphv_phase phase,
                       double s, double *z)
{
    double distance = fabs(s), t = rest_of_field(method, phase, K * s);
    double w = sphv_profile_derivative(profile, 0, distance).value;
    double g = s == 0 ? 0 : (s < 0 ? -1 : 1) * sphv_profile_derivative(profile, 1, distance).value;
    switch (method) {
    case SPHV_SPH:
    case SPHV_SPH_DIFFERENCE:
        z[0] = t * g;
        return;
    case SPHV_CSPM:
        z[0] = s * g;
        z[1] = t * g;
        return;
    case SPHV_BONET_LOK:
    case SPHV_FPM:
        memcpy(z, (double[6]){w, g, t * g, t * w, s * g, s * w}, 6 * sizeof *z);
        return;
    case SPHV_MSPH:
        taylor_summand(profile, w, g, s, t, z);
        return;
    default:
        break;
    }
    int order = order_of(method), n = 0;
    for (int k = 0; k <= 2 * order; k++) z[n++] = w * gsl_pow_int(s, k);
    for (int k = 0; k <= 2 * order; k++) z[n++] = g * gsl_pow_int(s, k);
    for (int k = 0; k <= order; k++) z[n++] = t * w * gsl_pow_int(s, k);
    for (int k = 0; k <= order; k++) z[n++] = t * g * gsl_pow_int(s, k);
}

/// Solves a small system in place by elimination with pivoting; not finite when it is singular.
/// Kernels with negative parts can make the moment matrix indefinite.
static void solve(int n, double m[3][3], double *x)
{
    double a[3][3];
    memcpy(a, m, sizeof a);
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(a[i][k]) > fabs(a[pivot][k])) pivot = i;
        for (int j = 0; j < n; j++) {
            double other = a[k][j];
            a[k][j] = a[pivot][j];
            a[pivot][j] = other;
        }
        double right = x[k];
        x[k] = x[pivot];
        x[pivot] = right;
        for (int i = k + 1; i < n; i++) {
            double factor = a[i][k] / a[k][k];
            for (int j = k; j < n; j++) a[i][j] -= factor * a[k][j];
            x[i] -= factor * x[k];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) x[i] -= a[i][k] * x[k];
        x[i] /= a[i][i];
    }
}

/// h·d/dx [P(0)ᵀ M⁻¹ b] with M_ij = Σ Ŵ s^(i+j) V, b_i = Σ T Ŵ s^i V and s = (x_b − x)/h.
static double moving_least_squares(int order, const double *sums)
{
    const double *w = sums, *g = w + 2 * order + 1, *tw = g + 2 * order + 1, *tg = tw + order + 1;
    double m[3][3], dm[3][3], c[3] = {1, 0, 0}, a[3], gradient = 0;
    for (int i = 0; i <= order; i++) {
        for (int j = 0; j <= order; j++) {
            m[i][j] = w[i + j];
            dm[i][j] = -g[i + j] - (i + j ? (i + j) * w[i + j - 1] : 0);
        }
        a[i] = tw[i];
    }
    solve(order + 1, m, c);
    solve(order + 1, m, a);
    for (int i = 0; i <= order; i++) {
        gradient += c[i] * (-tg[i] - (i ? i * tw[i - 1] : 0));
        for (int j = 0; j <= order; j++) gradient -= c[i] * dm[i][j] * a[j];
    }
    return gradient;
}

/// Determinant of three rows of three.
static double determinant(const double *row)
{
    const double *a = row, *b = row + 3, *c = row + 6;
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// h·A′ of Σ_j c_j Σ (test) s^j/j! V = Σ (test) T V for the tests W, W′ and W″.
static double taylor(const double *sums)
{
    double m[3][3], x[3] = {sums[9], sums[10], sums[11]};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) m[i][j] = sums[3 * i + j] * (j == 2 ? 0.5 : 1);
    solve(3, m, x);
    return x[1];
}

double sphv_sums_denominator(sphv_method method, const double *sums)
{
    const double *w = sums;
    switch (method) {
    case SPHV_CSPM:
        return w[0];
    case SPHV_BONET_LOK:
    case SPHV_FPM:
        return w[5] * w[1] - w[4] * w[0];
    case SPHV_MSPH:
        return determinant(w);
    case SPHV_SHEPARD:
    case SPHV_RKPM_0:
        return w[0];
    case SPHV_RKPM:
        return w[0] * w[2] - w[1] * w[1];
    case SPHV_RKPM_2:
        return determinant((double[9]){w[0], w[1], w[2], w[1], w[2], w[3], w[2], w[3], w[4]});
    default:
        return 1;
    }
}

double sphv_sums_error(sphv_method method, double K, sphv_phase phase, const double *sums)
{
    double exact = phase == SPHV_PHASE_SINE && sphv_methods[method].consistency < 1 ? K : 0;
    double estimate;
    switch (method) {
    case SPHV_SPH:
    case SPHV_SPH_DIFFERENCE:
        estimate = -sums[0];
        break;
    case SPHV_CSPM:
        estimate = sums[1] / sums[0];
        break;
    case SPHV_BONET_LOK:
    case SPHV_FPM: // in one dimension or more their gradients are the same
        estimate =
            (sums[3] * sums[1] - sums[2] * sums[0]) / (sums[5] * sums[1] - sums[4] * sums[0]);
        break;
    case SPHV_MSPH:
        estimate = taylor(sums);
        break;
    default:
        estimate = moving_least_squares(order_of(method), sums);
    }
    return (estimate - exact) / K;
}

/// What the covariances of neighbouring summands need of one particle: expectation of z over its
/// perturbation, covariances of z with the position y and with itself, and mean and variance of y.
struct expectations {
    double z[SPHV_SUMS_MAX], zy[SPHV_SUMS_MAX], zz[SPHV_SUMS_MAX][SPHV_SUMS_MAX];
    double position, variance;
};

/// Covariances are taken about the summand at the unperturbed place: E[zz] − E[z]E[z] itself would
/// be lost in rounding when σ is small.
static void expect(const sphv_experiment *of, double K, sphv_phase phase, double position,
                   double deviation, const double *nodes, const double *weights, int node_count,
                   struct expectations *out)
{
    int n = sphv_sums_count(of->method);
    memset(out, 0, sizeof *out);
    out->position = position;
    out->variance = deviation * deviation;
    if (fabs(position) - of->profile->support > deviation * fabs(nodes[0])) return;
    double middle[SPHV_SUMS_MAX] = {0}, shift[SPHV_SUMS_MAX] = {0};
    double reach = sphv_disorder_reach(of);
    if (fabs(position) < reach)
        sphv_sums_summand(of->method, of->profile, K, phase, position, middle);
    for (int k = 0; k < node_count; k++) {
        double z[SPHV_SUMS_MAX] = {0}, away = deviation * nodes[k], y = position + away;
        if (fabs(y) < reach) sphv_sums_summand(of->method, of->profile, K, phase, y, z);
        for (int i = 0; i < n; i++) {
            z[i] -= middle[i];
            shift[i] += weights[k] * z[i];
            out->zy[i] += weights[k] * z[i] * away;
            for (int j = 0; j <= i; j++) out->zz[i][j] += weights[k] * z[i] * z[j];
        }
    }
    for (int i = 0; i < n; i++) {
        out->z[i] = middle[i] + shift[i];
        for (int j = 0; j <= i; j++) out->zz[i][j] -= shift[i] * shift[j];
    }
}

/// Volumes Δx: independent summands.
static void add_lattice(int n, double spacing, const struct expectations *b, sphv_sums *out)
{
    for (int i = 0; i < n; i++) {
        out->mean[i] += spacing * b->z[i];
        for (int j = 0; j <= i; j++) out->covariance[i][j] += spacing * spacing * b->zz[i][j];
    }
}

/// Cov[z_b,i (y_{b+2} − y_b), z_{b+1},j (y_{b+1} − y_{b−1})], two products of independent factors.
static double next_covariance(const struct expectations *b, int i, double next_gap,
                              const struct expectations *r, int j, double gap)
{
    return b->z[i] * next_gap * r->zy[j] - b->zy[i] * (r->z[j] * gap + r->zy[j]);
}

/// Volumes (y_{b+1} − y_{b−1})/2: summand b depends on three perturbations, so it is correlated
/// with b, b ± 1 and b ± 2 alone. `b` points into a run with two particles more on either side.
static void add_tessellated(int n, const struct expectations *b, sphv_sums *out)
{
    const struct expectations *l = b - 1, *r = b + 1, *rr = b + 2;
    double gap = r->position - l->position, next_gap = rr->position - b->position;
    double variance = r->variance + l->variance, square = gap * gap + variance;
    for (int i = 0; i < n; i++) {
        out->mean[i] += 0.5 * b->z[i] * gap;
        for (int j = 0; j <= i; j++) {
            double own = b->zz[i][j] * square + b->z[i] * b->z[j] * variance;
            double next = next_covariance(b, i, next_gap, r, j, gap) +
                          next_covariance(b, j, next_gap, r, i, gap);
            double after = -r->variance * (b->z[i] * rr->z[j] + b->z[j] * rr->z[i]);
            out->covariance[i][j] += 0.25 * (own + next + after);
        }
    }
}

static void symmetrise(sphv_sums *sums)
{
    for (int i = 0; i < sums->count; i++)
        for (int j = 0; j < i; j++) sums->covariance[j][i] = sums->covariance[i][j];
}

void sphv_sums_conditional(const sphv_experiment *experiment, double K, sphv_phase phase,
                           double own, const double *nodes, const double *weights, int node_count,
                           sphv_sums *out)
{
    double spacing = experiment->spacing.value, sigma = experiment->sigma;
    double reach = experiment->profile->support / spacing + 2 * sigma * fabs(nodes[0]) + 1;
    int n = sphv_sums_count(experiment->method);
    bool tessellated = experiment->volume == SPHV_VOLUME_TESSELLATED;
    struct expectations run[5]; // the particles m − 2 … m + 2, for the one in the middle
    memset(out, 0, sizeof *out);
    out->count = n;
    int last = (int)ceil(reach);
    for (int m = -last - 3; m <= last + 3; m++) {
        memmove(run, run + 1, 4 * sizeof *run);
        double position = m == 0 ? 0 : (m - sigma * own) * spacing;
        expect(experiment, K, phase, position, m == 0 ? 0 : sigma * spacing, nodes, weights,
               node_count, &run[4]);
        if (m < -last + 1) continue;
        if (tessellated)
            add_tessellated(n, &run[2], out);
        else
            add_lattice(n, spacing, &run[2], out);
    }
    symmetrise(out);
}
