#include "arguments.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "core/data_directory.h"

/// Options of every command, parsed beside its own.
static const sphv_option common_options[] = {
    {"format", 0, "FORMAT", "text (default), json, csv or md"},
    {"data-dir", 0, "DIR",
     "folder with kernels/ and scenes/ (default: SPHVERIFY_DATA, then the "
     "installed or the source tree's data)"},
    {"help", 'h', NULL, "print this help"},
    {NULL, 0, NULL, NULL},
};

enum { COMMON = 1000, FORMAT = 0, DATA_DIRECTORY = 1, HELP = 2 };

static void print_option(const sphv_option *option)
{
    char left[64];
    int length = option->letter ? snprintf(left, sizeof left, "-%c, ", option->letter)
                                : snprintf(left, sizeof left, "    ");
    snprintf(left + length, sizeof left - (size_t)length, "--%s%s%s", option->name,
             option->argument ? " " : "", option->argument ? option->argument : "");
    printf("  %-26s %s\n", left, option->help);
}

static void print_help(const sphv_command *command)
{
    printf("Usage: sphverify %s [OPTIONS]%s%s\n\n%s.\n\nOptions:\n", command->name,
           *command->operands ? " " : "", command->operands, command->summary);
    for (const sphv_option *o = command->options; o->name; o++) print_option(o);
    for (const sphv_option *o = common_options; o->name; o++) print_option(o);
    printf("\n%s", command->help);
}

static int complain(const sphv_command *command, const char *format, const char *text)
{
    sphv_error error;
    char message[512];
    snprintf(message, sizeof message, format, text);
    sphv_fail(&error, SPHV_INVALID_INPUT, "sphverify %s: %s", command->name, message);
    fprintf(stderr, "%s\n", error.message);
    return 2;
}

static int read_format(const sphv_command *command, const char *text, sphv_format *format)
{
    static const char *const names[] = {"text", "json", "csv", "md"};
    for (int i = 0; i < 4; i++)
        if (strcmp(text, names[i]) == 0) {
            *format = (sphv_format)i;
            return -1;
        }
    return complain(command, "--format is '%.60s'; allowed: text, json, csv, md", text);
}

static void add_option(const sphv_option *option, int code, struct option *to, char *letters)
{
    *to = (struct option){option->name, option->argument ? required_argument : no_argument, NULL,
                          code};
    if (option->letter) {
        size_t end = strlen(letters);
        letters[end] = option->letter;
        letters[end + 1] = '\0';
        if (option->argument) strcat(letters, ":");
    }
}

static int code_of_letter(const sphv_command *command, int letter)
{
    for (int i = 0; command->options[i].name; i++)
        if (command->options[i].letter == letter) return COMMON + 100 + i;
    for (int i = 0; common_options[i].name; i++)
        if (common_options[i].letter == letter) return COMMON + i;
    return letter;
}

static int take(sphv_arguments *arguments, int code, int *help)
{
    int status = -1;
    if (code >= COMMON + 100)
        arguments->values[code - COMMON - 100] = optarg ? optarg : "";
    else if (code == COMMON + FORMAT)
        status = read_format(arguments->command, optarg, &arguments->format);
    else if (code == COMMON + DATA_DIRECTORY)
        arguments->data_directory = optarg;
    else if (code == COMMON + HELP)
        *help = 1;
    return status;
}

int sphv_arguments_parse(const sphv_command *command, int argc, char **argv,
                         sphv_arguments *arguments)
{
    *arguments = (sphv_arguments){.command = command};
    struct option options[SPHV_OPTIONS_MAX + 4] = {{0}};
    char letters[2 * SPHV_OPTIONS_MAX + 8] = ":";
    int count = 0, help = 0;
    for (int i = 0; command->options[i].name; i++)
        add_option(&command->options[i], COMMON + 100 + i, &options[count++], letters);
    for (int i = 0; common_options[i].name; i++)
        add_option(&common_options[i], COMMON + i, &options[count++], letters);
    opterr = 0;
    for (int code; (code = getopt_long(argc, argv, letters, options, NULL)) != -1;) {
        if (code == ':')
            return complain(command, "option '%.60s' needs an argument; see --help",
                            argv[optind - 1]);
        if (code == '?')
            return complain(command, "unknown or ambiguous option '%.60s'; allowed: see --help",
                            argv[optind - 1]);
        int status = take(arguments, code < COMMON ? code_of_letter(command, code) : code, &help);
        if (status >= 0) return status;
    }
    if (help) {
        print_help(command);
        return 0;
    }
    arguments->operands = argv + optind;
    arguments->operand_count = argc - optind;
    if (arguments->operand_count < command->operands_min)
        return complain(command, "an operand is missing; allowed: %s", command->operands);
    if (command->operands_max >= 0 && arguments->operand_count > command->operands_max)
        return complain(command, "one operand too many: '%.60s'; see --help",
                        arguments->operands[command->operands_max]);
    arguments->data_directory = sphv_data_directory(arguments->data_directory);
    return -1;
}

const char *sphv_argument(const sphv_arguments *arguments, const char *option)
{
    for (int i = 0; arguments->command->options[i].name; i++)
        if (strcmp(arguments->command->options[i].name, option) == 0) return arguments->values[i];
    return NULL;
}
