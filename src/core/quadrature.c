#include "quadrature.h"

#include <float.h>
#include <gsl/gsl_integration.h>
#include <math.h>

#include "sphverify/kernel.h"

enum { NODES = 32 };

sphv_result sphv_quadrature(double (*f)(double x, void *context), void *context, double from,
                            double to, double panel)
{
    // GSL keeps the 32-point rule as a constant table, so this allocates a handle, not the nodes.
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(NODES);
    if (!rule) return (sphv_result){NAN, INFINITY};
    double count = fmax(1, ceil((to - from) / panel));
    double sum = 0, lost = 0, magnitude = 0;
    for (double i = 0; i < count; i++) {
        double a = from + (to - from) * (i / count), b = from + (to - from) * ((i + 1) / count);
        for (size_t node = 0; node < NODES; node++) {
            double x, weight;
            gsl_integration_glfixed_point(a, b, node, &x, &weight, rule);
            double term = weight * f(x, context), next = sum + term;
            lost += fabs(sum) >= fabs(term) ? (sum - next) + term : (term - next) + sum;
            sum = next;
            magnitude += fabs(term);
        }
    }
    gsl_integration_glfixed_table_free(rule);
    return (sphv_result){sum + lost, 8 * DBL_EPSILON * magnitude};
}

/// A compensated sum (Neumaier 1974) and the sum of what is not known about its terms.
struct running {
    double sum, lost, bound;
};

static void add(struct running *to, double term, double bound)
{
    double next = to->sum + term;
    to->lost += fabs(to->sum) >= fabs(term) ? (to->sum - next) + term : (term - next) + to->sum;
    to->sum = next;
    to->bound += bound + DBL_EPSILON * DBL_EPSILON * fabs(next);
}

/// Adds one node to every moment. q^n is carried as the sum of two doubles.
static void add_node(struct running *to, double q, double weight, double place_error, int first,
                     int count, const sphv_result w[2])
{
    double high = 1, low = 0;
    for (int n = 0; n < first + count; n++) {
        if (n >= first) {
            double size = fabs(w[0].value) * (n * place_error + 3 * DBL_EPSILON);
            double slope = (fabs(w[1].value) + w[1].bound) * q * place_error;
            add(&to[n - first], weight * (high * w[0].value),
                weight * high * (w[0].bound + size + slope));
        }
        double product = high * q;
        low = fma(high, q, -product) + low * q;
        high = product + low;
        low = (product - high) + low;
    }
}

sphv_status sphv_quadrature_moments(void (*values)(const void *context, double q,
                                                   sphv_result out[3]),
                                    const void *context, double from, double to, double panel,
                                    int first, int count, sphv_result *out)
{
    struct running sums[SPHV_MOMENT_MAX + 1] = {{0, 0, 0}};
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(NODES);
    if (!rule) return SPHV_RESOURCE_FAILURE;
    double panels = fmax(1, ceil((to - from) / panel));
    for (double i = 0; i < panels; i++) {
        double a = from + (to - from) * (i / panels), b = from + (to - from) * ((i + 1) / panels);
        for (size_t node = 0; node < NODES; node++) {
            double q, weight;
            sphv_result w[3];
            gsl_integration_glfixed_point(a, b, node, &q, &weight, rule);
            values(context, q, w);
            // The node's place carries two roundings of its panel's end.
            add_node(sums, q, weight, DBL_EPSILON * b / q, first, count, w);
        }
    }
    gsl_integration_glfixed_table_free(rule);
    for (int j = 0; j < count; j++) {
        double value = sums[j].sum + sums[j].lost;
        out[j] = (sphv_result){value, sums[j].bound + DBL_EPSILON * fabs(value)};
    }
    return SPHV_OK;
}
