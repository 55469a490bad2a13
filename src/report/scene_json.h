/// \file scene_json.h
/// A scene's results as JSON, for `run` and for the report alike.
#ifndef SPHVERIFY_REPORT_SCENE_JSON_H
#define SPHVERIFY_REPORT_SCENE_JSON_H

#include <jansson.h>

#include "sphverify/scene.h"

/// The scene, its tallies and its claims; null for numbers that do not exist. The caller owns it.
json_t *sphv_scene_json(const sphv_scene_result *result);

#endif
