/// \file scene.h
/// Scenes: a figure of a paper as data — its curves, its range, its claims — and what running it
/// found.
#ifndef SPHVERIFY_SCENE_H
#define SPHVERIFY_SCENE_H

#include "sphverify/compare.h"

/// What a scene's horizontal axis is.
typedef enum sphv_abscissa {
    SPHV_OVER_Q,       ///< the kernel itself over q = r/h
    SPHV_OVER_H,       ///< error over h/λ, each curve at its own Δx/h
    SPHV_OVER_SPACING, ///< error over Δx/h, each curve at its own h/λ
} sphv_abscissa;

typedef struct sphv_curve {
    char *id;    ///< short name that claims refer to
    char *label; ///< text of the legend
    sphv_kernel *kernel;
    const sphv_profile *profile; ///< of `kernel`, in one dimension
    double h;                    ///< where h is not the abscissa
    sphv_number spacing;         ///< where the spacing is not the abscissa
    char *spacing_text;          ///< as written in the scene
    double spacing_exponent; ///< over h: Δx/h = spacing·(h/h_to)^exponent, 0 for a constant one
    sphv_experiment experiment; ///< method, layout, volume rule, σ and realisations
} sphv_curve;

/// A sentence of the paper (or of this project's theory) with what to measure.
typedef struct sphv_claim {
    char *id, *statement;
    const struct sphv_claim_measure *measure; ///< a row of `sphv_claim_measures`
    size_t curve;                             ///< index of the curve measured
    bool has_reference;
    size_t reference;  ///< index of the curve it is compared with, for the measures that need one
    bool special_only; ///< use only the points with Δx/h = 2κ/(2n+1)
    double from, to;   ///< part of the abscissa to use
    double expected, tolerance;
    char *reason;  ///< where the tolerance comes from
    char *refuted; ///< why the claim is known not to hold; NULL for claims that should
} sphv_claim;

/// A scene file, loaded.
typedef struct sphv_scene {
    char *path, *name, *title, *source;
    char *notes; ///< choices made where the paper gives no number; "" when there are none
    sphv_abscissa abscissa;
    double from, to;
    bool logarithmic; ///< abscissa spaced and drawn logarithmically
    size_t points;    ///< empirical points per curve
    bool statistical; ///< a curve needs chance or another method: every value is an L2 norm
    size_t markers;   ///< analytic points drawn per curve where the abscissa is h or q
    size_t curve_count, claim_count;
    sphv_curve *curves;
    sphv_claim *claims;
} sphv_scene;

/// Loads a scene file and the kernels it names.
/// \param data_directory where kernel names are looked up
sphv_status sphv_scene_load(const char *data_directory, const char *path, sphv_scene **out,
                            sphv_error *error) SPHV_MUST_CHECK;
void sphv_scene_free(sphv_scene *scene);

/// One point of a curve. Where the abscissa is q, `point.analytic.total` is Ŵ(q) in exact
/// arithmetic (or by the closed form) and `point.empirical.total` its floating-point evaluation.
typedef struct sphv_sample {
    double x; ///< abscissa
    double h;
    sphv_number spacing;
    long n;                ///< Δx/h = 2κ/(2n+1), or −1 at other spacings and over q
    bool marked;           ///< to be drawn as an analytic point
    sphv_point point;      ///< exact form beside measurement
    sphv_prediction paper; ///< the paper's form; meaningful where n >= 0
    sphv_verdict paper_verdict;
} sphv_sample;

typedef struct sphv_claim_result {
    double analytic;  ///< what theory predicts for the measure; NaN where it predicts nothing
    double empirical; ///< what was measured
    sphv_verdict verdict;
    bool surprising; ///< the verdict is not what the scene file expects of the claim
} sphv_claim_result;

/// What running a scene found.
typedef struct sphv_scene_result {
    const sphv_scene *scene;
    size_t *sample_count;  ///< per curve
    sphv_sample **samples; ///< per curve, ascending in x; with the special spacings among them
    sphv_claim_result *claims;
    size_t agreeing, disagreeing, inconclusive; ///< points, exact form against measurement
    size_t paper_agreeing, paper_disagreeing, paper_inconclusive;
    /// Disagrees when any point does or a claim surprises; inconclusive when that is all that can
    /// be said of more than half of the points, or of a claim.
    sphv_verdict verdict;
    double seconds;
} sphv_scene_result;

/// Runs both halves over all points of a scene, on all processors, and judges its claims.
sphv_status sphv_scene_run(const sphv_scene *scene, sphv_progress progress, void *context,
                           sphv_scene_result **out, sphv_error *error) SPHV_MUST_CHECK;
void sphv_scene_result_free(sphv_scene_result *result);

/// A way of measuring a claim: one row of one table.
typedef struct sphv_claim_measure {
    const char *name;
    const char *meaning;
    bool needs_reference;
    bool plain_only; ///< of signed errors or the paper's form: has no meaning for L2 norms
    /// Measures one half.
    /// \param empirical false: the prediction; true: the measurement
    double (*measure)(const sphv_scene_result *result, const sphv_claim *claim, bool empirical);
} sphv_claim_measure;

/// The table, ended by a row without a name.
extern const sphv_claim_measure sphv_claim_measures[];

/// Measures a claim on both halves and compares both with what it expects. The claim need not be
/// one of the scene's own; its curves are indices into the scene's.
sphv_claim_result sphv_claim_judge(const sphv_scene_result *result, const sphv_claim *claim);

/// Agreement of both forms with measurement over (h/λ, n) for one kernel.
typedef struct sphv_agreement_cell {
    double h;
    int n;
    sphv_point exact;
    sphv_prediction paper;
    sphv_verdict paper_verdict;
} sphv_agreement_cell;

typedef struct sphv_agreement {
    const sphv_kernel *kernel;
    size_t h_count, n_count; ///< cells are ordered by n within h
    sphv_agreement_cell *cells;
    size_t exact[3], paper[3]; ///< cells per sphv_verdict
} sphv_agreement;

/// Evaluates the table for n = 2 … 40 and h/λ from 0.0018 to 0.5.
sphv_status sphv_agreement_run(const sphv_kernel *kernel, sphv_agreement **out,
                               sphv_error *error) SPHV_MUST_CHECK;
void sphv_agreement_free(sphv_agreement *agreement);

#endif
