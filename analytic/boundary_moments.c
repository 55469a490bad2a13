#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>
#include <stdlib.h>
#include <string.h>

#include "boundary_internal.h"

// Moments over an octant {0 <= s_i < t_i, |s| < κ} in polar coordinates. The radius is cut at the
// kernel's knots and where an edge or corner enters, the angular part of a plane is a closed form.
// At those radii angles begin like a square root: q = a + (b − a) sin²(πx/2) makes the integrand
// analytic in x, and Gauss–Legendre rules converge geometrically.

enum { BREAKS = SPHV_PIECES_MAX + 12, ORDER = SPHV_MONOMIAL_DEGREE_MAX + 1 };

void sphv_radial_functions(const sphv_profile *profile, double q, double out[SPHV_RADIALS])
{
    sphv_result values[3];
    sphv_profile_values(profile, q, values);
    out[0] = values[0].value;
    if (q > 0) {
        out[1] = values[1].value / q;
        out[2] = values[2].value - out[1];
    } else {
        out[1] = values[1].value == 0 ? values[2].value : 0;
        out[2] = 0;
    }
}

/// ∫cos^a φ sin^b φ dφ, a + b <= degree, over the angles of the quarter circle of radius q that lie
/// in {x < t[0], y < t[1]}; false when none do.
static bool angles(double q, const double *t, int degree, double out[ORDER][ORDER])
{
    double c[2] = {1, 0}, s[2] = {0, 1}, angle[2] = {0, M_PI_2};
    if (q > t[0]) {
        c[0] = t[0] / q;
        s[0] = sqrt((q - t[0]) * (q + t[0])) / q;
        angle[0] = atan2(s[0], c[0]);
    }
    if (q > t[1]) {
        s[1] = t[1] / q;
        c[1] = sqrt((q - t[1]) * (q + t[1])) / q;
        angle[1] = atan2(s[1], c[1]);
    }
    if (!(angle[1] > angle[0])) return false;
    out[0][0] = angle[1] - angle[0];
    if (degree >= 1) {
        out[1][0] = s[1] - s[0];
        out[0][1] = c[0] - c[1];
    }
    if (degree >= 2) out[1][1] = 0.5 * (s[1] - s[0]) * (s[1] + s[0]);
    for (int a = 0; a <= degree; a++)
        for (int b = 0; a + b <= degree; b++) {
            double whole = a + b;
            if (a >= 2)
                out[a][b] = (gsl_pow_int(c[1], a - 1) * gsl_pow_int(s[1], b + 1) -
                             gsl_pow_int(c[0], a - 1) * gsl_pow_int(s[0], b + 1) +
                             (a - 1) * out[a - 2][b]) /
                            whole;
            else if (b >= 2)
                out[a][b] = (gsl_pow_int(c[0], a + 1) * gsl_pow_int(s[0], b - 1) -
                             gsl_pow_int(c[1], a + 1) * gsl_pow_int(s[1], b - 1) +
                             (b - 1) * out[a][b - 2]) /
                            whole;
        }
    return true;
}

struct rule {
    int count;
    double x[64], weight[64]; ///< of x on [0, 1], for the graded variable sin²(πx/2)
};

static bool make_rule(int count, struct rule *out)
{
    gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc((size_t)count);
    if (!table) return false;
    out->count = count;
    for (int i = 0; i < count; i++) {
        double x, weight;
        gsl_integration_glfixed_point(0, 1, (size_t)i, &x, &weight, table);
        out->x[i] = gsl_pow_2(sin(M_PI_2 * x));
        out->weight[i] = weight * M_PI_2 * sin(M_PI * x);
    }
    gsl_integration_glfixed_table_free(table);
    return true;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/// Sorts break points, keeps those within [0, last], and ends them with both.
static int sort_breaks(double *at, int count, double last)
{
    int kept = 0;
    for (int i = 0; i < count; i++)
        if (at[i] > 0 && at[i] < last) at[kept++] = at[i];
    at[kept++] = 0;
    at[kept++] = last;
    qsort(at, (size_t)kept, sizeof *at, ascending);
    return kept;
}

struct octant {
    const sphv_profile *profile;
    const struct rule *rule;
    const double *t;
    int degree;
    double *sum[SPHV_RADIALS], *size[SPHV_RADIALS];
};

/// Adds ∫ of one sphere of radius q: angular[α] times q^|α| times the radial functions.
static void add_sphere(const struct octant *of, double q, double weight, const double *angular)
{
    int d = of->profile->dimension;
    const sphv_monomial *table = sphv_monomials(d);
    double p[SPHV_RADIALS], power[ORDER] = {1};
    sphv_radial_functions(of->profile, q, p);
    for (int i = 1; i < ORDER; i++) power[i] = power[i - 1] * q;
    for (size_t m = 0; m < sphv_monomial_count(d, of->degree); m++)
        for (int k = 0; k < SPHV_RADIALS; k++) {
            int exponent = table[m].degree - (k == 2 ? 2 : 0);
            if (exponent < 0) continue;
            double term = weight * p[k] * power[exponent] * angular[m];
            of->sum[k][m] += term;
            of->size[k][m] += fabs(term);
        }
}

static void line_octant(const struct octant *of, double q, double weight)
{
    double ones[ORDER];
    for (int i = 0; i < ORDER; i++) ones[i] = 1;
    add_sphere(of, q, weight, ones);
}

static void plane_octant(const struct octant *of, double q, double weight)
{
    double arc[ORDER][ORDER], angular[ORDER * (ORDER + 1) / 2];
    if (!angles(q, of->t, of->degree, arc)) return;
    const sphv_monomial *table = sphv_monomials(2);
    for (size_t m = 0; m < sphv_monomial_count(2, of->degree); m++)
        angular[m] = arc[table[m].power[0]][table[m].power[1]];
    add_sphere(of, q, weight * q, angular);
}

/// A sphere's part in the octant: circles of radius √(1 − z²), z = s_3/q.
static void space_octant(const struct octant *of, double q, double weight)
{
    const double *t = of->t;
    const sphv_monomial *table = sphv_monomials(3);
    size_t count = sphv_monomial_count(3, of->degree);
    double *angular = calloc(count, sizeof *angular), arc[ORDER][ORDER];
    if (!angular) {
        of->sum[0][0] = NAN;
        return;
    }
    double corner = t[0] * t[0] + t[1] * t[1];
    double at[8] = {sqrt(fmax(0, q * q - t[0] * t[0])) / q, sqrt(fmax(0, q * q - t[1] * t[1])) / q,
                    sqrt(fmax(0, q * q - corner)) / q};
    int breaks = sort_breaks(at, 3, fmin(1, t[2] / q));
    for (int i = 0; i + 1 < breaks; i++)
        for (int node = 0; node < of->rule->count; node++) {
            double z = at[i] + (at[i + 1] - at[i]) * of->rule->x[node];
            double share = (at[i + 1] - at[i]) * of->rule->weight[node];
            double circle = sqrt((1 - z) * (1 + z));
            if (!(circle > 0) || !angles(q * circle, t, of->degree, arc)) continue;
            for (size_t m = 0; m < count; m++) {
                const int *power = table[m].power;
                angular[m] += share * gsl_pow_int(z, power[2]) *
                              gsl_pow_int(circle, power[0] + power[1]) * arc[power[0]][power[1]];
            }
        }
    add_sphere(of, q, weight * q * q, angular);
    free(angular);
}

static void integrate(const struct octant *of)
{
    const sphv_profile *profile = of->profile;
    int d = profile->dimension, count = 0;
    double at[BREAKS], reach = 0;
    for (int i = 0; i < profile->piece_count; i++) at[count++] = profile->pieces[i].outer;
    for (int set = 1; set < 1 << d; set++) {
        double square = 0;
        for (int i = 0; i < d; i++)
            if (set >> i & 1) square += of->t[i] * of->t[i];
        at[count++] = reach = sqrt(square);
    }
    int breaks = sort_breaks(at, count, fmin(profile->support, reach));
    for (int i = 0; i + 1 < breaks; i++)
        for (int node = 0; node < of->rule->count; node++) {
            double q = at[i] + (at[i + 1] - at[i]) * of->rule->x[node];
            double weight = (at[i + 1] - at[i]) * of->rule->weight[node];
            if (d == 1)
                line_octant(of, q, weight);
            else if (d == 2)
                plane_octant(of, q, weight);
            else
                space_octant(of, q, weight);
        }
}

/// Whether Ŵ′ does not vanish at the origin, so that p_1 is like 1/q there.
static bool has_tip(const sphv_profile *profile)
{
    sphv_result values[3];
    sphv_profile_values(profile, 0, values);
    return fabs(values[1].value) > values[1].bound;
}

static bool is_formed(const sphv_profile *profile, int k, int degree)
{
    if (k == 2) return degree >= 2;
    return !(k == 1 && degree == 0 && profile->dimension == 1 && has_tip(profile));
}

/// Adds the octants, each with its sign, evaluated by two rules. \param work 4 arrays for each k
static void add_octants(const sphv_profile *profile, const double *below, const double *above,
                        int degree, const struct rule rules[2], double *work, sphv_result *out[3])
{
    int d = profile->dimension;
    const sphv_monomial *table = sphv_monomials(d);
    size_t count = sphv_monomial_count(d, degree);
    for (int octant = 0; octant < 1 << d; octant++) {
        double t[SPHV_DIMENSIONS], *at = work;
        struct octant of[2];
        memset(work, 0, 4 * SPHV_RADIALS * count * sizeof *work);
        for (int i = 0; i < d; i++)
            t[i] = fmin(octant >> i & 1 ? below[i] : above[i], profile->support);
        for (int r = 0; r < 2; r++) {
            of[r] = (struct octant){profile, &rules[r], t, degree, {0}, {0}};
            for (int k = 0; k < SPHV_RADIALS; k++, at += 2 * count) {
                of[r].sum[k] = at;
                of[r].size[k] = at + count;
            }
            integrate(&of[r]);
        }
        for (int k = 0; k < SPHV_RADIALS; k++)
            for (size_t m = 0; m < count; m++) {
                double sign = 1;
                for (int i = 0; i < d; i++)
                    if ((octant >> i & 1) && table[m].power[i] % 2) sign = -sign;
                out[k][m].value += sign * of[0].sum[k][m];
                // The finer rule is far closer than the coarser; kernel, places and weights are
                // known to a few units each, 64 in all, and |α| more through the powers.
                out[k][m].bound += fabs(of[0].sum[k][m] - of[1].sum[k][m]) +
                                   (64 + table[m].degree) * SPHV_U * of[0].size[k][m];
            }
    }
}

sphv_status sphv_truncated_moments(const sphv_profile *profile, const double *below,
                                   const double *above, int degree, sphv_result *out[3],
                                   sphv_error *error)
{
    int d = profile->dimension;
    if (degree < 0 || degree > SPHV_MONOMIAL_DEGREE_MAX)
        return sphv_fail(error, SPHV_INVALID_INPUT, "moments of degree %d; allowed: 0 to %d",
                         degree, SPHV_MONOMIAL_DEGREE_MAX);
    for (int i = 0; i < d; i++)
        if (!(below[i] >= 0 && above[i] >= 0))
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "a particle outside its box: distances %g and %g; allowed: 0 or more",
                             below[i], above[i]);
    size_t count = sphv_monomial_count(d, degree);
    struct rule rules[2];
    double *work = malloc(4 * SPHV_RADIALS * count * sizeof *work);
    if (!work || !make_rule(d < 3 ? 64 : 32, &rules[0]) || !make_rule(d < 3 ? 48 : 24, &rules[1])) {
        free(work);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for moments");
    }
    for (int k = 0; k < SPHV_RADIALS; k++) memset(out[k], 0, count * sizeof *out[k]);
    add_octants(profile, below, above, degree, rules, work, out);
    free(work);
    if (isnan(out[0][0].value))
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "not enough memory for moments");
    for (int k = 0; k < SPHV_RADIALS; k++)
        for (size_t m = 0; m < count; m++)
            if (!is_formed(profile, k, sphv_monomials(d)[m].degree))
                out[k][m] = (sphv_result){0, INFINITY};
    return SPHV_OK;
}
