#include "radial.h"

#include <math.h>
#include <string.h>

#include "../internal.h"
#include "evaluation.h"

/// A compiled form whose terms are larger than its values by more than this factor is refused: what
/// cancels is lost.
static const double CANCELLATION_MAX = 1000;

/// sup |Ŵ^(n)| over all pieces: what a wrong q can do.
static double steepest(const sphv_profile *profile, int n)
{
    double largest = 0, factorial = 1;
    for (int i = 2; i <= n; i++) factorial *= i;
    for (int i = 0; i < profile->piece_count; i++)
        largest = fmax(largest, profile->pieces[i].derivative_bound[n] * factorial);
    return largest;
}

/// q on that side of every knot on which the squares are.
static double place(const sphv_profile *profile, double h, double square, double q)
{
    for (int i = 0; i < profile->knot_count; i++) {
        double knot = profile->knots[i].position.value, limit = knot * h;
        bool inside = square < limit * limit;
        if (inside && q >= knot) q = nextafter(knot, 0);
        if (!inside && q < knot) q = knot;
    }
    return q < profile->support ? q : nextafter(profile->support, 0);
}

void sphv_radial_values(const sphv_radial *radial, sphv_sum_level level, double square, double p[3],
                        double size[3])
{
    const sphv_degrees *moment = sphv_sum_sets[level].moment;
    sphv_result w[3];
    double q = place(radial->profile, radial->h, square, sqrt(square) / radial->h);
    sphv_profile_values(radial->profile, q, w);
    double off = 6 * SPHV_U * q; // q is wrong by at most this
    double share = SPHV_RADIAL_ERROR * SPHV_U;
    for (int k = 0; k < 3; k++) p[k] = size[k] = 0;
    p[0] = w[0].value;
    size[0] = fabs(p[0]) + (w[0].bound + radial->slope[1] * off) / share;
    if (q == 0) {
        p[1] = w[1].value == 0 ? w[2].value : 0;
        if (moment[1].from == 0) size[1] = fabs(p[1]) + w[2].bound / share;
        return;
    }
    p[1] = w[1].value / q;
    double first_error = (w[1].bound + radial->slope[2] * off) / q + 8 * SPHV_U * fabs(p[1]);
    size[1] = fabs(p[1]) + first_error / share;
    if (moment[1].from == 1) size[1] *= q;
    if (moment[2].from > moment[2].to) return;
    double second = w[2].value - p[1];
    p[2] = second / (q * q);
    double error = w[2].bound + radial->slope[3] * off + first_error + 14 * SPHV_U * fabs(second);
    size[2] = fabs(second) + error / share;
}

/// The polynomials of Ŵ and its derivatives in the t_i: what jumps at each knot, mirrored.
static bool compile_pieces(sphv_radial *radial, int derivatives)
{
    const sphv_profile *profile = radial->profile;
    int lowest = SPHV_RADIAL_TERMS;
    for (int i = 0; i < profile->piece_count; i++)
        if (profile->pieces[i].degree < 0) return false;
    for (int n = profile->knot_count - 1; n >= 0; n--) {
        const sphv_knot *knot = &profile->knots[n];
        if (knot->position.value == 0) continue;
        if (radial->knots == SPHV_RADIAL_KNOTS || knot->terms > SPHV_RADIAL_TERMS) return false;
        // A jump within the support would need a comparison of its own.
        if (knot->position.value < profile->support && knot->order <= derivatives) return false;
        int i = radial->knots++;
        radial->knot[i] = knot->position.value;
        if (knot->order < lowest) lowest = knot->order;
        for (int j = knot->order; j < knot->terms; j++) {
            double sign = j % 2 ? -1 : 1, factor = 1;
            for (int k = 0; k <= derivatives && k <= j; k++) {
                radial->term[k][i][j - k] = sign * factor * knot->jump[j];
                factor *= -(j - k);
            }
            for (int k = 0; k <= derivatives && k <= j; k++)
                if (j - k + 1 > radial->terms[k]) radial->terms[k] = j - k + 1;
        }
    }
    for (int k = 0; k <= derivatives; k++) radial->low[k] = lowest > k ? lowest - k : 0;
    return radial->knots > 0;
}

/// Moves the terms down by the powers that all have in common.
static void factor_out(sphv_radial *radial, int k)
{
    int low = radial->low[k];
    radial->terms[k] -= low;
    for (int i = 0; i < radial->knots; i++) {
        double *term = radial->term[k][i];
        memmove(term, term + low, (size_t)radial->terms[k] * sizeof *term);
        memset(term + radial->terms[k], 0, (size_t)low * sizeof *term);
    }
}

/// p_1 = Ŵ′/q as a polynomial in t: (κ − t) p_1 = Ŵ′, term by term; p_2 = p_1′/q.
static void divide(sphv_radial *radial)
{
    double edge = radial->knot[0], *first = radial->term[1][0], *second = radial->term[2][0];
    long double quotient = 0;
    int n = radial->terms[1];
    for (int j = 0; j < n; j++) {
        quotient = (first[j] + quotient) / edge;
        first[j] = (double)quotient;
        if (j > 0) second[j - 1] = (double)(-j * quotient);
    }
    first[n - 1] = 0; // what would be left over: Ŵ′(0) = 0
    if (n > 1) second[n - 2] = 0;
    radial->terms[1] = n > 1 ? n - 1 : 1;
    radial->terms[2] = n > 2 ? n - 2 : 1;
    radial->low[2] = radial->low[1] > 0 ? radial->low[1] - 1 : 0;
}

/// Σ|c_ij| k_i^j j^n/k_i^n, n = 0 or 1: bounds a polynomial's terms, or those of its slope.
static double magnitude(const sphv_radial *radial, int k, int n)
{
    double sum = 0;
    for (int i = 0; i < radial->knots; i++)
        for (int j = n; j < radial->terms[k] + radial->low[k]; j++) {
            double c = j < radial->low[k] ? 0 : radial->term[k][i][j - radial->low[k]];
            sum += fabs(c) * pow(radial->knot[i], j - n) * (n ? j : 1);
        }
    return sum;
}

/// Bounds |p_k| q^m: its largest size, and the rounding of the compiled form.
static bool bound(sphv_radial *radial, int k, int m, double largest)
{
    int operations = 2 * (radial->terms[k] + radial->low[k]) + radial->knots + 6;
    double terms = magnitude(radial, k, 0), support = radial->profile->support;
    // r² is wrong by 5 u, its root by 2 u more, q by 2 u more, and 1/q is as well.
    double error = operations * SPHV_U * terms + 8 * SPHV_U * support * magnitude(radial, k, 1);
    error *= pow(support, radial->over_q[k] ? m - 1 : m);
    error += 8 * SPHV_U * largest;
    radial->size[k] = largest + error / (SPHV_RADIAL_ERROR * SPHV_U);
    return terms * pow(support, m) < CANCELLATION_MAX * largest;
}

static bool compile(sphv_radial *radial, sphv_sum_level level)
{
    const sphv_degrees *moment = sphv_sum_sets[level].moment;
    bool second = moment[2].from <= moment[2].to;
    const sphv_knot *origin = &radial->profile->knots[0];
    bool flat = radial->profile->knot_count > 0 &&
                (origin->position.value > 0 || origin->order > 1); // Ŵ′(0) = 0
    if (!compile_pieces(radial, second ? 2 : 1)) return false;
    radial->form = radial->knots == 1 && flat ? SPHV_RADIAL_QUOTIENT : SPHV_RADIAL_SLOPE;
    // Near q = 0 a quotient of rounded numbers would be of no use without q to go with it.
    if (radial->form == SPHV_RADIAL_SLOPE && (second || moment[1].from == 0)) return false;
    if (radial->form == SPHV_RADIAL_QUOTIENT) divide(radial);
    radial->over_q[1] = radial->form == SPHV_RADIAL_SLOPE;
    radial->over_q[2] = true;
    for (int k = 0; k < (second ? 3 : 2); k++) factor_out(radial, k);
    const double *slope = radial->slope;
    if (!bound(radial, 0, 0, slope[0])) return false;
    if (!bound(radial, 1, moment[1].from, slope[2 - moment[1].from])) return false;
    if (second && !bound(radial, 2, 2, 2 * slope[2])) return false;
    // The passes divide by r.
    for (int k = 0; k < 3; k++)
        for (int i = 0; radial->over_q[k] && i < radial->knots; i++)
            for (int j = 0; j < radial->terms[k]; j++) radial->term[k][i][j] *= radial->h;
    return true;
}

void sphv_radial_make(sphv_radial *radial, const sphv_profile *profile, double h,
                      sphv_sum_level level)
{
    *radial = (sphv_radial){.profile = profile, .h = h, .inverse_h = 1 / h};
    radial->limit = (profile->support * h) * (profile->support * h);
    for (int n = 0; n < 4; n++) radial->slope[n] = steepest(profile, n);
    if (!compile(radial, level)) radial->form = SPHV_RADIAL_PROFILE;
}
