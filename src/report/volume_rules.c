#include "volume_rules.h"

#include <stdlib.h>
#include <string.h>

const sphv_volume sphv_rule_volume[SPHV_RULES] = {SPHV_VOLUME_TESSELLATED, SPHV_VOLUME_LATTICE};
const char *const sphv_rule_name[SPHV_RULES] = {"tessellated volumes", "volumes Δx"};

/// A scene with the curves that it lacks behind its own, and the samples of all.
struct both {
    sphv_scene scene;         ///< `curves` is owned, what they point to is not
    sphv_scene_result result; ///< `sample_count` and `samples` are owned, the samples are not
    sphv_scene lacking;       ///< the added curves alone
    sphv_scene_result *ran;   ///< what running `lacking` found
};

static bool is_ruled(const sphv_curve *curve)
{
    const sphv_experiment *of = &curve->experiment;
    return of->layout == SPHV_PERTURBED && of->sigma > 0 &&
           (of->volume == SPHV_VOLUME_TESSELLATED || of->volume == SPHV_VOLUME_LATTICE);
}

/// Whether two curves differ in nothing but the volume rule.
static bool is_same(const sphv_curve *a, const sphv_curve *b)
{
    const sphv_experiment *x = &a->experiment, *y = &b->experiment;
    return strcmp(sphv_kernel_name(a->kernel), sphv_kernel_name(b->kernel)) == 0 && a->h == b->h &&
           a->spacing.value == b->spacing.value && a->spacing_exponent == b->spacing_exponent &&
           x->method == y->method && x->layout == y->layout && x->sigma == y->sigma;
}

/// \return index of the curve with that rule; curve_count when there is none
static size_t find_curve(const sphv_scene *scene, const sphv_curve *like, int rule)
{
    size_t c = 0;
    while (c < scene->curve_count &&
           !(is_ruled(&scene->curves[c]) &&
             scene->curves[c].experiment.volume == sphv_rule_volume[rule] &&
             is_same(&scene->curves[c], like)))
        c++;
    return c;
}

static bool is_claim_of_rules(const sphv_scene *scene, const sphv_claim *claim)
{
    const sphv_curve *curve = &scene->curves[claim->curve];
    if (!is_ruled(curve)) return false;
    if (!claim->has_reference) return true;
    const sphv_curve *other = &scene->curves[claim->reference];
    return is_ruled(other) && other->experiment.volume == curve->experiment.volume;
}

static sphv_volume volume_of(const sphv_scene *scene, const sphv_claim *claim)
{
    return scene->curves[claim->curve].experiment.volume;
}

/// Whether an earlier claim asks the same of the same curve with the other volume rule. Its range
/// may be another: the rules meet the floor of smoothing at different places.
static bool is_repeated(const sphv_scene *scene, size_t index)
{
    const sphv_claim *claim = &scene->claims[index];
    for (size_t i = 0; i < index; i++) {
        const sphv_claim *other = &scene->claims[i];
        if (is_claim_of_rules(scene, other) && other->measure == claim->measure &&
            other->expected == claim->expected && other->special_only == claim->special_only &&
            other->has_reference == claim->has_reference &&
            volume_of(scene, other) != volume_of(scene, claim) &&
            is_same(&scene->curves[other->curve], &scene->curves[claim->curve]) &&
            (!claim->has_reference ||
             is_same(&scene->curves[other->reference], &scene->curves[claim->reference])))
            return true;
    }
    return false;
}

static bool is_listed(const sphv_scene *scene, size_t index)
{
    return is_claim_of_rules(scene, &scene->claims[index]) && !is_repeated(scene, index);
}

/// Adds the curve with each rule that the scene lacks.
static void add_lacking(struct both *both, const sphv_curve *like)
{
    for (int rule = 0; rule < SPHV_RULES; rule++) {
        if (find_curve(&both->scene, like, rule) < both->scene.curve_count) continue;
        sphv_curve *added = &both->scene.curves[both->scene.curve_count++];
        *added = *like;
        added->experiment.volume = sphv_rule_volume[rule];
    }
}

static void free_both(struct both *both)
{
    free(both->scene.curves);
    free(both->result.sample_count);
    free(both->result.samples);
    sphv_scene_result_free(both->ran);
}

static sphv_status run_both(const sphv_scene_result *result, struct both *both, sphv_error *error)
{
    const sphv_scene *scene = result->scene;
    size_t own = scene->curve_count, room = own + 4 * scene->claim_count + 1;
    *both = (struct both){.scene = *scene, .result = *result};
    both->scene.curves = calloc(room, sizeof *both->scene.curves);
    both->result.sample_count = calloc(room, sizeof *both->result.sample_count);
    both->result.samples = calloc(room, sizeof *both->result.samples);
    if (!both->scene.curves || !both->result.sample_count || !both->result.samples)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    memcpy(both->scene.curves, scene->curves, own * sizeof *scene->curves);
    for (size_t i = 0; i < scene->claim_count; i++) {
        if (!is_listed(scene, i)) continue;
        add_lacking(both, &scene->curves[scene->claims[i].curve]);
        if (scene->claims[i].has_reference)
            add_lacking(both, &scene->curves[scene->claims[i].reference]);
    }
    both->lacking = both->scene;
    both->lacking.curves += own;
    both->lacking.curve_count -= own;
    both->lacking.claim_count = 0;
    if (both->lacking.curve_count) {
        sphv_status status = sphv_scene_run(&both->lacking, NULL, NULL, &both->ran, error);
        if (status != SPHV_OK) return status;
    }
    for (size_t c = 0; c < both->scene.curve_count; c++) {
        const sphv_scene_result *from = c < own ? result : both->ran;
        size_t at = c < own ? c : c - own;
        both->result.sample_count[c] = from->sample_count[at];
        both->result.samples[c] = from->samples[at];
    }
    both->result.scene = &both->scene;
    return SPHV_OK;
}

static void judge(const struct both *both, sphv_rule_row *row)
{
    for (int rule = 0; rule < SPHV_RULES; rule++) {
        const sphv_scene *scene = &both->scene;
        sphv_claim claim = *row->claim;
        claim.curve = find_curve(scene, &scene->curves[claim.curve], rule);
        if (claim.has_reference)
            claim.reference = find_curve(scene, &scene->curves[claim.reference], rule);
        row->found[rule] = sphv_claim_judge(&both->result, &claim);
    }
}

static sphv_status compare_scene(const sphv_scene_result *result, sphv_rule_comparison *out,
                                 sphv_error *error)
{
    const sphv_scene *scene = result->scene;
    size_t listed = 0;
    for (size_t i = 0; i < scene->claim_count; i++) listed += is_listed(scene, i);
    if (!listed) return SPHV_OK;
    sphv_rule_row *rows = realloc(out->rows, (out->count + listed) * sizeof *rows);
    if (!rows) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    out->rows = rows;
    struct both both;
    sphv_status status = run_both(result, &both, error);
    for (size_t i = 0; status == SPHV_OK && i < scene->claim_count; i++) {
        if (!is_listed(scene, i)) continue;
        sphv_rule_row *row = &out->rows[out->count++];
        *row = (sphv_rule_row){.scene = scene, .claim = &scene->claims[i]};
        judge(&both, row);
    }
    free_both(&both);
    return status;
}

static void conclude(sphv_rule_comparison *out)
{
    for (size_t i = 0; i < out->count; i++) {
        const sphv_claim_result *found = out->rows[i].found;
        for (int rule = 0; rule < SPHV_RULES; rule++)
            out->holding[rule] += found[rule].verdict == SPHV_AGREES;
        out->telling += found[SPHV_RULE_TESSELLATED].verdict != found[SPHV_RULE_LATTICE].verdict;
    }
    const size_t *holding = out->holding;
    out->reproducing =
        holding[SPHV_RULE_TESSELLATED] > holding[SPHV_RULE_LATTICE]   ? SPHV_RULE_TESSELLATED
        : holding[SPHV_RULE_TESSELLATED] < holding[SPHV_RULE_LATTICE] ? SPHV_RULE_LATTICE
                                                                      : -1;
    int used = snprintf(out->conclusion, sizeof out->conclusion,
                        "Of %zu claims on perturbed particles %zu hold with %s and %zu with %s; on "
                        "%zu the rules differ. ",
                        out->count, holding[0], sphv_rule_name[0], holding[1], sphv_rule_name[1],
                        out->telling);
    char *rest = out->conclusion + used;
    size_t room = sizeof out->conclusion - (size_t)used;
    if (out->reproducing < 0)
        snprintf(rest, room, "The claims do not tell which rule the paper used.");
    else
        snprintf(rest, room, "The paper is reproduced by %s%s.", sphv_rule_name[out->reproducing],
                 holding[out->reproducing] == out->count ? "" : ", but for the claims that fail");
}

sphv_status sphv_volume_rules_compute(const sphv_report *report, sphv_rule_comparison *out,
                                      sphv_error *error)
{
    *out = (sphv_rule_comparison){.reproducing = -1};
    sphv_status status = SPHV_OK;
    for (size_t i = 0; status == SPHV_OK && i < report->scene_count; i++)
        if (report->scenes[i]->scene->statistical)
            status = compare_scene(report->scenes[i], out, error);
    if (status == SPHV_OK) conclude(out);
    return status;
}

void sphv_volume_rules_free(sphv_rule_comparison *comparison)
{
    free(comparison->rows);
    comparison->rows = NULL;
    comparison->count = 0;
}
