/// Exact rationals and polynomials over them.
#include "core/rational.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

static void parse(mpq_t out, const char *text)
{
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_rational_parse(text, out, &error), error);
}

static void assert_rational(const mpq_t value, long numerator, unsigned long denominator)
{
    if (mpq_cmp_si(value, numerator, denominator) != 0)
        fail_msg("%.17g is not %ld/%lu", mpq_get_d(value), numerator, denominator);
}

static void test_parsing_is_exact(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        long numerator;
        unsigned long denominator;
    } cases[] = {{"0", 0, 1},        {"-0", 0, 1},    {"3/4", 3, 4},
                 {"-6/8", -3, 4},    {"0.125", 1, 8}, {"0.1", 1, 10},
                 {"1e3", 1000, 1},   {"25e-2", 1, 4}, {"-154063/4608000", -154063, 4608000},
                 {"0.5/0.25", 2, 1}, {"+.5", 1, 2},   {"1.5e1/3", 5, 1}};
    mpq_t value;
    mpq_init(value);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        parse(value, cases[i].text);
        assert_rational(value, cases[i].numerator, cases[i].denominator);
    }
    mpq_clear(value);
}

static void test_refusals(void **state)
{
    (void)state;
    mpq_t value;
    mpq_init(value);
    sphv_error error = {SPHV_OK, ""};
    assert_failed(sphv_rational_parse("1/0.0", value, &error), &error, SPHV_INVALID_INPUT,
                  "divides by zero");
    assert_failed(sphv_rational_parse("10/7/pi", value, &error), &error, SPHV_INVALID_INPUT,
                  "not a number");
    assert_failed(sphv_rational_parse("1e500", value, &error), &error, SPHV_INVALID_INPUT,
                  "not a number");
    char many[90];
    memset(many, '7', 81);
    many[81] = '\0';
    assert_failed(sphv_rational_parse(many, value, &error), &error, SPHV_INVALID_INPUT, "81");
    mpq_clear(value);
}

/// Rounding of n/d for small integers is the correctly rounded division of the processor.
static void test_rounding_is_to_nearest(void **state)
{
    (void)state;
    random_start("rounding");
    mpq_t value;
    mpq_init(value);
    for (int i = 0; i < 5000; i++) {
        long n = random_integer(-1000000000, 1000000000), d = random_integer(1, 1000000000);
        mpq_set_si(value, n, (unsigned long)d);
        mpq_canonicalize(value);
        assert_close(sphv_rational_round(value), (double)n / (double)d, 0);
    }
    parse(value, "1e400");
    assert_true(isinf(sphv_rational_round(value)));
    parse(value, "-1e400");
    assert_true(isinf(sphv_rational_round(value)) && sphv_rational_round(value) < 0);
    mpq_clear(value);
}

static void test_powers(void **state)
{
    (void)state;
    mpq_t base, power;
    mpq_inits(base, power, NULL);
    mpq_set_si(base, -2, 3);
    sphv_rational_power(power, base, 5);
    assert_rational(power, -32, 243);
    sphv_rational_power(power, base, 0);
    assert_rational(power, 1, 1);
    mpq_clears(base, power, NULL);
}

/// p(q) = 1 − 3q/2 + 2q³.
static void make_cubic(sphv_polynomial *p)
{
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_polynomial_make(p, 3, &error), error);
    mpq_set_si(p->coefficient[0], 1, 1);
    mpq_set_si(p->coefficient[1], -3, 2);
    mpq_set_si(p->coefficient[3], 2, 1);
}

static void test_shift_agrees_with_evaluation(void **state)
{
    (void)state;
    sphv_polynomial p, shifted;
    make_cubic(&p);
    make_cubic(&shifted);
    mpq_t shift, q, moved, a, b;
    mpq_inits(shift, q, moved, a, b, NULL);
    mpq_set_si(shift, -7, 5);
    sphv_polynomial_shift(&shifted, shift);
    for (long i = -5; i <= 5; i++) {
        mpq_set_si(q, i, 3);
        mpq_canonicalize(q);
        mpq_add(moved, q, shift);
        sphv_polynomial_value(a, &shifted, q);
        sphv_polynomial_value(b, &p, moved);
        assert_true(mpq_equal(a, b));
    }
    mpq_clears(shift, q, moved, a, b, NULL);
    sphv_polynomial_free(&p);
    sphv_polynomial_free(&shifted);
    sphv_polynomial_free(&p); // harmless again
}

static void test_moments_by_hand(void **state)
{
    (void)state;
    sphv_polynomial p;
    make_cubic(&p);
    mpq_t from, to, moment;
    mpq_inits(from, to, moment, NULL);
    mpq_set_si(from, 1, 1);
    mpq_set_si(to, 2, 1);
    // ∫_1^2 q (1 − 3q/2 + 2q³) dq = 3/2 − 7/2 + 62/5
    sphv_polynomial_moment(moment, &p, 0, 1, from, to);
    assert_rational(moment, 52, 5);
    // ∫_1^2 q² (−3/2 + 6q²) dq = −7/2 + 186/5
    sphv_polynomial_moment(moment, &p, 1, 2, from, to);
    assert_rational(moment, 337, 10);
    mpq_clears(from, to, moment, NULL);
    sphv_polynomial_free(&p);
}

static void test_two_double_number(void **state)
{
    (void)state;
    mpq_t third, part;
    mpq_inits(third, part, NULL);
    mpq_set_si(third, 1, 3);
    sphv_number number = sphv_rational_number(third);
    // 1/3 − fl(1/3) = 1/3 · 2^−54 exactly (fl(1/3) = (2^54 − 1)/3/2^54)
    assert_close(number.residual, 0x1p-54 / 3, 0);
    mpq_clears(third, part, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parsing_is_exact),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_rounding_is_to_nearest),
        cmocka_unit_test(test_powers),
        cmocka_unit_test(test_shift_agrees_with_evaluation),
        cmocka_unit_test(test_moments_by_hand),
        cmocka_unit_test(test_two_double_number),
    };
    return run_group(tests);
}
