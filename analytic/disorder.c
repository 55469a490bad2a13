#include "disorder.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>
#include <stdlib.h>
#include <string.h>

enum { NODES = 16, OWN_NODES = 8 };

/// Lower triangular root of a covariance, columns of vanished pivots left zero.
static void root(const sphv_sums *sums, double l[SPHV_SUMS_MAX][SPHV_SUMS_MAX])
{
    memset(l, 0, SPHV_SUMS_MAX * sizeof *l);
    for (int j = 0; j < sums->count; j++) {
        double pivot = sums->covariance[j][j];
        for (int k = 0; k < j; k++) pivot -= l[j][k] * l[j][k];
        if (!(pivot > 1e-12 * sums->covariance[j][j])) continue;
        l[j][j] = sqrt(pivot);
        for (int i = j + 1; i < sums->count; i++) {
            double sum = sums->covariance[i][j];
            for (int k = 0; k < j; k++) sum -= l[i][k] * l[j][k];
            l[i][j] = sum / l[j][j];
        }
    }
}

/// The error at mean + a·column i + b·column j.
static double error_at(sphv_method method, double K, sphv_phase phase, const sphv_sums *sums,
                       double l[SPHV_SUMS_MAX][SPHV_SUMS_MAX], int i, double a, int j, double b)
{
    double point[SPHV_SUMS_MAX];
    for (int k = 0; k < sums->count; k++) point[k] = sums->mean[k] + a * l[k][i] + b * l[k][j];
    return sphv_sums_error(method, K, phase, point);
}

/// Relative variance of the denominator, linearised.
static double fluctuation(sphv_method method, const sphv_sums *sums,
                          double l[SPHV_SUMS_MAX][SPHV_SUMS_MAX])
{
    double middle = sphv_sums_denominator(method, sums->mean), variance = 0;
    for (int i = 0; i < sums->count; i++) {
        double plus[SPHV_SUMS_MAX], minus[SPHV_SUMS_MAX];
        for (int k = 0; k < sums->count; k++) {
            plus[k] = sums->mean[k] + 1e-4 * l[k][i];
            minus[k] = sums->mean[k] - 1e-4 * l[k][i];
        }
        double slope =
            (sphv_sums_denominator(method, plus) - sphv_sums_denominator(method, minus)) / 2e-4;
        variance += slope * slope;
    }
    return variance / (middle * middle);
}

/// The square's mean over a normal distribution by the 2n² + 1 point rule of degree 5 (Stroud
/// 1971, E_n^r² 5-2): exact through the fourth order in the fluctuations.
sphv_mean_square sphv_sums_mean_square(sphv_method method, double K, sphv_phase phase,
                                       const sphv_sums *sums)
{
    int n = sums->count;
    double l[SPHV_SUMS_MAX][SPHV_SUMS_MAX], variance = 0;
    root(sums, l);
    double middle = sphv_sums_error(method, K, phase, sums->mean);
    double far = sqrt(n + 2.0), near = sqrt((n + 2.0) / 2);
    double axis = (4.0 - n) / (2 * (n + 2.0) * (n + 2.0)), plane = 1 / ((n + 2.0) * (n + 2.0));
    double sum = 2 / (n + 2.0) * middle * middle;
    for (int i = 0; i < n; i++) {
        double plus = error_at(method, K, phase, sums, l, i, far, i, 0);
        double minus = error_at(method, K, phase, sums, l, i, -far, i, 0);
        double slope = (error_at(method, K, phase, sums, l, i, 1e-4, i, 0) -
                        error_at(method, K, phase, sums, l, i, -1e-4, i, 0)) /
                       2e-4;
        variance += slope * slope;
        sum += axis * (plus * plus + minus * minus);
        for (int j = 0; j < i; j++)
            for (int sign = 0; sign < 4; sign++) {
                double value = error_at(method, K, phase, sums, l, i, sign & 1 ? near : -near, j,
                                        sign & 2 ? near : -near);
                sum += plane * value * value;
            }
    }
    sphv_mean_square result = {sum, middle * middle + variance, fluctuation(method, sums, l)};
    // A linear error needs no rule, and the rule's negative weights are best avoided then.
    if (sphv_methods[method].unknowns[0] == 0 || !(sum > 0)) result.value = result.linear;
    return result;
}

/// ∂Ŵ/∂s at a signed offset.
static double slope_at(const sphv_profile *profile, double s)
{
    if (s == 0 || !(fabs(s) < profile->support)) return 0;
    return (s < 0 ? -1 : 1) * sphv_profile_derivative(profile, 1, fabs(s)).value;
}

/// ∂z/∂s by central differences of a summand, with a step small against the knots' distances.
static void summand_slope(const sphv_experiment *of, double K, sphv_phase phase, double s,
                          double *slope)
{
    double plus[SPHV_SUMS_MAX] = {0}, minus[SPHV_SUMS_MAX] = {0}, step = 1e-5;
    if (fabs(s + step) < of->profile->support)
        sphv_sums_summand(of->method, of->profile, K, phase, s + step, plus);
    if (fabs(s - step) < of->profile->support)
        sphv_sums_summand(of->method, of->profile, K, phase, s - step, minus);
    for (int i = 0; i < sphv_sums_count(of->method); i++)
        slope[i] = (plus[i] - minus[i]) / (2 * step);
}

/// ∂(V_b/h)/∂s_j on the lattice, for particles `b` and `j` counted from the one at the origin.
static double volume_slope(const sphv_experiment *of, double density, int b, int j)
{
    double spacing = of->spacing.value;
    switch (of->volume) {
    case SPHV_VOLUME_TESSELLATED:
        return j == b + 1 ? 0.5 : j == b - 1 ? -0.5 : 0;
    case SPHV_VOLUME_DENSITY: // V = 1/Σ Ŵ(s_c − s_b), whose own slope vanishes by symmetry
        return b == j ? 0 : -slope_at(of->profile, (j - b) * spacing) / (density * density);
    default:
        return 0;
    }
}

void sphv_sums_first_order(const sphv_experiment *experiment, double K, sphv_phase phase,
                           sphv_sums *out)
{
    const sphv_experiment *of = experiment;
    double spacing = of->spacing.value, density = 0, z[SPHV_SUMS_MAX], slope[SPHV_SUMS_MAX];
    int n = sphv_sums_count(of->method), side = (int)ceil(of->profile->support / spacing);
    for (int c = -side; c <= side; c++)
        density += sphv_profile_derivative(of->profile, 0, fabs(c * spacing)).value;
    double volume = of->volume == SPHV_VOLUME_DENSITY ? 1 / density : spacing;
    double own[SPHV_SUMS_MAX] = {0};
    memset(out, 0, sizeof *out);
    out->count = n;
    for (int j = -2 * side - 1; j <= 2 * side + 1; j++) {
        double response[SPHV_SUMS_MAX] = {0};
        for (int b = -side; b <= side; b++) {
            if (!(fabs(b * spacing) < of->profile->support)) continue;
            double change = volume_slope(of, density, b, j);
            if (change == 0) continue;
            sphv_sums_summand(of->method, of->profile, K, phase, b * spacing, z);
            for (int i = 0; i < n; i++) response[i] += z[i] * change;
        }
        if (j != 0 && abs(j) <= side) {
            summand_slope(of, K, phase, j * spacing, slope);
            for (int i = 0; i < n; i++) {
                response[i] += slope[i] * volume;
                own[i] -= slope[i] * volume; // moving the particle moves all offsets the other way
            }
        }
        if (abs(j) <= side && fabs(j * spacing) < of->profile->support) {
            sphv_sums_summand(of->method, of->profile, K, phase, j * spacing, z);
            for (int i = 0; i < n; i++) out->mean[i] += z[i] * volume;
        }
        if (j == 0) { // kept until all offsets are known
            for (int i = 0; i < n; i++) own[i] += response[i];
            continue;
        }
        for (int i = 0; i < n; i++)
            for (int k = 0; k < n; k++) out->covariance[i][k] += response[i] * response[k];
    }
    double variance = of->sigma * spacing * of->sigma * spacing;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++)
            out->covariance[i][k] = variance * (out->covariance[i][k] + own[i] * own[k]);
}

/// Gauss–Hermite nodes and weights for the standard normal distribution.
static bool normal_rule(int count, double *nodes, double *weights)
{
    gsl_integration_fixed_workspace *rule =
        gsl_integration_fixed_alloc(gsl_integration_fixed_hermite, (size_t)count, 0, 0.5, 0, 0);
    if (!rule) return false;
    for (int i = 0; i < count; i++) {
        nodes[i] = gsl_integration_fixed_nodes(rule)[i];
        weights[i] = gsl_integration_fixed_weights(rule)[i] / sqrt(2 * M_PI);
    }
    gsl_integration_fixed_free(rule);
    return true;
}

static void add(sphv_mean_square *to, double weight, sphv_mean_square part)
{
    to->value += weight * part.value;
    to->linear += weight * part.linear;
    to->fluctuation += weight * part.fluctuation;
}

/// E[(error/max|A′|)²] averaged over the field's phase, from conditional means and covariances.
static sphv_mean_square mean_square(const sphv_experiment *of, double K, int node_count,
                                    int own_count)
{
    double nodes[NODES], weights[NODES], own[NODES], own_weights[NODES];
    sphv_mean_square sum = {0, 0, 0};
    if (!normal_rule(node_count, nodes, weights) || !normal_rule(own_count, own, own_weights))
        return (sphv_mean_square){NAN, NAN, NAN};
    for (int phase = SPHV_PHASE_SINE; phase <= SPHV_PHASE_COSINE; phase++)
        for (int k = 0; k < own_count; k++) {
            sphv_sums sums;
            sphv_sums_conditional(of, K, (sphv_phase)phase, own[k], nodes, weights, node_count,
                                  &sums);
            add(&sum, 0.5 * own_weights[k],
                sphv_sums_mean_square(of->method, K, (sphv_phase)phase, &sums));
        }
    return sum;
}

static sphv_mean_square density_mean_square(const sphv_experiment *of, double K)
{
    enum { COUNT = 5 };
    double nodes[COUNT], weights[COUNT];
    sphv_mean_square sum = {0, 0, 0};
    if (!normal_rule(COUNT, nodes, weights)) return (sphv_mean_square){NAN, NAN, NAN};
    for (int phase = SPHV_PHASE_SINE; phase <= SPHV_PHASE_COSINE; phase++) {
        sphv_sums sums;
        if (!sphv_sums_main_effects(of, K, (sphv_phase)phase, nodes, weights, COUNT, &sums))
            return (sphv_mean_square){NAN, NAN, NAN};
        add(&sum, 0.5, sphv_sums_mean_square(of->method, K, (sphv_phase)phase, &sums));
    }
    return sum;
}

/// On the lattice: E for standard SPH, whose difference form is the same by symmetry, and
/// (1 + E(K))/(1 + E(0)) − 1 for Bonet and Lok's correction, whose matrix L is the inverse of the
/// estimate of a linear field, as CSPM's and FPM's are by the same symmetry.
static sphv_status predict_lattice(const sphv_experiment *of, sphv_prediction *out,
                                   sphv_error *error)
{
    sphv_status status =
        sphv_predict_lattice(of->profile, of->h, of->spacing, SPHV_FORM_EXACT, out, error);
    if (status != SPHV_OK || sphv_methods[of->method].unknowns[0] == 0) return status;
    sphv_prediction linear;
    status = sphv_predict_lattice(of->profile, 1e-9, of->spacing, SPHV_FORM_EXACT, &linear, error);
    if (status != SPHV_OK) return status;
    double slope = 1 + linear.total.value;
    out->total.value = (out->total.value - linear.total.value) / slope;
    out->total.bound =
        (out->total.bound + linear.total.bound * (1 + fabs(out->total.value))) / fabs(slope);
    out->l2 = (sphv_result){fabs(out->total.value) / M_SQRT2, out->total.bound / M_SQRT2};
    out->smoothing = out->discretisation = (sphv_result){NAN, INFINITY};
    return SPHV_OK;
}

sphv_status sphv_predict_disorder(const sphv_experiment *experiment, sphv_prediction *out,
                                  sphv_error *error)
{
    const sphv_experiment *of = experiment;
    sphv_status status = sphv_experiment_check(of, error);
    if (status != SPHV_OK) return status;
    if (of->layout != SPHV_LATTICE && of->layout != SPHV_PERTURBED)
        return sphv_fail(error, SPHV_NO_CLOSED_FORM,
                         "no theory for layout '%s'; allowed: lattice, perturbed",
                         sphv_layouts[of->layout].name);
    memset(out, 0, sizeof *out);
    if (of->sigma == 0 && of->volume != SPHV_VOLUME_DENSITY &&
        (sphv_methods[of->method].unknowns[0] == 0 || of->method == SPHV_BONET_LOK ||
         of->method == SPHV_CSPM || of->method == SPHV_FPM))
        return predict_lattice(of, out, error);
    double K = 2 * M_PI * of->h;
    sphv_mean_square found;
    // Third and fourth cumulants of the sums enter with the denominator's relative variance.
    double neglected;
    if (of->volume == SPHV_VOLUME_DENSITY) {
        found = density_mean_square(of, K);
        // What two perturbations do together is of relative order σ². The factor is an estimate,
        // from Monte Carlo over the figures' ranges, and no proof.
        neglected = 20 * gsl_pow_2(of->sigma) * fmax(1, gsl_pow_2(of->spacing.value)) * found.value;
    } else {
        found = mean_square(of, K, NODES, OWN_NODES);
        sphv_mean_square coarse = mean_square(of, K, NODES - 4, OWN_NODES - 2);
        // Particles change places with probability Φ(−Δx/(σ√2)) at either side of each.
        double swaps = 2 * gsl_cdf_ugaussian_P(-1 / (of->sigma * M_SQRT2 + 1e-300));
        neglected = fabs(found.value - coarse.value) +
                    (of->volume == SPHV_VOLUME_TESSELLATED ? 4 * swaps * found.value : 0);
    }
    // Fluctuations that reach a singular moment matrix leave no expansion to trust.
    if (!(found.value < 2 * found.linear && found.value > 0.25 * found.linear)) {
        found.value = found.linear;
        neglected = found.linear;
    }
    neglected += fabs(found.value - found.linear) + 4 * found.fluctuation * found.value;
    out->smoothing = out->discretisation = out->total = (sphv_result){NAN, INFINITY};
    out->l2.value = sqrt(found.value);
    out->l2.bound = neglected / (2 * out->l2.value) + 1e-12 * out->l2.value;
    out->rigour = SPHV_RIGOUR_STATISTICAL;
    return SPHV_OK;
}
