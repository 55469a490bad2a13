/// \file convergence_json.h
/// The results of a convergence scene as JSON, for `run` and for the report alike.
#ifndef SPHVERIFY_REPORT_CONVERGENCE_JSON_H
#define SPHVERIFY_REPORT_CONVERGENCE_JSON_H

#include <jansson.h>

#include "scene_facts.h"

/// Everything: settings, every norm of every quantity at every level, cells, claims. The caller
/// owns it.
json_t *sphv_convergence_json(const sphv_convergence_result *result);

/// One object per printed cell and claim, the same keys in each, with those of a claim of any other
/// scene first: for CSV and Markdown. The caller owns it.
json_t *sphv_convergence_rows(const sphv_convergence_result *result);

#endif
