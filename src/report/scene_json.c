#include "scene_json.h"

#include <math.h>

#include "json_parts.h"

static json_t *claim_json(const sphv_scene *scene, const sphv_claim *claim,
                          const sphv_claim_result *found)
{
    json_t *object = json_pack(
        "{s:s, s:s, s:s, s:s, s:s?, s:b, s:o, s:o, s:o, s:o, s:s, s:o, s:o, s:s, s:s?, s:b}", "id",
        claim->id, "statement", claim->statement, "measure", claim->measure->name, "curve",
        scene->curves[claim->curve].id, "reference",
        claim->has_reference ? scene->curves[claim->reference].id : NULL, "special_only",
        claim->special_only, "from", sphv_json_number(claim->from), "to",
        sphv_json_number(claim->to), "expected", sphv_json_number(claim->expected), "tolerance",
        sphv_json_number(claim->tolerance), "reason", claim->reason, "analytic",
        sphv_json_number(found->analytic), "empirical", sphv_json_number(found->empirical),
        "verdict", sphv_verdict_name(found->verdict), "refuted", claim->refuted, "surprising",
        found->surprising);
    return object;
}

static json_t *tally(size_t agreeing, size_t disagreeing, size_t inconclusive)
{
    return json_pack("{s:I, s:I, s:I}", "agrees", (json_int_t)agreeing, "disagrees",
                     (json_int_t)disagreeing, "inconclusive", (json_int_t)inconclusive);
}

static json_t *count_json(bool there, long count)
{
    return there ? json_integer((json_int_t)count) : json_null();
}

json_t *sphv_faults_json(bool there, const sphv_fault_counts *faults)
{
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "estimates", count_json(there, faults->estimates),
        "isolated", count_json(there, faults->isolated), "too_few",
        count_json(there, faults->too_few), "singular", count_json(there, faults->singular),
        "ill_conditioned", count_json(there, faults->ill_conditioned), "not_finite",
        count_json(there, faults->not_finite), "worst_condition",
        sphv_json_number(there ? faults->worst_condition : NAN));
}

/// A curve with its experiment, and its points in short.
static json_t *curve_json(const sphv_scene_result *result, size_t c)
{
    const sphv_curve *curve = &result->scene->curves[c];
    sphv_curve_facts facts = sphv_curve_facts_collect(result, c);
    json_t *object = json_pack(
        "{s:o, s:o, s:s, s:o, s:o, s:o, s:o, s:o}", "id", sphv_json_text(curve->id), "label",
        sphv_json_text(curve->label), "kernel", sphv_kernel_name(curve->kernel), "method",
        sphv_json_text_or_null(facts.method), "layout", sphv_json_text_or_null(facts.layout),
        "volume", sphv_json_text_or_null(facts.volume), "sigma", sphv_json_number(facts.sigma),
        "seed", facts.random ? json_integer((json_int_t)curve->experiment.seed) : json_null());
    json_object_set_new(object, "realisations",
                        facts.statistical
                            ? json_pack("[i, i]", facts.realisations_least, facts.realisations_most)
                            : json_null());
    json_object_set_new(object, "points",
                        tally(facts.exact[SPHV_AGREES], facts.exact[SPHV_DISAGREES],
                              facts.exact[SPHV_INCONCLUSIVE]));
    json_object_set_new(object, "largest_relative_difference", sphv_json_number(facts.relative));
    json_object_set_new(object, "faults", sphv_faults_json(facts.statistical, &facts.faults));
    return object;
}

json_t *sphv_scene_json(const sphv_scene_result *result)
{
    const sphv_scene *scene = result->scene;
    json_t *claims = json_array();
    for (size_t i = 0; i < scene->claim_count; i++)
        json_array_append_new(claims, claim_json(scene, &scene->claims[i], &result->claims[i]));
    json_t *curves = json_array();
    for (size_t c = 0; c < scene->curve_count; c++)
        json_array_append_new(curves, curve_json(result, c));
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:s, s:b, s:o, s:o, s:o, s:o, s:o}", "scene", scene->name, "title",
        scene->title, "source", scene->source, "notes", scene->notes, "verdict",
        sphv_verdict_name(result->verdict), "statistical", scene->statistical, "points",
        tally(result->agreeing, result->disagreeing, result->inconclusive), "paper_points",
        tally(result->paper_agreeing, result->paper_disagreeing, result->paper_inconclusive),
        "claims", claims, "curves", curves, "seconds", sphv_json_number(result->seconds));
}
