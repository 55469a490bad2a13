#include "core/field_parse.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sphverify/number.h"

/// A text being read.
typedef struct reader {
    const char *text, *at;
    sphv_field *field;
    sphv_error *error;
} reader;

static const char axes[] = "xyz";

static void skip_blanks(reader *of)
{
    while (*of->at == ' ' || *of->at == '\t') of->at++;
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static sphv_status refuse(const reader *of, const char *at, const char *what, const char *allowed)
{
    return sphv_fail(of->error, SPHV_INVALID_INPUT, "field '%s', column %d: %s; allowed: %s",
                     of->text, (int)(at - of->text) + 1, what, allowed);
}

/// What may stand where a factor is missing: a mistyped name is the likely cause at the start.
static sphv_status refuse_factor(const reader *of)
{
    char allowed[256];
    int used =
        snprintf(allowed, sizeof allowed, "a number, %.*s", of->field->dimension == 1 ? 1 : 4,
                 of->field->dimension == 1 ? "x" : "x, y");
    if (of->field->dimension == 3)
        used += snprintf(allowed + used, sizeof allowed - (size_t)used, ", z");
    used += snprintf(allowed + used, sizeof allowed - (size_t)used, ", or as the whole field");
    for (const sphv_field_row *row = sphv_fields; row->name; row++)
        if (row->dimensions[of->field->dimension - 1])
            used += snprintf(allowed + used, sizeof allowed - (size_t)used, " %s", row->name);
    return refuse(of, of->at, *of->at ? "no part of a polynomial" : "it ends too soon", allowed);
}

/// A decimal or fraction, without its sign.
static sphv_status read_number(reader *of, double *value)
{
    const char *end = of->at;
    char token[sizeof of->field->name];
    sphv_number number;
    sphv_error why;
    while (is_digit(*end) || *end == '.' || *end == '/' || *end == 'e' || *end == 'E' ||
           ((*end == '+' || *end == '-') && (end[-1] == 'e' || end[-1] == 'E')))
        end++;
    size_t length = (size_t)(end - of->at);
    memcpy(token, of->at, length);
    token[length] = '\0';
    if (sphv_number_parse(token, &number, &why) != SPHV_OK)
        return refuse(of, of->at, "a number that cannot be read",
                      "decimals such as 0.5, fractions "
                      "such as 5/2");
    *value = number.value;
    of->at = end;
    return SPHV_OK;
}

/// The power of a coordinate, 1 when none is written.
static sphv_status read_power(reader *of, int *power)
{
    *power = 1;
    skip_blanks(of);
    if (*of->at != '^') return SPHV_OK;
    of->at++;
    skip_blanks(of);
    const char *start = of->at;
    if (!is_digit(*start)) return refuse(of, start, "no power", "whole numbers from 0 to 16");
    for (*power = 0; is_digit(*of->at); of->at++) {
        *power = 10 * *power + (*of->at - '0');
        if (*power > SPHV_FIELD_POWER_MAX)
            return refuse(of, start, "too high a power", "whole numbers from 0 to 16");
    }
    return SPHV_OK;
}

static sphv_status read_factor(reader *of, double *coefficient, int power[SPHV_DIMENSIONS])
{
    skip_blanks(of);
    const char *axis = *of->at ? strchr(axes, *of->at) : NULL;
    if (is_digit(*of->at) || *of->at == '.') {
        double value = 0;
        sphv_status status = read_number(of, &value);
        *coefficient *= value;
        return status;
    }
    if (!axis || axis - axes >= of->field->dimension) return refuse_factor(of);
    const char *start = of->at++;
    int more;
    sphv_status status = read_power(of, &more);
    if (status != SPHV_OK) return status;
    power[axis - axes] += more;
    if (power[axis - axes] > SPHV_FIELD_POWER_MAX)
        return refuse(of, start, "too high a power of one coordinate", "up to 16 in all");
    return SPHV_OK;
}

static sphv_status read_product(reader *of, double sign)
{
    double coefficient = sign;
    int power[SPHV_DIMENSIONS] = {0};
    skip_blanks(of);
    const char *start = of->at;
    for (;;) {
        sphv_status status = read_factor(of, &coefficient, power);
        if (status != SPHV_OK) return status;
        skip_blanks(of);
        if (*of->at != '*') break;
        of->at++;
    }
    sphv_field *field = of->field;
    int t = 0;
    for (; t < field->terms; t++) {
        bool same = true;
        for (int i = 0; i < SPHV_DIMENSIONS; i++)
            same = same && field->term[t].factor[i].parameter == power[i];
        if (same) break;
    }
    if (t == SPHV_FIELD_TERMS_MAX)
        return refuse(of, start, "too many terms", "up to 32 different monomials");
    if (t == field->terms) {
        field->term[t].coefficient = 0;
        for (int i = 0; i < SPHV_DIMENSIONS; i++)
            field->term[t].factor[i] = (sphv_factor){SPHV_FACTOR_POWER, power[i], 0};
        field->terms++;
    }
    field->term[t].coefficient += coefficient;
    if (!isfinite(field->term[t].coefficient))
        return refuse(of, start, "a coefficient that overflows", "magnitudes up to 1e308");
    return SPHV_OK;
}

sphv_status sphv_field_parse_polynomial(const char *text, sphv_field *out, sphv_error *error)
{
    reader of = {text, text, out, error};
    double sign = 1;
    out->terms = 0;
    skip_blanks(&of);
    if (*of.at == '+' || *of.at == '-') sign = *of.at++ == '-' ? -1 : 1;
    for (;;) {
        sphv_status status = read_product(&of, sign);
        if (status != SPHV_OK) return status;
        if (*of.at == '\0') return SPHV_OK;
        if (*of.at != '+' && *of.at != '-')
            return refuse(&of, of.at, "no sign here", "+, -, * or the end");
        sign = *of.at++ == '-' ? -1 : 1;
    }
}
