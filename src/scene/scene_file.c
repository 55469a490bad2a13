#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/directory.h"
#include "core/yaml_file.h"
#include "internal.h"

/// The file as libcyaml fills it.
struct file_abscissa {
    int quantity, scale;
    char *from, *to;
    int points;
    int *markers;
};

struct file_curve {
    char *id, *label, *kernel, *h, *spacing, *spacing_exponent;
    char *method, *layout, *volume, *sigma;
};

struct file_realisations {
    int least, most;
    char *width;
    int *seed;
};

struct file_claim {
    char *id, *statement, *measure, *curve, *reference;
    bool *special;
    char *from, *to, *expected, *tolerance, *reason, *refuted;
};

struct file_scene {
    char *name, *title, *source, *notes;
    struct file_abscissa abscissa;
    struct file_realisations *realisations;
    struct file_curve *curves;
    struct file_claim *claims;
    unsigned curves_count, claims_count;
};

enum { OPTIONAL = CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, POINTS_MAX = 20000 };

static const cyaml_strval_t quantities[] = {
    {"q", SPHV_OVER_Q}, {"h", SPHV_OVER_H}, {"spacing", SPHV_OVER_SPACING}};
static const cyaml_strval_t scales[] = {{"linear", 0}, {"log", 1}};

#define TEXT(key, flags, structure, member, longest)                                               \
    CYAML_FIELD_STRING_PTR(key, flags, structure, member, 1, longest)

static const cyaml_schema_field_t abscissa_fields[] = {
    CYAML_FIELD_ENUM("quantity", CYAML_FLAG_DEFAULT, struct file_abscissa, quantity, quantities, 3),
    CYAML_FIELD_ENUM("scale", CYAML_FLAG_DEFAULT, struct file_abscissa, scale, scales, 2),
    TEXT("from", CYAML_FLAG_POINTER, struct file_abscissa, from, 80),
    TEXT("to", CYAML_FLAG_POINTER, struct file_abscissa, to, 80),
    CYAML_FIELD_INT("points", CYAML_FLAG_DEFAULT, struct file_abscissa, points),
    CYAML_FIELD_INT_PTR("markers", OPTIONAL, struct file_abscissa, markers),
    CYAML_FIELD_END};

static const cyaml_schema_field_t curve_fields[] = {
    TEXT("id", CYAML_FLAG_POINTER, struct file_curve, id, 60),
    TEXT("label", CYAML_FLAG_POINTER, struct file_curve, label, 100),
    TEXT("kernel", CYAML_FLAG_POINTER, struct file_curve, kernel, 400),
    TEXT("h", OPTIONAL, struct file_curve, h, 80),
    TEXT("spacing", OPTIONAL, struct file_curve, spacing, 80),
    TEXT("spacing_exponent", OPTIONAL, struct file_curve, spacing_exponent, 80),
    TEXT("method", OPTIONAL, struct file_curve, method, 40),
    TEXT("layout", OPTIONAL, struct file_curve, layout, 40),
    TEXT("volume", OPTIONAL, struct file_curve, volume, 40),
    TEXT("sigma", OPTIONAL, struct file_curve, sigma, 80),
    CYAML_FIELD_END};

static const cyaml_schema_field_t realisation_fields[] = {
    CYAML_FIELD_INT("least", CYAML_FLAG_DEFAULT, struct file_realisations, least),
    CYAML_FIELD_INT("most", CYAML_FLAG_DEFAULT, struct file_realisations, most),
    TEXT("width", CYAML_FLAG_POINTER, struct file_realisations, width, 80),
    CYAML_FIELD_INT_PTR("seed", OPTIONAL, struct file_realisations, seed), CYAML_FIELD_END};

static const cyaml_schema_field_t claim_fields[] = {
    TEXT("id", CYAML_FLAG_POINTER, struct file_claim, id, 60),
    TEXT("statement", CYAML_FLAG_POINTER, struct file_claim, statement, 600),
    TEXT("measure", CYAML_FLAG_POINTER, struct file_claim, measure, 60),
    TEXT("curve", CYAML_FLAG_POINTER, struct file_claim, curve, 60),
    TEXT("reference", OPTIONAL, struct file_claim, reference, 60),
    CYAML_FIELD_BOOL_PTR("special", OPTIONAL, struct file_claim, special),
    TEXT("from", OPTIONAL, struct file_claim, from, 80),
    TEXT("to", OPTIONAL, struct file_claim, to, 80),
    TEXT("expected", CYAML_FLAG_POINTER, struct file_claim, expected, 80),
    TEXT("tolerance", CYAML_FLAG_POINTER, struct file_claim, tolerance, 80),
    TEXT("reason", CYAML_FLAG_POINTER, struct file_claim, reason, 600),
    TEXT("refuted", OPTIONAL, struct file_claim, refuted, 900),
    CYAML_FIELD_END};

static const cyaml_schema_value_t curve_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct file_curve, curve_fields)};
static const cyaml_schema_value_t claim_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct file_claim, claim_fields)};

static const cyaml_schema_field_t scene_fields[] = {
    TEXT("name", CYAML_FLAG_POINTER, struct file_scene, name, 64),
    TEXT("title", CYAML_FLAG_POINTER, struct file_scene, title, 200),
    TEXT("source", CYAML_FLAG_POINTER, struct file_scene, source, 400),
    TEXT("notes", OPTIONAL, struct file_scene, notes, 4000),
    CYAML_FIELD_MAPPING("abscissa", CYAML_FLAG_DEFAULT, struct file_scene, abscissa,
                        abscissa_fields),
    CYAML_FIELD_MAPPING_PTR("realisations", OPTIONAL, struct file_scene, realisations,
                            realisation_fields),
    CYAML_FIELD_SEQUENCE("curves", CYAML_FLAG_POINTER, struct file_scene, curves, &curve_entry, 1,
                         40),
    CYAML_FIELD_SEQUENCE("claims", OPTIONAL, struct file_scene, claims, &claim_entry, 0, 100),
    CYAML_FIELD_END};

static const cyaml_schema_value_t scene_schema = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct file_scene, scene_fields)};

/// What the readers below share.
struct reader {
    const char *data_directory;
    const sphv_yaml *yaml;
    const struct file_scene *file;
    sphv_scene *scene;
    sphv_error *error;
};

static sphv_status number(const struct reader *of, const char *place, const char *text,
                          sphv_number *out)
{
    sphv_error reason;
    if (sphv_number_parse(text, out, &reason) == SPHV_OK) return SPHV_OK;
    return sphv_yaml_fail(of->yaml, place, of->error, "%s", reason.message);
}

static sphv_status copy(const struct reader *of, const char *from, char **to)
{
    *to = strdup(from ? from : "");
    return *to ? SPHV_OK : sphv_fail(of->error, SPHV_RESOURCE_FAILURE, "out of memory");
}

static sphv_status read_abscissa(const struct reader *of)
{
    const struct file_abscissa *file = &of->file->abscissa;
    sphv_scene *scene = of->scene;
    sphv_number from, to;
    sphv_status status = number(of, "abscissa.from", file->from, &from);
    if (status == SPHV_OK) status = number(of, "abscissa.to", file->to, &to);
    if (status != SPHV_OK) return status;
    scene->abscissa = (sphv_abscissa)file->quantity;
    scene->logarithmic = file->scale == 1;
    scene->from = from.value;
    scene->to = to.value;
    if (!(from.value < to.value) || from.value < 0 || (scene->logarithmic && from.value == 0))
        return sphv_yaml_fail(of->yaml, "abscissa.from", of->error,
                              "range %s to %s; allowed: ascending and positive (from 0 when "
                              "linear)",
                              file->from, file->to);
    if (file->points < 2 || file->points > POINTS_MAX)
        return sphv_yaml_fail(of->yaml, "abscissa.points", of->error, "%d points; allowed: 2 to %d",
                              file->points, POINTS_MAX);
    int markers = file->markers ? *file->markers : 15;
    if (markers < 0 || markers > file->points)
        return sphv_yaml_fail(of->yaml, "abscissa.markers", of->error,
                              "%d markers; allowed: 0 to the number of points", markers);
    scene->points = (size_t)file->points;
    scene->markers = (size_t)markers;
    return SPHV_OK;
}

/// h and spacing of a curve: each given where it is not the abscissa.
static sphv_status read_fixed(const struct reader *of, unsigned index, const char *key,
                              const char *text, bool wanted, sphv_number *out)
{
    char place[64];
    snprintf(place, sizeof place, "curves.%u.%s", index, key);
    if (wanted != (text != NULL))
        return sphv_yaml_fail(of->yaml, place, of->error,
                              "curve '%s' %s '%s'; allowed: a curve fixes what is not the abscissa",
                              of->file->curves[index].id, wanted ? "lacks" : "gives", key);
    return text ? number(of, place, text, out) : SPHV_OK;
}

/// Rejects a curve that would leave the range of arguments anywhere on the abscissa.
static sphv_status check_range(const struct reader *of, unsigned index, const sphv_curve *curve)
{
    const sphv_scene *scene = of->scene;
    if (scene->abscissa == SPHV_OVER_Q) return SPHV_OK;
    sphv_error reason;
    const double ends[] = {scene->from, scene->to};
    for (int i = 0; i < 2; i++) {
        bool over_h = scene->abscissa == SPHV_OVER_H;
        double h = over_h ? ends[i] : curve->h;
        sphv_number spacing =
            over_h ? sphv_curve_spacing(scene, curve, h) : sphv_number_from_double(ends[i]);
        if (sphv_check_point(curve->profile, h, spacing, &reason) == SPHV_OK) continue;
        char place[64];
        snprintf(place, sizeof place, "curves.%u", index);
        return sphv_yaml_fail(of->yaml, place, of->error, "curve '%s': %s", curve->id,
                              reason.message);
    }
    return SPHV_OK;
}

/// The realisations that the whole scene asks for; a width of 2 % from 8 to 64 unless it says.
static sphv_status read_realisations(const struct reader *of, sphv_experiment *out)
{
    const struct file_realisations *file = of->file->realisations;
    *out =
        (sphv_experiment){.seed = 1, .width = 0.02, .realisations_min = 8, .realisations_max = 64};
    if (!file) return SPHV_OK;
    sphv_number width;
    sphv_status status = number(of, "realisations.width", file->width, &width);
    if (status != SPHV_OK) return status;
    if (!(width.value > 0 && width.value < 1) || file->least < 2 || file->most < file->least ||
        file->most > 100000)
        return sphv_yaml_fail(of->yaml, "realisations", of->error,
                              "%d to %d realisations for a width of %s; allowed: 2 to 100000, "
                              "ascending, and a width between 0 and 1",
                              file->least, file->most, file->width);
    out->width = width.value;
    out->realisations_min = file->least;
    out->realisations_max = file->most;
    if (file->seed) out->seed = (uint64_t)*file->seed;
    return SPHV_OK;
}

/// Method, layout, volume rule and σ of a curve.
static sphv_status read_experiment(const struct reader *of, unsigned index, sphv_curve *curve)
{
    const struct file_curve *file = &of->file->curves[index];
    sphv_experiment *experiment = &curve->experiment;
    sphv_error reason = {SPHV_OK, ""};
    sphv_number sigma = {0, 0}, exponent = {0, 0};
    char place[64];
    snprintf(place, sizeof place, "curves.%u", index);
    sphv_status status = read_realisations(of, experiment);
    if (status != SPHV_OK) return status;
    if (file->method) status = sphv_method_parse(file->method, &experiment->method, &reason);
    if (status == SPHV_OK && file->layout)
        status = sphv_layout_parse(file->layout, &experiment->layout, &reason);
    if (status == SPHV_OK && file->volume)
        status = sphv_volume_parse(file->volume, &experiment->volume, &reason);
    if (status == SPHV_OK && file->sigma) status = sphv_number_parse(file->sigma, &sigma, &reason);
    if (status == SPHV_OK && file->spacing_exponent)
        status = sphv_number_parse(file->spacing_exponent, &exponent, &reason);
    experiment->sigma = sigma.value;
    experiment->profile = curve->profile;
    experiment->h = 1;
    curve->spacing_exponent = exponent.value;
    if (status == SPHV_OK) status = sphv_experiment_check(experiment, &reason);
    if (status == SPHV_OK && file->spacing_exponent && of->scene->abscissa != SPHV_OVER_H)
        status = sphv_fail(&reason, SPHV_INVALID_INPUT,
                           "'spacing_exponent'; allowed: where h is the abscissa");
    if (status != SPHV_OK)
        return sphv_yaml_fail(of->yaml, place, of->error, "curve '%s': %s", curve->id,
                              reason.message);
    if (experiment->method != SPHV_SPH || experiment->layout != SPHV_LATTICE ||
        experiment->volume != SPHV_VOLUME_LATTICE)
        of->scene->statistical = true;
    return SPHV_OK;
}

static sphv_status read_curve(const struct reader *of, unsigned index)
{
    const struct file_curve *file = &of->file->curves[index];
    sphv_curve *curve = &of->scene->curves[index];
    sphv_abscissa abscissa = of->scene->abscissa;
    sphv_number h = {0, 0};
    char place[64];
    sphv_status status = copy(of, file->id, &curve->id);
    if (status == SPHV_OK) status = copy(of, file->label, &curve->label);
    if (status == SPHV_OK) status = copy(of, file->spacing, &curve->spacing_text);
    if (status == SPHV_OK)
        status = read_fixed(of, index, "h", file->h, abscissa == SPHV_OVER_SPACING, &h);
    if (status == SPHV_OK)
        status = read_fixed(of, index, "spacing", file->spacing, abscissa == SPHV_OVER_H,
                            &curve->spacing);
    if (status != SPHV_OK) return status;
    curve->h = h.value;
    snprintf(place, sizeof place, "curves.%u.kernel", index);
    sphv_error reason;
    status = sphv_catalogue_find(of->data_directory, file->kernel, &curve->kernel, &reason);
    if (status == SPHV_RESOURCE_FAILURE) return sphv_fail(of->error, status, "%s", reason.message);
    if (status != SPHV_OK) return sphv_yaml_fail(of->yaml, place, of->error, "%s", reason.message);
    curve->profile = sphv_kernel_profile(curve->kernel, 1);
    if (!curve->profile)
        return sphv_yaml_fail(of->yaml, place, of->error,
                              "kernel '%s' is not legal in 1 dimension; allowed: %s", file->kernel,
                              sphv_kernel_refusal(curve->kernel, 1));
    status = read_experiment(of, index, curve);
    return status == SPHV_OK ? check_range(of, index, curve) : status;
}

static sphv_status find_curve(const struct reader *of, unsigned claim, const char *key,
                              const char *id, size_t *out)
{
    for (size_t i = 0; i < of->scene->curve_count; i++)
        if (strcmp(of->scene->curves[i].id, id) == 0) {
            *out = i;
            return SPHV_OK;
        }
    char place[64];
    snprintf(place, sizeof place, "claims.%u.%s", claim, key);
    return sphv_yaml_fail(of->yaml, place, of->error,
                          "no curve '%s'; allowed: the ids of this scene's curves", id);
}

static sphv_status read_measure(const struct reader *of, unsigned index, sphv_claim *claim)
{
    const struct file_claim *file = &of->file->claims[index];
    char place[64], allowed[300] = "";
    size_t used = 0;
    snprintf(place, sizeof place, "claims.%u.measure", index);
    for (const sphv_claim_measure *m = sphv_claim_measures; m->name; m++) {
        if (strcmp(m->name, file->measure) == 0) claim->measure = m;
        used += (size_t)snprintf(allowed + used, sizeof allowed - used, "%s%s", used ? ", " : "",
                                 m->name);
    }
    if (!claim->measure)
        return sphv_yaml_fail(of->yaml, place, of->error, "unknown measure '%s'; allowed: %s",
                              file->measure, allowed);
    if (claim->measure->needs_reference != (file->reference != NULL))
        return sphv_yaml_fail(of->yaml, place, of->error, "measure '%s' %s a 'reference' curve",
                              file->measure, file->reference ? "takes no" : "needs");
    claim->has_reference = file->reference != NULL;
    sphv_status status = find_curve(of, index, "curve", file->curve, &claim->curve);
    if (status == SPHV_OK && file->reference)
        status = find_curve(of, index, "reference", file->reference, &claim->reference);
    return status;
}

static sphv_status read_claim_number(const struct reader *of, unsigned index, const char *key,
                                     const char *text, double otherwise, double *out)
{
    *out = otherwise;
    if (!text) return SPHV_OK;
    char place[64];
    sphv_number value;
    snprintf(place, sizeof place, "claims.%u.%s", index, key);
    sphv_status status = number(of, place, text, &value);
    *out = value.value;
    return status;
}

static sphv_status read_claim(const struct reader *of, unsigned index)
{
    const struct file_claim *file = &of->file->claims[index];
    sphv_claim *claim = &of->scene->claims[index];
    sphv_status status = copy(of, file->id, &claim->id);
    if (status == SPHV_OK) status = copy(of, file->statement, &claim->statement);
    if (status == SPHV_OK) status = copy(of, file->reason, &claim->reason);
    if (status == SPHV_OK && file->refuted) status = copy(of, file->refuted, &claim->refuted);
    if (status == SPHV_OK) status = read_measure(of, index, claim);
    if (status == SPHV_OK)
        status = read_claim_number(of, index, "from", file->from, of->scene->from, &claim->from);
    if (status == SPHV_OK)
        status = read_claim_number(of, index, "to", file->to, of->scene->to, &claim->to);
    if (status == SPHV_OK)
        status = read_claim_number(of, index, "expected", file->expected, 0, &claim->expected);
    if (status == SPHV_OK)
        status = read_claim_number(of, index, "tolerance", file->tolerance, 0, &claim->tolerance);
    if (status == SPHV_OK && claim->tolerance < 0) {
        char place[64];
        snprintf(place, sizeof place, "claims.%u.tolerance", index);
        status = sphv_yaml_fail(of->yaml, place, of->error,
                                "tolerance %s; allowed: zero or positive", file->tolerance);
    }
    claim->special_only = file->special && *file->special;
    return status;
}

static sphv_status read_scene(const struct reader *of)
{
    const struct file_scene *file = of->file;
    sphv_scene *scene = of->scene;
    sphv_status status = copy(of, file->name, &scene->name);
    if (status == SPHV_OK) status = copy(of, file->title, &scene->title);
    if (status == SPHV_OK) status = copy(of, file->source, &scene->source);
    if (status == SPHV_OK) status = copy(of, file->notes, &scene->notes);
    if (status != SPHV_OK) return status;
    if (!sphv_plain_name(file->name))
        return sphv_yaml_fail(of->yaml, "name", of->error,
                              "'%s' is not a name; allowed: letters, digits, '-', '_' and '.'",
                              file->name);
    status = read_abscissa(of);
    scene->curves = calloc(file->curves_count, sizeof *scene->curves);
    scene->claims = calloc(file->claims_count + 1, sizeof *scene->claims);
    if (!scene->curves || !scene->claims)
        return sphv_fail(of->error, SPHV_RESOURCE_FAILURE, "out of memory");
    for (unsigned i = 0; status == SPHV_OK && i < file->curves_count; i++) {
        scene->curve_count = i + 1;
        status = read_curve(of, i);
    }
    for (unsigned i = 0; status == SPHV_OK && i < file->claims_count; i++) {
        scene->claim_count = i + 1;
        status = read_claim(of, i);
    }
    return status;
}

sphv_status sphv_scene_load(const char *data_directory, const char *path, sphv_scene **out,
                            sphv_error *error)
{
    sphv_yaml *yaml;
    sphv_status status = sphv_yaml_load(path, &scene_schema, &yaml, error);
    if (status != SPHV_OK) return status;
    struct reader of = {data_directory, yaml, sphv_yaml_data(yaml), calloc(1, sizeof *of.scene),
                        error};
    status = of.scene ? copy(&of, path, &of.scene->path)
                      : sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    if (status == SPHV_OK) status = read_scene(&of);
    sphv_yaml_free(yaml);
    if (status == SPHV_OK)
        *out = of.scene;
    else
        sphv_scene_free(of.scene);
    return status;
}

void sphv_scene_free(sphv_scene *scene)
{
    if (!scene) return;
    for (size_t i = 0; i < scene->curve_count; i++) {
        free(scene->curves[i].id);
        free(scene->curves[i].label);
        free(scene->curves[i].spacing_text);
        sphv_kernel_free(scene->curves[i].kernel);
    }
    for (size_t i = 0; i < scene->claim_count; i++) {
        free(scene->claims[i].id);
        free(scene->claims[i].statement);
        free(scene->claims[i].reason);
        free(scene->claims[i].refuted);
    }
    free(scene->curves);
    free(scene->claims);
    free(scene->path);
    free(scene->name);
    free(scene->title);
    free(scene->source);
    free(scene->notes);
    free(scene);
}
