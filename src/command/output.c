#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "command.h"

int sphv_report_failure(const sphv_arguments *arguments, const sphv_error *error)
{
    sphv_progress_bar(NULL, 1);
    fprintf(stderr, "sphverify %s: %s\n", arguments->command->name, error->message);
    return sphv_exit_status(error->status);
}

int sphv_verdict_exit(sphv_verdict verdict)
{
    return verdict == SPHV_AGREES ? 0 : 1;
}

void sphv_progress_bar(void *context, double done)
{
    static int shown = -1;
    if (!isatty(STDERR_FILENO)) return;
    int percent = (int)(100 * done);
    if (percent == shown || (shown < 0 && done >= 1)) return;
    if (done >= 1) {
        fprintf(stderr, "\r\033[K");
        shown = -1;
        return;
    }
    char bar[41];
    int filled = percent * 40 / 100;
    memset(bar, '.', 40);
    memset(bar, '#', (size_t)filled);
    bar[40] = '\0';
    fprintf(stderr, "\r%s [%s] %3d %%", context ? (const char *)context : "", bar, percent);
    shown = percent;
}

void sphv_print_json(const json_t *value)
{
    json_dumpf(value, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17) | JSON_ENCODE_ANY);
    putchar('\n');
}
