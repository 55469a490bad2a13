#include <pthread.h>

#include "sphverify/field.h"

enum { TABLE = 969 }; ///< monomials of degree <= 16 in three dimensions: 19·18·17/6

static sphv_monomial table[SPHV_DIMENSIONS][TABLE];
static pthread_once_t once = PTHREAD_ONCE_INIT;

size_t sphv_monomial_count(int dimension, int degree)
{
    size_t count = 1;
    if (degree < 0) return 0;
    for (int i = 1; i <= dimension; i++) count = count * (size_t)(degree + i) / (size_t)i;
    return count;
}

size_t sphv_monomial_index(int dimension, const int power[SPHV_DIMENSIONS])
{
    int degree = 0;
    for (int i = 0; i < dimension; i++) degree += power[i];
    size_t before = sphv_monomial_count(dimension, degree - 1);
    if (dimension == 1) return before;
    if (dimension == 2) return before + (size_t)power[1];
    // Those with a higher power of x first: one of degree m = y's and z's powers in two dimensions
    return before + sphv_monomial_count(2, power[1] + power[2] - 1) + (size_t)power[2];
}

static double factorial(int n)
{
    double product = 1;
    for (int i = 2; i <= n; i++) product *= i;
    return product;
}

static void place(int dimension, const int power[SPHV_DIMENSIONS])
{
    sphv_monomial *at = &table[dimension - 1][sphv_monomial_index(dimension, power)];
    at->factorial = 1;
    at->degree = 0;
    for (int i = 0; i < SPHV_DIMENSIONS; i++) {
        at->power[i] = power[i];
        at->degree += power[i];
        at->factorial *= factorial(power[i]);
    }
}

static void fill(void)
{
    for (int x = 0; x <= SPHV_MONOMIAL_DEGREE_MAX; x++) {
        place(1, (const int[]){x, 0, 0});
        for (int y = 0; x + y <= SPHV_MONOMIAL_DEGREE_MAX; y++) {
            place(2, (const int[]){x, y, 0});
            for (int z = 0; x + y + z <= SPHV_MONOMIAL_DEGREE_MAX; z++)
                place(3, (const int[]){x, y, z});
        }
    }
}

const sphv_monomial *sphv_monomials(int dimension)
{
    pthread_once(&once, fill);
    return table[dimension - 1];
}
