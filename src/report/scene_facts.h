/// \file scene_facts.h
/// What the report says of a scene's curves and of methods that fail, for all of its formats.
#ifndef SPHVERIFY_REPORT_SCENE_FACTS_H
#define SPHVERIFY_REPORT_SCENE_FACTS_H

#include "sphverify/convergence.h"
#include "sphverify/report.h"

/// Estimates made and those without a usable result, by reason.
typedef struct sphv_fault_counts {
    long estimates, isolated, too_few, singular, ill_conditioned, not_finite;
    double worst_condition; ///< NaN where no condition number was met
    double worst_h, worst_spacing;
    const char *worst_scene; ///< name of the scene where it was met; NULL
} sphv_fault_counts;

/// The parts of an experiment that a curve keeps, as words; "" or NaN where they do not apply.
typedef struct sphv_curve_facts {
    const char *method, *layout, *volume; ///< "" over q
    double sigma;                         ///< NaN on layouts without a perturbation
    bool random;                          ///< the seed matters
    size_t exact[3], paper[3];            ///< points per sphv_verdict
    double difference, bound;             ///< largest difference, and its bound
    double relative;                      ///< largest |prediction/measurement − 1|; NaN over q
    bool statistical;                     ///< a point is a Monte-Carlo mean
    int realisations_least, realisations_most;
    sphv_fault_counts faults;
} sphv_curve_facts;

/// \param curve index
sphv_curve_facts sphv_curve_facts_collect(const sphv_scene_result *result, size_t curve);

/// Whether the paper's form has a value at a point of the scene.
bool sphv_scene_has_paper(const sphv_scene_result *result);

/// Sum of all reasons.
long sphv_faults_sum(const sphv_fault_counts *faults);

/// What failed in a scheme of a convergence scene, over all its levels.
sphv_fault_counts sphv_scheme_faults(const sphv_convergence_result *result, size_t scheme);

/// Estimates and failures of one method over all scenes.
typedef struct sphv_method_facts {
    const char *name;
    size_t curves; ///< and schemes of convergence scenes
    sphv_fault_counts faults;
} sphv_method_facts;

/// \param count receives the number of methods
/// \return one entry per row of sphv_methods that a scene uses, for the caller to free; NULL
///         without memory
sphv_method_facts *sphv_method_facts_collect(const sphv_report *report, size_t *count);

enum { SPHV_REALISATIONS_TEXT = 32 };

/// `16`, `16–24`, or `–` on a curve without chance.
/// \return text, which receives it
const char *sphv_realisations_text(char text[SPHV_REALISATIONS_TEXT],
                                   const sphv_curve_facts *facts);

/// `singular 3, ill-conditioned 2` or `none`.
void sphv_faults_text(char *text, size_t size, const sphv_fault_counts *faults);

#endif
