#include "methods_support.h"

#include <float.h>
#include <math.h>

#define U (DBL_EPSILON / 2)

void scatter(int dimension, double support, struct cloud *out)
{
    static const int counts[] = {40, 150, 400};
    static const double reach[] = {0.25, 0.35, 0.6}; // of the support, at most
    *out = (struct cloud){.dimension = dimension, .count = counts[dimension - 1], .h = 1};
    while (out->h * support > reach[dimension - 1]) out->h /= 2;
    for (int b = 0; b < out->count; b++) {
        out->volume[b] = random_log(0.5, 2) / out->count;
        for (int i = 0; i < dimension; i++) {
            out->x[b][i] = (double)random_integer(0, 256) / 256;
            if (b < 1 << dimension)
                out->x[b][i] = b >> i & 1; // corners
            else if (b % 8 == 0 && i == b / 8 % dimension)
                out->x[b][i] = 0; // sides
        }
    }
}

/// p_k at distance q, as sums.h defines them.
static void radial(const sphv_profile *profile, double q, double p[3])
{
    sphv_result w[3];
    sphv_profile_values(profile, q, w);
    p[0] = w[0].value;
    p[1] = q > 0 ? w[1].value / q : w[1].value == 0 ? w[2].value : 0;
    p[2] = q > 0 ? (w[2].value - w[1].value / q) / (q * q) : 0;
}

/// Offset in units of h, and whether b is in support.
static bool offset(const sphv_profile *profile, const struct cloud *cloud, int a, int b,
                   double s[SPHV_DIMENSIONS], double *q)
{
    double square = 0;
    for (int i = 0; i < SPHV_DIMENSIONS; i++) {
        s[i] = i < cloud->dimension ? (cloud->x[b][i] - cloud->x[a][i]) / cloud->h : 0;
        square += s[i] * s[i];
    }
    *q = sqrt(square);
    return *q < profile->support;
}

static double power(int d, int k, const double s[SPHV_DIMENSIONS])
{
    double product = 1;
    for (int i = 0; i < d; i++)
        for (int n = 0; n < sphv_monomials(d)[k].power[i]; n++) product *= s[i];
    return product;
}

/// All sums of one particle, in the first column of a block of eight.
static unsigned sum(const sphv_profile *profile, const struct cloud *cloud, int a,
                    const sphv_sum_layout *layout, double *sums, double *spread)
{
    const sphv_sum_set *set = &sphv_sum_sets[layout->level];
    int d = cloud->dimension, fields = cloud->fields ? cloud->fields : 1;
    unsigned neighbours = 0;
    for (int b = 0; b < cloud->count; b++) {
        double s[SPHV_DIMENSIONS], q, p[3];
        if (!offset(profile, cloud, a, b, s, &q)) continue;
        neighbours++;
        radial(profile, q, p);
        double v = cloud->volume[b] / pow(cloud->h, d), powers[64];
        for (int j = 0; j < (int)sphv_monomial_count(d, 5); j++) powers[j] = power(d, j, s);
        for (int k = 0; k < 3; k++) {
            const sphv_degrees *moment = &set->moment[k], *of_field = &set->field[k];
            if (moment->from <= moment->to)
                sums[(layout->size_at + k) * 8] += v * fabs(p[k]) * pow(q, moment->from);
            for (int j = (int)sphv_monomial_count(d, moment->from - 1);
                 j < (int)sphv_monomial_count(d, moment->to); j++)
                sums[sphv_moment_index(layout, k, j) * 8] += v * p[k] * powers[j];
            for (int j = (int)sphv_monomial_count(d, of_field->from - 1);
                 j < (int)sphv_monomial_count(d, of_field->to); j++)
                for (int f = 0; f < fields; f++)
                    sums[sphv_field_sum_index(layout, f, k, j) * 8] +=
                        v * p[k] * powers[j] * (cloud->field[f][b] - cloud->field[f][a]);
        }
        for (int f = 0; f < fields; f++)
            spread[f] = fmax(spread[f], fabs(cloud->field[f][b] - cloud->field[f][a]));
    }
    return neighbours;
}

void estimate_at_level(const sphv_profile *profile, sphv_method method, const struct cloud *cloud,
                       int a, sphv_sum_level level, struct single *out)
{
    enum { MOST = 300 };
    static double sums[MOST * 8];
    int fields = cloud->fields ? cloud->fields : 1;
    sphv_sum_layout layout = sphv_sum_layout_make(cloud->dimension, level, fields);
    assert_true(layout.count <= MOST);
    memset(sums, 0, sizeof sums);
    double spread[2] = {0, 0}, rounding[8], values[2 * 8] = {0}, estimates[2][SPHV_QUANTITIES_MAX];
    double bounds[2 * SPHV_QUANTITIES_MAX] = {0}, *arrays[2 * SPHV_QUANTITIES_MAX];
    size_t particle = 0, quantities = sphv_method_quantities(method, cloud->dimension);
    unsigned char fault = SPHV_FAULTS;
    *out = (struct single){.neighbours = sum(profile, cloud, a, &layout, sums, spread)};
    // at most five factors and the kernel's division in a term, twice as many roundings with the
    // offset's; then one for each addition
    for (int l = 0; l < 8; l++) rounding[l] = (out->neighbours + 20) * U;
    for (int f = 0; f < fields; f++) {
        values[f * 8] = cloud->field[f][a];
        for (size_t q = 0; q < quantities; q++)
            arrays[(size_t)f * quantities + q] = &estimates[f][q];
    }
    sphv_sum_block block = {.layout = &layout,
                            .count = 1,
                            .stride = 8,
                            .sums = sums,
                            .particle = &particle,
                            .neighbours = &out->neighbours,
                            .rounding = rounding,
                            .spread = spread};
    sphv_request request = {.profile = profile,
                            .h = cloud->h,
                            .method_count = 1,
                            .methods = &method,
                            .field_count = (size_t)fields};
    sphv_method_estimates found = {.method = method,
                                   .quantities = quantities,
                                   .estimate = arrays,
                                   .condition = &out->condition,
                                   .fault = &fault,
                                   .rounding = bounds};
    sphv_solve_block(&block, &request, values, &found);
    out->fault = (sphv_fault)fault;
    for (size_t q = 0; q < quantities; q++) {
        out->estimate[q] = estimates[0][q];
        out->second[q] = fields > 1 ? estimates[1][q] : 0;
        out->rounding[q] = bounds[q];
    }
}

void estimate_at(const sphv_profile *profile, sphv_method method, const struct cloud *cloud, int a,
                 struct single *out)
{
    estimate_at_level(profile, method, cloud, a, sphv_method_level(method), out);
}

enum { LARGEST = 10 };

/// Gaussian elimination with partial pivoting; the right side becomes the solution.
static void eliminate(int n, long double m[LARGEST][LARGEST], long double *x)
{
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabsl(m[i][k]) > fabsl(m[pivot][k])) pivot = i;
        for (int j = 0; j < n; j++) {
            long double other = m[k][j];
            m[k][j] = m[pivot][j];
            m[pivot][j] = other;
        }
        long double right = x[k];
        x[k] = x[pivot];
        x[pivot] = right;
        for (int i = k + 1; i < n; i++) {
            long double factor = m[i][k] / m[k][k];
            for (int j = k; j < n; j++) m[i][j] -= factor * m[k][j];
            x[i] -= factor * x[k];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int j = i + 1; j < n; j++) x[i] -= m[i][j] * x[j];
        x[i] /= m[i][i];
    }
}

/// W, ∂W and ∂²W of one neighbour in the order of the monomials, and s^β/β!.
struct neighbour {
    long double w[LARGEST], taylor[LARGEST], s[SPHV_DIMENSIONS], v, value;
};

static int gather(const sphv_profile *profile, const struct cloud *cloud, int a,
                  struct neighbour *of)
{
    int d = cloud->dimension, count = 0;
    for (int b = 0; b < cloud->count; b++) {
        double s[SPHV_DIMENSIONS], q, p[3];
        if (!offset(profile, cloud, a, b, s, &q)) continue;
        struct neighbour *n = &of[count++];
        radial(profile, q, p);
        n->v = (long double)cloud->volume[b] / powl(cloud->h, d);
        n->value = cloud->field[0][b];
        for (int i = 0; i < SPHV_DIMENSIONS; i++) n->s[i] = s[i];
        for (size_t k = 0; k < sphv_monomial_count(d, 2); k++) {
            const sphv_monomial *m = &sphv_monomials(d)[k];
            long double product = 1;
            for (int i = 0; i < d; i++)
                for (int e = 0; e < m->power[i]; e++) product *= s[i];
            bool square = m->power[0] == 2 || m->power[1] == 2 || m->power[2] == 2;
            n->w[k] = p[m->degree] * product + (square ? p[1] : 0);
            n->taylor[k] = product / m->factorial;
        }
    }
    return count;
}

static void reference_taylor(int n, int count, const struct neighbour *of, long double *out)
{
    long double m[LARGEST][LARGEST] = {{0}};
    for (int i = 0; i < n; i++) out[i] = 0;
    for (int b = 0; b < count; b++)
        for (int i = 0; i < n; i++) {
            out[i] += of[b].v * of[b].w[i] * of[b].value;
            for (int j = 0; j < n; j++) m[i][j] += of[b].v * of[b].w[i] * of[b].taylor[j];
        }
    eliminate(n, m, out);
}

/// Value and gradient from given gradients of weights: CSPM with those of W, or the mixed
/// correction with those of W̃.
static void reference_corrected(int d, bool mixed, int count, const struct neighbour *of,
                                long double own, long double *out)
{
    long double sum = 0, slope[SPHV_DIMENSIONS] = {0}, m[LARGEST][LARGEST] = {{0}};
    for (int i = 0; i <= d; i++) out[i] = 0;
    for (int b = 0; b < count; b++) {
        sum += of[b].v * of[b].w[0];
        out[0] += of[b].v * of[b].w[0] * of[b].value;
        for (int i = 0; i < d; i++) slope[i] += of[b].v * of[b].w[1 + i];
    }
    out[0] /= sum;
    for (int b = 0; b < count; b++)
        for (int i = 0; i < d; i++) {
            long double g = of[b].w[1 + i];
            if (mixed) g = (g * sum - of[b].w[0] * slope[i]) / (sum * sum);
            out[1 + i] += of[b].v * g * (of[b].value - own);
            for (int j = 0; j < d; j++) m[i][j] += of[b].v * g * of[b].s[j];
        }
    eliminate(d, m, out + 1);
}

/// Moving least squares with the weights as functions of the particle's place x = 0:
/// f(x) = Σ_b ψ_b A_b; its gradient by differentiating M(x) c(x) = P(0).
static void reference_reproducing(int d, int n, int count, const struct neighbour *of,
                                  long double own, long double *out)
{
    long double m[LARGEST][LARGEST] = {{0}}, c[LARGEST] = {1}, copy[LARGEST][LARGEST];
    const sphv_monomial *table = sphv_monomials(d);
    for (int b = 0; b < count; b++)
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                m[i][j] += of[b].v * of[b].w[0] * of[b].taylor[i] * of[b].taylor[j];
    memcpy(copy, m, sizeof m);
    eliminate(n, copy, c);
    for (int q = 0; q <= d; q++) out[q] = 0;
    for (int b = 0; b < count; b++)
        for (int i = 0; i < n; i++)
            out[0] += c[i] * of[b].taylor[i] * of[b].w[0] * of[b].v * (of[b].value - own);
    out[0] += own;
    for (int k = 0; k < d; k++) {
        // ∂_k of the basis (s − x)^β/β! is −(s − x)^(β − e_k)/(β − e_k)!, of W it is −∂_kW
        long double change[LARGEST] = {0};
        for (int pass = 0; pass < 2; pass++)
            for (int b = 0; b < count; b++) {
                long double slope[LARGEST] = {0}, psi = 0, moved = 0;
                for (int i = 0; i < n; i++) {
                    int lower[SPHV_DIMENSIONS] = {table[i].power[0], table[i].power[1],
                                                  table[i].power[2]};
                    if (lower[k]-- > 0) slope[i] = -of[b].taylor[sphv_monomial_index(d, lower)];
                    psi += c[i] * of[b].taylor[i];
                    moved += c[i] * slope[i];
                }
                long double w = of[b].v * of[b].w[0], g = -of[b].v * of[b].w[1 + k];
                if (pass == 0) // c′ = −M⁻¹ M′ c
                    for (int i = 0; i < n; i++)
                        change[i] -= g * of[b].taylor[i] * psi + w * slope[i] * psi +
                                     w * of[b].taylor[i] * moved;
                else
                    for (int i = 0; i < n; i++)
                        out[1 + k] += (of[b].value - own) *
                                      (change[i] * of[b].taylor[i] * w + c[i] * slope[i] * w +
                                       c[i] * of[b].taylor[i] * g);
                if (pass == 0 && b == count - 1) {
                    memcpy(copy, m, sizeof m);
                    eliminate(n, copy, change);
                }
            }
    }
}

void reference_at(const sphv_profile *profile, sphv_method method, const struct cloud *cloud, int a,
                  long double out[SPHV_QUANTITIES_MAX])
{
    static struct neighbour of[CLOUD_MOST];
    int d = cloud->dimension, count = gather(profile, cloud, a, of);
    long double own = cloud->field[0][a];
    int first = d + 1, second = (d + 1) * (d + 2) / 2;
    switch (method) {
    case SPHV_SPH:
    case SPHV_SPH_DIFFERENCE:
        for (int q = 0; q <= d; q++) {
            out[q] = 0;
            for (int b = 0; b < count; b++)
                out[q] += (q ? -1 : 1) * of[b].v * of[b].w[q] *
                          (of[b].value - (q && method == SPHV_SPH_DIFFERENCE ? own : 0));
        }
        break;
    case SPHV_SHEPARD:
    case SPHV_RKPM_0:
        reference_reproducing(d, 1, count, of, own, out);
        break;
    case SPHV_RKPM:
        reference_reproducing(d, first, count, of, own, out);
        break;
    case SPHV_RKPM_2:
        reference_reproducing(d, second, count, of, own, out);
        break;
    case SPHV_BONET_LOK:
        reference_corrected(d, true, count, of, own, out);
        break;
    case SPHV_CSPM:
        reference_corrected(d, false, count, of, own, out);
        break;
    case SPHV_FPM:
        reference_taylor(first, count, of, out);
        break;
    case SPHV_MSPH:
        reference_taylor(second, count, of, out);
        break;
    }
    for (size_t q = 1; q < sphv_method_quantities(method, d); q++)
        for (int n = 0; n < sphv_monomials(d)[q].degree; n++) out[q] /= cloud->h;
}
