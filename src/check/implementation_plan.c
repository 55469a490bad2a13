/// Which calls a library is asked for, and what the file's kernel says at each.
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "implementation_check.h"

static const double pi = 3.14159265358979323846;

double sphv_implementation_answer(const sphv_probe *probe, int which)
{
    double h = probe->call.h, power = which ? h : 1;
    for (int d = 0; d < probe->call.dimension; d++) power *= h;
    return power * (which ? probe->answer.derivative : probe->answer.value);
}

/// Horner's rule in the file's powers of q errs by at most 2·degree roundings of Σ|terms|, the
/// constant, the power of h and the units here by d + 8 of the result; q = r/h and r themselves are
/// rounded. Forms that cancel less stay below that.
double sphv_implementation_tolerance(const sphv_implementation_data *data, const sphv_probe *probe,
                                     int which)
{
    const sphv_result *reference = probe->reference;
    double roundings = (2 * data->degree + 4) * probe->size[which] +
                       (probe->call.dimension + 8) * fabs(reference[which].value) +
                       4 * probe->q * fabs(reference[which + 1].value);
    return data->roundoff * roundings + reference[which].bound;
}

static sphv_probe *add(sphv_implementation_data *data, sphv_probe_kind kind, double q, double r,
                       double h, int dimension)
{
    if (data->count == data->capacity) {
        size_t capacity = data->capacity ? 2 * data->capacity : 1024;
        sphv_probe *grown = realloc(data->probes, capacity * sizeof *grown);
        if (!grown) return NULL;
        data->probes = grown;
        data->capacity = capacity;
    }
    sphv_probe *probe = &data->probes[data->count++];
    *probe = (sphv_probe){.kind = kind, .call = {r, h, dimension}, .q = q};
    return probe;
}

static bool plan_dimension(sphv_implementation_data *data, const sphv_profile *profile)
{
    enum { SHAPE = 400, SCALED = 40, STAIRS = 60, LENGTHS = 3 };
    static const double lengths[LENGTHS] = {0.0017, 0.7319, 41.3};
    static const double beyond[] = {1, 1 + 1e-6, 1.01, 1.37, 2, 3.1, 10, 1e3, 1e6};
    static const double golden = 0.61803398874989484820;
    double kappa = profile->support;
    int d = profile->dimension;
    bool good =
        add(data, SPHV_PROBE_SHAPE, 0, 0, 1, d) && add(data, SPHV_PROBE_SHAPE, 1e-8, 1e-8, 1, d);
    for (int i = 0; good && i < SHAPE; i++) {
        double q = kappa * fmod((i + 0.5) * golden, 1);
        good = add(data, SPHV_PROBE_SHAPE, q, q, 1, d) != NULL;
    }
    for (int i = 0; good && i < profile->piece_count; i++)
        for (int side = -1; good && side <= 1; side += 2) {
            double q = profile->pieces[i].outer * (1 + side * 1e-4);
            good = q >= kappa || add(data, SPHV_PROBE_SHAPE, q, q, 1, d);
        }
    for (int i = 0; good && i < SCALED; i++) {
        double q = kappa * fmod((i + 0.25) * golden, 0.999);
        good = add(data, SPHV_PROBE_SHAPE, q, q, 1, d) != NULL;
        size_t unscaled = data->count - 1;
        for (int k = 0; good && k < LENGTHS; k++) {
            sphv_probe *probe = add(data, SPHV_PROBE_SCALED, q, q * lengths[k], lengths[k], d);
            good = probe != NULL;
            if (good) probe->unscaled = unscaled;
        }
    }
    for (size_t i = 0; good && i < sizeof beyond / sizeof *beyond; i++)
        for (int k = 0; good && k < 2; k++)
            good = add(data, SPHV_PROBE_OUTSIDE, beyond[i] * kappa,
                       beyond[i] * kappa * (k ? 0.25 : 1), k ? 0.25 : 1, d) != NULL;
    for (int i = 0; good && i < STAIRS; i++) {
        double q = kappa * (0.2 + 0.6 * fmod((i + 0.7) * golden, 1)), close = q * (1 + 0x1p-36);
        good = add(data, SPHV_PROBE_SHAPE, q, q, 1, d) &&
               add(data, SPHV_PROBE_STAIR, close, close, 1, d);
    }
    return good;
}

/// Does a particle stand where W′ jumps? Then which side a code takes is its own affair.
static bool on_jump(const sphv_profile *profile, sphv_number spacing)
{
    for (int i = 0; i < profile->knot_count; i++)
        if (profile->knots[i].order <= 1 && profile->knots[i].position.value > 0 &&
            sphv_number_place(profile->knots[i].position, spacing).on_lattice)
            return true;
    return false;
}

static bool plan_lattice(sphv_implementation_data *data, const sphv_profile *profile)
{
    static const double hs[] = {0.0018, 0.02, 0.2};
    static const int ns[] = {2, 3, 5, 8, 13, 21, 40};
    static const double fractions[] = {0.61, 0.4286, 0.2718, 0.1931, 0.1, 0.0577, 0.0251};
    enum { SPACINGS = sizeof ns / sizeof *ns + sizeof fractions / sizeof *fractions };
    for (int i = 0; i < SPACINGS; i++) {
        int arbitrary = i - (int)(sizeof ns / sizeof *ns);
        sphv_number spacing =
            arbitrary < 0 ? sphv_profile_special_spacing(profile, ns[i])
                          : sphv_number_from_double(fractions[arbitrary] * profile->support);
        if (on_jump(profile, spacing)) continue;
        for (size_t k = 0; k < sizeof hs / sizeof *hs; k++) {
            long inside = sphv_number_place(profile->support_exact, spacing).inside;
            sphv_lattice_probe *point = &data->lattice[data->lattice_count++];
            *point = (sphv_lattice_probe){hs[k], spacing, data->count, (size_t)inside};
            for (long j = 1; j <= inside; j++) {
                double q = (double)j * spacing.value, r = q * hs[k];
                sphv_probe *probe = add(data, SPHV_PROBE_LATTICE, q, r, hs[k], 1);
                if (!probe) return false;
                probe->weight = 2 * spacing.value * hs[k] * sin(2 * pi * r) / (2 * pi);
            }
        }
    }
    return true;
}

/// Σ|terms| in powers of q, of the piece q is in and of those beyond: a B-spline summed from
/// truncated powers adds those up.
static void sum_sizes(const sphv_kernel *kernel, const sphv_profile *profile, sphv_probe *probe)
{
    double q = fmin(probe->q, profile->support);
    if (!kernel->polynomial) {
        probe->size[0] = profile->pieces[0].derivative_bound[0];
        probe->size[1] = profile->pieces[0].derivative_bound[1];
        // The derivative of sinc^m is m sinc^(m−1) (cos θ − sin θ/θ)/q in the usual form, with a
        // few roundings of either term, however small their difference.
        if (profile->form->family->needs_exponent && probe->q > 0)
            probe->size[1] += 0.25 * profile->form->exponent * probe->reference[0].value / probe->q;
        return;
    }
    const sphv_exact_pieces *exact = &kernel->exact[profile->dimension - 1];
    double over = sphv_sphere_pi(profile->dimension);
    for (int i = 0; i < exact->count; i++) {
        if (q >= profile->pieces[i].outer && i + 1 < exact->count) continue;
        const sphv_polynomial *p = &exact->polynomial[i];
        double value = 0, slope = 0;
        for (int k = p->degree; k >= 0; k--) {
            slope = slope * q + value;
            value = value * q + fabs(mpq_get_d(p->coefficient[k])) / over;
        }
        probe->size[0] += value;
        probe->size[1] += slope;
    }
}

static void refer(sphv_implementation_data *data)
{
    for (size_t i = 0; i < data->count; i++) {
        sphv_probe *probe = &data->probes[i];
        const sphv_profile *profile = sphv_kernel_profile(data->kernel, probe->call.dimension);
        sphv_profile_values(profile, probe->q, probe->reference);
        sum_sizes(data->kernel, profile, probe);
    }
    const sphv_exact_pieces *pieces = &data->kernel->pieces;
    data->degree = data->kernel->polynomial ? 0 : 16;
    for (int i = 0; data->kernel->polynomial && i < pieces->count; i++) {
        int degree = pieces->polynomial[i].degree + (data->kernel->fourth_order ? 2 : 0);
        if (degree > data->degree) data->degree = degree;
    }
}

/// Single precision shows in two ways: every result is a float, or results do not move with r where
/// only doubles tell two places apart.
static void recognise_precision(sphv_implementation_data *data)
{
    size_t results = 0, floats = 0, stairs = 0, still = 0;
    for (size_t i = 0; i < data->count; i++) {
        const sphv_probe *probe = &data->probes[i];
        const double both[] = {probe->answer.value, probe->answer.derivative};
        for (int k = 0; k < 2; k++)
            if (isfinite(both[k]) && both[k] != 0) {
                results++;
                floats += fabs(both[k]) <= FLT_MAX && both[k] == (double)(float)both[k];
            }
        if (probe->kind != SPHV_PROBE_STAIR) continue;
        double moved = 0x1p-36 * probe->q * fabs(probe->reference[1].value);
        if (moved < 64 * DBL_EPSILON * fabs(probe->reference[0].value)) continue;
        stairs++;
        still += probe->answer.value == probe[-1].answer.value && probe->answer.value != 0;
    }
    data->single =
        (results >= 50 && floats == results) || (stairs >= 20 && still > 0.6 * (double)stairs);
    data->roundoff = data->single ? FLT_EPSILON / 2 : DBL_EPSILON / 2;
}

bool sphv_implementation_plan(const sphv_examination *of, sphv_implementation_data *data)
{
    for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
        const sphv_profile *profile = sphv_kernel_profile(of->kernel, d);
        if (!profile || (of->options->dimension && of->options->dimension != d)) continue;
        if (!plan_dimension(data, profile)) return false;
        if (d == 1 && !plan_lattice(data, profile)) return false;
    }
    return true;
}

void sphv_implementation_refer(sphv_implementation_data *data)
{
    refer(data);
    recognise_precision(data);
}
