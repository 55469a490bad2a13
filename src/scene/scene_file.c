#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene_reader.h"

enum { POINTS_MAX = 20000 };

static const cyaml_strval_t quantities[] = {
    {"q", SPHV_OVER_Q}, {"h", SPHV_OVER_H}, {"spacing", SPHV_OVER_SPACING}};
static const cyaml_strval_t scales[] = {{"linear", 0}, {"log", 1}};

static const cyaml_schema_field_t abscissa_fields[] = {
    CYAML_FIELD_ENUM("quantity", CYAML_FLAG_DEFAULT, struct sphv_file_abscissa, quantity,
                     quantities, 3),
    CYAML_FIELD_ENUM("scale", CYAML_FLAG_DEFAULT, struct sphv_file_abscissa, scale, scales, 2),
    SPHV_TEXT("from", CYAML_FLAG_POINTER, struct sphv_file_abscissa, from, 80),
    SPHV_TEXT("to", CYAML_FLAG_POINTER, struct sphv_file_abscissa, to, 80),
    CYAML_FIELD_INT("points", CYAML_FLAG_DEFAULT, struct sphv_file_abscissa, points),
    CYAML_FIELD_INT_PTR("markers", SPHV_OPTIONAL, struct sphv_file_abscissa, markers),
    CYAML_FIELD_END};

static const cyaml_schema_field_t curve_fields[] = {
    SPHV_TEXT("id", CYAML_FLAG_POINTER, struct sphv_file_curve, id, 60),
    SPHV_TEXT("label", CYAML_FLAG_POINTER, struct sphv_file_curve, label, 100),
    SPHV_TEXT("kernel", CYAML_FLAG_POINTER, struct sphv_file_curve, kernel, 400),
    SPHV_TEXT("h", SPHV_OPTIONAL, struct sphv_file_curve, h, 80),
    SPHV_TEXT("spacing", SPHV_OPTIONAL, struct sphv_file_curve, spacing, 80),
    SPHV_TEXT("spacing_exponent", SPHV_OPTIONAL, struct sphv_file_curve, spacing_exponent, 80),
    SPHV_TEXT("method", SPHV_OPTIONAL, struct sphv_file_curve, method, 40),
    SPHV_TEXT("layout", SPHV_OPTIONAL, struct sphv_file_curve, layout, 40),
    SPHV_TEXT("volume", SPHV_OPTIONAL, struct sphv_file_curve, volume, 40),
    SPHV_TEXT("sigma", SPHV_OPTIONAL, struct sphv_file_curve, sigma, 80),
    CYAML_FIELD_END};

static const cyaml_schema_field_t realisation_fields[] = {
    CYAML_FIELD_INT("least", CYAML_FLAG_DEFAULT, struct sphv_file_realisations, least),
    CYAML_FIELD_INT("most", CYAML_FLAG_DEFAULT, struct sphv_file_realisations, most),
    SPHV_TEXT("width", CYAML_FLAG_POINTER, struct sphv_file_realisations, width, 80),
    CYAML_FIELD_INT_PTR("seed", SPHV_OPTIONAL, struct sphv_file_realisations, seed),
    CYAML_FIELD_END};

static const cyaml_schema_field_t claim_fields[] = {
    SPHV_STATED_FIRST(struct sphv_file_claim),
    SPHV_TEXT("measure", CYAML_FLAG_POINTER, struct sphv_file_claim, measure, 60),
    SPHV_TEXT("curve", CYAML_FLAG_POINTER, struct sphv_file_claim, curve, 60),
    SPHV_TEXT("reference", SPHV_OPTIONAL, struct sphv_file_claim, reference, 60),
    CYAML_FIELD_BOOL_PTR("special", SPHV_OPTIONAL, struct sphv_file_claim, special),
    SPHV_TEXT("from", SPHV_OPTIONAL, struct sphv_file_claim, from, 80),
    SPHV_TEXT("to", SPHV_OPTIONAL, struct sphv_file_claim, to, 80),
    SPHV_STATED_LAST(struct sphv_file_claim),
    CYAML_FIELD_END};

static const cyaml_schema_value_t curve_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_file_curve, curve_fields)};
static const cyaml_schema_value_t claim_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_file_claim, claim_fields)};

static const cyaml_schema_field_t scene_fields[] = {
    SPHV_HEAD_FIELDS(struct sphv_file_scene),
    CYAML_FIELD_MAPPING("abscissa", CYAML_FLAG_DEFAULT, struct sphv_file_scene, abscissa,
                        abscissa_fields),
    CYAML_FIELD_MAPPING_PTR("realisations", SPHV_OPTIONAL, struct sphv_file_scene, realisations,
                            realisation_fields),
    CYAML_FIELD_SEQUENCE("curves", CYAML_FLAG_POINTER, struct sphv_file_scene, curves, &curve_entry,
                         1, 40),
    CYAML_FIELD_SEQUENCE("claims", SPHV_OPTIONAL, struct sphv_file_scene, claims, &claim_entry, 0,
                         100),
    CYAML_FIELD_END};

const cyaml_schema_value_t sphv_scene_schema = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct sphv_file_scene, scene_fields)};

sphv_status sphv_scene_number(const struct sphv_scene_reader *of, const char *place,
                              const char *text, sphv_number *out)
{
    sphv_error reason;
    if (sphv_number_parse(text, out, &reason) == SPHV_OK) return SPHV_OK;
    return sphv_yaml_fail(of->yaml, place, of->error, "%s", reason.message);
}

static sphv_status read_abscissa(const struct sphv_scene_reader *of)
{
    const struct sphv_file_abscissa *file = &of->file->abscissa;
    sphv_scene *scene = of->scene;
    sphv_number from, to;
    sphv_status status = sphv_scene_number(of, "abscissa.from", file->from, &from);
    if (status == SPHV_OK) status = sphv_scene_number(of, "abscissa.to", file->to, &to);
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
    int markers = file->markers ? *file->markers : file->points < 15 ? file->points : 15;
    if (markers < 0 || markers > file->points)
        return sphv_yaml_fail(of->yaml, "abscissa.markers", of->error,
                              "%d markers; allowed: 0 to the number of points", markers);
    scene->points = (size_t)file->points;
    scene->markers = (size_t)markers;
    return SPHV_OK;
}

static sphv_status find_curve(const struct sphv_scene_reader *of, unsigned claim, const char *key,
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

static sphv_status read_measure(const struct sphv_scene_reader *of, unsigned index,
                                sphv_claim *claim)
{
    const struct sphv_file_claim *file = &of->file->claims[index];
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
    if (claim->measure->plain_only && of->scene->statistical)
        return sphv_yaml_fail(of->yaml, place, of->error,
                              "measure '%s' in a scene of L2 norms; allowed: where every curve is "
                              "standard SPH on a lattice",
                              file->measure);
    claim->has_reference = file->reference != NULL;
    sphv_status status = find_curve(of, index, "curve", file->curve, &claim->curve);
    if (status == SPHV_OK && file->reference)
        status = find_curve(of, index, "reference", file->reference, &claim->reference);
    return status;
}

static sphv_status read_claim_number(const struct sphv_scene_reader *of, unsigned index,
                                     const char *key, const char *text, double otherwise,
                                     double *out)
{
    *out = otherwise;
    if (!text) return SPHV_OK;
    char place[64];
    sphv_number value;
    snprintf(place, sizeof place, "claims.%u.%s", index, key);
    sphv_status status = sphv_scene_number(of, place, text, &value);
    *out = value.value;
    return status;
}

static sphv_status read_claim(const struct sphv_scene_reader *of, unsigned index)
{
    const struct sphv_file_claim *file = &of->file->claims[index];
    sphv_claim *claim = &of->scene->claims[index];
    sphv_status status = sphv_read_claim_texts(&file->stated, SPHV_TEXTS_OF(claim), of->error);
    if (status == SPHV_OK) status = read_measure(of, index, claim);
    if (status == SPHV_OK)
        status = read_claim_number(of, index, "from", file->from, of->scene->from, &claim->from);
    if (status == SPHV_OK)
        status = read_claim_number(of, index, "to", file->to, of->scene->to, &claim->to);
    if (status == SPHV_OK)
        status =
            read_claim_number(of, index, "expected", file->stated.expected, 0, &claim->expected);
    if (status == SPHV_OK)
        status =
            read_claim_number(of, index, "tolerance", file->stated.tolerance, 0, &claim->tolerance);
    if (status == SPHV_OK &&
        (claim->from > claim->to || claim->from > of->scene->to || claim->to < of->scene->from)) {
        char place[64];
        snprintf(place, sizeof place, "claims.%u.%s", index, file->from ? "from" : "to");
        status = sphv_yaml_fail(of->yaml, place, of->error,
                                "no point from %g to %g; allowed: a part of the abscissa, %g to %g",
                                claim->from, claim->to, of->scene->from, of->scene->to);
    }
    if (status == SPHV_OK && claim->tolerance < 0) {
        char place[64];
        snprintf(place, sizeof place, "claims.%u.tolerance", index);
        status = sphv_yaml_fail(of->yaml, place, of->error,
                                "tolerance %s; allowed: zero or positive", file->stated.tolerance);
    }
    claim->special_only = file->special && *file->special;
    return status;
}

/// Claims name curves, and reports name claims, by their ids: each id stands once.
static sphv_status refuse_repeated(const struct sphv_scene_reader *of)
{
    const struct sphv_file_scene *file = of->file;
    char place[64];
    for (unsigned i = 0; i < file->curves_count; i++)
        for (unsigned j = 0; j < i; j++)
            if (strcmp(file->curves[i].id, file->curves[j].id) == 0) {
                snprintf(place, sizeof place, "curves.%u.id", i);
                return sphv_yaml_fail(of->yaml, place, of->error,
                                      "curve '%s' again; allowed: each id once",
                                      file->curves[i].id);
            }
    for (unsigned i = 0; i < file->claims_count; i++)
        for (unsigned j = 0; j < i; j++)
            if (strcmp(file->claims[i].stated.id, file->claims[j].stated.id) == 0) {
                snprintf(place, sizeof place, "claims.%u.id", i);
                return sphv_yaml_fail(of->yaml, place, of->error,
                                      "claim '%s' again; allowed: each id once",
                                      file->claims[i].stated.id);
            }
    return SPHV_OK;
}

static sphv_status read_scene(const struct sphv_scene_reader *of)
{
    const struct sphv_file_scene *file = of->file;
    sphv_scene *scene = of->scene;
    sphv_status status = read_abscissa(of);
    scene->curves = calloc(file->curves_count, sizeof *scene->curves);
    scene->claims = calloc(file->claims_count + 1, sizeof *scene->claims);
    if (!scene->curves || !scene->claims)
        return sphv_fail(of->error, SPHV_RESOURCE_FAILURE, "out of memory");
    if (status == SPHV_OK) status = refuse_repeated(of);
    for (unsigned i = 0; status == SPHV_OK && i < file->curves_count; i++) {
        scene->curve_count = i + 1;
        status = sphv_scene_read_curve(of, i);
    }
    for (unsigned i = 0; status == SPHV_OK && i < file->claims_count; i++) {
        scene->claim_count = i + 1;
        status = read_claim(of, i);
    }
    return status;
}

sphv_status sphv_scene_read(const char *data_directory, const char *path, const sphv_yaml *yaml,
                            sphv_scene **out, sphv_error *error)
{
    struct sphv_scene_reader of = {data_directory, yaml, sphv_yaml_data(yaml),
                                   calloc(1, sizeof *of.scene), error};
    if (!of.scene) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    sphv_status status = sphv_read_head(yaml, path, &of.file->head, SPHV_HEAD_OF(of.scene), error);
    if (status == SPHV_OK) status = read_scene(&of);
    if (status == SPHV_OK)
        *out = of.scene;
    else
        sphv_scene_free(of.scene);
    return status;
}

sphv_status sphv_scene_load(const char *data_directory, const char *path, sphv_scene **out,
                            sphv_error *error)
{
    sphv_yaml *yaml;
    sphv_status status = sphv_yaml_load(path, &sphv_scene_schema, &yaml, error);
    if (status != SPHV_OK) return status;
    status = sphv_scene_read(data_directory, path, yaml, out, error);
    sphv_yaml_free(yaml);
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
    for (size_t i = 0; i < scene->claim_count; i++)
        sphv_free_claim_texts(SPHV_TEXTS_OF(&scene->claims[i]));
    free(scene->curves);
    free(scene->claims);
    sphv_free_head(SPHV_HEAD_OF(scene));
    free(scene);
}
