#include "rational.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Reads one unsigned decimal into `out` and moves `*text` behind it; false when there is none.
static int read_decimal(const char **text, mpq_t out)
{
    char digits[96];
    size_t count = 0;
    long scale = 0;
    int seen_point = 0;
    const char *c = *text;
    for (; isdigit((unsigned char)*c) || (*c == '.' && !seen_point); c++) {
        if (*c == '.') {
            seen_point = 1;
            continue;
        }
        if (count + 1 >= sizeof digits) return 0;
        digits[count++] = *c;
        scale -= seen_point;
    }
    if (count == 0) return 0;
    digits[count] = '\0';
    if (*c == 'e' || *c == 'E') {
        char *end;
        const char *exponent = c + 1;
        if (*exponent == '+' || *exponent == '-') exponent++;
        if (!isdigit((unsigned char)*exponent)) return 0;
        long power = strtol(c + 1, &end, 10);
        if (power < -400 || power > 400) return 0;
        scale += power;
        c = end;
    }
    mpz_set_str(mpq_numref(out), digits, 10);
    mpz_set_ui(mpq_denref(out), 1);
    mpz_t ten;
    mpz_init(ten);
    mpz_ui_pow_ui(ten, 10, (unsigned long)labs(scale));
    if (scale >= 0)
        mpz_mul(mpq_numref(out), mpq_numref(out), ten);
    else
        mpz_set(mpq_denref(out), ten);
    mpz_clear(ten);
    mpq_canonicalize(out);
    *text = c;
    return 1;
}

sphv_status sphv_rational_parse(const char *text, mpq_t out, sphv_error *error)
{
    const char *c = text;
    int negative = 0;
    if (strlen(text) > 80)
        return sphv_fail(error, SPHV_INVALID_INPUT, "number of %zu characters; allowed: at most 80",
                         strlen(text));
    if (*c == '+' || *c == '-') negative = *c++ == '-';
    int good = read_decimal(&c, out);
    if (good && *c == '/') {
        mpq_t divisor;
        mpq_init(divisor);
        c++;
        good = read_decimal(&c, divisor);
        if (good && mpq_sgn(divisor) == 0) {
            mpq_clear(divisor);
            return sphv_fail(error, SPHV_INVALID_INPUT,
                             "'%s' divides by zero; allowed: a non-zero denominator", text);
        }
        if (good) mpq_div(out, out, divisor);
        mpq_clear(divisor);
    }
    if (!good || *c != '\0')
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "'%s' is not a number; allowed: decimals and fractions such as 0.37, "
                         "1e-3, -3/2",
                         text);
    if (negative) mpq_neg(out, out);
    return SPHV_OK;
}

double sphv_decimal_uncertainty(const char *text)
{
    int digits = 0;
    for (const char *c = text; *c && *c != 'e' && *c != 'E'; c++) {
        if (*c == '/') return 0;
        digits += isdigit((unsigned char)*c) && (digits > 0 || *c != '0');
    }
    if (digits < 16 || !strpbrk(text, ".eE")) return 0;
    return fmax(pow(10, 1 - digits), DBL_EPSILON);
}

double sphv_rational_round(const mpq_t value)
{
    double toward_zero = mpq_get_d(value);
    if (!isfinite(toward_zero)) return toward_zero;
    double away = nextafter(toward_zero, mpq_sgn(value) < 0 ? -INFINITY : INFINITY);
    if (!isfinite(away)) return toward_zero;
    mpq_t low, high;
    mpq_inits(low, high, NULL);
    mpq_set_d(low, toward_zero);
    mpq_set_d(high, away);
    mpq_sub(low, value, low);
    mpq_sub(high, high, value);
    mpq_abs(low, low);
    mpq_abs(high, high);
    int closer_away = mpq_cmp(high, low) < 0;
    mpq_clears(low, high, NULL);
    return closer_away ? away : toward_zero;
}

sphv_number sphv_rational_number(const mpq_t value)
{
    sphv_number number = {sphv_rational_round(value), 0};
    if (isfinite(number.value)) {
        mpq_t rest;
        mpq_init(rest);
        mpq_set_d(rest, number.value);
        mpq_sub(rest, value, rest);
        number.residual = sphv_rational_round(rest);
        mpq_clear(rest);
    }
    return number;
}

void sphv_rational_power(mpq_t out, const mpq_t base, int exponent)
{
    mpz_pow_ui(mpq_numref(out), mpq_numref(base), (unsigned long)exponent);
    mpz_pow_ui(mpq_denref(out), mpq_denref(base), (unsigned long)exponent);
}

sphv_status sphv_polynomial_make(sphv_polynomial *p, int degree, sphv_error *error)
{
    p->degree = degree;
    p->coefficient = malloc((size_t)(degree + 1) * sizeof *p->coefficient);
    if (!p->coefficient) {
        p->degree = -1;
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    for (int i = 0; i <= degree; i++) mpq_init(p->coefficient[i]);
    return SPHV_OK;
}

void sphv_polynomial_free(sphv_polynomial *p)
{
    if (!p->coefficient) return;
    for (int i = 0; i <= p->degree; i++) mpq_clear(p->coefficient[i]);
    free(p->coefficient);
    p->coefficient = NULL;
    p->degree = -1;
}

void sphv_polynomial_shift(sphv_polynomial *p, const mpq_t shift)
{
    mpq_t product;
    mpq_init(product);
    for (int round = 0; round < p->degree; round++)
        for (int i = p->degree - 1; i >= round; i--) {
            mpq_mul(product, shift, p->coefficient[i + 1]);
            mpq_add(p->coefficient[i], p->coefficient[i], product);
        }
    mpq_clear(product);
}

void sphv_polynomial_value(mpq_t out, const sphv_polynomial *p, const mpq_t q)
{
    mpq_set_ui(out, 0, 1);
    for (int i = p->degree; i >= 0; i--) {
        mpq_mul(out, out, q);
        mpq_add(out, out, p->coefficient[i]);
    }
}

void sphv_polynomial_moment(mpq_t out, const sphv_polynomial *p, int order, int power,
                            const mpq_t from, const mpq_t to)
{
    mpq_t upper, lower, factor;
    mpq_inits(upper, lower, factor, NULL);
    mpq_set_ui(out, 0, 1);
    for (int i = order; i <= p->degree; i++) {
        int exponent = i - order + power + 1;
        sphv_rational_power(upper, to, exponent);
        sphv_rational_power(lower, from, exponent);
        mpq_sub(upper, upper, lower);
        mpq_mul(upper, upper, p->coefficient[i]);
        mpq_set_si(factor, order ? i : 1, (unsigned long)exponent);
        mpq_canonicalize(factor);
        mpq_mul(upper, upper, factor);
        mpq_add(out, out, upper);
    }
    mpq_clears(upper, lower, factor, NULL);
}
