#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "constant_text.h"
#include "directory.h"
#include "kernel_internal.h"
#include "yaml_file.h"

/// The file as libcyaml fills it.
struct file_piece {
    char *until;
    char **coefficients;
    unsigned coefficients_count;
};

struct file_constants {
    char *one, *two, *three;
};

struct file_claims {
    int *boundary_smoothness;
    int *smoothing_order;
    bool *monotone;
    bool *non_negative;
};

struct file_kernel {
    char *name, *title, *source, *support, *family;
    int *exponent;
    char *transform;
    struct file_piece *pieces, *derivative;
    unsigned pieces_count, derivative_count;
    int *dimensions;
    unsigned dimensions_count;
    struct file_constants *constants;
    struct file_claims *claims;
};

enum { OPTIONAL = CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL };

static const cyaml_schema_value_t number_entry = {
    CYAML_VALUE_STRING(CYAML_FLAG_POINTER, char, 1, 80)};

static const cyaml_schema_field_t piece_fields[] = {
    CYAML_FIELD_STRING_PTR("until", CYAML_FLAG_POINTER, struct file_piece, until, 1, 80),
    CYAML_FIELD_SEQUENCE("coefficients", CYAML_FLAG_POINTER, struct file_piece, coefficients,
                         &number_entry, 1, SPHV_DEGREE_MAX + 1),
    CYAML_FIELD_END};

static const cyaml_schema_value_t piece_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct file_piece, piece_fields)};

static const cyaml_schema_field_t constant_fields[] = {
    CYAML_FIELD_STRING_PTR("1d", OPTIONAL, struct file_constants, one, 1, 80),
    CYAML_FIELD_STRING_PTR("2d", OPTIONAL, struct file_constants, two, 1, 80),
    CYAML_FIELD_STRING_PTR("3d", OPTIONAL, struct file_constants, three, 1, 80), CYAML_FIELD_END};

static const cyaml_schema_field_t claim_fields[] = {
    CYAML_FIELD_INT_PTR("boundary_smoothness", OPTIONAL, struct file_claims, boundary_smoothness),
    CYAML_FIELD_INT_PTR("smoothing_order", OPTIONAL, struct file_claims, smoothing_order),
    CYAML_FIELD_BOOL_PTR("monotone", OPTIONAL, struct file_claims, monotone),
    CYAML_FIELD_BOOL_PTR("non_negative", OPTIONAL, struct file_claims, non_negative),
    CYAML_FIELD_END};

static const cyaml_schema_value_t dimension_entry = {CYAML_VALUE_INT(CYAML_FLAG_DEFAULT, int)};

static const cyaml_schema_field_t kernel_fields[] = {
    CYAML_FIELD_STRING_PTR("name", CYAML_FLAG_POINTER, struct file_kernel, name, 1, 64),
    CYAML_FIELD_STRING_PTR("title", CYAML_FLAG_POINTER, struct file_kernel, title, 1, 200),
    CYAML_FIELD_STRING_PTR("source", OPTIONAL, struct file_kernel, source, 0, 400),
    CYAML_FIELD_STRING_PTR("support", CYAML_FLAG_POINTER, struct file_kernel, support, 1, 80),
    CYAML_FIELD_STRING_PTR("family", OPTIONAL, struct file_kernel, family, 1, 40),
    CYAML_FIELD_INT_PTR("exponent", OPTIONAL, struct file_kernel, exponent),
    CYAML_FIELD_STRING_PTR("transform", OPTIONAL, struct file_kernel, transform, 1, 40),
    CYAML_FIELD_SEQUENCE("pieces", OPTIONAL, struct file_kernel, pieces, &piece_entry, 1,
                         SPHV_PIECES_MAX),
    CYAML_FIELD_SEQUENCE("derivative", OPTIONAL, struct file_kernel, derivative, &piece_entry, 1,
                         SPHV_PIECES_MAX),
    CYAML_FIELD_SEQUENCE("dimensions", CYAML_FLAG_POINTER, struct file_kernel, dimensions,
                         &dimension_entry, 1, SPHV_DIMENSIONS),
    CYAML_FIELD_MAPPING_PTR("constants", OPTIONAL, struct file_kernel, constants, constant_fields),
    CYAML_FIELD_MAPPING_PTR("claims", OPTIONAL, struct file_kernel, claims, claim_fields),
    CYAML_FIELD_END};

static const cyaml_schema_value_t kernel_schema = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct file_kernel, kernel_fields)};

static sphv_status read_rational(const sphv_yaml *yaml, const char *place, const char *text,
                                 mpq_t out, sphv_error *error)
{
    sphv_error reason;
    sphv_status status = sphv_rational_parse(text, out, &reason);
    if (status == SPHV_OK) return SPHV_OK;
    return sphv_yaml_fail(yaml, place, error, "%s", reason.message);
}

static sphv_status copy_text(const char *from, char **to, sphv_error *error)
{
    if (!from) return SPHV_OK;
    *to = strdup(from);
    return *to ? SPHV_OK : sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
}

static sphv_status read_identity(const sphv_yaml *yaml, const struct file_kernel *file,
                                 sphv_kernel *kernel, sphv_error *error)
{
    if (!sphv_plain_name(file->name))
        return sphv_yaml_fail(yaml, "name", error,
                              "'%s' is not a name; allowed: letters, digits, '-', '_' and '.'",
                              file->name);
    sphv_status status = copy_text(file->name, &kernel->name, error);
    if (status == SPHV_OK) status = copy_text(file->title, &kernel->title, error);
    if (status == SPHV_OK) status = copy_text(file->source, &kernel->source, error);
    if (status != SPHV_OK) return status;
    for (unsigned i = 0; i < file->dimensions_count; i++) {
        char place[32];
        snprintf(place, sizeof place, "dimensions.%u", i);
        int d = file->dimensions[i];
        if (d < 1 || d > SPHV_DIMENSIONS || kernel->declared[d - 1])
            return sphv_yaml_fail(yaml, place, error,
                                  "dimension %d; allowed: 1, 2 and 3, each once", d);
        kernel->declared[d - 1] = true;
    }
    return SPHV_OK;
}

static sphv_status read_support(const sphv_yaml *yaml, const char *text, mpq_t support,
                                sphv_error *error)
{
    sphv_status status = read_rational(yaml, "support", text, support, error);
    if (status != SPHV_OK) return status;
    double value = sphv_rational_round(support);
    if (!(value >= 0.01 && value <= 100))
        return sphv_yaml_fail(yaml, "support", error,
                              "support %s; allowed: 0.01 to 100 (in units of h)", text);
    return SPHV_OK;
}

static sphv_status read_coefficients(const sphv_yaml *yaml, const char *list, unsigned index,
                                     const struct file_piece *piece, sphv_polynomial *out,
                                     sphv_error *error)
{
    sphv_status status = sphv_polynomial_make(out, (int)piece->coefficients_count - 1, error);
    for (unsigned k = 0; status == SPHV_OK && k < piece->coefficients_count; k++) {
        char place[64];
        snprintf(place, sizeof place, "%s.%u.coefficients.%u", list, index, k);
        status = read_rational(yaml, place, piece->coefficients[k], out->coefficient[k], error);
        double size = fabs(mpq_get_d(out->coefficient[k]));
        bool in_range = size <= 1e60 && (size >= 1e-60 || mpq_sgn(out->coefficient[k]) == 0);
        if (status == SPHV_OK && !in_range)
            status = sphv_yaml_fail(yaml, place, error,
                                    "coefficient %s; allowed: 0 and magnitudes from 1e-60 to 1e60",
                                    piece->coefficients[k]);
    }
    return status;
}

/// Whether a piece is so short that its ends are hardly two places in double precision.
static bool too_short(mpq_srcptr inner, mpq_srcptr outer)
{
    mpq_t length;
    mpq_init(length);
    mpq_set(length, outer);
    if (inner) mpq_sub(length, length, inner);
    bool is_short = mpq_get_d(length) < 1e-6;
    mpq_clear(length);
    return is_short;
}

static sphv_status read_pieces(const sphv_yaml *yaml, const char *list,
                               const struct file_piece *pieces, unsigned count, const mpq_t support,
                               sphv_exact_pieces *out, sphv_error *error)
{
    sphv_status status = sphv_exact_pieces_make(out, (int)count, error);
    for (unsigned i = 0; status == SPHV_OK && i < count; i++) {
        char place[64];
        snprintf(place, sizeof place, "%s.%u.until", list, i);
        status = read_rational(yaml, place, pieces[i].until, out->outer[i], error);
        if (status != SPHV_OK) break;
        int ascending =
            i ? mpq_cmp(out->outer[i], out->outer[i - 1]) > 0 : mpq_sgn(out->outer[0]) > 0;
        if (!ascending)
            status = sphv_yaml_fail(yaml, place, error,
                                    "pieces overlap: until %s after %s; allowed: ascending ends "
                                    "above 0",
                                    pieces[i].until, i ? pieces[i - 1].until : "0");
        else if (too_short(i ? out->outer[i - 1] : NULL, out->outer[i]))
            status = sphv_yaml_fail(yaml, place, error,
                                    "the piece until %s is too short; allowed: lengths from 1e-6",
                                    pieces[i].until);
        else if (i + 1 == count && mpq_cmp(out->outer[i], support) != 0)
            status = sphv_yaml_fail(yaml, place, error,
                                    "the last piece ends at %s; allowed: the support of the file",
                                    pieces[i].until);
        if (status == SPHV_OK)
            status = read_coefficients(yaml, list, i, &pieces[i], &out->polynomial[i], error);
        out->rounding = fmax(out->rounding, sphv_decimal_uncertainty(pieces[i].until));
        for (unsigned k = 0; k < pieces[i].coefficients_count; k++)
            out->rounding =
                fmax(out->rounding, sphv_decimal_uncertainty(pieces[i].coefficients[k]));
    }
    if (status == SPHV_OK && !sphv_exact_pieces_manageable(out))
        status = sphv_yaml_fail(yaml, list, error,
                                "the common denominator of all fractions is too long; allowed: "
                                "fewer pieces, lower degrees, or decimals of up to 17 digits");
    return status;
}

static sphv_status read_family(const sphv_yaml *yaml, const struct file_kernel *file,
                               sphv_kernel *kernel, sphv_error *error)
{
    const sphv_family *family = sphv_family_find(file->family);
    if (!family) {
        char names[200] = "";
        for (const sphv_family *f = sphv_families; f->name; f++) {
            if (f != sphv_families) strcat(names, ", ");
            strcat(names, f->name);
        }
        return sphv_yaml_fail(yaml, "family", error, "unknown family '%s'; allowed: %s",
                              file->family, names);
    }
    if (file->derivative)
        return sphv_yaml_fail(yaml, "derivative", error,
                              "a family has its own derivative; allowed: 'derivative' with "
                              "'pieces'");
    if (family->needs_exponent != (file->exponent != NULL))
        return sphv_yaml_fail(yaml, file->exponent ? "exponent" : "family", error,
                              "family '%s' %s 'exponent'; allowed: 'exponent' with sinc only",
                              family->name, family->needs_exponent ? "needs" : "takes no");
    if (file->exponent && (*file->exponent < 1 || *file->exponent > 12))
        return sphv_yaml_fail(yaml, "exponent", error, "exponent %d; allowed: 1 to 12",
                              *file->exponent);
    kernel->form.family = family;
    kernel->form.exponent = file->exponent ? *file->exponent : 0;
    kernel->form.support = kernel->support.value;
    if (family->truncated && !(kernel->support.value <= 12))
        return sphv_yaml_fail(yaml, "support", error,
                              "support %s; allowed: up to 12 for a truncated family",
                              file->support);
    return SPHV_OK;
}

static sphv_status read_shape(const sphv_yaml *yaml, const struct file_kernel *file,
                              sphv_kernel *kernel, sphv_error *error)
{
    mpq_t support;
    mpq_init(support);
    sphv_status status = read_support(yaml, file->support, support, error);
    if (status == SPHV_OK) {
        kernel->support = sphv_rational_number(support);
        kernel->polynomial = file->pieces != NULL;
        if (file->transform && strcmp(file->transform, "fourth-order") != 0)
            status =
                sphv_yaml_fail(yaml, "transform", error,
                               "unknown transform '%s'; allowed: fourth-order", file->transform);
        kernel->fourth_order = file->transform != NULL;
    }
    if (status == SPHV_OK && (file->pieces != NULL) == (file->family != NULL))
        status = sphv_yaml_fail(yaml, file->family ? "family" : "", error,
                                "the shape is given %s; allowed: either 'pieces' or 'family'",
                                file->family ? "twice" : "nowhere");
    if (status == SPHV_OK && file->transform && file->derivative)
        status = sphv_yaml_fail(yaml, "derivative", error,
                                "'derivative' with 'transform': of which function is unclear; "
                                "allowed: one of them");
    if (status == SPHV_OK && file->pieces && file->exponent)
        status = sphv_yaml_fail(yaml, "exponent", error,
                                "'exponent' with 'pieces'; allowed: with a family only");
    if (status == SPHV_OK && file->pieces)
        status = read_pieces(yaml, "pieces", file->pieces, file->pieces_count, support,
                             &kernel->pieces, error);
    if (status == SPHV_OK && file->pieces && file->derivative)
        status = read_pieces(yaml, "derivative", file->derivative, file->derivative_count, support,
                             &kernel->gradient, error);
    if (status == SPHV_OK && file->family) status = read_family(yaml, file, kernel, error);
    mpq_clear(support);
    return status;
}

static const int *claim(int *storage, const int *value)
{
    if (!value) return NULL;
    *storage = *value;
    return storage;
}

static const int *claim_flag(int *storage, const bool *value)
{
    if (!value) return NULL;
    *storage = *value;
    return storage;
}

/// A claimed constant is kept as text; that it can be read is settled here, with its line.
static sphv_status read_constant(const sphv_yaml *yaml, const char *place, const char *text,
                                 char **to, sphv_error *error)
{
    if (!text) return SPHV_OK;
    sphv_error reason;
    long double value;
    if (sphv_constant_parse(text, &value, &reason) != SPHV_OK)
        return sphv_yaml_fail(yaml, place, error, "%s", reason.message);
    return copy_text(text, to, error);
}

static sphv_status read_claims(const sphv_yaml *yaml, const struct file_kernel *file,
                               sphv_kernel *kernel, sphv_error *error)
{
    sphv_status status = SPHV_OK;
    if (file->constants) {
        char **to = kernel->claims.constant;
        status = read_constant(yaml, "constants.1d", file->constants->one, &to[0], error);
        if (status == SPHV_OK)
            status = read_constant(yaml, "constants.2d", file->constants->two, &to[1], error);
        if (status == SPHV_OK)
            status = read_constant(yaml, "constants.3d", file->constants->three, &to[2], error);
    }
    if (file->claims) {
        int *storage = kernel->claimed_value;
        kernel->claims.boundary_smoothness = claim(&storage[0], file->claims->boundary_smoothness);
        kernel->claims.smoothing_order = claim(&storage[1], file->claims->smoothing_order);
        kernel->claims.monotone = claim_flag(&storage[2], file->claims->monotone);
        kernel->claims.non_negative = claim_flag(&storage[3], file->claims->non_negative);
    }
    return status;
}

static sphv_status load(const char *path, bool unnormalisable, sphv_kernel **out, sphv_error *error)
{
    sphv_yaml *yaml;
    sphv_status status = sphv_yaml_load(path, &kernel_schema, &yaml, error);
    if (status != SPHV_OK) return status;
    const struct file_kernel *file = sphv_yaml_data(yaml);
    sphv_kernel *kernel = sphv_kernel_new();
    status = kernel ? copy_text(path, &kernel->path, error)
                    : sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    if (status == SPHV_OK) status = read_identity(yaml, file, kernel, error);
    if (status == SPHV_OK) status = read_shape(yaml, file, kernel, error);
    if (status == SPHV_OK) status = read_claims(yaml, file, kernel, error);
    if (status == SPHV_OK) {
        sphv_error reason;
        status = sphv_kernel_compile(kernel, &reason);
        if (status == SPHV_INVALID_INPUT && unnormalisable)
            status = SPHV_OK;
        else if (status == SPHV_INVALID_INPUT)
            sphv_yaml_fail(yaml, file->pieces ? "pieces" : "family", error, "%s", reason.message);
        else if (status != SPHV_OK)
            sphv_fail(error, status, "%s", reason.message);
    }
    sphv_yaml_free(yaml);
    if (status == SPHV_OK)
        *out = kernel;
    else
        sphv_kernel_free(kernel);
    return status;
}

sphv_status sphv_kernel_load(const char *path, sphv_kernel **out, sphv_error *error)
{
    return load(path, false, out, error);
}

sphv_status sphv_kernel_load_any(const char *path, sphv_kernel **out, sphv_error *error)
{
    return load(path, true, out, error);
}
