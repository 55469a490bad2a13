/// \file error_output.h
/// How the command `error` prints what it found.
#ifndef SPHVERIFY_COMMAND_ERROR_OUTPUT_H
#define SPHVERIFY_COMMAND_ERROR_OUTPUT_H

#include "command.h"

/// What the options ask for.
typedef struct sphv_error_question {
    sphv_kernel *kernel;
    sphv_experiment experiment;
    const char *spacing_text; ///< as given
    sphv_form_of_theory form;
    bool exhaustive;
} sphv_error_question;

/// Prints one point in any format.
/// \param terms of eq. 20 or 25, or NULL
void sphv_print_error(sphv_format format, const sphv_error_question *of, const sphv_point *point,
                      const sphv_term_table *terms);

#endif
