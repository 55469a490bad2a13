#include "constant_text.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTH_MAX = 32, LENGTH_MAX = 200, NUMBER_MAX = 80 };

static const long double pi = 3.14159265358979323846264338327950288L;

/// A recursive descent over the text. `bad` once set stays set, and nothing is read any more.
struct reader {
    const char *at;
    int depth;
    bool bad;
};

static long double read_sum(struct reader *reader);

static void skip_blanks(struct reader *reader)
{
    while (*reader->at == ' ') reader->at++;
}

static bool take(struct reader *reader, const char *word)
{
    skip_blanks(reader);
    size_t length = strlen(word);
    if (reader->bad || strncmp(reader->at, word, length) != 0) return false;
    reader->at += length;
    return true;
}

static long double fail(struct reader *reader)
{
    reader->bad = true;
    return 0;
}

/// An unsigned decimal; strtold alone would also take hexadecimal, infinity and NaN.
static long double read_number(struct reader *reader)
{
    const char *c = reader->at;
    size_t digits = 0;
    bool point = false;
    for (; isdigit((unsigned char)*c) || (*c == '.' && !point); c++) {
        if (*c == '.')
            point = true;
        else
            digits++;
    }
    if (digits > 0 && (*c == 'e' || *c == 'E')) {
        const char *exponent = c + 1;
        if (*exponent == '+' || *exponent == '-') exponent++;
        if (!isdigit((unsigned char)*exponent)) return fail(reader);
        while (isdigit((unsigned char)*exponent)) exponent++;
        c = exponent;
    }
    size_t length = (size_t)(c - reader->at);
    if (digits == 0 || length > NUMBER_MAX) return fail(reader);
    char copy[NUMBER_MAX + 1];
    memcpy(copy, reader->at, length);
    copy[length] = '\0';
    reader->at = c;
    return strtold(copy, NULL);
}

static long double read_primary(struct reader *reader)
{
    if (reader->bad || ++reader->depth > DEPTH_MAX) return fail(reader);
    long double value;
    bool root = take(reader, "sqrt");
    if (take(reader, "(")) {
        value = read_sum(reader);
        if (!take(reader, ")")) value = fail(reader);
        if (root) value = value >= 0 ? sqrtl(value) : fail(reader);
    } else if (root) {
        value = fail(reader);
    } else if (take(reader, "pi") || take(reader, "π")) {
        value = pi;
    } else {
        value = read_number(reader);
    }
    reader->depth--;
    return value;
}

static long double power(long double base, long double exponent)
{
    // Halves of integers by products and a root: powl may lose several units in the last place.
    long double doubled = 2 * exponent;
    if (doubled != nearbyintl(doubled) || fabsl(doubled) > 64) return powl(base, exponent);
    int n = (int)fabsl(doubled);
    long double value = n % 2 ? sqrtl(base) : 1;
    for (int i = 0; i < n / 2; i++) value *= base;
    return exponent < 0 ? 1 / value : value;
}

static long double read_signed(struct reader *reader)
{
    if (reader->bad || ++reader->depth > DEPTH_MAX) return fail(reader);
    long double value;
    if (take(reader, "-")) {
        value = -read_signed(reader);
    } else if (take(reader, "+")) {
        value = read_signed(reader);
    } else {
        value = read_primary(reader);
        if (take(reader, "^")) value = power(value, read_signed(reader));
    }
    reader->depth--;
    return value;
}

static long double read_product(struct reader *reader)
{
    long double value = read_signed(reader);
    for (;;) {
        if (take(reader, "*"))
            value *= read_signed(reader);
        else if (take(reader, "/"))
            value /= read_signed(reader);
        else
            return value;
    }
}

static long double read_sum(struct reader *reader)
{
    long double value = read_product(reader);
    for (;;) {
        if (take(reader, "+"))
            value += read_product(reader);
        else if (take(reader, "-"))
            value -= read_product(reader);
        else
            return value;
    }
}

sphv_status sphv_constant_parse(const char *text, long double *out, sphv_error *error)
{
    struct reader reader = {text, 0, strlen(text) > LENGTH_MAX};
    long double value = read_sum(&reader);
    skip_blanks(&reader);
    if (reader.bad || *reader.at != '\0')
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "'%s' is not a constant; allowed: numbers, pi, + - * / ^, sqrt() and "
                         "brackets, such as 10/7/pi or pi^(-1/2)",
                         text);
    if (!isfinite(value) || !isfinite((double)value))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "'%s' is not a finite number; allowed: constants such as 10/7/pi", text);
    *out = value;
    return SPHV_OK;
}
