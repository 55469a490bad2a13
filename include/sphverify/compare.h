/// \file compare.h
/// The comparator: does a prediction agree with a measurement?
#ifndef SPHVERIFY_COMPARE_H
#define SPHVERIFY_COMPARE_H

#include "sphverify/boundary.h"
#include "sphverify/estimate.h"
#include "sphverify/measure.h"
#include "sphverify/theory.h"

/// The three answers.
typedef enum sphv_verdict {
    SPHV_AGREES,       ///< |analytic − empirical| ≤ sum of bounds, and the bounds are telling
    SPHV_DISAGREES,    ///< the difference exceeds the sum of bounds
    SPHV_INCONCLUSIVE, ///< the bounds would hide an error of 1 % of the quantity
} sphv_verdict;

const char *sphv_verdict_name(sphv_verdict verdict);

/// The worse of two: disagrees, then inconclusive, then agrees.
sphv_verdict sphv_verdict_worse(sphv_verdict a, sphv_verdict b);

/// Compares two numbers.
/// \param scale size of the quantity, of which an error of 1 % must not go unnoticed
sphv_verdict sphv_compare(sphv_result analytic, sphv_result empirical, double scale);

/// What a root mean square error is known to, beside a prediction of some rigour: its rounding and,
/// where the prediction is an expectation, half of the 99.9 % interval of one realisation. That
/// follows from the norm's own standard deviation where theory knows it. Where not, errors of
/// particles whose supports do not overlap are independent, count/neighbours of them.
/// \param bound    rounding of rmse
/// \param scatter  standard deviation over realisations, or infinite
double sphv_norm_interval(double rmse, double bound, sphv_rigour rigour, size_t count,
                          size_t neighbours, double scatter);

/// Compares a prediction with a root mean square error over particles, known to
/// `sphv_norm_interval`. Beside an expectation an error of 20 % must not go unnoticed.
/// \param bound rounding of rmse; \param scale as above, of other predictions than expectations
sphv_verdict sphv_compare_norm(sphv_result analytic, sphv_rigour rigour, double rmse, double bound,
                               size_t count, size_t neighbours, double scatter, double scale);

/// One point: both halves side by side.
typedef struct sphv_point {
    sphv_prediction analytic;
    sphv_measurement empirical;
    double difference; ///< analytic − empirical total, or l2 where no total exists
    sphv_verdict verdict;
    bool statistical; ///< l2 is an expectation beside a Monte-Carlo mean; `total.value` is NaN
    sphv_disorder_measurement disorder; ///< of the measurement, where it is statistical
} sphv_point;

/// Smallest and largest arguments that `sphv_evaluate_point` accepts.
#define SPHV_H_MIN 1e-9
#define SPHV_H_MAX 10.0
#define SPHV_SPACING_MIN 1e-4

/// Checks h and spacing as a user gives them.
sphv_status sphv_check_point(const sphv_profile *profile, double h, sphv_number spacing,
                             sphv_error *error) SPHV_MUST_CHECK;

/// Evaluates both halves at one point of a uniform lattice in one dimension and compares E.
/// The quantity whose 1 % counts is the larger of |E_s|, |E_d| and |E|: near a sign change of E the
/// parts, not their difference, are what the theory claims to know.
/// \param exhaustive evaluate every particle of a wavelength instead of one
/// \param progress   for the exhaustive evaluation; may be NULL
sphv_status sphv_evaluate_point(const sphv_profile *profile, double h, sphv_number spacing,
                                sphv_form_of_theory form, bool exhaustive, sphv_progress progress,
                                void *context, sphv_point *out, sphv_error *error) SPHV_MUST_CHECK;

/// Evaluates both halves of an experiment. Standard SPH on a lattice is `sphv_evaluate_point`; all
/// else compares L2 norms, prediction beside Monte-Carlo mean, and is `inconclusive` when either's
/// interval is wider than the experiment asks or no theory exists. `total.value` is NaN then and
/// `total.bound` that of `l2`.
sphv_status sphv_evaluate_experiment(const sphv_experiment *experiment, sphv_progress progress,
                                     void *context, sphv_point *out,
                                     sphv_error *error) SPHV_MUST_CHECK;

/// One method, field and smoothing length on one box of particles.
typedef struct sphv_box_question {
    sphv_box box;
    const sphv_profile *profile; ///< of the box's dimension
    double h;
    sphv_method method;
    sphv_field field; ///< of the box's dimension
} sphv_box_question;

/// What was predicted and measured, in the order of the monomials: value, gradient, and second
/// derivatives where the method gives them.
typedef struct sphv_box_point {
    size_t quantities;
    bool predicted; ///< a theory exists; where a single quantity has none, `analytic.exists` says
    sphv_box_prediction analytic;
    sphv_norms norms[SPHV_QUANTITIES_MAX];    ///< over all particles
    double interval[SPHV_QUANTITIES_MAX];     ///< what their RMSE is known to, sphv_norm_interval
    sphv_norms interior[SPHV_QUANTITIES_MAX]; ///< over those at least κh from every side
    /// Of the RMSE over all particles; `inconclusive` without a theory.
    sphv_verdict verdicts[SPHV_QUANTITIES_MAX];
    sphv_verdict verdict; ///< the worst of the quantities that have a theory
    size_t particles, neighbours_least, neighbours_most;
    double pairs, seconds, worst_condition;
} sphv_box_point;

/// Evaluates both halves on a box and compares the root mean square errors. The quantity whose 1 %
/// counts is the largest error among derivatives of the same degree or, where these are rounding,
/// the field's derivative itself.
sphv_status sphv_evaluate_box(const sphv_box_question *question, sphv_progress progress,
                              void *context, sphv_box_point *out,
                              sphv_error *error) SPHV_MUST_CHECK;

/// The terms of eq. 20 or 25 on actual particles, root mean squares over particles and phases.
typedef struct sphv_term_table {
    const sphv_term_row *rows; ///< ended by a row without a name
    double rms[SPHV_TERMS_MAX];
    double sum;      ///< of all terms
    double measured; ///< the error they stand for: eq. 20 without the smoothing error
    double residual; ///< measured − sum, particle by particle
    int particles;
} sphv_term_table;

/// Evaluates the terms for 512 particles of a tessellated layout.
/// \return SPHV_NO_CLOSED_FORM for methods and volume rules without such terms
sphv_status sphv_evaluate_terms(const sphv_experiment *experiment, sphv_term_table *table,
                                sphv_error *error) SPHV_MUST_CHECK;

/// Least-squares slope of log|y| against log x with the standard error of the slope; points with
/// y = 0 are left out. NaN when fewer than two remain.
sphv_result sphv_fit_slope(const double *x, const double *y, size_t count);

#endif
