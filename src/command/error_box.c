#include "error_box.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "point_options.h"

struct error_box {
    sphv_kernel *kernel;
    sphv_box_question question;
};

/// The side of a box of N = side^d particles.
static sphv_status read_side(const sphv_arguments *arguments, int dimension, size_t *side,
                             sphv_error *error)
{
    const char *text = sphv_argument(arguments, "particles");
    char *end;
    double count = strtod(text, &end), root = round(pow(count, 1.0 / dimension));
    if (end != text && *end == '\0' && count >= 1 && count <= SPHV_BOX_PARTICLES_MAX &&
        pow(root, dimension) == count) {
        *side = (size_t)root;
        return SPHV_OK;
    }
    return sphv_fail(error, SPHV_INVALID_INPUT,
                     "--particles is '%.40s'; allowed: %s, 1 to %g, such as %d", text,
                     dimension == 1   ? "a whole number"
                     : dimension == 2 ? "a square number"
                                      : "a cube number",
                     SPHV_BOX_PARTICLES_MAX,
                     dimension == 1   ? 100
                     : dimension == 2 ? 625
                                      : 1000);
}

static sphv_status read_box(const sphv_arguments *arguments, sphv_box *box, sphv_error *error)
{
    static const char *const placements[] = {"vertex", "cell", NULL};
    static const char *const jitters[] = {"normal", "uniform", NULL};
    const char *layout = sphv_argument(arguments, "layout");
    const char *volume = sphv_argument(arguments, "volume");
    long seed;
    int placement, jitter;
    sphv_status status = sphv_dimension_option(arguments, 2, &box->dimension, error);
    if (status == SPHV_OK) status = read_side(arguments, box->dimension, &box->side, error);
    if (status == SPHV_OK && layout) status = sphv_layout_parse(layout, &box->layout, error);
    if (status == SPHV_OK) status = sphv_real_option(arguments, "sigma", 0, &box->amplitude, error);
    if (status == SPHV_OK && !layout && box->amplitude > 0) box->layout = SPHV_PERTURBED;
    box->volume = box->layout == SPHV_LATTICE ? SPHV_VOLUME_LATTICE : SPHV_VOLUME_EQUAL;
    if (status == SPHV_OK && volume) status = sphv_volume_parse(volume, &box->volume, error);
    box->periodic = sphv_argument(arguments, "periodic") != NULL;
    box->reflected = sphv_argument(arguments, "reflected") != NULL;
    if (status == SPHV_OK)
        status = sphv_word_option(arguments, "placement", placements, &placement, error);
    if (status == SPHV_OK) status = sphv_word_option(arguments, "jitter", jitters, &jitter, error);
    if (status == SPHV_OK)
        status = sphv_whole_option(arguments, "seed", 0, 1000000000, 1, &seed, error);
    if (status != SPHV_OK) return status;
    if (box->layout != SPHV_PERTURBED && (box->reflected || sphv_argument(arguments, "jitter")))
        return sphv_fail(
            error, SPHV_INVALID_INPUT,
            "--jitter and --reflected say how particles are perturbed; without --sigma "
            "they are not");
    // Without a boundary there is no vertex to stand on.
    bool chosen = sphv_argument(arguments, "placement") != NULL;
    box->placement = box->periodic && !chosen ? SPHV_PLACEMENT_CELL : (sphv_placement)placement;
    box->jitter = (sphv_jitter)jitter;
    box->seed = (uint64_t)seed;
    return sphv_box_check(box, error);
}

/// h itself, or from the spacing ratio Δx/h.
static sphv_status read_h(const sphv_arguments *arguments, const sphv_box *box, double *h,
                          sphv_error *error)
{
    bool absolute = sphv_argument(arguments, "h") != NULL;
    if (absolute == (sphv_argument(arguments, "spacing") != NULL))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "with --particles one of --h and --spacing is needed, not %s",
                         absolute ? "both" : "none");
    sphv_number number;
    sphv_status status = sphv_number_option(arguments, absolute ? "h" : "spacing", &number, error);
    if (status != SPHV_OK) return status;
    *h = absolute ? number.value : sphv_box_spacing(box) / number.value;
    if (*h >= SPHV_H_MIN && *h <= SPHV_H_MAX) return SPHV_OK;
    return sphv_fail(error, SPHV_INVALID_INPUT, "h is %g; allowed: %g to %g", *h, SPHV_H_MIN,
                     SPHV_H_MAX);
}

static sphv_status read_question(const sphv_arguments *arguments, struct error_box *of,
                                 sphv_error *error)
{
    const char *name = sphv_argument(arguments, "kernel");
    const char *method = sphv_argument(arguments, "method");
    const char *field = sphv_argument(arguments, "field");
    sphv_box_question *question = &of->question;
    if (!name) return sphv_fail(error, SPHV_INVALID_INPUT, "--kernel is missing; see --help");
    sphv_status status = read_box(arguments, &question->box, error);
    if (status == SPHV_OK && method) status = sphv_method_parse(method, &question->method, error);
    if (status == SPHV_OK)
        status = sphv_field_parse(field ? field : "f1", question->box.dimension, &question->field,
                                  error);
    if (status == SPHV_OK) status = read_h(arguments, &question->box, &question->h, error);
    if (status == SPHV_OK)
        status = sphv_catalogue_find(arguments->data_directory, name, &of->kernel, error);
    if (status == SPHV_OK)
        status =
            sphv_profile_required(of->kernel, question->box.dimension, &question->profile, error);
    return status;
}

/// `A`, `dA/dx`, `d2A/dxdy` …
static void quantity_name(int dimension, size_t quantity, char name[16])
{
    static const char axis[] = "xyz";
    const sphv_monomial *of = &sphv_monomials(dimension)[quantity];
    int used = snprintf(name, 16, of->degree == 0 ? "A" : of->degree == 1 ? "dA/" : "d2A/");
    for (int k = 0; k < dimension; k++)
        for (int p = 0; p < of->power[k]; p++)
            used += snprintf(name + used, (size_t)(16 - used), "d%c", axis[k]);
}

/// Particles left out of a norm, over all reasons.
static size_t left_out(const sphv_norms *norms)
{
    size_t sum = norms->exact_undefined;
    for (int f = 0; f < SPHV_FAULTS; f++) sum += norms->excluded[f];
    return sum;
}

static const char *verdict_of(const sphv_box_point *point, size_t q)
{
    if (!point->predicted || !point->analytic.exists[q]) return "no theory";
    return sphv_verdict_name(point->verdicts[q]);
}

static void print_faults(const sphv_norms *norms)
{
    if (left_out(norms) == 0) return;
    printf("left out of the norms of the value:");
    for (int f = 0; f < SPHV_FAULTS; f++)
        if (norms->excluded[f]) printf(" %zu %s;", norms->excluded[f], sphv_faults[f].name);
    if (norms->exact_undefined)
        printf(" %zu where the exact value is not finite;", norms->exact_undefined);
    printf(" of %zu\n", norms->counted + left_out(norms));
}

static void print_text(const struct error_box *of, const sphv_box_point *point)
{
    const sphv_box_question *question = &of->question;
    const sphv_box *box = &question->box;
    double spacing = sphv_box_spacing(box);
    printf("%s in %dD, %s by %s on %zu particles in the unit box\n", sphv_kernel_name(of->kernel),
           box->dimension, question->field.name, sphv_methods[question->method].name,
           point->particles);
    printf("layout %s, %s placement%s, volumes %s", sphv_layouts[box->layout].name,
           sphv_placements[box->placement].name, box->periodic ? ", periodic" : "",
           sphv_volumes[box->volume].name);
    if (box->layout == SPHV_PERTURBED)
        printf(", %s jitter of %g dx%s, seed %llu", sphv_jitters[box->jitter].name, box->amplitude,
               box->reflected ? ", reflected" : "", (unsigned long long)box->seed);
    printf("\nh = %.6g, Δx/h = %.6g, %zu to %zu neighbours\n\n", question->h, spacing / question->h,
           point->neighbours_least, point->neighbours_most);
    printf("RMSE      %13s %13s %9s %13s %13s  %s\n", "predicted", "measured", "bounds", "interior",
           "maximum", "verdict");
    for (size_t q = 0; q < point->quantities; q++) {
        const sphv_norms *norms = &point->norms[q];
        char name[16];
        quantity_name(box->dimension, q, name);
        printf("%-9s ", name);
        if (norms->counted == 0) {
            printf("%13s %13s\n", "-", "no particle");
            continue;
        }
        if (point->predicted && point->analytic.exists[q])
            printf("%13.6e %13.6e %9.1e", point->analytic.rmse[q].value, norms->rmse,
                   point->analytic.rmse[q].bound + point->interval[q]);
        else
            printf("%13s %13.6e %9.1e", "-", norms->rmse, norms->bound);
        if (point->interior[q].counted)
            printf(" %13.6e", point->interior[q].rmse);
        else
            printf(" %13s", "no particle");
        printf(" %13.6e  %s\n", norms->maximum, verdict_of(point, q));
    }
    printf("\n%.0f pairs in %.2f s", point->pairs, point->seconds);
    if (point->worst_condition > 1) printf("; worst condition number %.2e", point->worst_condition);
    printf("\n");
    print_faults(&point->norms[0]);
    if (point->predicted)
        printf("%s (%s)\n", sphv_verdict_name(point->verdict),
               sphv_rigour_name(point->analytic.rigour));
    else
        printf("%s: %s\n", sphv_verdict_name(point->verdict),
               point->norms[0].counted > 0 ? "no theory for these particles and this method"
                                           : "no particle is left to compare");
}

static json_t *prediction_json(const sphv_box_point *point, size_t q, const sphv_result *of)
{
    return point->predicted && point->analytic.exists[q] ? sphv_json_number(of[q].value)
                                                         : json_null();
}

/// Null where every particle was left out.
static json_t *norm_json(const sphv_norms *norms, double value)
{
    return norms->counted ? sphv_json_number(value) : json_null();
}

static json_t *quantity_json(const struct error_box *of, const sphv_box_point *point, size_t q)
{
    const sphv_norms *norms = &point->norms[q];
    char name[16];
    quantity_name(of->question.box.dimension, q, name);
    json_t *excluded = json_object();
    for (int f = SPHV_FAULT_NONE + 1; f < SPHV_FAULTS; f++)
        json_object_set_new(excluded, sphv_faults[f].name,
                            json_integer((json_int_t)norms->excluded[f]));
    json_object_set_new(excluded, "exact-undefined",
                        json_integer((json_int_t)norms->exact_undefined));
    return json_pack(
        "{s:s, s:{s:o, s:o, s:o}, s:{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:I, s:o}, s:s}",
        "quantity", name, "analytic", "rmse", prediction_json(point, q, point->analytic.rmse),
        "interior", prediction_json(point, q, point->analytic.interior), "bound",
        point->predicted && point->analytic.exists[q]
            ? sphv_json_number(point->analytic.rmse[q].bound)
            : json_null(),
        "empirical", "rmse", norm_json(norms, norms->rmse), "interior",
        point->interior[q].counted ? sphv_json_number(point->interior[q].rmse) : json_null(),
        "bound", norm_json(norms, norms->bound), "interval", norm_json(norms, point->interval[q]),
        "mae", norm_json(norms, norms->mae), "maximum", norm_json(norms, norms->maximum),
        "mean_square", norm_json(norms, norms->mean_square), "standard_deviation",
        norm_json(norms, norms->standard_deviation), "counted", (json_int_t)norms->counted,
        "excluded", excluded, "verdict", verdict_of(point, q));
}

static json_t *as_json(const struct error_box *of, const sphv_box_point *point)
{
    const sphv_box_question *question = &of->question;
    const sphv_box *box = &question->box;
    json_t *quantities = json_array();
    for (size_t q = 0; q < point->quantities; q++)
        json_array_append_new(quantities, quantity_json(of, point, q));
    return json_pack(
        "{s:s, s:i, s:s, s:s, s:s, s:s, s:s, s:b, s:s, s:b, s:o, s:o, s:o, s:I, s:s, s:I, s:I, s:I,"
        " s:o, s:o, s:o, s:o, s:s}",
        "kernel", sphv_kernel_name(of->kernel), "dim", box->dimension, "method",
        sphv_methods[question->method].name, "field", question->field.name, "layout",
        sphv_layouts[box->layout].name, "volume", sphv_volumes[box->volume].name, "placement",
        sphv_placements[box->placement].name, "periodic", box->periodic, "jitter",
        sphv_jitters[box->jitter].name, "reflected", box->reflected, "h",
        sphv_json_number(question->h), "spacing",
        sphv_json_number(sphv_box_spacing(box) / question->h), "sigma",
        sphv_json_number(box->amplitude), "seed", (json_int_t)box->seed, "rigour",
        point->predicted ? sphv_rigour_name(point->analytic.rigour) : "none", "particles",
        (json_int_t)point->particles, "neighbours", (json_int_t)point->neighbours_most,
        "neighbours_least", (json_int_t)point->neighbours_least, "pairs", json_real(point->pairs),
        "worst_condition", sphv_json_number(point->worst_condition), "seconds",
        sphv_json_number(point->seconds), "quantities", quantities, "verdict",
        sphv_verdict_name(point->verdict));
}

/// CSV and Markdown: a row for each quantity, with what was asked in front.
static json_t *as_rows(json_t *answer)
{
    json_t *rows = json_array(), *quantities = json_object_get(answer, "quantities"), *quantity;
    size_t i;
    json_array_foreach(quantities, i, quantity)
    {
        json_t *row = json_object();
        json_object_update(row, answer);
        json_object_del(row, "quantities");
        json_object_update(row, quantity);
        json_array_append_new(rows, row);
    }
    return rows;
}

static void print(sphv_format format, const struct error_box *of, const sphv_box_point *point)
{
    if (format == SPHV_FORMAT_TEXT) {
        print_text(of, point);
        return;
    }
    json_t *answer = as_json(of, point);
    if (format == SPHV_FORMAT_JSON) {
        sphv_print_json(answer);
    } else {
        json_t *rows = as_rows(answer);
        sphv_print_rows(format, rows);
        json_decref(rows);
    }
    json_decref(answer);
}

int sphv_run_error_box(const sphv_arguments *arguments)
{
    struct error_box of = {0};
    sphv_box_point point;
    sphv_error error;
    sphv_status status = read_question(arguments, &of, &error);
    if (status == SPHV_OK)
        status = sphv_evaluate_box(&of.question, sphv_progress_bar, "particles", &point, &error);
    if (status == SPHV_OK) print(arguments->format, &of, &point);
    sphv_kernel_free(of.kernel);
    return status == SPHV_OK ? sphv_verdict_exit(point.verdict)
                             : sphv_report_failure(arguments, &error);
}
