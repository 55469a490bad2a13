#include "expansion.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

static const double unit_roundoff = DBL_EPSILON / 2;

/// Errors of second order in the unit roundoff, and the rounding of a bound itself.
static const double slack = 1 + 1e-12;

double sphv_rational_over_pi(const mpq_t value, bool over_pi)
{
    // π as the sum of two doubles.
    static const double pi_high = 0x1.921fb54442d18p+1, pi_low = 0x1.1a62633145c07p-53;
    mpf_t exact, part;
    mpf_init2(exact, 192);
    mpf_init2(part, 64);
    mpf_set_q(exact, value);
    double high = mpf_get_d(exact);
    double low = 0;
    if (isfinite(high)) {
        mpf_set_d(part, high);
        mpf_sub(exact, exact, part);
        low = mpf_get_d(exact);
    }
    mpf_clear(exact);
    mpf_clear(part);
    double sum = high + low;
    if (!over_pi || !isfinite(sum)) return sum;
    low = (high - sum) + low;
    double quotient = sum / pi_high;
    double rest = fma(-quotient, pi_high, sum) + (low - quotient * pi_low);
    return quotient + rest / pi_high;
}

void sphv_piece_free(sphv_piece *piece)
{
    free((sphv_number *)piece->centre);
    free((double *)piece->taylor);
    free((int *)piece->serving);
    free(piece->derivative_bound);
}

/// The integer polynomial y ↦ scale · p(origin + y/2^bits), coefficients ascending.
struct dyadic {
    int degree;
    mp_bitcnt_t bits;
    mpz_t scale, *coefficient;
};

static bool dyadic_make(struct dyadic *d, const sphv_polynomial *p, mp_bitcnt_t bits)
{
    d->degree = p->degree;
    d->bits = bits;
    d->coefficient = malloc((size_t)(p->degree + 1) * sizeof *d->coefficient);
    if (!d->coefficient) return false;
    mpz_init_set_ui(d->scale, 1);
    for (int i = 0; i <= p->degree; i++) mpz_lcm(d->scale, d->scale, mpq_denref(p->coefficient[i]));
    for (int i = 0; i <= p->degree; i++) {
        mpz_init(d->coefficient[i]);
        mpz_divexact(d->coefficient[i], d->scale, mpq_denref(p->coefficient[i]));
        mpz_mul(d->coefficient[i], d->coefficient[i], mpq_numref(p->coefficient[i]));
        mpz_mul_2exp(d->coefficient[i], d->coefficient[i], bits * (mp_bitcnt_t)(p->degree - i));
    }
    mpz_mul_2exp(d->scale, d->scale, bits * (mp_bitcnt_t)p->degree);
    return true;
}

static void dyadic_free(struct dyadic *d)
{
    for (int i = 0; i <= d->degree; i++) mpz_clear(d->coefficient[i]);
    free(d->coefficient);
    mpz_clear(d->scale);
}

/// Shifts the origin of y, by synthetic division in integers.
static void dyadic_shift(struct dyadic *d, const mpz_t by)
{
    for (int round = 0; round < d->degree; round++)
        for (int i = d->degree - 1; i >= round; i--)
            mpz_addmul(d->coefficient[i], by, d->coefficient[i + 1]);
}

/// Coefficient of (q − origin)^i.
static void dyadic_coefficient(mpq_t out, const struct dyadic *d, int i)
{
    mpz_mul_2exp(mpq_numref(out), d->coefficient[i], d->bits * (mp_bitcnt_t)i);
    mpz_set(mpq_denref(out), d->scale);
}

static void round_row(double *row, const sphv_polynomial *p, bool over_pi)
{
    for (int i = 0; i <= p->degree; i++) row[i] = sphv_rational_over_pi(p->coefficient[i], over_pi);
}

/// How many units of u |t|^i the value may be wrong by. In Horner's rule the i-th coefficient meets
/// i products and i + 1 sums; it carries one rounding of its own and i times two of the offset: 4i
/// + 2. The same holds for its part in every derivative.
static void weigh_row(double *row, int degree)
{
    for (int i = 0; i <= degree; i++) row[degree + 1 + i] = (4 * i + 2) * fabs(row[i]);
}

/// The expansions between the ends, about binary fractions near equally spaced places.
static bool fill_middle(sphv_piece *piece, const sphv_polynomial *p, bool over_pi, double *taylor,
                        sphv_number *centre)
{
    double step = (piece->outer - piece->inner) / (piece->centres - 1);
    int exponent;
    frexp(step, &exponent);
    mp_bitcnt_t bits = exponent < 6 ? (mp_bitcnt_t)(6 - exponent) : 0; // step·2^bits >= 32
    struct dyadic d;
    if (!dyadic_make(&d, p, bits)) return false;
    mpz_t place, last, move;
    mpz_inits(place, last, move, NULL);
    mpq_t coefficient;
    mpq_init(coefficient);
    for (int k = 1; k < piece->centres - 1; k++) {
        double scaled = nearbyint(ldexp(piece->inner + k * step, (int)bits));
        centre[k] = (sphv_number){ldexp(scaled, -(int)bits), 0};
        mpz_set_d(place, scaled);
        mpz_sub(move, place, last);
        mpz_swap(last, place);
        dyadic_shift(&d, move);
        for (int i = 0; i <= p->degree; i++) {
            dyadic_coefficient(coefficient, &d, i);
            taylor[k * 2 * (p->degree + 1) + i] = sphv_rational_over_pi(coefficient, over_pi);
        }
    }
    mpq_clear(coefficient);
    mpz_clears(place, last, move, NULL);
    dyadic_free(&d);
    return true;
}

/// Σ |c_i| t^i
static double magnitude(const double *c, int degree, double t)
{
    double sum = 0;
    for (int i = degree; i >= 0; i--) sum = sum * t + fabs(c[i]);
    return sum;
}

static double value(const double *c, int degree, double t)
{
    double sum = 0;
    for (int i = degree; i >= 0; i--) sum = sum * t + c[i];
    return sum;
}

/// Near an end where the piece vanishes to high order its own terms cancel about every other
/// centre: there the expansion about the outer end serves its neighbours too, as long as it is the
/// better conditioned one, at both ends of the cell.
static void choose_serving(const sphv_piece *piece, int *serving)
{
    int degree = piece->degree, last = piece->centres - 1;
    double radius = 0.5 / piece->per_length;
    const double *edge = piece->taylor + last * 2 * (degree + 1);
    for (int k = 0; k <= last; k++) {
        const double *own = piece->taylor + k * 2 * (degree + 1);
        double far = piece->outer - piece->centre[k].value + radius, near = far - 2 * radius;
        double own_size = magnitude(own, degree, radius);
        double at_far = fabs(value(own, degree, -radius)),
               at_near = fabs(value(own, degree, radius));
        double own_worst = fmax(own_size / at_far, own_size / at_near);
        double edge_worst = fmax(magnitude(edge, degree, far) / at_far,
                                 magnitude(edge, degree, fmax(near, 0)) / at_near);
        serving[k] = edge_worst < own_worst ? last : k;
    }
    serving[last] = last;
}

/// sup |Ŵ^(n)|/n!: the largest Taylor majorant of the cells, or that of either end.
static void bound_derivatives(sphv_piece *piece)
{
    int degree = piece->degree, last = piece->centres - 1;
    double length = piece->outer - piece->inner;
    // Centres stand within 1/64 of a step of their equally spaced places.
    double radius = (0.5 + 0x1p-5) * length / last;
    for (int n = 0; n <= SPHV_JET_MAX; n++) {
        double cells = 0, ends[2] = {0, 0};
        for (int k = 0; k <= last; k++) {
            const double *c = piece->taylor + k * 2 * (degree + 1);
            double near = 0, whole = 0, power = 1, whole_power = 1, binomial = 1;
            for (int i = n; i <= degree; i++) {
                near += binomial * power * fabs(c[i]);
                whole += binomial * whole_power * fabs(c[i]);
                power *= radius;
                whole_power *= length;
                binomial *= (i + 1.0) / (i + 1 - n);
            }
            cells = fmax(cells, near);
            if (k == 0) ends[0] = whole;
            if (k == last) ends[1] = whole;
        }
        piece->derivative_bound[n] = fmin(cells, fmin(ends[0], ends[1])) * slack;
    }
}

sphv_status sphv_piece_expand(sphv_piece *piece, const sphv_exact_piece *exact, bool over_pi,
                              int centres, sphv_error *error)
{
    int degree = exact->polynomial->degree;
    double length = piece->outer - piece->inner;
    // A sliver of a piece has no room for centres that doubles can tell apart.
    if (!(length > 1e-6 * piece->outer)) centres = 2;
    size_t width = 2 * ((size_t)degree + 1);
    double *taylor = malloc((size_t)centres * width * sizeof *taylor);
    sphv_number *centre = malloc((size_t)centres * sizeof *centre);
    int *serving = malloc((size_t)centres * sizeof *serving);
    piece->degree = degree;
    piece->centres = centres;
    piece->per_length = length > 0 ? (centres - 1) / length : 0;
    piece->centre = centre;
    piece->taylor = taylor;
    piece->serving = serving;
    piece->derivative_bound = malloc((SPHV_JET_MAX + 1) * sizeof *piece->derivative_bound);
    if (!taylor || !centre || !serving || !piece->derivative_bound)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    centre[0] = sphv_rational_number(exact->inner);
    centre[centres - 1] = sphv_rational_number(exact->outer);
    round_row(taylor, exact->about_inner, over_pi);
    round_row(taylor + (size_t)(centres - 1) * width, exact->about_outer, over_pi);
    if (centres > 2 && !fill_middle(piece, exact->polynomial, over_pi, taylor, centre))
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    for (int k = 0; k < centres; k++) weigh_row(taylor + (size_t)k * width, degree);
    choose_serving(piece, serving);
    bound_derivatives(piece);
    return SPHV_OK;
}

/// The expansion that serves q, and q's offset from its centre. The offset is known to two unit
/// roundoffs: q − centre.value is exact within a factor of two (Sterbenz), rounded once elsewhere.
static const double *expansion_at(const sphv_piece *piece, double q, double *offset)
{
    int last = piece->centres - 1;
    double place = (q - piece->inner) * piece->per_length + 0.5;
    int k = piece->serving[!(place < last) ? last : place > 0 ? (int)place : 0];
    *offset = (q - piece->centre[k].value) - piece->centre[k].residual;
    return piece->taylor + k * 2 * (piece->degree + 1);
}

static sphv_result rounded(double sum, double roundings)
{
    return (sphv_result){sum, unit_roundoff * roundings * slack + DBL_MIN};
}

/// p(t), p′(t) and p″(t)/2 in one Horner pass.
static inline void horner(const double *c, int degree, double t, double out[3])
{
    double value = c[degree], slope = 0, bend = 0;
    for (int i = degree - 1; i >= 0; i--) {
        bend = bend * t + slope;
        slope = slope * t + value;
        value = value * t + c[i];
    }
    out[0] = value;
    out[1] = slope;
    out[2] = bend;
}

void sphv_piece_values(const sphv_piece *piece, double q, sphv_result out[3])
{
    double t, sum[3], roundings[3];
    const double *c = expansion_at(piece, q, &t);
    horner(c, piece->degree, t, sum);
    horner(c + piece->degree + 1, piece->degree, fabs(t), roundings);
    out[0] = rounded(sum[0], roundings[0]);
    out[1] = rounded(sum[1], roundings[1]);
    out[2] = rounded(2 * sum[2], 2 * roundings[2]);
}

/// i!/(i − derivative)!, exact as long as it is below 2^53.
static inline double falling_factorial(int i, int derivative)
{
    double product = 1;
    for (int k = 0; k < derivative; k++) product *= i - k;
    return product;
}

/// A low derivative, whose factors are exact: inlined for each order, so that none of them costs a
/// division.
static inline sphv_result low_derivative(const double *c, int degree, int derivative, double t)
{
    const double *weight = c + degree + 1;
    double sum = 0, roundings = 0;
    for (int i = degree; i >= derivative; i--) {
        double factor = falling_factorial(i, derivative);
        sum = sum * t + c[i] * factor;
        roundings = roundings * fabs(t) + weight[i] * factor;
    }
    return rounded(sum, roundings);
}

sphv_result sphv_piece_derivative(const sphv_piece *piece, int derivative, double q)
{
    double t;
    const double *c = expansion_at(piece, q, &t), *weight = c + piece->degree + 1;
    if (derivative > piece->degree) return (sphv_result){0, 0};
    if (derivative == 0) return low_derivative(c, piece->degree, 0, t);
    if (derivative == 1) return low_derivative(c, piece->degree, 1, t);
    if (derivative == 2) return low_derivative(c, piece->degree, 2, t);
    double sum = 0, roundings = 0, factor = falling_factorial(piece->degree, derivative);
    bool exact_factor = factor * piece->degree < 0x1p53;
    for (int i = piece->degree; i >= derivative; i--) {
        sum = sum * t + c[i] * factor;
        roundings = roundings * fabs(t) + weight[i] * factor;
        factor = factor * (i - derivative) / i;
    }
    // Every coefficient of a weight ≥ 2 may meet these roundings of its factor as well.
    return rounded(sum, exact_factor ? roundings : roundings * (1 + derivative + piece->degree));
}
