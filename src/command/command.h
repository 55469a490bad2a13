/// \file command.h
/// The command line: one row per command, one row per option; help and parsing follow from both.
#ifndef SPHVERIFY_COMMAND_H
#define SPHVERIFY_COMMAND_H

#include <jansson.h>
#include <stdbool.h>

#include "report/json_parts.h"
#include "sphverify/compare.h"
#include "sphverify/status.h"

enum { SPHV_OPTIONS_MAX = 24 };

typedef enum sphv_format {
    SPHV_FORMAT_TEXT,
    SPHV_FORMAT_JSON,
    SPHV_FORMAT_CSV,
    SPHV_FORMAT_MARKDOWN,
} sphv_format;

/// One option. Options without an argument are flags.
typedef struct sphv_option {
    const char *name;     ///< long name without dashes
    char letter;          ///< short form, or 0
    const char *argument; ///< name of the argument in help, or NULL for a flag
    const char *help;
} sphv_option;

struct sphv_arguments;

/// One command.
typedef struct sphv_command {
    const char *name;
    const char *operands; ///< in the usage line, for instance "K..."; "" for none
    const char *summary;
    const char *help;               ///< paragraphs and examples below the options
    int operands_min, operands_max; ///< max −1: any number
    const sphv_option *options;     ///< its own, ended by a row without a name
    /// \return the exit status
    int (*run)(const struct sphv_arguments *arguments);
} sphv_command;

/// A parsed command line.
typedef struct sphv_arguments {
    const sphv_command *command;
    const char *data_directory;
    sphv_format format;
    const char *values[SPHV_OPTIONS_MAX]; ///< by row of the command's options; flags: ""
    char **operands;
    int operand_count;
} sphv_arguments;

/// All commands, ended by a row without a name.
extern const sphv_command *const sphv_commands[];
extern const sphv_command sphv_command_kernels, sphv_command_kernel, sphv_command_error,
    sphv_command_check, sphv_command_run, sphv_command_report;

/// Value of a command's own option by name; NULL when it was not given.
const char *sphv_argument(const sphv_arguments *arguments, const char *option);

/// Prints `sphverify COMMAND: message` on stderr and returns the exit status of the failure.
int sphv_report_failure(const sphv_arguments *arguments, const sphv_error *error);

/// Exit status of a verdict: 0 when all agrees, 1 otherwise.
int sphv_verdict_exit(sphv_verdict verdict);

/// A progress bar on stderr when it is a terminal and stdout's work is long; otherwise silent.
/// \param context a text that names the work
void sphv_progress_bar(void *context, double done);

/// Prints a list of objects (jansson keeps their keys' order): an aligned table, a JSON array, CSV,
/// or a Markdown table. Nested objects become columns `outer.inner`; lists are joined by blanks.
void sphv_print_rows(sphv_format format, const json_t *rows);

/// Prints JSON on stdout with 17 significant digits.
void sphv_print_json(const json_t *value);

#endif
