#include "child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { OUTPUT_MAX = 64 << 20, CHUNK = 1 << 16, NOT_STARTED = 127, COMPLAINT = 240 };

/// The parent's ends, and what has passed through them.
struct conversation {
    int input, output, complaints; ///< −1 once closed
    const char *text;              ///< still to be sent
    size_t left;
    char *received;
    size_t size, capacity;
    char complaint[COMPLAINT]; ///< the end of what it says on standard error
    size_t complaint_size;
};

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void close_end(int *descriptor)
{
    if (*descriptor >= 0) close(*descriptor);
    *descriptor = -1;
}

static int spawn(pid_t *pid, char *const *arguments, int input, int output, int complaints)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t signals;
    int reason = posix_spawn_file_actions_init(&actions);
    if (reason) return reason;
    reason = posix_spawnattr_init(&attributes);
    if (reason) {
        posix_spawn_file_actions_destroy(&actions);
        return reason;
    }
    // dup2 clears close-on-exec; every other descriptor of ours is closed by exec.
    reason = posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    if (!reason) reason = posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    if (!reason) reason = posix_spawn_file_actions_adddup2(&actions, complaints, STDERR_FILENO);
    sigemptyset(&signals);
    if (!reason) reason = posix_spawnattr_setsigmask(&attributes, &signals);
    sigaddset(&signals, SIGPIPE);
    if (!reason) reason = posix_spawnattr_setsigdefault(&attributes, &signals);
    if (!reason)
        reason =
            posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    if (!reason)
        reason = posix_spawnp(pid, arguments[0], &actions, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return reason;
}

static void send_some(struct conversation *talk)
{
    ssize_t sent = send(talk->input, talk->text, talk->left, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) {
        talk->text += sent;
        talk->left -= (size_t)sent;
    } else if (sent < 0 && errno != EAGAIN && errno != EINTR) {
        talk->left = 0; // it no longer listens; its exit status tells why
    }
    if (talk->left == 0) close_end(&talk->input);
}

/// \return false when memory or patience with the size of the output has run out
static bool receive_output(struct conversation *talk)
{
    if (talk->capacity - talk->size < CHUNK + 1) {
        size_t capacity = 2 * talk->capacity + 2 * CHUNK;
        char *larger = capacity <= OUTPUT_MAX ? realloc(talk->received, capacity) : NULL;
        if (!larger) return false;
        talk->received = larger;
        talk->capacity = capacity;
    }
    ssize_t got = read(talk->output, talk->received + talk->size, CHUNK);
    if (got > 0)
        talk->size += (size_t)got;
    else if (got == 0 || (errno != EAGAIN && errno != EINTR))
        close_end(&talk->output);
    talk->received[talk->size] = '\0';
    return true;
}

static void receive_complaint(struct conversation *talk)
{
    char text[COMPLAINT];
    ssize_t got = read(talk->complaints, text, sizeof text);
    if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) close_end(&talk->complaints);
    for (ssize_t i = 0; i < got; i++) {
        bool blank = (unsigned char)text[i] <= ' ' || text[i] == '^';
        if (blank && (!talk->complaint_size || talk->complaint[talk->complaint_size - 1] == ' '))
            continue;
        if (talk->complaint_size == COMPLAINT - 1) { // the end tells more than the beginning
            memmove(talk->complaint, talk->complaint + 1, --talk->complaint_size);
        }
        talk->complaint[talk->complaint_size++] = blank ? ' ' : text[i];
        talk->complaint[talk->complaint_size] = '\0';
    }
}

/// Talks until the child closes its output or the time is up.
/// \return NULL, or what went wrong
static const char *converse(struct conversation *talk, double deadline)
{
    while (talk->output >= 0 || talk->complaints >= 0) {
        double left = deadline - now();
        if (left <= 0) return "took too long and was stopped";
        struct pollfd ends[] = {
            {talk->input, POLLOUT, 0}, {talk->output, POLLIN, 0}, {talk->complaints, POLLIN, 0}};
        int ready = poll(ends, 3, (int)(1000 * left) + 1);
        if (ready < 0 && errno != EINTR) return strerror(errno);
        if (ready <= 0) continue;
        if (ends[0].revents) send_some(talk);
        if (ends[1].revents && !receive_output(talk)) return "wrote too much";
        if (ends[2].revents) receive_complaint(talk);
    }
    return NULL;
}

/// Waits for the end of the child, killing it when `stop` or when the time is up.
static int wait_for(pid_t pid, double deadline, bool stop, bool *stopped)
{
    int outcome = 0;
    for (;;) {
        if (!stop && now() > deadline) *stopped = stop = true;
        if (stop) kill(pid, SIGKILL);
        pid_t ended = waitpid(pid, &outcome, stop ? 0 : WNOHANG);
        if (ended == pid) return outcome;
        if (ended < 0 && errno != EINTR) return -1; // reaped elsewhere: nothing is known of it
        if (ended == 0) nanosleep(&(struct timespec){0, 1000000}, NULL);
    }
}

static sphv_status cannot_run(const char *program, int reason, sphv_error *error)
{
    return sphv_fail(error, SPHV_RESOURCE_FAILURE, "%s cannot be run: %s", program,
                     reason == ENOENT ? "it is not on PATH" : strerror(reason));
}

static sphv_status judge(const char *program, const struct conversation *talk, const char *trouble,
                         int outcome, sphv_error *error)
{
    if (!trouble && outcome >= 0 && WIFEXITED(outcome) && WEXITSTATUS(outcome) == 0) return SPHV_OK;
    // Where posix_spawn cannot report that exec failed, the child ends with this (POSIX).
    if (!trouble && outcome >= 0 && WIFEXITED(outcome) && WEXITSTATUS(outcome) == NOT_STARTED)
        return cannot_run(program, ENOENT, error);
    char how[64] = "ended in an unknown way";
    if (outcome >= 0 && WIFEXITED(outcome))
        snprintf(how, sizeof how, "ended with status %d", WEXITSTATUS(outcome));
    else if (outcome >= 0 && WIFSIGNALED(outcome))
        snprintf(how, sizeof how, "was ended by signal %d", WTERMSIG(outcome));
    return sphv_fail(error, SPHV_RESOURCE_FAILURE, "%s %s%s%s", program, trouble ? trouble : how,
                     talk->complaint_size ? ": " : "", talk->complaint);
}

sphv_status sphv_child_run(char *const *arguments, const char *input, size_t input_size,
                           double seconds, char **output, size_t *output_size, sphv_error *error)
{
    *output = NULL;
    int in[2] = {-1, -1}, out[2] = {-1, -1}, complaints[2] = {-1, -1};
    double deadline = now() + seconds;
    int reason = 0;
    pid_t pid = -1;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, in) != 0 || pipe2(out, O_CLOEXEC) != 0 ||
        pipe2(complaints, O_CLOEXEC) != 0)
        reason = errno;
    if (!reason) reason = spawn(&pid, arguments, in[0], out[1], complaints[1]);
    close_end(&in[0]);
    close_end(&out[1]);
    close_end(&complaints[1]);
    struct conversation talk = {.input = in[1],
                                .output = out[0],
                                .complaints = complaints[0],
                                .text = input,
                                .left = input_size};
    sphv_status status;
    if (reason) {
        status = cannot_run(arguments[0], reason, error);
    } else {
        bool stopped = false;
        const char *trouble = converse(&talk, deadline);
        int outcome = wait_for(pid, deadline, trouble != NULL, &stopped);
        if (stopped) trouble = "took too long and was stopped";
        status = judge(arguments[0], &talk, trouble, outcome, error);
    }
    close_end(&talk.input);
    close_end(&talk.output);
    close_end(&talk.complaints);
    if (status != SPHV_OK) {
        free(talk.received);
        return status;
    }
    *output = talk.received ? talk.received : strdup("");
    if (output_size) *output_size = talk.size;
    return *output ? SPHV_OK : sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
}
