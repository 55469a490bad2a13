/// What a wrong library did: hypotheses, of which one is named when it fits every place.
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "implementation_check.h"

/// The library's results of one kind in one dimension, and what they are compared with.
struct suspicion {
    const sphv_examination *of;
    const sphv_implementation_data *data;
    const sphv_profile *profile;
    int dimension, which;
    double factor, length; ///< parameters of a hypothesis
    double from, to;       ///< only the places with from ≤ q ≤ to
    const sphv_profile *other;
};

/// What a hypothesis says the library returns at a place.
typedef double (*hypothesis)(const struct suspicion *of, const sphv_probe *probe);

static bool concerns(const struct suspicion *of, const sphv_probe *probe)
{
    return probe->kind == SPHV_PROBE_SHAPE && probe->call.dimension == of->dimension &&
           probe->q >= of->from && probe->q <= of->to &&
           isfinite(sphv_implementation_answer(probe, of->which));
}

/// Does the hypothesis hold everywhere, to the rounding allowed to the library?
static bool fits(const struct suspicion *of, hypothesis predict, double stretch)
{
    size_t places = 0;
    for (size_t i = 0; i < of->data->count; i++) {
        const sphv_probe *probe = &of->data->probes[i];
        if (!concerns(of, probe)) continue;
        if (probe->call.r == 0) continue; // where 0/0 and cones have answers of their own
        double tolerance = sphv_implementation_tolerance(of->data, probe, of->which);
        double predicted = predict(of, probe);
        double apart = fabs(sphv_implementation_answer(probe, of->which) - predicted);
        if (!(apart <= stretch * tolerance + 16 * of->data->roundoff * fabs(predicted)))
            return false;
        places++;
    }
    return places > 20;
}

static double multiple(const struct suspicion *of, const sphv_probe *probe)
{
    return of->factor * probe->reference[of->which].value;
}

static double clamped(const struct suspicion *of, const sphv_probe *probe)
{
    (void)of;
    return fmax(probe->reference[0].value, 0);
}

/// The file's kernel with `length`·h for h: length^−d Ŵ(q/length), times `factor`.
static double stretched(const struct suspicion *of, const sphv_probe *probe)
{
    sphv_result there[3];
    sphv_profile_values(of->profile, probe->q / of->length, there);
    return of->factor * there[of->which].value / pow(of->length, of->dimension + of->which);
}

static double another(const struct suspicion *of, const sphv_probe *probe)
{
    sphv_result there[3];
    sphv_profile_values(of->other, probe->q, there);
    return there[of->which].value;
}

static double over_power_of_q(const struct suspicion *of, const sphv_probe *probe)
{
    return of->factor * probe->reference[1].value * pow(probe->q, of->length);
}

static double value_itself(const struct suspicion *of, const sphv_probe *probe)
{
    return of->factor * probe->reference[0].value;
}

static double curvature(const struct suspicion *of, const sphv_probe *probe)
{
    return of->factor * probe->reference[2].value;
}

/// The factor between answer and prediction where the prediction is largest.
static double factor_of(struct suspicion *of, hypothesis predict)
{
    double largest = 0, factor = NAN;
    of->factor = 1;
    for (size_t i = 0; i < of->data->count; i++) {
        const sphv_probe *probe = &of->data->probes[i];
        if (!concerns(of, probe) || probe->call.r == 0 || probe->q < 0.05 * of->profile->support)
            continue;
        double predicted = predict(of, probe);
        if (!(fabs(predicted) > largest)) continue;
        largest = fabs(predicted);
        factor = sphv_implementation_answer(probe, of->which) / predicted;
    }
    return factor;
}

static bool near(const struct suspicion *of, double a, double b)
{
    double roundings = of->data->single ? 64 * of->data->roundoff : 1e-12;
    return fabs(a - b) <= roundings * fabs(b);
}

/// C_d with few digits: how many, or 0.
static int digits_of(const struct suspicion *of, double used)
{
    double right = of->profile->constant.value;
    for (int digits = 1; digits <= 10 && fabs(used / right - 1) < 0.05; digits++) {
        char text[40];
        snprintf(text, sizeof text, "%.*e", digits - 1, right);
        if (near(of, used, strtod(text, NULL))) return digits;
    }
    return 0;
}

static void name_factor(struct suspicion *of, double factor, sphv_check_result *result)
{
    const sphv_kernel *kernel = of->of->kernel;
    double constant = factor * of->profile->constant.value, kappa = of->profile->support;
    int d = of->dimension, digits = digits_of(of, constant);
    static const struct {
        double factor;
        const char *meaning;
    } factors[] = {
        {-1, "the sign is flipped"},
        {3.14159265358979323846, "pi is missing in the constant"},
        {1 / 3.14159265358979323846, "one pi too many in the constant"},
        {2, "twice too large: as if W were integrated over one half only"},
        {0.5, "half of the right one"},
    };
    if (near(of, constant, 1)) {
        sphv_check_cause(result, "not normalised: the constant %.17g is missing",
                         of->profile->constant.value);
        return;
    }
    for (int other = 1; other <= SPHV_DIMENSIONS; other++) {
        const sphv_profile *profile = sphv_kernel_profile(kernel, other);
        if (other == d || !profile || !near(of, constant, profile->constant.value)) continue;
        sphv_check_cause(result, "the constant is that of %dD", other);
        return;
    }
    for (size_t i = 0; i < sizeof factors / sizeof *factors; i++)
        if (near(of, factor, factors[i].factor)) {
            sphv_check_cause(result, "%s", factors[i].meaning);
            return;
        }
    if (of->profile->excess != 0 && near(of, factor, 1 / (1 + of->profile->excess)))
        sphv_check_cause(result, "renormalised over the truncated support: %.10g times the file's",
                         factor);
    else if (!of->data->single && near(of, constant, (double)(float)of->profile->constant.value))
        sphv_check_cause(result, "the constant is rounded to single precision");
    else if (digits)
        sphv_check_cause(result, "the constant is rounded to %d digits: %.10g for %.17g", digits,
                         constant, of->profile->constant.value);
    else if (kappa != 1 && (near(of, factor, pow(kappa, d)) || near(of, factor, pow(kappa, -d))))
        sphv_check_cause(result,
                         "%.10g^%d too %s: h and the support radius are confused in the constant",
                         kappa, d, factor > 1 ? "large" : "small");
    else if (near(of, factor, pow(2, d)) || near(of, factor, pow(2, -d)))
        sphv_check_cause(result, "2^%d too %s: h and 2h are confused in the constant", d,
                         factor > 1 ? "large" : "small");
    else
        sphv_check_cause(result, "%.10g times the right one everywhere: the constant is wrong",
                         factor);
}

static bool name_stretch(struct suspicion *of, sphv_check_result *result)
{
    double kappa = of->profile->support;
    const double lengths[] = {1 / kappa, kappa, 0.5, 2};
    for (int i = 0; i < 4; i++) {
        if (lengths[i] == 1) continue;
        of->length = lengths[i];
        double factor = factor_of(of, stretched);
        if (!isfinite(factor) || factor == 0) continue;
        of->factor = factor;
        double stretch =
            fmax(1, fabs(factor)) * pow(fmax(lengths[i], 1 / lengths[i]), of->dimension + 3);
        if (!fits(of, stretched, stretch)) continue;
        if (i == 0)
            sphv_check_cause(result, "the library's h is the support radius");
        else
            sphv_check_cause(result, "the library takes %.10g h for h", lengths[i]);
        if (!near(of, factor, 1))
            sphv_check_cause(result, "and its constant is %.10g times that of this h", factor);
        return true;
    }
    return false;
}

static bool name_other_kernel(struct suspicion *of, sphv_check_result *result)
{
    const sphv_catalogue *reference = of->of->options->reference;
    for (size_t i = 0; reference && i < reference->count; i++) {
        of->other = sphv_kernel_profile(reference->kernels[i], of->dimension);
        if (!of->other || !fits(of, another, 4)) continue;
        sphv_check_cause(result, "this is %s", sphv_kernel_name(reference->kernels[i]));
        return true;
    }
    return false;
}

static int by_place(const void *a, const void *b)
{
    double p = (*(const sphv_probe *const *)a)->q, q = (*(const sphv_probe *const *)b)->q;
    return (p > q) - (p < q);
}

/// Where the library is wrong.
struct range {
    size_t count, wrong, zeros; ///< places, wrong ones, wrong ones where it returns zero
    double first, last;         ///< q of the first and last wrong place
    double largest;             ///< difference, relative to the largest right value
};

static struct range find_range(const struct suspicion *of)
{
    struct range range = {.first = NAN, .last = NAN};
    const sphv_probe **places = malloc((of->data->count + 1) * sizeof *places);
    if (!places) return range;
    for (size_t i = 0; i < of->data->count; i++)
        if (concerns(of, &of->data->probes[i])) places[range.count++] = &of->data->probes[i];
    if (range.count) qsort(places, range.count, sizeof *places, by_place);
    double scale = 0;
    for (size_t i = 0; i < range.count; i++) {
        double found = sphv_implementation_answer(places[i], of->which);
        double apart = fabs(found - places[i]->reference[of->which].value);
        scale = fmax(scale, fabs(places[i]->reference[of->which].value));
        if (apart <= sphv_implementation_tolerance(of->data, places[i], of->which)) continue;
        if (range.wrong++ == 0) range.first = places[i]->q;
        range.last = places[i]->q;
        range.zeros += found == 0;
        range.largest = fmax(range.largest, apart);
    }
    range.largest /= scale;
    free(places);
    return range;
}

static void name_range(const struct suspicion *of, const struct range *range,
                       sphv_check_result *result)
{
    double kappa = of->profile->support;
    if (range->wrong && range->zeros == range->wrong && range->first > 0.05 * kappa)
        sphv_check_cause(
            result,
            "the library is zero from q = %.6g on: its support is smaller than the file's %.10g",
            range->first, kappa);
    else if (range->wrong)
        sphv_check_cause(
            result,
            "wrong at %zu of %zu places, from q = %.6g to %.6g, by up to %.3e of the largest",
            range->wrong, range->count, range->first, range->last, range->largest);
}

static bool name_gradient(struct suspicion *of, sphv_check_result *result)
{
    static const struct {
        int power;
        const char *meaning;
    } powers[] = {
        {-1, "the gradient lacks a factor q (it is W'/q, as for ∇W = (W'/r) r)"},
        {1, "the gradient has a factor q too many"},
        {-2, "the gradient lacks a factor q^2"},
    };
    for (size_t i = 0; i < sizeof powers / sizeof *powers; i++) {
        of->length = powers[i].power;
        of->factor = factor_of(of, over_power_of_q);
        // At q = 1e-8 the quotient's own rounding is that of the slope over q.
        double stretch = fmax(1, fabs(of->factor)) * (powers[i].power < 0 ? 1e18 : 4);
        if (!isfinite(of->factor) || !fits(of, over_power_of_q, fmin(stretch, 1e3))) continue;
        sphv_check_cause(result, "%s", powers[i].meaning);
        if (!near(of, of->factor, 1)) sphv_check_cause(result, "times %.10g", of->factor);
        return true;
    }
    static const struct {
        hypothesis predict;
        const char *meaning;
    } others[] = {
        {value_itself, "the gradient is W itself"},
        {curvature, "the gradient is the second derivative"},
    };
    for (size_t i = 0; i < 2; i++) {
        of->factor = factor_of(of, others[i].predict);
        if (!isfinite(of->factor) || !fits(of, others[i].predict, 1e3)) continue;
        sphv_check_cause(result, "%s", others[i].meaning);
        return true;
    }
    return false;
}

/// One mistake at all the places that concern: a factor, or a mistake of a gradient.
static bool name_mistake(struct suspicion *of, sphv_check_result *result)
{
    double factor = factor_of(of, multiple);
    of->factor = factor;
    if (isfinite(factor) && factor != 0 && fits(of, multiple, fmax(2, 2 * fabs(factor)))) {
        name_factor(of, factor, result);
        return true;
    }
    return of->which && name_gradient(of, result);
}

void sphv_implementation_name_cause(const sphv_examination *of,
                                    const sphv_implementation_data *data, int dimension, int which,
                                    sphv_check_result *result)
{
    struct suspicion about = {.of = of,
                              .data = data,
                              .profile = sphv_kernel_profile(of->kernel, dimension),
                              .dimension = dimension,
                              .which = which,
                              .factor = 1,
                              .to = INFINITY};
    if (!which && fits(&about, clamped, 2)) {
        sphv_check_cause(result, "negative values are set to zero");
        return;
    }
    if (name_mistake(&about, result) || name_stretch(&about, result) ||
        name_other_kernel(&about, result))
        return;
    // One piece of a kernel can be wrong on its own.
    struct range range = find_range(&about);
    about.from = range.first;
    about.to = range.last;
    if (range.wrong && range.zeros < range.wrong && name_mistake(&about, result))
        sphv_check_cause(result, "from q = %.6g to %.6g, and right elsewhere", range.first,
                         range.last);
    else
        name_range(&about, &range, result);
}

void sphv_implementation_name_scaling(const sphv_implementation_data *data, int dimension,
                                      sphv_check_result *result)
{
    double power[2] = {NAN, NAN};
    for (int which = 0; which < 2; which++) {
        bool same = true, found = false;
        for (size_t i = 0; i < data->count; i++) {
            const sphv_probe *probe = &data->probes[i];
            if (probe->kind != SPHV_PROBE_SCALED || probe->call.dimension != dimension) continue;
            double right = probe->reference[which].value;
            double ratio = sphv_implementation_answer(probe, which) /
                           sphv_implementation_answer(&data->probes[probe->unscaled], which);
            // Not where little is left of W, nor at h near 1, where powers of h are alike.
            if (fabs(log(probe->call.h)) < 1 ||
                !(fabs(right) > 0.01 * fabs(probe->reference[0].value)))
                continue;
            double here = log(fabs(ratio)) / log(probe->call.h);
            if (!found) power[which] = nearbyint(here);
            same = same && fabs(here - power[which]) < 0.3 && isfinite(here);
            found = true;
        }
        if (!same || !found) power[which] = NAN;
    }
    if (power[0] == 0 && power[1] == 1)
        sphv_check_cause(result,
                         "the derivative is that with respect to q: a factor 1/h is missing");
    else if (power[0] == 0 && power[1] == 2)
        sphv_check_cause(result, "the derivative lacks a factor 1/h^2");
    else if (power[0] > 0 && power[0] == power[1])
        sphv_check_cause(result, "a factor h^-%g is missing: W scales as h^%g", power[0],
                         power[0] - dimension);
    else if (power[0] < 0 && power[0] == power[1])
        sphv_check_cause(result, "a factor h^%g too many", power[0]);
    else if (isfinite(power[0]) && isfinite(power[1]) && (power[0] != 0 || power[1] != 0))
        sphv_check_cause(result, "W carries h^%g too much, dW/dr h^%g", power[0], power[1]);
}
