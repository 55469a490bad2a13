/// \file arguments.h
/// Parsing a command line against its command's options.
#ifndef SPHVERIFY_COMMAND_ARGUMENTS_H
#define SPHVERIFY_COMMAND_ARGUMENTS_H

#include "command.h"

/// Parses options and operands.
/// \return −1 to go on, otherwise the exit status: 0 after --help, 2 after a message on stderr
int sphv_arguments_parse(const sphv_command *command, int argc, char **argv,
                         sphv_arguments *arguments);

#endif
