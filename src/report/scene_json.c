#include "scene_json.h"

#include <math.h>

static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *claim_json(const sphv_scene *scene, const sphv_claim *claim,
                          const sphv_claim_result *found)
{
    json_t *object = json_pack(
        "{s:s, s:s, s:s, s:s, s:s?, s:b, s:o, s:o, s:o, s:o, s:s, s:o, s:o, s:s, s:s?, s:b}", "id",
        claim->id, "statement", claim->statement, "measure", claim->measure->name, "curve",
        scene->curves[claim->curve].id, "reference",
        claim->has_reference ? scene->curves[claim->reference].id : NULL, "special_only",
        claim->special_only, "from", number(claim->from), "to", number(claim->to), "expected",
        number(claim->expected), "tolerance", number(claim->tolerance), "reason", claim->reason,
        "analytic", number(found->analytic), "empirical", number(found->empirical), "verdict",
        sphv_verdict_name(found->verdict), "refuted", claim->refuted, "surprising",
        found->surprising);
    return object;
}

static json_t *tally(size_t agreeing, size_t disagreeing, size_t inconclusive)
{
    return json_pack("{s:I, s:I, s:I}", "agrees", (json_int_t)agreeing, "disagrees",
                     (json_int_t)disagreeing, "inconclusive", (json_int_t)inconclusive);
}

json_t *sphv_scene_json(const sphv_scene_result *result)
{
    const sphv_scene *scene = result->scene;
    json_t *claims = json_array();
    for (size_t i = 0; i < scene->claim_count; i++)
        json_array_append_new(claims, claim_json(scene, &scene->claims[i], &result->claims[i]));
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:o}", "scene", scene->name, "title",
        scene->title, "source", scene->source, "notes", scene->notes, "verdict",
        sphv_verdict_name(result->verdict), "points",
        tally(result->agreeing, result->disagreeing, result->inconclusive), "paper_points",
        tally(result->paper_agreeing, result->paper_disagreeing, result->paper_inconclusive),
        "claims", claims, "seconds", number(result->seconds));
}
