/// \file json_parts.h
/// Parts of JSON that the commands and the report share.
#ifndef SPHVERIFY_REPORT_JSON_PARTS_H
#define SPHVERIFY_REPORT_JSON_PARTS_H

#include <jansson.h>

#include "sphverify/check.h"

/// A number, or null where there is none.
json_t *sphv_json_number(double value);

/// Text that need not be UTF-8 (a path): what is not becomes U+FFFD.
json_t *sphv_json_text(const char *text);

/// The same, or null where it is NULL or empty.
json_t *sphv_json_text_or_null(const char *text);

/// {"value", "bound"}
json_t *sphv_json_result(sphv_result result);

/// {"id", "dimension", "claim", "claimed", "analytic", "empirical", "bound", "informative",
/// "verdict", "cause"}
json_t *sphv_check_result_json(const sphv_check_result *result);

#endif
