/// Numbers as people write them, and knots on lattices.
#include "sphverify/number.h"

#include <gmp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

static sphv_number parsed(const char *text)
{
    sphv_number number = {NAN, NAN};
    sphv_error error = {SPHV_OK, ""};
    assert_ok(sphv_number_parse(text, &number, &error), error);
    return number;
}

static void test_decimals_are_read_as_strtod_reads_them(void **state)
{
    (void)state;
    const char *const texts[] = {
        "0",   "1",      "-1",   "+2.5", ".5",    "5.",  "0.37",  "1e-3", "2E+05",
        "1e0", "1e-300", "-0.1", "007",  "2.385", "0.1", "1e308", "3e5",  "123456789.123456789"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        sphv_number number = parsed(texts[i]);
        double expected = strtod(texts[i], NULL); // correctly rounded in glibc
        assert_close(number.value, expected, 0);
        assert_true(fabs(number.residual) <= 0x1p-53 * fabs(number.value));
    }
}

/// value + residual is the fraction to 2^−104 of it: exact rational arithmetic is the judge.
static void test_fractions_are_kept_beyond_double(void **state)
{
    (void)state;
    random_start("fractions");
    mpq_t exact, part;
    mpq_inits(exact, part, NULL);
    for (int i = 0; i < 2000; i++) {
        long top = random_integer(-100000, 100000), bottom = random_integer(1, 100000);
        char text[64];
        snprintf(text, sizeof text, "%ld/%ld", top, bottom);
        sphv_number number = parsed(text), ratio = sphv_number_from_ratio(top, bottom);
        assert_close(ratio.value, number.value, 0);
        assert_close(ratio.residual, number.residual, 0);
        assert_close(number.value, (double)top / (double)bottom, 0);
        mpq_set_si(exact, top, (unsigned long)bottom);
        mpq_canonicalize(exact);
        mpq_set_d(part, number.value);
        mpq_sub(exact, exact, part);
        mpq_set_d(part, number.residual);
        mpq_sub(exact, exact, part);
        assert_true(fabs(mpq_get_d(exact)) <= 0x1p-105 * fabs(number.value));
    }
    mpq_clears(exact, part, NULL);
    assert_close(parsed("0.5/3").value, 0.5 / 3, 0);
    assert_close(parsed("-1e-2/4e-2").value, -0.25, 0);
    assert_close(sphv_number_from_ratio(1, -3).value, -1.0 / 3, 0);
    sphv_number kept = sphv_number_from_double(0.1);
    assert_close(kept.value, 0.1, 0);
    assert_close(kept.residual, 0, 0);
}

static void test_other_texts_are_refused(void **state)
{
    (void)state;
    const char *const texts[] = {"",         " ",
                                 "x",        "1 ",
                                 " 1",       "1x",
                                 "0x10",     "inf",
                                 "nan",      "-inf",
                                 "1/0",      "0/0",
                                 "1/",       "/2",
                                 "1/2/3",    "1//2",
                                 "1e",       "1e+",
                                 "e5",       "--1",
                                 "+-1",      ".",
                                 "1.2.3",    "1,5",
                                 "1e999",    "1e401",
                                 "1e-401",   "1e309",
                                 "1_0",      "4/11\n",
                                 "1/-2",     "π",
                                 "1d0",      "1e99999999999999999999999999999999",
                                 "%s%s%s%n", "1\t",
                                 "\xff\xfe", "1e-400"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        sphv_number number;
        sphv_error error = {SPHV_OK, ""};
        sphv_status status = sphv_number_parse(texts[i], &number, &error);
        if (status == SPHV_OK) fail_msg("'%s' was read as %g", texts[i], number.value);
        assert_failed(status, &error, SPHV_INVALID_INPUT, "allowed");
    }
    char digits[200];
    memset(digits, '1', sizeof digits - 1);
    digits[sizeof digits - 1] = '\0';
    sphv_number number;
    sphv_error error = {SPHV_OK, ""};
    assert_failed(sphv_number_parse(digits, &number, &error), &error, SPHV_INVALID_INPUT, "80");
}

static void test_any_bytes_give_a_number_or_a_message(void **state)
{
    (void)state;
    random_start("random bytes");
    static const char likely[] = "0123456789..//eE+--+";
    for (int i = 0; i < 20000; i++) {
        char text[24];
        long length = random_integer(0, 22);
        for (long c = 0; c < length; c++)
            text[c] = random_integer(0, 9) ? likely[random_integer(0, sizeof likely - 2)]
                                           : (char)random_integer(1, 255);
        text[length] = '\0';
        sphv_number number = {NAN, NAN};
        sphv_error error = {SPHV_OK, ""};
        sphv_status status = sphv_number_parse(text, &number, &error);
        if (status == SPHV_OK)
            assert_true(isfinite(number.value) && isfinite(number.residual));
        else
            assert_failed(status, &error, SPHV_INVALID_INPUT, "allowed");
    }
}

/// Places are compared with integer arithmetic on the same fractions.
static void test_places_are_exact(void **state)
{
    (void)state;
    random_start("places");
    for (int i = 0; i < 20000; i++) {
        long a = random_integer(0, 40), b = random_integer(1, 20);  // knot a/b
        long c = random_integer(1, 60), d = random_integer(1, 997); // step c/d
        long top = a * d, bottom = b * c;                           // knot/step
        sphv_lattice_place place =
            sphv_number_place(sphv_number_from_ratio(a, b), sphv_number_from_ratio(c, d));
        long whole = top / bottom, rest = top % bottom;
        assert_int_equal(place.on_lattice, rest == 0);
        assert_int_equal(place.inside, rest == 0 ? (whole ? whole - 1 : 0) : whole);
        // offset and step are good to 2^-52 each, and offset is divided by step
        assert_close(place.fraction, (double)rest / (double)bottom, rest ? 0x1p-51 : 0);
        assert_true(place.fraction < 1);
    }
}

static void test_places_at_special_spacings(void **state)
{
    (void)state;
    for (long n = 1; n <= 4000; n++) {
        sphv_number step = sphv_number_from_ratio(4, 2 * n + 1);
        sphv_lattice_place edge = sphv_number_place(sphv_number_from_double(2), step);
        assert_int_equal(edge.inside, n);
        assert_false(edge.on_lattice);
        assert_close(edge.fraction, 0.5, 0x1p-40); // (2n+1)/2 − n loses log2(n) bits
        sphv_lattice_place middle = sphv_number_place(sphv_number_from_double(1), step);
        assert_close(middle.fraction, n % 2 ? 0.75 : 0.25, 0x1p-40);
    }
}

static void test_a_knot_a_hair_from_a_particle(void **state)
{
    (void)state;
    sphv_number third = sphv_number_from_ratio(1, 3);
    sphv_lattice_place on = sphv_number_place(sphv_number_from_double(2), third);
    assert_true(on.on_lattice);
    assert_int_equal(on.inside, 5);
    // 1/3 as a double is below 1/3, so the sixth particle stands inside 2, by 2^-53.
    sphv_lattice_place in =
        sphv_number_place(sphv_number_from_double(2), sphv_number_from_double(1.0 / 3));
    assert_false(in.on_lattice);
    assert_int_equal(in.inside, 6);
    assert_true(in.fraction > 0 && in.fraction < 1e-14);
    sphv_lattice_place out = sphv_number_place(sphv_number_from_double(2),
                                               sphv_number_from_double(nextafter(1.0 / 3, 1)));
    assert_int_equal(out.inside, 5);
    assert_true(out.fraction > 1 - 1e-14 && out.fraction < 1);
    sphv_lattice_place origin = sphv_number_place(sphv_number_from_double(0), third);
    assert_true(origin.on_lattice);
    assert_int_equal(origin.inside, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_decimals_are_read_as_strtod_reads_them),
        cmocka_unit_test(test_fractions_are_kept_beyond_double),
        cmocka_unit_test(test_other_texts_are_refused),
        cmocka_unit_test(test_any_bytes_give_a_number_or_a_message),
        cmocka_unit_test(test_places_are_exact),
        cmocka_unit_test(test_places_at_special_spacings),
        cmocka_unit_test(test_a_knot_a_hair_from_a_particle),
    };
    return run_group(tests);
}
