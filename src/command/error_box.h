/// \file error_box.h
/// The command `error` on a box of particles, in one to three dimensions.
#ifndef SPHVERIFY_COMMAND_ERROR_BOX_H
#define SPHVERIFY_COMMAND_ERROR_BOX_H

#include "command.h"

/// Reads the question (`--particles` is among the options), evaluates and prints it.
/// \return the exit status
int sphv_run_error_box(const sphv_arguments *arguments);

#endif
