#include "quadrature.h"

#include <float.h>
#include <gsl/gsl_integration.h>
#include <math.h>

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
