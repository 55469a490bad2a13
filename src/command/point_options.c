#include "point_options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

sphv_status sphv_number_option(const sphv_arguments *arguments, const char *option,
                               sphv_number *out, sphv_error *error)
{
    const char *text = sphv_argument(arguments, option);
    if (!text) return sphv_fail(error, SPHV_INVALID_INPUT, "--%s is missing; see --help", option);
    sphv_error reason;
    if (sphv_number_parse(text, out, &reason) == SPHV_OK) return SPHV_OK;
    return sphv_fail(error, SPHV_INVALID_INPUT, "--%s: %s", option, reason.message);
}

sphv_status sphv_whole_option(const sphv_arguments *arguments, const char *option, long least,
                              long most, long otherwise, long *out, sphv_error *error)
{
    const char *text = sphv_argument(arguments, option);
    char *end = NULL;
    *out = otherwise;
    if (!text) return SPHV_OK;
    *out = strtol(text, &end, 10);
    if (end != text && *end == '\0' && *out >= least && *out <= most) return SPHV_OK;
    return sphv_fail(error, SPHV_INVALID_INPUT, "--%s is '%.40s'; allowed: %ld to %ld", option,
                     text, least, most);
}

sphv_status sphv_real_option(const sphv_arguments *arguments, const char *option, double otherwise,
                             double *out, sphv_error *error)
{
    sphv_number number = {otherwise, 0};
    sphv_status status = SPHV_OK;
    if (sphv_argument(arguments, option))
        status = sphv_number_option(arguments, option, &number, error);
    *out = number.value;
    return status;
}

sphv_status sphv_dimension_option(const sphv_arguments *arguments, int fallback, int *out,
                                  sphv_error *error)
{
    const char *text = sphv_argument(arguments, "dim");
    *out = fallback;
    if (!text) return SPHV_OK;
    if (strlen(text) != 1 || *text < '1' || *text > '0' + SPHV_DIMENSIONS)
        return sphv_fail(error, SPHV_INVALID_INPUT, "--dim is '%.40s'; allowed: 1, 2, 3", text);
    *out = *text - '0';
    return SPHV_OK;
}

sphv_status sphv_word_option(const sphv_arguments *arguments, const char *option,
                             const char *const *words, int *out, sphv_error *error)
{
    const char *text = sphv_argument(arguments, option);
    *out = 0;
    if (!text) return SPHV_OK;
    char allowed[256] = "";
    size_t used = 0;
    for (int i = 0; words[i]; i++) {
        if (strcmp(words[i], text) == 0) {
            *out = i;
            return SPHV_OK;
        }
        used += (size_t)snprintf(allowed + used, sizeof allowed - used, "%s%s", i ? ", " : "",
                                 words[i]);
    }
    return sphv_fail(error, SPHV_INVALID_INPUT, "--%s is '%.60s'; allowed: %s", option, text,
                     allowed);
}

sphv_status sphv_profile_required(const sphv_kernel *kernel, int dimension,
                                  const sphv_profile **out, sphv_error *error)
{
    *out = sphv_kernel_profile(kernel, dimension);
    if (*out) return SPHV_OK;
    return sphv_fail(error, SPHV_INVALID_INPUT, "kernel '%s' is not legal in %d dimensions: %s",
                     sphv_kernel_name(kernel), dimension, sphv_kernel_refusal(kernel, dimension));
}
