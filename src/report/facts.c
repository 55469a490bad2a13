#include "facts.h"

#include <float.h>
#include <math.h>

#include "core/constant_text.h"

sphv_verdict sphv_tally_verdict(const size_t counts[3])
{
    return counts[SPHV_DISAGREES]      ? SPHV_DISAGREES
           : counts[SPHV_INCONCLUSIVE] ? SPHV_INCONCLUSIVE
                                       : SPHV_AGREES;
}

/// A claimed constant must be the recomputed one to the rounding of both; a constant rounded to a
/// few digits is not, and puts a floor under every convergence plot.
static void judge_constant(sphv_dimension_facts *facts)
{
    long double claimed;
    sphv_error error;
    facts->claimed = NAN;
    facts->claim_verdict = SPHV_DISAGREES;
    if (sphv_constant_parse(facts->claim, &claimed, &error) != SPHV_OK) return;
    facts->claimed = (double)claimed;
    sphv_result found = facts->profile->constant;
    double allowed = found.bound + DBL_EPSILON * fabs(found.value);
    if (fabs(facts->claimed - found.value) <= allowed) facts->claim_verdict = SPHV_AGREES;
}

static void collect_dimension(const sphv_kernel *kernel, int d, sphv_dimension_facts *facts)
{
    facts->profile = sphv_kernel_profile(kernel, d);
    if (!facts->profile) return;
    sphv_kernel_constant_text(kernel, d, facts->constant, sizeof facts->constant);
    for (int i = 0; i < SPHV_FACT_MOMENTS; i++)
        sphv_kernel_moment_text(kernel, d, 2 * i, facts->moment[i], sizeof facts->moment[i]);
    facts->fourier = sphv_fourier_find_sign(facts->profile);
    facts->claim = sphv_kernel_get_claims(kernel)->constant[d - 1];
    if (facts->claim) judge_constant(facts);
}

static void count_claim(sphv_kernel_facts *facts, sphv_verdict verdict)
{
    facts->claims++;
    facts->claims_refuted += verdict != SPHV_AGREES;
    facts->verdict = sphv_verdict_worse(facts->verdict, verdict);
}

static void collect_orders(sphv_kernel_facts *facts)
{
    const sphv_profile *profile = facts->dimension[0].profile;
    if (!profile) return;
    facts->special_order = sphv_predicted_order(profile, true, &facts->special_knot);
    facts->general_order = sphv_predicted_order(profile, false, &facts->general_knot);
    int c = (profile->boundary_smoothness + 1);
    facts->edge_order = c < 2 ? 2 : c + c % 2;
}

/// Checks that require nothing count only when they fail all the same.
static void count_checks(sphv_kernel_facts *facts)
{
    for (size_t i = 0; facts->check && i < facts->check->count; i++) {
        const sphv_check_result *result = &facts->check->results[i];
        if (result->informative && result->verdict == SPHV_AGREES) continue;
        facts->checks++;
        facts->checks_passed += result->verdict == SPHV_AGREES;
    }
    if (facts->check) facts->verdict = sphv_verdict_worse(facts->verdict, facts->check->verdict);
}

void sphv_kernel_facts_collect(const sphv_kernel *kernel, const sphv_agreement *agreement,
                               const sphv_check_report *check, sphv_kernel_facts *facts)
{
    *facts = (sphv_kernel_facts){
        .kernel = kernel, .agreement = agreement, .check = check, .verdict = SPHV_AGREES};
    if (agreement) facts->verdict = sphv_tally_verdict(agreement->exact);
    for (int d = SPHV_DIMENSIONS; d >= 1; d--) {
        sphv_dimension_facts *of = &facts->dimension[d - 1];
        collect_dimension(kernel, d, of);
        if (of->profile) facts->profile = of->profile;
        if (of->profile && of->claim) count_claim(facts, of->claim_verdict);
    }
    collect_orders(facts);
    count_checks(facts);
    facts->claimed_smoothness = sphv_kernel_get_claims(kernel)->boundary_smoothness;
    if (facts->claimed_smoothness && facts->profile) {
        facts->smoothness_verdict =
            *facts->claimed_smoothness == facts->profile->boundary_smoothness ? SPHV_AGREES
                                                                              : SPHV_DISAGREES;
        count_claim(facts, facts->smoothness_verdict);
    }
}

const char *sphv_kernel_paper_failure(const sphv_kernel_facts *facts)
{
    if (!facts->agreement || !facts->agreement->paper[SPHV_DISAGREES]) return NULL;
    if (facts->special_order < facts->edge_order)
        return "The paper’s form counts only the edge of the support. The other knots lower the "
               "order in Δx/h, and leaving them out is why it fails here.";
    if (facts->dimension[0].profile->knot_count > 1)
        return "The paper’s form counts only the edge of the support. The other knots (the origin "
               "among them, where Ŵ is not smooth there) contribute too, and leaving them out is "
               "why it fails here.";
    return "The kernel has no knot but its edge, so it is the cut: the paper’s form keeps two "
           "terms "
           "of each series, and at these spacings what follows is larger than the first terms left "
           "out suggest.";
}
