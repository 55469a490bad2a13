#include "boundary_jitter.h"

#include <gsl/gsl_math.h>
#include <stdlib.h>

enum {
    N = SPHV_QUANTITIES_MAX,
    SUM_ORDER = 8, ///< nodes of a panel of particles that are alike: 1e−5 for sin² 4πx
};

/// Supports' radii in spacings, by dimension, up to which every neighbour is taken.
static const int reach_max[SPHV_DIMENSIONS] = {256, 8, 4};

/// Largest standard deviation of a displacement, in Δx, that is still small.
static const double deviation_max = 0.15;

static sphv_displacement displacement_of(const sphv_box *box, bool folded, double sign)
{
    double a = box->amplitude;
    bool normal = box->jitter == SPHV_JITTER_NORMAL;
    if (!folded) {
        double q = normal ? a * sqrt(3) : a * sqrt(0.6), w = normal ? 1.0 / 6 : 5.0 / 18;
        return (sphv_displacement){0, {-q, 0, q}, {w, 1 - 2 * w, w}};
    }
    // |ε|: even between 0 and a; or of mean a √(2/π) and variance a² (1 − 2/π).
    double middle = normal ? a * sqrt(M_2_PI) : a / 2;
    double q = normal ? a * sqrt(1 - M_2_PI) : a / 2 * sqrt(0.6), w = normal ? 0.5 : 5.0 / 18;
    return (sphv_displacement){sign * middle, {-q, 0, q}, {w, 1 - 2 * w, w}};
}

/// Σ over particles of the whole box and of its interior.
struct totals {
    double count[2], square[2][N], next[2][N], rounding[2][N]; ///< the last: of its square
    bool singular[2];
};

/// Puts together the neighbours of a particle, all lines within reach.
static void put(sphv_jitter_cloud *cloud, const sphv_line *const *line)
{
    int offset[SPHV_DIMENSIONS] = {0};
    double dx = cloud->dx;
    // Those that a perturbation may bring into the support belong to it.
    double reach = cloud->profile->support + 4 * cloud->box->amplitude * cloud->ds;
    for (int i = 0; i < cloud->d; i++) {
        cloud->moved[i] = sphv_jitter_at(cloud, line[i]->x);
        cloud->x[i] = line[i]->x + cloud->moved[i]->mean * dx;
        offset[i] = -line[i]->below;
    }
    cloud->count = 0;
    for (;;) {
        sphv_jitter_neighbour *b = sphv_jitter_next(cloud, 1);
        double square = 0;
        for (int i = 0; i < cloud->d; i++) {
            double x = line[i]->x + offset[i] * dx;
            // Exactly on the side, or a power of x may be that of a negative number.
            if (fabs(x) < 1e-6 * dx) x = 0;
            b->moved[i] = sphv_jitter_at(cloud, x);
            b->x[i] = x + b->moved[i]->mean * dx;
            b->s[i] = (offset[i] + b->moved[i]->mean - cloud->moved[i]->mean) * cloud->ds;
            square += b->s[i] * b->s[i];
        }
        if (square > 0 && square < reach * reach) {
            b->value = sphv_field_derivative(cloud->field, (int[SPHV_DIMENSIONS]){0}, b->x);
            cloud->count++;
        }
        int i = cloud->d - 1;
        while (i >= 0 && ++offset[i] > line[i]->above) {
            offset[i] = -line[i]->below;
            i--;
        }
        if (i < 0) return;
    }
}

static void add_particle(sphv_jitter_sums *of, const sphv_line *const *line, struct totals *to)
{
    sphv_jitter_effect effects;
    const sphv_jitter_cloud *cloud = of->cloud;
    double weight[2] = {1, 1};
    for (int i = 0; i < cloud->d; i++) {
        weight[0] *= line[i]->weight;
        weight[1] *= line[i]->weight * line[i]->inside;
    }
    bool regular = sphv_jitter_effects(of, &effects);
    for (int part = 0; part < 2; part++) {
        if (!(weight[part] > 0)) continue;
        to->count[part] += weight[part];
        to->singular[part] = to->singular[part] || !regular;
        for (size_t q = 0; q < of->quantities; q++) {
            int degree = sphv_monomials(cloud->d)[q].degree;
            double scale = weight[part] * gsl_pow_int(cloud->h, -2 * degree);
            to->square[part][q] += scale * (gsl_pow_2(effects.mean[q]) + effects.variance[q]);
            to->next[part][q] += scale * effects.next[q];
            to->rounding[part][q] += scale * gsl_pow_2(effects.rounding[q]);
        }
    }
}

static void finish(const struct totals *from, int part, size_t quantity, sphv_result *out)
{
    *out = (sphv_result){0, 0};
    if (!(from->count[part] > 0)) return;
    double square = from->square[part][quantity] / from->count[part];
    double next = from->next[part][quantity] / from->count[part];
    out->value = sqrt(square);
    // What was added last is as large as what is left out, or larger.
    out->bound = sqrt(square + next) - out->value;
    double rounding = sqrt(from->rounding[part][quantity] / from->count[part]);
    if (from->singular[part] || !(out->bound <= SPHV_JITTER_BOUND_MAX * out->value + rounding))
        *out = (sphv_result){NAN, INFINITY};
    else
        out->bound += rounding;
}

static sphv_status sum_box(sphv_jitter_group *group, const sphv_field_theory *field,
                           struct totals *to, sphv_error *error)
{
    sphv_lines lines[SPHV_DIMENSIONS] = {{0}};
    const sphv_line *at[SPHV_DIMENSIONS] = {0};
    int counts[SPHV_DIMENSIONS] = {1, 1, 1};
    sphv_jitter_cloud *cloud = &group->cloud;
    const sphv_box *box = cloud->box;
    int reach = (int)floor(cloud->profile->support / cloud->ds) + 1;
    sphv_status status =
        sphv_jitter_cloud_make(cloud, (size_t)gsl_pow_int(2 * reach + 1, cloud->d) + 1, error);
    for (int i = 0; i < cloud->d && status == SPHV_OK; i++) {
        sphv_side side = {.count = box->side,
                          .spacing = sphv_box_spacing(box),
                          .offset = box->placement == SPHV_PLACEMENT_CELL ? 0.5 : 0,
                          .reach = reach,
                          .periodic = box->periodic,
                          .margin = cloud->h * cloud->profile->support,
                          .amplitude = box->amplitude,
                          .jitter = box->jitter,
                          .singular_until = -1};
        if (i == 0 && field->singular) side.singular_until = 2 * side.margin;
        int order = field->narrow ? SPHV_SUM_RULE : SUM_ORDER;
        status = sphv_lines_make(&side, side.singular_until > 0 ? order / 2 : order,
                                 SPHV_STRIP_WHOLE, &lines[i], error);
        counts[i] = lines[i].count;
    }
    for (int i = 0; status == SPHV_OK && i < counts[0]; i++)
        for (int j = 0; j < counts[1]; j++)
            for (int k = 0; k < counts[2]; k++) {
                at[0] = &lines[0].line[i];
                if (cloud->d > 1) at[1] = &lines[1].line[j];
                if (cloud->d > 2) at[2] = &lines[2].line[k];
                put(cloud, at);
                for (size_t m = 0; m < group->count; m++) add_particle(&group->sums[m], at, &to[m]);
            }
    for (int i = 0; i < cloud->d; i++) sphv_lines_free(&lines[i]);
    sphv_jitter_cloud_free(cloud);
    return status;
}

static sphv_status check(const sphv_jitter_cloud *cloud, sphv_method method, sphv_error *error)
{
    double deviation = cloud->box->amplitude;
    if (cloud->box->jitter == SPHV_JITTER_UNIFORM) deviation /= sqrt(3);
    if (deviation > deviation_max)
        return sphv_fail(error, SPHV_NO_CLOSED_FORM,
                         "perturbations of standard deviation %.3g spacings; the theory of boxes "
                         "goes to %g",
                         deviation, deviation_max);
    // In three dimensions sums over few nodes would still be long, and of few nodes a bad estimate.
    if (cloud->wide && cloud->d > 2)
        return sphv_fail(
            error, SPHV_NO_CLOSED_FORM,
            "a support of %.3g spacings on a perturbed lattice; in three dimensions the "
            "theory of boxes goes to %d",
            cloud->profile->support / cloud->ds, reach_max[cloud->d - 1]);
    // Where p_1 or p_2 has no bound at the origin, the nearest neighbours are not like the others.
    if (cloud->wide && sphv_profile_derivative(cloud->profile, 1, 0).value != 0)
        return sphv_fail(
            error, SPHV_NO_CLOSED_FORM,
            "the kernel's derivative does not vanish at the origin: no theory of perturbed boxes "
            "with supports of more than %d spacings",
            reach_max[cloud->d - 1]);
    if (cloud->wide && method == SPHV_MSPH &&
        sphv_profile_derivative(cloud->profile, 3, 0).value != 0)
        return sphv_fail(
            error, SPHV_NO_CLOSED_FORM,
            "the kernel's third derivative does not vanish at the origin: no theory of "
            "perturbed boxes for method 'msph' with supports of more than %d spacings",
            reach_max[cloud->d - 1]);
    switch (method) {
    case SPHV_SPH:
    case SPHV_SPH_DIFFERENCE:
    case SPHV_SHEPARD:
    case SPHV_RKPM_0:
    case SPHV_CSPM:
    case SPHV_FPM:
    case SPHV_MSPH:
        return SPHV_OK;
    default:
        return sphv_fail(error, SPHV_NO_CLOSED_FORM, "no theory of perturbed boxes for method '%s'",
                         sphv_methods[method].name);
    }
}

void sphv_jitter_start(const sphv_box *box, const sphv_profile *profile, double h, double volume,
                       bool every, const sphv_field *field, sphv_jitter_group *out)
{
    double ds = sphv_box_spacing(box) / h;
    out->count = 0;
    out->cloud =
        (sphv_jitter_cloud){.box = box,
                            .profile = profile,
                            .field = field,
                            .d = box->dimension,
                            .h = h,
                            .dx = sphv_box_spacing(box),
                            .ds = ds,
                            .v = volume * gsl_pow_int(ds, box->dimension),
                            .wide = !every && profile->support / ds > reach_max[box->dimension - 1],
                            .free = displacement_of(box, false, 1),
                            .low = displacement_of(box, true, 1),
                            .high = displacement_of(box, true, -1)};
}

sphv_status sphv_jitter_add(sphv_jitter_group *group, sphv_method method, sphv_error *error)
{
    sphv_jitter_cloud *cloud = &group->cloud;
    sphv_status status = check(cloud, method, error);
    if (status != SPHV_OK) return status;
    sphv_jitter_sums *sums = &group->sums[group->count++];
    *sums = (sphv_jitter_sums){.cloud = cloud,
                               .method = method,
                               .degree = sphv_shape_degree(method),
                               .quantities = sphv_method_quantities(method, cloud->d)};
    sums->terms = sphv_monomial_count(cloud->d, sums->degree);
    size_t needed = sphv_monomial_count(cloud->d, 2 * sums->degree);
    if (needed > cloud->monomials) cloud->monomials = needed;
    return SPHV_OK;
}

sphv_status sphv_predict_jitter(sphv_jitter_group *group, const sphv_field_theory *field,
                                sphv_box_prediction *const *out, sphv_error *error)
{
    struct totals *totals = calloc(group->count, sizeof *totals);
    sphv_status status =
        totals ? sum_box(group, field, totals, error)
               : sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for a box's theory");
    for (size_t m = 0; m < group->count && status == SPHV_OK; m++) {
        out[m]->quantities = group->sums[m].quantities;
        out[m]->rigour = SPHV_RIGOUR_STATISTICAL;
        for (size_t q = 0; q < out[m]->quantities; q++) {
            finish(&totals[m], 0, q, &out[m]->rmse[q]);
            finish(&totals[m], 1, q, &out[m]->interior[q]);
            out[m]->exists[q] =
                isfinite(out[m]->rmse[q].value) || isfinite(out[m]->interior[q].value);
            out[m]->scatter[q] = out[m]->interior_scatter[q] = INFINITY;
        }
    }
    free(totals);
    return status;
}
