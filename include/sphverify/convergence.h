/// \file convergence.h
/// Convergence scenes: a table of rates as data — particles, schemes, fields, the printed numbers
/// and what is known of them — and what running it found.
///
/// A scene has levels (numbers of particles, or ratios h/Δx at one number), schemes (a method with
/// kernel, rule for h and box) and targets (a quantity of a field, say ∂f2/∂x). Every norm of every
/// target by every scheme at every level is measured, the root mean square predicted, and rates are
/// least-squares slopes of their logarithms.
#ifndef SPHVERIFY_CONVERGENCE_H
#define SPHVERIFY_CONVERGENCE_H

#include "sphverify/boundary.h"
#include "sphverify/estimate.h"
#include "sphverify/scene.h"

/// What a level is measured by. The first five need a method.
typedef enum sphv_metric {
    SPHV_METRIC_RMSE,
    SPHV_METRIC_MAE,
    SPHV_METRIC_MAXIMUM,
    SPHV_METRIC_MEAN_SQUARE,
    SPHV_METRIC_STANDARD_DEVIATION,
    SPHV_METRIC_FAILED,     ///< part of the particles whose estimate carries a fault
    SPHV_METRIC_NEIGHBOURS, ///< n_nb, see sphv_stage
    SPHV_METRIC_H,
    SPHV_METRICS
} sphv_metric;

/// What it is held against.
typedef enum sphv_axis {
    SPHV_AXIS_PARTICLES,
    SPHV_AXIS_NEIGHBOURS,
    SPHV_AXIS_H,
    SPHV_AXIS_RATIO, ///< h/Δx
    SPHV_AXES
} sphv_axis;

extern const sphv_name_row sphv_metrics[]; ///< indexed by sphv_metric, ended by a NULL name
extern const sphv_name_row sphv_axes[];    ///< indexed by sphv_axis

/// What h follows.
typedef enum sphv_h_rule {
    SPHV_H_OF_SPACING,   ///< h = factor Δx
    SPHV_H_OF_PARTICLES, ///< h = factor N^exponent
    SPHV_H_OF_RATIO,     ///< h = factor (h/Δx of the level) Δx
} sphv_h_rule;

/// One column: how estimates are made.
typedef struct sphv_scheme {
    char *id, *label;
    size_t box; ///< index
    sphv_kernel *kernel;
    const sphv_profile *profile; ///< in the scene's dimension
    bool has_method;             ///< false where only neighbours are counted
    sphv_method method;
    sphv_h_rule rule;
    double factor, exponent;
    char *factor_text; ///< as written
    size_t pass;       ///< the first scheme with the same box, kernel and h: one pass serves both
} sphv_scheme;

/// A quantity of a field, or the same with a wrong exact value, or with none, so that its norms are
/// those of the estimate itself (evidence of how a number came about).
typedef struct sphv_target {
    char *name; ///< f1, f1_x, f1_xy
    size_t field, quantity;
    bool altered, alone; ///< alone: altered to no exact value
    sphv_field without;  ///< what the wrong exact value leaves out
} sphv_target;

/// A box with its name; `side` is that of each level.
typedef struct sphv_named_box {
    char *id;
    sphv_box box;
} sphv_named_box;

typedef struct sphv_level {
    size_t side;
    double ratio; ///< h/Δx where the scene runs over it, else 0
} sphv_level;

/// Which numbers of which levels are taken together.
typedef struct sphv_series {
    size_t scheme, target;
    sphv_metric metric;
    sphv_axis axis;
    bool per_neighbour;  ///< divided by n_nb
    bool interior;       ///< only particles at least κh from every side
    size_t first, count; ///< levels
} sphv_series;

/// What becomes of a printed rate.
typedef enum sphv_cell_verdict {
    SPHV_CELL_REPRODUCED,    ///< the slope of the RMSE against N is the printed number
    SPHV_CELL_PER_NEIGHBOUR, ///< not that, but the slope of RMSE/n_nb is
    SPHV_CELL_NOT_REPRODUCED,
    SPHV_CELL_VERDICTS
} sphv_cell_verdict;

const char *sphv_cell_verdict_name(sphv_cell_verdict verdict);

/// How a number that is not reproduced may have come about: another setting, run.
typedef struct sphv_evidence {
    char *statement;
    sphv_series series;
    bool matches; ///< whether the scene expects its slope to be the printed one
} sphv_evidence;

/// A printed rate.
typedef struct sphv_cell {
    bool there;
    char *text; ///< as printed
    double printed;
    double limit; ///< asymptotic rate by theory, as the scene says; NaN where it says nothing
    sphv_cell_verdict expected;
    char *why; ///< why it is known not to be reproduced; NULL where it should be
    size_t evidence_count;
    sphv_evidence *evidence;
} sphv_cell;

/// Columns that share their tolerances.
typedef struct sphv_column_group {
    char *label, *reason;
    sphv_cell_verdict expected;
    double tolerance; ///< of each cell
    double rms;       ///< of the reproduced cells together; infinite where none is asked
} sphv_column_group;

/// A printed table: rows are targets, columns schemes.
typedef struct sphv_rate_table {
    size_t row_count, column_count, group_count;
    size_t *rows;    ///< targets
    size_t *columns; ///< schemes
    size_t *group;   ///< per column
    sphv_column_group *groups;
    sphv_cell *cells; ///< [row * column_count + column]
} sphv_rate_table;

/// A printed list of what each level is: n_nb and h of one scheme.
typedef struct sphv_level_list {
    size_t scheme;
    char **neighbours, **h; ///< per level, as printed
} sphv_level_list;

typedef enum sphv_rate_measure {
    SPHV_RATE_SLOPE,  ///< of the logarithms
    SPHV_RATE_FACTOR, ///< of the fitted power law: its value at 1
    SPHV_RATE_VALUE,  ///< at the series' first level
    SPHV_RATE_MEASURES
} sphv_rate_measure;

extern const sphv_name_row sphv_rate_measures[]; ///< indexed by sphv_rate_measure

/// A sentence with a number.
typedef struct sphv_rate_claim {
    char *id, *statement, *reason;
    char *refuted; ///< why it is known not to hold; NULL for claims that should
    sphv_series series;
    sphv_rate_measure measure;
    double expected, tolerance;
} sphv_rate_claim;

enum { SPHV_TRENDS_MAX = 4 };

/// A figure: one quantity by several schemes, or the particles of one level.
typedef struct sphv_rate_plot {
    char *id, *title;
    bool picture; ///< of the particles of `series.first` in the box of `series.scheme`
    sphv_series series;
    size_t scheme_count;
    size_t *schemes;
    size_t trend_count;
    double trends[SPHV_TRENDS_MAX]; ///< exponents of power laws drawn beside it
} sphv_rate_plot;

/// A target whose error is one of the consistency measures of an interior particle, by standard SPH
/// in either form: of the field 1 the value (normalisation) and the gradient (flatness), of the
/// field x the gradient's components (rotation, shear).
typedef struct sphv_measured_consistency {
    size_t target;
    sphv_consistency_measure measure;
} sphv_measured_consistency;

/// A scene file of kind `convergence`, loaded.
typedef struct sphv_convergence {
    char *path, *name, *title, *source, *notes;
    int dimension;
    bool over_ratio; ///< levels differ in h/Δx, not in N
    size_t box_count, level_count, field_count, scheme_count, target_count, claim_count, plot_count;
    size_t measure_count;
    sphv_measured_consistency *measures;
    sphv_named_box *boxes;
    sphv_level *levels;
    char **field_ids;
    sphv_field *fields;
    sphv_scheme *schemes;
    sphv_target *targets;
    sphv_rate_table *table;  ///< NULL: none
    sphv_level_list *listed; ///< NULL: none
    sphv_rate_claim *claims;
    sphv_rate_plot *plots;
} sphv_convergence;

/// A scene file of either kind; the other is NULL.
typedef struct sphv_any_scene {
    sphv_scene *scene;
    sphv_convergence *convergence;
} sphv_any_scene;

/// Loads a scene file of any kind, told apart by its key `kind`.
/// \param data_directory where kernel names are looked up
sphv_status sphv_any_scene_load(const char *data_directory, const char *path, sphv_any_scene *out,
                                sphv_error *error) SPHV_MUST_CHECK;
void sphv_any_scene_free(sphv_any_scene *scene);
void sphv_convergence_free(sphv_convergence *scene);

/// Smoothing length of a scheme at a level.
double sphv_scheme_h(const sphv_convergence *scene, const sphv_scheme *scheme, size_t level);

/// The box of a scheme at a level.
sphv_box sphv_scheme_box(const sphv_convergence *scene, const sphv_scheme *scheme, size_t level);

/// A target by a scheme at a level.
typedef struct sphv_rate_point {
    bool there;                 ///< the method gives this quantity
    sphv_norms whole, interior; ///< over all particles, and over those at least κh from every side
    bool predicted[2];          ///< whole, interior: theory has a number
    sphv_result prediction[2];  ///< of the RMSE
    sphv_rigour rigour;
    sphv_verdict verdict[2]; ///< of prediction and measurement, where predicted
} sphv_rate_point;

/// A scheme at a level.
typedef struct sphv_stage {
    size_t particles;
    double spacing, h;
    /// n_nb: particles nearer than κh to the middle of the box (Sigalotti's Table 1 counts so)
    size_t neighbours;
    size_t faults[SPHV_FAULTS]; ///< particles by fault
    double worst_condition;     ///< largest finite condition number; NaN where none was met
    sphv_rate_point *points;    ///< per target
} sphv_stage;

/// The power law y = factor · x^slope through a series.
typedef struct sphv_power_law {
    double slope, factor, error; ///< error: standard error of the slope; NaN where there is no law
    size_t points;
} sphv_power_law;

typedef struct sphv_cell_result {
    double slope;                   ///< of the RMSE against N
    double slope_h;                 ///< of the RMSE against h
    double per_neighbour;           ///< of RMSE/n_nb against N
    double interior;                ///< of the RMSE over the interior against N
    double theory, theory_interior; ///< of the predicted RMSE; NaN where there is no theory
    sphv_cell_verdict verdict;
    bool surprising;
    double *evidence;        ///< slopes
    bool evidence_surprises; ///< one of them is not what the scene expects
} sphv_cell_result;

typedef struct sphv_group_result {
    size_t cells, reproduced; ///< printed, and of these reproduced in either sense
    double rms;               ///< deviation of the reproduced cells; NaN where there are none
    bool surprising;          ///< larger than the group allows
} sphv_group_result;

/// What running a convergence scene found.
typedef struct sphv_convergence_result {
    const sphv_convergence *scene;
    sphv_stage *stages;        ///< [level * scheme_count + scheme]
    sphv_cell_result *cells;   ///< of the table; NULL without one
    sphv_group_result *groups; ///< of the table
    sphv_claim_result *claims;
    size_t verdicts[3];                 ///< predictions against measurements, per sphv_verdict
    size_t listed_neighbours, listed_h; ///< levels of the printed list that are met
    /// Disagrees when a prediction does, or a cell, group, piece of evidence, claim or printed
    /// level is not what the scene expects.
    sphv_verdict verdict;
    double pairs, seconds;
} sphv_convergence_result;

/// Runs both halves over all levels and judges the table and the claims. All schemes of a level
/// that share box, kernel and h share one pass; the particles of a level are released before the
/// next.
sphv_status sphv_convergence_run(const sphv_convergence *scene, sphv_progress progress,
                                 void *context, sphv_convergence_result **out,
                                 sphv_error *error) SPHV_MUST_CHECK;
void sphv_convergence_result_free(sphv_convergence_result *result);

const sphv_stage *sphv_convergence_stage(const sphv_convergence_result *result, size_t level,
                                         size_t scheme);
const sphv_rate_point *sphv_convergence_point(const sphv_convergence_result *result, size_t level,
                                              size_t scheme, size_t target);

/// Where a level stands on an axis.
double sphv_stage_place(const sphv_stage *stage, sphv_axis axis);

/// The number of a series at a level; NaN where there is none.
/// \param theory the predicted one; only of the RMSE
double sphv_series_value(const sphv_convergence_result *result, const sphv_series *series,
                         size_t level, bool theory);

/// Fits a power law to a series.
sphv_power_law sphv_series_fit(const sphv_convergence_result *result, const sphv_series *series,
                               bool theory);

#endif
