/// The file's own gradient against the derivative of w, and what a wrong one looks like.
#include <math.h>
#include <string.h>

#include "check_internal.h"

/// What a gradient can be compared with.
typedef enum gradient_base { SLOPE, VALUE, CURVATURE } gradient_base;

/// Coefficient k of w, w′ or w″ of a piece times q^shift.
static void expected_coefficient(mpq_t out, const sphv_polynomial *p, gradient_base base, int shift,
                                 int k)
{
    int order = base == SLOPE ? 1 : base == CURVATURE ? 2 : 0;
    int source = k - shift + order;
    mpq_set_ui(out, 0, 1);
    if (k - shift < 0 || source > p->degree) return;
    mpq_t falling;
    mpq_init(falling);
    mpq_set_ui(falling, 1, 1);
    for (int i = 0; i < order; i++) {
        mpq_t factor;
        mpq_init(factor);
        mpq_set_si(factor, source - i, 1);
        mpq_mul(falling, falling, factor);
        mpq_clear(factor);
    }
    mpq_mul(out, falling, p->coefficient[source]);
    mpq_clear(falling);
}

static const mpq_t *given_coefficient(const sphv_polynomial *p, int k, const mpq_t *zero)
{
    return k <= p->degree ? (const mpq_t *)&p->coefficient[k] : zero;
}

/// Equal, or no further apart than the rounding of long decimals.
static bool equal_to_rounding(const mpq_t a, const mpq_t b, double rounding)
{
    if (mpq_equal(a, b) || rounding == 0) return mpq_equal(a, b) != 0;
    mpq_t difference;
    mpq_init(difference);
    mpq_sub(difference, a, b);
    bool equal = fabs(mpq_get_d(difference)) <= rounding * fabs(mpq_get_d(b));
    mpq_clear(difference);
    return equal;
}

/// −1, 0 or 1, like mpq_cmp.
static int compare_to_rounding(const mpq_t a, const mpq_t b, double rounding)
{
    return equal_to_rounding(a, b, rounding) ? 0 : mpq_cmp(a, b);
}

/// A factor that long decimals have left next to an integer is that integer.
static double factor_value(const mpq_t factor)
{
    double value = sphv_rational_round(factor);
    return fabs(value - nearbyint(value)) < 1e-13 ? nearbyint(value) : value;
}

/// Is gradient piece g the piece p's base × q^shift × factor? The factor is found by the first
/// coefficient that is not zero, unless `known`.
static bool piece_is(const sphv_polynomial *g, const sphv_polynomial *p, double rounding,
                     gradient_base base, int shift, mpq_t factor, bool *known)
{
    mpq_t expected, zero;
    mpq_inits(expected, zero, NULL);
    bool equal = true;
    for (int k = -1; equal && k <= SPHV_DEGREE_MAX + 2; k++) {
        // w/q of a w with a constant term has a term in 1/q, which a polynomial cannot hold.
        if (k < 0) {
            if (shift < 0) {
                expected_coefficient(expected, p, base, 0, 0);
                equal = mpq_sgn(expected) == 0;
            }
            continue;
        }
        expected_coefficient(expected, p, base, shift, k);
        const mpq_t *given = given_coefficient(g, k, (const mpq_t *)&zero);
        if (!*known && mpq_sgn(expected) != 0 && mpq_sgn(*given) != 0) {
            mpq_div(factor, *given, expected);
            *known = true;
        }
        mpq_mul(expected, expected, factor);
        equal = equal_to_rounding(expected, *given, rounding);
    }
    mpq_clears(expected, zero, NULL);
    return equal;
}

/// Runs over all pairs of pieces that overlap. `only` ≥ 0: that piece of the gradient alone.
static bool gradient_is(const sphv_kernel *kernel, gradient_base base, int shift, mpq_t factor,
                        int only)
{
    const sphv_exact_pieces *w = &kernel->pieces, *g = &kernel->gradient;
    double rounding = 4 * fmax(w->rounding, g->rounding);
    bool known = base == SLOPE && shift == 0 && only >= 0;
    mpq_set_ui(factor, 1, 1);
    for (int i = 0, j = 0; i < w->count && j < g->count;) {
        if ((only < 0 || only == j) &&
            !piece_is(&g->polynomial[j], &w->polynomial[i], rounding, base, shift, factor, &known))
            return false;
        int order = compare_to_rounding(w->outer[i], g->outer[j], rounding);
        if (order <= 0) i++;
        if (order >= 0) j++;
    }
    return known || (base == SLOPE && shift == 0);
}

static void name_factor(sphv_check_result *result, const char *what, const mpq_t factor)
{
    double f = factor_value(factor);
    if (f == 1) {
        sphv_check_cause(result, "%s", what);
    } else if (f == -1) {
        sphv_check_cause(result, "%s, and its sign is flipped", what);
    } else {
        sphv_check_cause(result, "%s, times %.10g", what, f);
    }
}

static bool name_whole(const sphv_kernel *kernel, sphv_check_result *result)
{
    mpq_t factor;
    mpq_init(factor);
    double kappa = kernel->support.value;
    bool named = true;
    if (gradient_is(kernel, SLOPE, 0, factor, -1)) {
        double f = factor_value(factor);
        if (f == -1)
            sphv_check_cause(result, "the gradient's sign is flipped");
        else if (kappa != 1 && (fabs(f) == kappa || fabs(fabs(f) - 1 / kappa) < 1e-15))
            sphv_check_cause(result,
                             "the gradient is %.10g times too large: it was taken with "
                             "respect to another variable than q (chain rule)",
                             f);
        else
            sphv_check_cause(result, "the gradient is %.10g times too large", f);
    } else if (gradient_is(kernel, SLOPE, -1, factor, -1)) {
        name_factor(result, "the gradient lacks a factor q", factor);
    } else if (gradient_is(kernel, SLOPE, 1, factor, -1)) {
        name_factor(result, "the gradient has a factor q too many", factor);
    } else if (gradient_is(kernel, SLOPE, -2, factor, -1)) {
        name_factor(result, "the gradient lacks a factor q^2", factor);
    } else if (gradient_is(kernel, VALUE, 0, factor, -1)) {
        name_factor(result, "the gradient is w itself", factor);
    } else if (gradient_is(kernel, CURVATURE, 0, factor, -1)) {
        name_factor(result, "the gradient is the second derivative", factor);
    } else {
        named = false;
    }
    mpq_clear(factor);
    return named;
}

/// The piece of w in which gradient piece j begins.
static int matching_piece(const sphv_kernel *kernel, int j)
{
    int i = 0;
    if (j > 0)
        while (i + 1 < kernel->pieces.count &&
               mpq_cmp(kernel->pieces.outer[i], kernel->gradient.outer[j - 1]) <= 0)
            i++;
    return i;
}

/// Names the coefficients of one piece of the gradient that are not those of w′.
static void name_coefficients(const sphv_kernel *kernel, int j, sphv_check_result *result)
{
    const sphv_polynomial *g = &kernel->gradient.polynomial[j];
    const sphv_polynomial *p = &kernel->pieces.polynomial[matching_piece(kernel, j)];
    int wrong = 0, first = -1, last = -1, compared = g->degree;
    double largest = 0;
    mpq_t expected[SPHV_DEGREE_MAX + 1], zero;
    mpq_init(zero);
    if (p->degree - 1 > compared) compared = p->degree - 1;
    for (int k = 0; k <= compared; k++) {
        mpq_init(expected[k]);
        expected_coefficient(expected[k], p, SLOPE, 0, k);
        const mpq_t *given = given_coefficient(g, k, (const mpq_t *)&zero);
        if (mpq_equal(expected[k], *given)) continue;
        double right = sphv_rational_round(expected[k]), found = sphv_rational_round(*given);
        largest = fmax(largest, right != 0 ? fabs(found / right - 1) : INFINITY);
        if (wrong++ == 0) first = k;
        last = k;
    }
    if (wrong == 1) {
        char *text = mpq_get_str(NULL, 10, expected[first]);
        sphv_check_cause(result,
                         "piece %d of the gradient: the coefficient of q^%d is %.10g; w' "
                         "needs %.40s",
                         j + 1, first,
                         mpq_get_d(*given_coefficient(g, first, (const mpq_t *)&zero)),
                         text ? text : "another");
        void (*release)(void *, size_t);
        mp_get_memory_functions(NULL, NULL, &release);
        if (text) release(text, strlen(text) + 1);
    } else if (wrong == 2 && first <= g->degree && last <= g->degree &&
               mpq_equal(expected[first], g->coefficient[last]) &&
               mpq_equal(expected[last], g->coefficient[first])) {
        sphv_check_cause(result,
                         "piece %d of the gradient: the coefficients of q^%d and q^%d are "
                         "swapped",
                         j + 1, first, last);
    } else if (wrong && largest < 0.01) {
        sphv_check_cause(result,
                         "piece %d of the gradient: %d coefficients are rounded (relative "
                         "error up to %.1e)",
                         j + 1, wrong, largest);
    } else if (wrong) {
        sphv_check_cause(result, "piece %d of the gradient: %d coefficients are not those of w'",
                         j + 1, wrong);
    }
    for (int k = 0; k <= compared; k++) mpq_clear(expected[k]);
    mpq_clear(zero);
}

/// A mistake that one piece of the gradient makes throughout.
static bool name_piece(const sphv_kernel *kernel, int j, sphv_check_result *result)
{
    static const struct {
        gradient_base base;
        int shift;
        const char *meaning;
    } mistakes[] = {
        {SLOPE, -1, "lacks a factor q"},
        {SLOPE, 1, "has a factor q too many"},
        {SLOPE, -2, "lacks a factor q^2"},
        {VALUE, 0, "is w itself"},
        {CURVATURE, 0, "is the second derivative"},
    };
    mpq_t factor;
    mpq_init(factor);
    bool named = false;
    for (size_t i = 0; !named && i < sizeof mistakes / sizeof *mistakes; i++) {
        named = gradient_is(kernel, mistakes[i].base, mistakes[i].shift, factor, j) &&
                factor_value(factor) == 1;
        if (named)
            sphv_check_cause(result, "piece %d of the gradient %s", j + 1, mistakes[i].meaning);
    }
    mpq_clear(factor);
    return named;
}

/// Where file gradient and w′ differ most, or w′ is largest when they do not.
static double telling_place(const sphv_profile *profile, const sphv_profile *gradient)
{
    enum { STEPS = 1000 };
    double place = 0, largest = -1, steepest = 0, steepest_at = 0;
    for (int i = 0; i < STEPS; i++) {
        double q = profile->support * (i + 0.5) / STEPS;
        sphv_result slope = sphv_profile_derivative(profile, 1, q);
        sphv_result given = sphv_profile_derivative(gradient, 0, q);
        double difference = fabs(slope.value - given.value);
        if (difference > largest && difference > 2 * (slope.bound + given.bound)) {
            largest = difference;
            place = q;
        }
        if (fabs(slope.value) > steepest) {
            steepest = fabs(slope.value);
            steepest_at = q;
        }
    }
    return largest > 0 ? place : steepest_at;
}

sphv_status sphv_check_derivative(sphv_examination *of, int dimension, sphv_error *error)
{
    const sphv_kernel *kernel = of->kernel;
    if (!kernel->gradient.count) return SPHV_OK;
    sphv_check_result *result = sphv_check_add(of, "derivative", 0, error);
    if (!result) return SPHV_RESOURCE_FAILURE;
    const sphv_profile *profile = sphv_check_profile(of, dimension);
    const sphv_profile *gradient = sphv_kernel_gradient(kernel, profile->dimension);
    mpq_t factor;
    mpq_init(factor);
    bool equal = gradient_is(kernel, SLOPE, 0, factor, -1) && factor_value(factor) == 1;
    mpq_clear(factor);
    if (gradient && !kernel->fourth_order) {
        double q = telling_place(profile, gradient), constant = profile->constant.value;
        sphv_result slope = sphv_profile_derivative(profile, 1, q);
        sphv_result given = sphv_profile_derivative(gradient, 0, q);
        sphv_check_claim(result, "the gradient of the file is w', here at q = %.6g", q);
        sphv_check_numbers(
            result, slope.value / constant, given.value / constant,
            (slope.bound + given.bound) / fabs(constant) +
                (8e-16 + 8 * fmax(kernel->pieces.rounding, kernel->gradient.rounding)) *
                    fabs(slope.value / constant));
    } else {
        sphv_check_claim(result, "the gradient of the file is w' (before the transform)");
        sphv_check_numbers(result, 1, equal, 0);
    }
    if (equal) return SPHV_OK;
    sphv_check_fail(result);
    if (name_whole(kernel, result)) return SPHV_OK;
    mpq_init(factor);
    for (int j = 0; j < kernel->gradient.count; j++)
        if (!gradient_is(kernel, SLOPE, 0, factor, j) && !name_piece(kernel, j, result))
            name_coefficients(kernel, j, result);
    mpq_clear(factor);
    if (!*result->cause)
        sphv_check_cause(result, "the pieces of the gradient end elsewhere than those of w");
    return SPHV_OK;
}
