#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sphverify/report.h"

enum { ATTEMPTS = 100 };

static sphv_status cannot_write(sphv_error *error, const char *path, int reason)
{
    return sphv_fail(error, SPHV_RESOURCE_FAILURE, "%.800s: cannot be written: %s", path,
                     strerror(reason));
}

/// mkdir -p. \return 0, or the errno of the failure
static int make_directories(const char *directory)
{
    char *path = strdup(directory);
    if (!path) return ENOMEM;
    int reason = 0;
    for (char *end = path; reason == 0 && *end;) {
        end += strspn(end, "/");
        end += strcspn(end, "/");
        char kept = *end;
        *end = '\0';
        struct stat about;
        if ((mkdir(path, 0777) != 0 && errno != EEXIST) || stat(path, &about) != 0)
            reason = errno;
        else if (!S_ISDIR(about.st_mode))
            reason = ENOTDIR;
        *end = kept;
    }
    free(path);
    return reason;
}

/// Names come from scene files, so one must not lead out of the directory.
static bool is_plain_name(const char *name)
{
    size_t length = strlen(name);
    return length > 0 && length <= NAME_MAX - 32 && name[0] != '.' && !strchr(name, '/');
}

/// Opens a file that did not exist, with the permissions that the user's umask leaves.
static int open_temporary(sphv_output_file *file, const char *directory, const char *name)
{
    static atomic_uint counter;
    size_t size = strlen(directory) + strlen(name) + 64;
    file->temporary = malloc(size);
    if (!file->temporary) {
        errno = ENOMEM;
        return -1;
    }
    for (int attempt = 0; attempt < ATTEMPTS; attempt++) {
        snprintf(file->temporary, size, "%s/.%s.%ld.%u.part", directory, name, (long)getpid(),
                 atomic_fetch_add(&counter, 1));
        int descriptor = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0) return descriptor;
        if (errno != EEXIST) break;
    }
    int reason = errno;
    free(file->temporary);
    file->temporary = NULL;
    errno = reason;
    return -1;
}

sphv_status sphv_output_open(const char *directory, const char *name, sphv_output_file *out,
                             sphv_error *error)
{
    *out = (sphv_output_file){NULL, NULL, NULL};
    if (!*directory) directory = ".";
    if (!is_plain_name(name))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "'%.100s' is no name for a file; allowed: 1 to %d bytes without '/', not "
                         "beginning with '.'",
                         name, NAME_MAX - 32);
    size_t size = strlen(directory) + strlen(name) + 2;
    out->path = malloc(size);
    if (!out->path) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    snprintf(out->path, size, "%s/%s", directory, name);

    int reason = make_directories(directory), descriptor = -1;
    struct stat about;
    // A rename would replace a device or a pipe instead of writing to it.
    if (reason == 0 && stat(out->path, &about) == 0 && !S_ISREG(about.st_mode))
        reason = S_ISDIR(about.st_mode) ? EISDIR : EINVAL;
    if (reason == 0) {
        descriptor = open_temporary(out, directory, name);
        if (descriptor < 0) reason = errno;
    }
    if (reason == 0) {
        out->stream = fdopen(descriptor, "w");
        if (!out->stream) {
            reason = errno;
            close(descriptor);
        }
    }
    if (reason == 0) return SPHV_OK;
    sphv_status status = cannot_write(error, out->path, reason);
    sphv_output_discard(out);
    return status;
}

/// Why writing to a stream failed earlier: stdio does not keep it, but the same cause usually
/// stops one more byte. The file is about to be removed, so the byte does no harm.
static int reason_of(FILE *stream)
{
    return write(fileno(stream), " ", 1) < 0 ? errno : EIO;
}

/// Makes a rename survive a power cut. A file system that cannot do this is not an error.
static void sync_directory(const char *path)
{
    char *directory = strdup(path);
    if (!directory) return;
    *strrchr(directory, '/') = '\0';
    int descriptor = open(*directory ? directory : "/", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor >= 0) {
        (void)fsync(descriptor);
        close(descriptor);
    }
    free(directory);
}

sphv_status sphv_output_check(const char *directory, sphv_error *error)
{
    sphv_output_file probe;
    sphv_status status = sphv_output_open(directory, "sphverify", &probe, error);
    sphv_output_discard(&probe);
    return status;
}

sphv_status sphv_output_commit(sphv_output_file *file, sphv_error *error)
{
    int reason = 0;
    bool failed_before = ferror(file->stream);
    if (fflush(file->stream) != 0)
        reason = errno;
    else if (failed_before)
        reason = reason_of(file->stream);
    if (reason == 0 && fsync(fileno(file->stream)) != 0 && errno != EINVAL) reason = errno;
    if (fclose(file->stream) != 0 && reason == 0) reason = errno;
    file->stream = NULL;
    if (reason == 0 && rename(file->temporary, file->path) != 0) reason = errno;
    sphv_status status = SPHV_OK;
    if (reason) {
        status = cannot_write(error, file->path, reason);
    } else {
        sync_directory(file->path);
        free(file->temporary);
        file->temporary = NULL; // it has become the file
    }
    sphv_output_discard(file);
    return status;
}

void sphv_output_discard(sphv_output_file *file)
{
    if (file->stream) fclose(file->stream);
    if (file->temporary) (void)unlink(file->temporary);
    free(file->temporary);
    free(file->path);
    *file = (sphv_output_file){NULL, NULL, NULL};
}
