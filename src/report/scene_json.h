/// \file scene_json.h
/// A scene's results as JSON, for `run` and for the report alike.
#ifndef SPHVERIFY_REPORT_SCENE_JSON_H
#define SPHVERIFY_REPORT_SCENE_JSON_H

#include <jansson.h>

#include "scene_facts.h"

/// Estimates and failures; null in all when there are none to speak of.
json_t *sphv_faults_json(bool there, const sphv_fault_counts *faults);

/// The scene, its tallies, its claims, and its curves without their samples; null for numbers that
/// do not exist. The caller owns it.
json_t *sphv_scene_json(const sphv_scene_result *result);

#endif
