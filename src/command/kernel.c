#include <math.h>
#include <stdio.h>
#include <string.h>

#include "command.h"
#include "point_options.h"
#include "sphverify/theory.h"

enum { MOMENTS_SHOWN = 8, DERIVATIVES_SHOWN = 8 };

static json_t *text_or_null(const char *text)
{
    return *text ? json_string(text) : json_null();
}

static json_t *moments(const sphv_kernel *kernel, const sphv_profile *profile)
{
    json_t *list = json_array();
    for (int j = 0; j <= MOMENTS_SHOWN; j += 2) {
        char exact[256];
        sphv_kernel_moment_text(kernel, profile->dimension, j, exact, sizeof exact);
        json_array_append_new(list, json_pack("{s:i, s:o, s:o, s:o}", "order", j, "value",
                                              sphv_json_number(profile->moment[j].value), "bound",
                                              sphv_json_number(profile->moment[j].bound), "exact",
                                              text_or_null(exact)));
    }
    return list;
}

static json_t *knots(const sphv_profile *profile)
{
    json_t *list = json_array();
    for (int i = 0; i < profile->knot_count; i++) {
        const sphv_knot *knot = &profile->knots[i];
        json_array_append_new(
            list, json_pack("{s:o, s:i, s:o}", "position", sphv_json_number(knot->position.value),
                            "order", knot->order, "jump",
                            sphv_json_number(knot->jump[knot->order] * tgamma(knot->order + 1.0))));
    }
    return list;
}

/// Ŵ^(i) at the inner side of κ.
static json_t *edge_derivatives(const sphv_profile *profile)
{
    double jet[DERIVATIVES_SHOWN + 1];
    const sphv_knot *edge = sphv_profile_edge(profile);
    json_t *list = json_array();
    for (int i = 0; i <= DERIVATIVES_SHOWN; i++) {
        jet[i] = edge && i < edge->terms ? edge->jump[i] * tgamma(i + 1.0) : 0;
        json_array_append_new(list, sphv_json_number(jet[i]));
    }
    return list;
}

static json_t *properties(const sphv_kernel *kernel, const sphv_profile *profile)
{
    char constant[256];
    sphv_kernel_constant_text(kernel, profile->dimension, constant, sizeof constant);
    sphv_fourier_sign sign = sphv_fourier_find_sign(profile);
    return json_pack(
        "{s:i, s:{s:o, s:o, s:o}, s:i, s:o, s:o, s:o, s:o, s:o, s:{s:b, s:o, s:o, s:o, s:o}}",
        "dim", profile->dimension, "constant", "value", sphv_json_number(profile->constant.value),
        "bound", sphv_json_number(profile->constant.bound), "exact", text_or_null(constant), "beta",
        profile->boundary_smoothness, "integral_minus_one", sphv_json_number(profile->excess),
        "value_at_origin", sphv_json_number(sphv_profile_derivative(profile, 0, 0).value),
        "moments", moments(kernel, profile), "knots", knots(profile), "edge_derivatives",
        edge_derivatives(profile), "fourier", "negative", sign.negative, "first_negative",
        sign.negative ? sphv_json_number(sign.first_negative) : json_null(), "minimum",
        sphv_json_number(sign.minimum), "minimum_at", sphv_json_number(sign.minimum_at), "searched",
        sphv_json_number(sign.searched));
}

static const char *string_or(const json_t *value, const char *otherwise)
{
    return json_is_string(value) ? json_string_value(value) : otherwise;
}

static double number_at(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key));
}

static void print_dimension(const json_t *of)
{
    const json_t *constant = json_object_get(of, "constant");
    const json_t *fourier = json_object_get(of, "fourier"), *entry;
    size_t i;
    printf("\n%dD\n", (int)json_integer_value(json_object_get(of, "dim")));
    printf("  constant C      %.17g  = %s\n", number_at(constant, "value"),
           string_or(json_object_get(constant, "exact"), "(no rational form)"));
    int beta = (int)json_integer_value(json_object_get(of, "beta"));
    printf("  beta            %d%s\n", beta,
           beta < 0               ? "  (truncated: the value itself jumps at the edge)"
           : beta >= SPHV_JET_MAX ? "  (w is zero before the edge already)"
                                  : "");
    if (number_at(of, "integral_minus_one") != 0)
        printf("  integral - 1    %.6e  (the part beyond the support is missing)\n",
               number_at(of, "integral_minus_one"));
    printf("  moments\n");
    json_array_foreach(json_object_get(of, "moments"), i, entry)
        printf("    mu_%-2d         %.17g  = %s\n",
               (int)json_integer_value(json_object_get(entry, "order")), number_at(entry, "value"),
               string_or(json_object_get(entry, "exact"), "(no rational form)"));
    printf("  knots           position, lowest derivative that jumps, jump\n");
    json_array_foreach(json_object_get(of, "knots"), i, entry)
        printf("    %s%-12.6g %-3d %.10g\n", number_at(entry, "position") > 0 ? "±" : " ",
               number_at(entry, "position"),
               (int)json_integer_value(json_object_get(entry, "order")), number_at(entry, "jump"));
    printf("  at the edge     derivatives 0 to %d:", DERIVATIVES_SHOWN);
    json_array_foreach(json_object_get(of, "edge_derivatives"), i, entry)
        printf(" %.6g", json_number_value(entry));
    printf("\n  Fourier         ");
    if (json_is_true(json_object_get(fourier, "negative")))
        printf("first negative at wavenumber %.6g/h, minimum %.3e at %.6g/h\n",
               number_at(fourier, "first_negative"), number_at(fourier, "minimum"),
               number_at(fourier, "minimum_at"));
    else
        printf("nowhere negative beyond rounding up to wavenumber %.6g/h\n",
               number_at(fourier, "searched"));
}

static void print_text(const sphv_kernel *kernel, const json_t *answer)
{
    const json_t *dimension, *refused;
    const char *key;
    size_t i;
    printf("%s: %s\nsource: %s\nsupport: %.17g h\n", sphv_kernel_name(kernel),
           sphv_kernel_title(kernel), sphv_kernel_source(kernel), number_at(answer, "support"));
    json_array_foreach(json_object_get(answer, "dimensions"), i, dimension)
        print_dimension(dimension);
    json_object_foreach(json_object_get(answer, "refused"), key, refused)
        printf("\n%sD: not legal: %s\n", key, json_string_value(refused));
}

/// One row per dimension with the scalar properties, for CSV and Markdown.
static void print_summary(sphv_format format, const json_t *answer)
{
    json_t *rows = json_array(), *dimension;
    size_t i;
    json_array_foreach(json_object_get(answer, "dimensions"), i, dimension)
    {
        json_t *row = json_object();
        json_object_set(row, "kernel", json_object_get(answer, "kernel"));
        json_object_set(row, "support", json_object_get(answer, "support"));
        static const char *const keys[] = {"dim",
                                           "constant",
                                           "beta",
                                           "integral_minus_one",
                                           "value_at_origin",
                                           "edge_derivatives",
                                           "fourier"};
        for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
            json_object_set(row, keys[k], json_object_get(dimension, keys[k]));
        json_t *moment;
        size_t m;
        json_array_foreach(json_object_get(dimension, "moments"), m, moment)
        {
            char name[16];
            snprintf(name, sizeof name, "mu_%zu", 2 * m);
            json_object_set(row, name, json_object_get(moment, "value"));
        }
        json_array_append_new(rows, row);
    }
    sphv_print_rows(format, rows);
    json_decref(rows);
}

static int run(const sphv_arguments *arguments)
{
    sphv_error error;
    sphv_kernel *kernel = NULL;
    const sphv_profile *only = NULL;
    int asked;
    sphv_status status = sphv_dimension_option(arguments, 0, &asked, &error);
    if (status == SPHV_OK)
        status =
            sphv_catalogue_find(arguments->data_directory, arguments->operands[0], &kernel, &error);
    if (status == SPHV_OK && asked) status = sphv_profile_required(kernel, asked, &only, &error);
    if (status != SPHV_OK) {
        sphv_kernel_free(kernel);
        return sphv_report_failure(arguments, &error);
    }
    json_t *dimensions = json_array(), *refused = json_object();
    double support = 0;
    for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
        const sphv_profile *profile = sphv_kernel_profile(kernel, d);
        char name[4];
        snprintf(name, sizeof name, "%d", d);
        if (profile) support = profile->support;
        if (asked && d != asked) continue;
        if (profile)
            json_array_append_new(dimensions, properties(kernel, profile));
        else
            json_object_set_new(refused, name, json_string(sphv_kernel_refusal(kernel, d)));
    }
    json_t *answer =
        json_pack("{s:s, s:s, s:s, s:o, s:o, s:o}", "kernel", sphv_kernel_name(kernel), "title",
                  sphv_kernel_title(kernel), "source", sphv_kernel_source(kernel), "support",
                  sphv_json_number(support), "dimensions", dimensions, "refused", refused);
    if (arguments->format == SPHV_FORMAT_JSON)
        sphv_print_json(answer);
    else if (arguments->format == SPHV_FORMAT_TEXT)
        print_text(kernel, answer);
    else
        print_summary(arguments->format, answer);
    json_decref(answer);
    sphv_kernel_free(kernel);
    return 0;
}

static const sphv_option options[] = {
    {"dim", 'd', "D", "only this dimension: 1, 2 or 3 (default: all legal ones)"},
    {NULL, 0, NULL, NULL},
};

const sphv_command sphv_command_kernel = {
    "kernel",
    "K",
    "One kernel's properties: constants, moments, knots, edge, Fourier transform",
    "K is a catalogue name or the path of a kernel file. Constants and moments are recomputed\n"
    "from the pieces, exactly where they are rational.\n\n"
    "Example:\n"
    "  sphverify kernel cubic-spline --dim 1\n",
    1,
    1,
    options,
    run};
