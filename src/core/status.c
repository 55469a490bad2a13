#include "sphverify/status.h"

#include <stdarg.h>
#include <stdio.h>

sphv_status sphv_fail(sphv_error *error, sphv_status status, const char *format, ...)
{
    if (!error) return status;
    error->status = status;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    for (char *c = error->message; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f) *c = '?';
    return status;
}

int sphv_exit_status(sphv_status status)
{
    switch (status) {
    case SPHV_OK:
        return 0;
    case SPHV_INVALID_INPUT:
    case SPHV_NO_CLOSED_FORM:
        return 2;
    case SPHV_RESOURCE_FAILURE:
        return 3;
    }
    return 3;
}
