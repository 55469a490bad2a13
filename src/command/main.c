#include <errno.h>
#include <gsl/gsl_errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "arguments.h"
#include "command.h"

const sphv_command *const sphv_commands[] = {&sphv_command_kernels,
                                             &sphv_command_kernel,
                                             &sphv_command_error,
                                             &sphv_command_check,
                                             &sphv_command_run,
                                             &sphv_command_report,
                                             NULL};

static void print_usage(FILE *stream)
{
    fputs(
        "Usage: sphverify COMMAND [OPTIONS]\n\n"
        "Verifies the truncation error of SPH kernels and gradient estimates: closed-form theory\n"
        "on one side, particle sums on the other, and a verdict whether they agree.\n\n"
        "Commands:\n",
        stream);
    for (const sphv_command *const *c = sphv_commands; *c; c++)
        fprintf(stream, "  %-8s %-8s %s\n", (*c)->name, (*c)->operands, (*c)->summary);
    fputs("\n'sphverify COMMAND --help' explains a command.\n\n"
          "Example:\n"
          "  sphverify error --kernel cubic-spline --h 0.02 --spacing 4/11\n\n"
          "Exit status: 0 all agree, 1 something disagrees or could not be decided,\n"
          "2 bad usage or input, 3 a resource failed.\n",
          stream);
}

/// Output that could not be written is a failure even when everything agreed.
static int finish(int status)
{
    if (fflush(stdout) == 0 && !ferror(stdout)) return status;
    fprintf(stderr, "sphverify: standard output cannot be written: %s\n", strerror(errno));
    return 3;
}

int main(int argc, char **argv)
{
    gsl_set_error_handler_off();
    signal(SIGXFSZ, SIG_IGN); // a write beyond the file size limit is then an error like any other
    if (argc < 2) {
        print_usage(stderr);
        return 2;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 ||
        strcmp(argv[1], "help") == 0) {
        print_usage(stdout);
        return finish(0);
    }
    if (strcmp(argv[1], "--version") == 0) {
        puts("sphverify " SPHV_VERSION);
        return finish(0);
    }
    for (const sphv_command *const *c = sphv_commands; *c; c++)
        if (strcmp((*c)->name, argv[1]) == 0) {
            sphv_arguments arguments;
            int status = sphv_arguments_parse(*c, argc - 1, argv + 1, &arguments);
            return finish(status >= 0 ? status : (*c)->run(&arguments));
        }
    fputs("sphverify: unknown command '", stderr);
    for (const char *c = argv[1]; *c; c++) fputc((unsigned char)*c < 0x20 ? '?' : *c, stderr);
    fputs("'; allowed:", stderr);
    for (const sphv_command *const *c = sphv_commands; *c; c++)
        fprintf(stderr, "%s %s", c == sphv_commands ? "" : ",", (*c)->name);
    fputs(", --help, --version\n", stderr);
    return 2;
}
