#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>

#include "boundary_internal.h"
#include "core/quadrature.h"

// On the lattice a measure is Σ_m of the Fourier transform of its radial average g at 2π|m|/Δs
// (Poisson), m = 0 the continuum's value. Perturbed, each neighbour's summand z depends on its own
// displacement and the particle's: given the latter the summands are independent, so that mean and
// variance are sums of expectations over one displacement.

const sphv_name_row sphv_consistency_measures[] = {
    {"normalisation", "sum of W V less 1 (eqs. 10, 14)"},
    {"centre", "sum of s W V (eq. 16, l = 1)"},
    {"spread", "sum of s^2 W V: the intrinsic diffusion over h^2 (eqs. 18, 20)"},
    {"flatness", "sum of h grad W V (eq. 22, l = 0)"},
    {"rotation", "sum of x grad W V less 1, on the diagonal (eq. 27)"},
    {"shear", "sum of x grad W V off the diagonal (eq. 27)"},
    {NULL, NULL},
};

enum { Z = SPHV_CONSISTENCY_MEASURES, NODES = 4, WINDOW = 5 };

static double value_average(const sphv_profile *profile, double q)
{
    return sphv_profile_derivative(profile, 0, q).value;
}

static double spread_average(const sphv_profile *profile, double q)
{
    return q * q / profile->dimension * sphv_profile_derivative(profile, 0, q).value;
}

static double rotation_average(const sphv_profile *profile, double q)
{
    return -q / profile->dimension * sphv_profile_derivative(profile, 1, q).value;
}

/// The modes with max|m_i| = shell: their sum, and a bound of its error. \param size  of the moduli
static sphv_result shell_sum(const sphv_profile *profile, sphv_radial_function radial,
                             double spacing, int shell, double *size)
{
    int d = profile->dimension;
    sphv_result sum = {0, 0};
    *size = 0;
    for (int y = 0; y <= (d > 1 ? shell : 0); y++)
        for (int z = 0; z <= (d > 2 ? y : 0); z++) {
            // Points with these moduli in any order and sign.
            double count = 1 << (1 + (y > 0) + (z > 0));
            if (d == 2) count *= y == shell ? 1 : 2;
            if (d == 3) count *= z == shell ? 1 : y == shell || y == z ? 3 : 6;
            double norm = sqrt((double)shell * shell + (double)(y * y + z * z));
            sphv_result mode = sphv_radial_transform(profile, radial, 2 * M_PI * norm / spacing);
            sum.value += count * mode.value;
            sum.bound += count * mode.bound;
            *size += count * fabs(mode.value);
        }
    return sum;
}

/// The aliases m ≠ 0, and a bound of those beyond the last shell. \pre β >= 2
static sphv_result alias_sum(const sphv_profile *profile, sphv_radial_function radial,
                             double spacing)
{
    const int last = profile->dimension == 3 ? 10 : 40;
    sphv_result sum = {0, 0};
    // A transform has zeros, so that one small shell does not mean that the next ones are.
    double sizes[WINDOW], largest = INFINITY, doubt = 0;
    int shell = 0;
    while (shell < last && largest > doubt) {
        double *size = &sizes[shell % WINDOW];
        sphv_result part = shell_sum(profile, radial, spacing, ++shell, size);
        sum.value += part.value;
        sum.bound += part.bound;
        doubt = part.bound;
        if (shell < WINDOW) continue;
        largest = 0;
        for (int i = 0; i < WINDOW; i++) largest = fmax(largest, sizes[i]);
    }
    // β >= 2 makes the modes of −qŴ′, the slowest of all, fall like m^−(2 + (d + 1)/2), shells of
    // 2d (2m)^(d−1) of them at least like m^−2: Σ_{m>M} (M/m)² < M.
    sum.bound += shell * (largest + doubt);
    return sum;
}

/// The summands at s, each v times; h∂_iW = p_1 s_i.
static void summands(const sphv_profile *profile, const double *s, double out[Z])
{
    double square = 0, p[SPHV_RADIALS];
    for (int i = 0; i < profile->dimension; i++) square += s[i] * s[i];
    double q = sqrt(square), other = profile->dimension > 1 ? s[1] : 0;
    for (int z = 0; z < Z; z++) out[z] = 0;
    if (q >= profile->support) return;
    sphv_radial_functions(profile, q, p);
    out[SPHV_NORMALISATION] = p[0];
    out[SPHV_CENTRE] = p[0] * s[0];
    out[SPHV_SPREAD] = p[0] * s[0] * s[0];
    out[SPHV_FLATNESS] = p[1] * s[0];
    out[SPHV_ROTATION] = -p[1] * s[0] * s[0];
    out[SPHV_SHEAR] = -p[1] * s[0] * other;
}

/// |∇z|² averaged over directions.
static void mean_slopes(const sphv_profile *profile, double q, double out[Z])
{
    double d = profile->dimension, p[SPHV_RADIALS];
    sphv_radial_functions(profile, q, p);
    double w = p[0], p1 = p[1], slope = p[1] * q, p2 = p[2]; // p2: q² p_2
    double two = q * q / d, four = 3 * gsl_pow_4(q) / (d * (d + 2)), mixed = four / 3;
    double over = q > 0 ? 1 / (q * q) : 0;
    out[SPHV_NORMALISATION] = slope * slope;
    out[SPHV_CENTRE] = w * w + 2 * two * w * p1 + two * slope * slope;
    out[SPHV_SPREAD] = 4 * two * w * w + 4 * four * w * p1 + four * slope * slope;
    out[SPHV_FLATNESS] = ((d - 1) * p1 * p1 + gsl_pow_2(p1 + p2)) / d;
    out[SPHV_ROTATION] = 4 * p1 * p1 * two + four * over * (4 * p1 * p2 + p2 * p2);
    out[SPHV_SHEAR] = d == 1 ? 0 : 2 * p1 * p1 * two + mixed * over * (4 * p1 * p2 + p2 * p2);
}

struct slope_context {
    const sphv_profile *profile;
    int measure;
};

static double slope_integrand(double q, void *context)
{
    const struct slope_context *of = context;
    static const double surface[SPHV_DIMENSIONS] = {2, 2 * M_PI, 4 * M_PI};
    double slopes[Z];
    mean_slopes(of->profile, q, slopes);
    return surface[of->profile->dimension - 1] * gsl_pow_int(q, of->profile->dimension - 1) *
           slopes[of->measure];
}

/// A perturbation of one coordinate as nodes and weights.
struct jitter_rule {
    int count;
    double at[NODES], weight[NODES];
};

static bool make_rule(sphv_jitter jitter, double size, int count, struct jitter_rule *out)
{
    bool normal = jitter == SPHV_JITTER_NORMAL;
    gsl_integration_fixed_workspace *rule = gsl_integration_fixed_alloc(
        normal ? gsl_integration_fixed_hermite : gsl_integration_fixed_legendre, (size_t)count,
        normal ? 0 : -size, normal ? 1 / (2 * size * size) : size, 0, 0);
    if (!rule) return false;
    double sum = 0;
    out->count = count;
    for (int i = 0; i < count; i++) {
        out->at[i] = gsl_integration_fixed_nodes(rule)[i];
        out->weight[i] = gsl_integration_fixed_weights(rule)[i];
        sum += out->weight[i];
    }
    for (int i = 0; i < count; i++) out->weight[i] /= sum;
    gsl_integration_fixed_free(rule);
    return true;
}

/// The node of a rule in all coordinates; returns its weight.
static double node_of(const struct jitter_rule *rule, int d, int index, double *at)
{
    double weight = 1;
    for (int i = 0; i < d; i++, index /= rule->count) {
        at[i] = rule->at[index % rule->count];
        weight *= rule->weight[index % rule->count];
    }
    return weight;
}

/// Adds a neighbour's expectation and variance, given the particle's own displacement.
static void add_neighbour(const sphv_profile *profile, const struct jitter_rule *rule,
                          const double *place, double volume, double mean[Z], double variance[Z])
{
    int d = profile->dimension, nodes = (int)gsl_pow_int(rule->count, d);
    double first[Z] = {0}, second[Z] = {0};
    for (int node = 0; node < nodes; node++) {
        double s[SPHV_DIMENSIONS], z[Z], weight = node_of(rule, d, node, s);
        for (int i = 0; i < d; i++) s[i] += place[i];
        summands(profile, s, z);
        for (int m = 0; m < Z; m++) {
            first[m] += weight * z[m];
            second[m] += weight * z[m] * z[m];
        }
    }
    for (int m = 0; m < Z; m++) {
        mean[m] += volume * first[m];
        variance[m] += volume * volume * fmax(0, second[m] - first[m] * first[m]);
    }
}

/// Expectations and variances over all displacements.
static void perturbed(const sphv_profile *profile, double spacing, const struct jitter_rule *rule,
                      double mean[Z], double variance[Z])
{
    int d = profile->dimension, nodes = (int)gsl_pow_int(rule->count, d);
    double widest = 2 * fmax(fabs(rule->at[0]), fabs(rule->at[rule->count - 1]));
    int reach = (int)floor((profile->support + widest) / spacing), width = 2 * reach + 1;
    double volume = gsl_pow_int(spacing, d), points = gsl_pow_int(width, d), square[Z] = {0};
    for (int m = 0; m < Z; m++) mean[m] = variance[m] = 0;
    for (int node = 0; node < nodes; node++) {
        double own[SPHV_DIMENSIONS], given[Z], zero[SPHV_DIMENSIONS] = {0};
        double weight = node_of(rule, d, node, own), spread[Z] = {0};
        summands(profile, zero, given);
        for (int m = 0; m < Z; m++) given[m] *= volume;
        for (double point = 0; point < points; point++) {
            double place[SPHV_DIMENSIONS], left = point;
            bool self = true;
            for (int i = 0; i < d; i++, left = floor(left / width)) {
                double line = fmod(left, width) - reach;
                self = self && line == 0;
                place[i] = line * spacing - own[i];
            }
            if (!self) add_neighbour(profile, rule, place, volume, given, spread);
        }
        for (int m = 0; m < Z; m++) {
            mean[m] += weight * given[m];
            square[m] += weight * given[m] * given[m];
            variance[m] += weight * spread[m];
        }
    }
    for (int m = 0; m < Z; m++) variance[m] += fmax(0, square[m] - mean[m] * mean[m]);
    mean[SPHV_NORMALISATION] -= 1;
    mean[SPHV_ROTATION] -= 1;
}

/// By Poisson's formula.
static void predict_aliases(const sphv_profile *profile, double spacing, sphv_consistency *out)
{
    int d = profile->dimension;
    if (profile->boundary_smoothness < 2) {
        for (int m = 0; m < Z; m++) out->aliases[m].bound = INFINITY;
        return;
    }
    out->aliases[SPHV_NORMALISATION] = alias_sum(profile, value_average, spacing);
    out->aliases[SPHV_NORMALISATION].value += profile->excess;
    out->aliases[SPHV_ROTATION] = alias_sum(profile, rotation_average, spacing);
    out->aliases[SPHV_ROTATION].value += profile->slope_excess;
    sphv_result spread = alias_sum(profile, spread_average, spacing);
    spread.value += profile->moment[2].value / d;
    spread.bound += profile->moment[2].bound / d;
    out->aliases[SPHV_SPREAD] = spread;
}

/// By the lattice's moments.
static sphv_status predict_moments(const sphv_profile *profile, double spacing,
                                   sphv_consistency *out, sphv_error *error)
{
    sphv_octants octants;
    sphv_status status = sphv_octants_make(profile, spacing, 1, 2, &octants, error);
    if (status != SPHV_OK) return status;
    double numbers[SPHV_RADIALS][10];
    double *const moment[SPHV_RADIALS] = {numbers[0], numbers[1], NULL};
    int reach[SPHV_DIMENSIONS] = {octants.reach, octants.reach, octants.reach};
    size_t square = sphv_monomial_index(profile->dimension, (int[SPHV_DIMENSIONS]){2, 0, 0});
    sphv_octants_moments(&octants, reach, reach, moment);
    double bound[2] = {octants.rounding * octants.size[0], octants.rounding * octants.size[1]};
    double limit = profile->support;
    out->lattice[SPHV_NORMALISATION] = (sphv_result){moment[0][0] - 1, bound[0] + SPHV_U};
    out->lattice[SPHV_SPREAD] = (sphv_result){moment[0][square], bound[0] * limit * limit};
    out->lattice[SPHV_ROTATION] = (sphv_result){-moment[1][square] - 1, bound[1] * limit + SPHV_U};
    sphv_octants_free(&octants);
    return SPHV_OK;
}

static double count_neighbours(const sphv_profile *profile, double spacing)
{
    double reach = floor(profile->support / spacing), count = 0;
    double limit = gsl_pow_2(profile->support / spacing);
    bool deep = profile->dimension > 2, wide = profile->dimension > 1;
    for (double z = deep ? -reach : 0; z <= (deep ? reach : 0); z++)
        for (double y = wide ? -reach : 0; y <= (wide ? reach : 0); y++) {
            double left = limit - y * y - z * z;
            if (left <= 0) continue;
            // x² < left
            count += 2 * (ceil(sqrt(left)) - 1) + 1;
        }
    return count;
}

sphv_status sphv_predict_consistency(const sphv_profile *profile, double spacing,
                                     sphv_jitter jitter, double amplitude, sphv_consistency *out,
                                     sphv_error *error)
{
    *out = (sphv_consistency){0};
    if (!(spacing >= 1e-3 * profile->support && spacing < profile->support))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "a spacing of %g smoothing lengths; allowed: %g to %g", spacing,
                         1e-3 * profile->support, profile->support);
    if (!(amplitude >= 0 && amplitude <= 0.5))
        return sphv_fail(error, SPHV_INVALID_INPUT, "amplitude is %g; allowed: 0 to 0.5",
                         amplitude);
    out->neighbours = count_neighbours(profile, spacing);
    sphv_status status = predict_moments(profile, spacing, out, error);
    if (status != SPHV_OK) return status;
    predict_aliases(profile, spacing, out);
    for (int m = 0; m < Z; m++) out->mean[m] = out->lattice[m];
    if (amplitude == 0) return SPHV_OK;
    struct jitter_rule fine, coarse;
    double mean[2][Z], variance[2][Z];
    if (!make_rule(jitter, amplitude * spacing, NODES, &fine) ||
        !make_rule(jitter, amplitude * spacing, NODES - 1, &coarse))
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for a perturbation");
    perturbed(profile, spacing, &fine, mean[0], variance[0]);
    perturbed(profile, spacing, &coarse, mean[1], variance[1]);
    double deviation = jitter == SPHV_JITTER_NORMAL ? amplitude : amplitude / sqrt(3);
    for (int m = 0; m < Z; m++) {
        struct slope_context slopes = {profile, m};
        double sum = 0;
        for (int i = 0; i < profile->piece_count; i++)
            sum += sphv_quadrature(slope_integrand, &slopes, profile->pieces[i].inner,
                                   profile->pieces[i].outer, 0.5)
                       .value;
        out->leading_deviation[m] =
            deviation * pow(spacing, 1 + 0.5 * profile->dimension) * sqrt(sum);
        // The rules' difference, of which the finer's own error is a small part; summation.
        double rounding = 1e3 * SPHV_U;
        out->mean[m] = (sphv_result){mean[0][m], fabs(mean[0][m] - mean[1][m]) + rounding};
        out->deviation[m].value = sqrt(variance[0][m]);
        out->deviation[m].bound = fabs(sqrt(variance[0][m]) - sqrt(variance[1][m])) + rounding;
    }
    return SPHV_OK;
}
