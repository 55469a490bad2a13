#include "data_directory.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int is_directory(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

static int runs_from_build_folder(void)
{
    char program[4096];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length <= 0) return 0;
    program[length] = '\0';
    return strncmp(program, SPHV_BUILD_ROOT, strlen(SPHV_BUILD_ROOT)) == 0;
}

const char *sphv_data_directory(const char *option)
{
    if (option) return option;
    const char *environment = getenv("SPHVERIFY_DATA");
    if (environment && *environment) return environment;
    if (runs_from_build_folder() || !is_directory(SPHV_INSTALLED_DATA)) return SPHV_SOURCE_DATA;
    return SPHV_INSTALLED_DATA;
}
