/// \file volume_rules.h
/// Which volume rule reproduces the paper: the claims on perturbed particles, measured with both.
#ifndef SPHVERIFY_REPORT_VOLUME_RULES_H
#define SPHVERIFY_REPORT_VOLUME_RULES_H

#include "sphverify/report.h"

/// The rules compared.
enum { SPHV_RULE_TESSELLATED, SPHV_RULE_LATTICE, SPHV_RULES };

/// sphv_volumes row of each rule, and what the report calls it.
extern const sphv_volume sphv_rule_volume[SPHV_RULES];
extern const char *const sphv_rule_name[SPHV_RULES];

/// One claim with both rules. The tolerance is that of the scene file.
typedef struct sphv_rule_row {
    const sphv_scene *scene;
    const sphv_claim *claim;
    sphv_claim_result found[SPHV_RULES];
} sphv_rule_row;

typedef struct sphv_rule_comparison {
    size_t count;
    sphv_rule_row *rows;
    size_t holding[SPHV_RULES]; ///< claims whose verdict is `agrees`
    size_t telling;             ///< claims whose verdicts differ between the rules
    int reproducing;            ///< the rule with which more claims hold; −1 when neither
    char conclusion[320];       ///< the same as a sentence
} sphv_rule_comparison;

/// Measures each claim of the scenes on perturbed particles, with tessellated volumes or volumes
/// Δx, with the rule that its curve lacks too: the same curve with the other rule, from the scene
/// where it is there, else run here. A claim that a scene states for both rules is listed once; one
/// that compares the rules, not at all.
sphv_status sphv_volume_rules_compute(const sphv_report *report, sphv_rule_comparison *out,
                                      sphv_error *error) SPHV_MUST_CHECK;
void sphv_volume_rules_free(sphv_rule_comparison *comparison);

#endif
