/// \file slips.h
/// The slips of Quinlan, Basa and Lastiwka 2006, shown by numbers worked out on the spot.
#ifndef SPHVERIFY_REPORT_SLIPS_H
#define SPHVERIFY_REPORT_SLIPS_H

#include "sphverify/report.h"

enum { SPHV_SIGN_ROWS = 4, SPHV_KNOT_TERMS = 5, SPHV_SLIP_KNOTS = 8 };

/// Eq. 11 (and with it 12, 15, 16) has the wrong sign: the discretisation error at one spacing,
/// for A = x (the limit h → 0).
typedef struct sphv_sign_slip {
    int n;
    double spacing;
    sphv_result measured; ///< E − E_s
    sphv_result mended;   ///< eq. 16 with the sign mended, two Euler–Maclaurin terms
    sphv_result printed;  ///< eq. 16 as printed: its negative
    double first_term;    ///< first term of the mended form
    sphv_verdict mended_verdict, printed_verdict;
} sphv_sign_slip;

/// The analysis does not see interior knots: the series of the cubic B-spline, knot by knot.
typedef struct sphv_knot_slip {
    double h, spacing;
    int first_order; ///< p of term[…][0]
    int knot_count;
    double position[SPHV_SLIP_KNOTS];
    double term[SPHV_SLIP_KNOTS][SPHV_KNOT_TERMS];
    sphv_result measured, exact, paper; ///< E_d: measured E − E_s, all knots, edges only
    sphv_verdict exact_verdict, paper_verdict;
    int predicted_order, paper_order;
    sphv_result fitted_order; ///< slope of |E − E_s| over n = 5 … 40 at h = 1e-4
} sphv_knot_slip;

typedef struct sphv_slips {
    const sphv_kernel *sign_kernel; ///< NULL when the report has no quinlan-w10
    sphv_sign_slip sign[SPHV_SIGN_ROWS];
    const sphv_kernel *knot_kernel; ///< NULL when the report has no cubic-spline
    sphv_knot_slip knot;
} sphv_slips;

/// Works out what can be shown with the kernels of a report.
sphv_status sphv_slips_compute(const sphv_report *report, sphv_slips *slips,
                               sphv_error *error) SPHV_MUST_CHECK;

/// Slips of the text that need no numbers, ended by NULL.
extern const char *const sphv_slips_of_text[];

#endif
