/// Which route is the faster.
#include <gsl/gsl_math.h>

#include "../internal.h"
#include "chunks.h"
#include "evaluation.h"
#include "half_pairs.h"
#include "pass.h"
#include "transform.h"

/// The convolution's arrays may not need more than this.
static const double MEMORY_MAX = 1e9;
/// What its transforms may add to the relative error of a sum's bound: far below every truncation
/// error that is not itself rounding.
static const double ERROR_MAX = 1e-9;

/// Neighbours from which visiting each pair once is the faster: near 120 both take as long.
static const double HALF_PAIRS_MIN = 150;

/// Volume of the unit ball, by dimension − 1.
static const double ball[] = {2, M_PI, 4 * M_PI / 3};

/// Sizes of a convolution.
struct sizes {
    double count, side, reach, points, classes, neighbours;
    double moments, kernels, fields, transforms;
};

static struct sizes measure(const sphv_evaluation *evaluation)
{
    const sphv_particles *particles = evaluation->particles;
    const sphv_request *request = evaluation->request;
    int d = particles->dimension;
    double side = (double)particles->lattice_side, fields = (double)request->field_count;
    double reach = request->profile->support * request->h / particles->spacing;
    double kernels = evaluation->layout.per_field;
    struct sizes of = {.count = (double)particles->count, .side = side, .fields = fields};
    of.neighbours = fmin(of.count, 1 + ball[d - 1] * gsl_pow_int(reach, d));
    of.reach = fmin(ceil(reach) + 1, side - 1);
    of.points = gsl_pow_int((double)sphv_transform_size((size_t)(side + of.reach)), d);
    of.classes = gsl_pow_int(fmin(side, 2 * of.reach + 1), d);
    of.moments = evaluation->layout.moments;
    of.kernels = kernels;
    // Of pairs of fields, of pairs of kernels, and back of both
    of.transforms = ceil(fields / 2) + ceil(kernels / 2) + ceil(fields * kernels / 2);
    return of;
}

static bool fits(const sphv_evaluation *evaluation)
{
    const sphv_particles *particles = evaluation->particles;
    const sphv_profile *profile = evaluation->request->profile;
    const sphv_sum_set *set = &sphv_sum_sets[evaluation->layout.level];
    if (particles->lattice_side < 2 || particles->periodic) return false;
    // A jump can fall on a particle's distance.
    int needed = set->moment[2].from <= set->moment[2].to ? 2 : 1;
    for (int i = 0; i < profile->knot_count; i++)
        if (profile->knots[i].position.value > 0 && profile->knots[i].order <= needed) return false;
    for (size_t n = 1; n < particles->count; n++)
        if (particles->volume[n] != particles->volume[0]) return false;
    for (size_t f = 0; f < evaluation->request->field_count; f++)
        if (!isfinite(evaluation->spread[f])) return false;
    return true;
}

bool sphv_convolution_wins(const sphv_evaluation *evaluation)
{
    if (!fits(evaluation)) return false;
    struct sizes of = measure(evaluation);
    int d = evaluation->particles->dimension;
    double cells = gsl_pow_int(2 * of.reach + 1, d), arrays = of.fields * of.kernels;
    double memory = 16 * of.points * (ceil(of.fields / 2) + 2) + 8 * of.count * arrays +
                    8 * of.classes * (of.moments + 7) + 64 * cells;
    // ε‖A‖₂‖K‖₂ against ½ spread ‖K‖₁, ‖K‖₂/‖K‖₁ being of the order of 1/√neighbours
    double error = 3 * 40 * SPHV_U * log2(of.points) * sqrt(of.count / of.neighbours);
    // In nanoseconds, within a factor of two: the routes cost the same near 30 neighbours in 2D.
    double direct = of.count * (300 + 0.08 * of.neighbours * evaluation->layout.count);
    double convolution = of.points * of.transforms * (14 * d + 12) + 12 * of.count * arrays +
                         20 * cells * (of.moments + 7) + 400 * gsl_pow_int(of.reach + 1, d);
    return memory < MEMORY_MAX && error < ERROR_MAX && convolution < direct;
}

sphv_mean sphv_mean_of(const sphv_evaluation *evaluation)
{
    const sphv_particles *particles = evaluation->particles;
    double extent[SPHV_DIMENSIONS], spacing = 0;
    int d = particles->dimension, axes = d;
    for (int i = 0; i < d; i++) {
        sphv_span span = sphv_span_of(particles->x[i], particles->count);
        extent[i] = span.high - span.low;
    }
    // Axes along which particles are next to each other everywhere do not count.
    for (int pass = 0; pass < d && axes > 0; pass++) {
        double volume = 1;
        axes = 0;
        for (int i = 0; i < d; i++)
            if (extent[i] > spacing) {
                volume *= extent[i];
                axes++;
            }
        if (axes > 0) spacing = pow(volume / (double)particles->count, 1.0 / axes);
    }
    double reach = evaluation->request->profile->support * evaluation->request->h / spacing;
    if (axes == 0 || !isfinite(reach)) return (sphv_mean){0, 0};
    return (sphv_mean){reach, ball[axes - 1] * gsl_pow_int(reach, axes)};
}

bool sphv_half_pairs_win(const sphv_evaluation *evaluation)
{
    const sphv_request *request = evaluation->request;
    int d = evaluation->particles->dimension;
    if (d < 2 || evaluation->particles->periodic || evaluation->particles->count == 0 ||
        request->field_count < 1 || request->field_count > SPHV_PASS_FIELDS)
        return false;
    for (size_t m = 0; m < request->method_count; m++)
        if (request->methods[m] != SPHV_SPH) return false;
    return sphv_mean_of(evaluation).neighbours > HALF_PAIRS_MIN;
}
