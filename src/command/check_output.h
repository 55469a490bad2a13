/// \file check_output.h
/// What `check` prints and writes.
#ifndef SPHVERIFY_COMMAND_CHECK_OUTPUT_H
#define SPHVERIFY_COMMAND_CHECK_OUTPUT_H

#include <jansson.h>
#include <stdio.h>

#include "sphverify/check.h"

/// {"kernel", "verdict", "checks": [{"id", "dimension", "claim", …}]}
json_t *sphv_check_json(const sphv_check_report *report);

/// One flat object per result, for CSV and Markdown.
json_t *sphv_check_rows_json(const sphv_check_report *report);

void sphv_check_print_text(FILE *stream, const sphv_check_report *report);
void sphv_check_print_markdown(FILE *stream, const sphv_check_report *report);

json_t *sphv_self_test_json(const sphv_self_test *test);
void sphv_self_test_print(FILE *stream, const sphv_self_test *test);

#endif
