#include <gsl/gsl_math.h>
#include <stdlib.h>
#include <string.h>

#include "disorder.h"

/// A lattice around one particle on which single particles are moved. All positions in units of h,
/// index `middle` is the particle itself.
struct stage {
    const sphv_experiment *of;
    double K, spacing, density; ///< density: ΣŴ(s_c − s_b) on the lattice
    sphv_phase phase;
    int count, side, reach; ///< sums; neighbours on one side; particles within one support
    double (*summand)[SPHV_SUMS_MAX]; ///< z(s_b) on the lattice, b = −side … side
};

static double kernel(const struct stage *stage, double s)
{
    if (!(fabs(s) < sphv_disorder_reach(stage->of))) return 0;
    return sphv_profile_derivative(stage->of->profile, 0, fabs(s)).value;
}

static void summand_at(const struct stage *stage, double s, double *z)
{
    memset(z, 0, SPHV_SUMS_MAX * sizeof *z);
    if (fabs(s) < sphv_disorder_reach(stage->of))
        sphv_sums_summand(stage->of->method, stage->of->profile, stage->K, stage->phase, s, z);
}

/// ΣŴ seen by a particle that has moved by `shift` out of its place.
static double own_density(const struct stage *stage, double shift)
{
    double sum = kernel(stage, 0);
    for (int c = 1; c <= stage->reach; c++)
        sum +=
            kernel(stage, c * stage->spacing - shift) + kernel(stage, c * stage->spacing + shift);
    return sum;
}

/// The sums when particle j alone, counted from the one at the origin, has moved by `shift`.
static void moved_sums(const struct stage *stage, int j, double shift, double *sums)
{
    memset(sums, 0, SPHV_SUMS_MAX * sizeof *sums);
    for (int b = -stage->side; b <= stage->side; b++) {
        double place = b * stage->spacing, apart = (b - j) * stage->spacing, z[SPHV_SUMS_MAX];
        const double *of_b = stage->summand[b + stage->side];
        double density = stage->density;
        if (b == j)
            density = own_density(stage, shift);
        else if (abs(b - j) <= stage->reach)
            density += kernel(stage, apart - shift) - kernel(stage, apart);
        if (j == 0 && b != 0) {
            summand_at(stage, place - shift, z); // all offsets are seen from the moved particle
            of_b = z;
        } else if (b == j && j != 0) {
            summand_at(stage, place + shift, z);
            of_b = z;
        }
        for (int i = 0; i < stage->count; i++) sums[i] += of_b[i] / density;
    }
}

/// Adds mean and covariance of what moving particle j alone does.
static void add_effect(const struct stage *stage, int j, const double *unmoved, const double *nodes,
                       const double *weights, int node_count, sphv_sums *out)
{
    double mean[SPHV_SUMS_MAX] = {0}, square[SPHV_SUMS_MAX][SPHV_SUMS_MAX] = {{0}};
    for (int k = 0; k < node_count; k++) {
        double sums[SPHV_SUMS_MAX];
        moved_sums(stage, j, stage->of->sigma * stage->spacing * nodes[k], sums);
        for (int i = 0; i < stage->count; i++) {
            sums[i] -= unmoved[i];
            mean[i] += weights[k] * sums[i];
            for (int l = 0; l <= i; l++) square[i][l] += weights[k] * sums[i] * sums[l];
        }
    }
    for (int i = 0; i < stage->count; i++) {
        out->mean[i] += mean[i];
        for (int l = 0; l <= i; l++) {
            double covariance = square[i][l] - mean[i] * mean[l];
            out->covariance[i][l] += covariance;
            if (l != i) out->covariance[l][i] += covariance;
        }
    }
}

bool sphv_sums_main_effects(const sphv_experiment *experiment, double K, sphv_phase phase,
                            const double *nodes, const double *weights, int node_count,
                            sphv_sums *out)
{
    double spacing = experiment->spacing.value, support = experiment->profile->support;
    double furthest = experiment->sigma * fabs(nodes[0]);
    struct stage stage = {.of = experiment,
                          .K = K,
                          .spacing = spacing,
                          .phase = phase,
                          .count = sphv_sums_count(experiment->method),
                          .side = (int)ceil(support / spacing + furthest),
                          .reach = (int)ceil(support / spacing + furthest)};
    stage.summand = malloc((size_t)(2 * stage.side + 1) * sizeof *stage.summand);
    if (!stage.summand) return false;
    for (int b = -stage.side; b <= stage.side; b++)
        summand_at(&stage, b * spacing, stage.summand[b + stage.side]);
    stage.density = own_density(&stage, 0);
    double unmoved[SPHV_SUMS_MAX];
    moved_sums(&stage, 0, 0, unmoved);
    memset(out, 0, sizeof *out);
    out->count = stage.count;
    memcpy(out->mean, unmoved, sizeof out->mean);
    for (int j = -2 * stage.side; j <= 2 * stage.side; j++)
        add_effect(&stage, j, unmoved, nodes, weights, node_count, out);
    free(stage.summand);
    return true;
}
