#include "implementation.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <fenv.h>
#include <math.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { CANARY_BYTES = 256, DESCRIPTORS_MAX = 4096 };
static const unsigned char canary = 0xA5;
static const rlim_t memory_allowed = (rlim_t)1 << 30; ///< beyond what this process holds

/// How far the child has come.
enum stage { STARTED, LOADED, CALLING, REPEATING, DONE };

/// Memory shared with the child: what it reports. Calls and answers follow on pages of their own.
struct channel {
    atomic_int stage;
    atomic_size_t next; ///< the call being made
    int missing_symbol; // a stray write may leave any bits here, which a bool could not hold
    int rounding_changed;
    int differs;
    size_t differing;
    char message[300];
};

struct shared {
    unsigned char *base;
    size_t page, calls_at, answers_at, size; ///< in bytes; one page without access at the end
    struct channel *channel;
    sphv_kernel_call *calls;
    sphv_kernel_answer *answers;
    unsigned char *canary;
};

const char *sphv_outcome_name(sphv_outcome outcome)
{
    static const char *const names[] = {"answered",  "not loaded", "no symbol", "trapped",
                                        "timed out", "exited",     "tampered"};
    return names[outcome];
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool shared_make(struct shared *shared, const sphv_kernel_call *calls, size_t count)
{
    size_t page = (size_t)sysconf(_SC_PAGESIZE);
    size_t head = (sizeof(struct channel) + page - 1) / page * page;
    size_t asked = (count * sizeof *calls + page - 1) / page * page;
    size_t told = (count * sizeof(sphv_kernel_answer) + CANARY_BYTES + page - 1) / page * page;
    shared->page = page;
    shared->calls_at = head;
    shared->answers_at = head + asked;
    shared->size = head + asked + told + page;
    shared->base =
        mmap(NULL, shared->size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared->base == MAP_FAILED) return false;
    mprotect(shared->base + shared->size - page, page, PROT_NONE);
    shared->channel = (void *)shared->base;
    shared->calls = (void *)(shared->base + shared->calls_at);
    shared->answers = (void *)(shared->base + shared->answers_at);
    shared->canary = (void *)(shared->answers + count);
    memcpy(shared->calls, calls, count * sizeof *calls);
    for (size_t i = 0; i < count; i++) shared->answers[i] = (sphv_kernel_answer){NAN, NAN};
    memset(shared->canary, canary, CANARY_BYTES);
    return true;
}

static void limit(int resource, rlim_t value)
{
    struct rlimit old;
    if (getrlimit(resource, &old) == 0 && old.rlim_max != RLIM_INFINITY && value > old.rlim_max)
        value = old.rlim_max;
    struct rlimit limits = {value, value};
    setrlimit(resource, &limits);
}

/// Address space that this process holds now, 4 GiB when the system does not say.
static rlim_t memory_held(void)
{
    unsigned long pages = 0;
    char line[128];
    FILE *file = fopen("/proc/self/statm", "r");
    if (file) {
        if (fgets(line, sizeof line, file)) pages = strtoul(line, NULL, 10);
        fclose(file);
    }
    return pages ? (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) : (rlim_t)4 << 30;
}

/// Takes from the child what a kernel does not need.
static void confine(double seconds, int output)
{
    static const int signals[] = {SIGSEGV, SIGBUS,  SIGFPE,  SIGILL,  SIGABRT, SIGTRAP, SIGSYS,
                                  SIGXFSZ, SIGXCPU, SIGTERM, SIGALRM, SIGPIPE, SIGINT,  SIGHUP};
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    // A sanitizer's or a caller's handler would turn a trap into something else.
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) signal(signals[i], SIG_DFL);
    int nothing = open("/dev/null", O_RDWR);
    if (nothing >= 0) dup2(nothing, STDIN_FILENO);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    for (int i = STDERR_FILENO + 1; i < DESCRIPTORS_MAX; i++) close(i);
    limit(RLIMIT_AS, memory_held() + memory_allowed);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_FSIZE, 0);
    limit(RLIMIT_CPU, (rlim_t)ceil(seconds) + 1);
}

typedef double (*kernel_function)(double r, double h, int dimension);

static kernel_function find(void *library, const char *name, struct channel *channel)
{
    // ISO C has no conversion from void * to a function; POSIX guarantees the representation.
    kernel_function function = NULL;
    void *symbol = dlsym(library, name);
    memcpy(&function, &symbol, sizeof function);
    if (!function) {
        channel->missing_symbol = 1;
        snprintf(channel->message, sizeof channel->message, "the library has no function '%s'",
                 name);
    }
    return function;
}

/// The same number, or the same NaN.
static bool same_bits(double a, double b)
{
    uint64_t first, second;
    memcpy(&first, &a, sizeof first);
    memcpy(&second, &b, sizeof second);
    return first == second;
}

/// The child: loads the library, calls it for everything, reports and ends.
static _Noreturn void serve(const char *path, const struct shared *shared, size_t count)
{
    struct channel *channel = shared->channel;
    mprotect(shared->calls, shared->answers_at - shared->calls_at, PROT_READ);
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        snprintf(channel->message, sizeof channel->message, "%s", dlerror());
        _exit(0);
    }
    channel->stage = LOADED;
    kernel_function value = find(library, "kernel_value", channel);
    kernel_function derivative = value ? find(library, "kernel_derivative", channel) : NULL;
    if (!value || !derivative) _exit(0);
    channel->stage = CALLING;
    for (size_t i = 0; i < count; i++) {
        const sphv_kernel_call *call = &shared->calls[i];
        channel->next = i;
        shared->answers[i].value = value(call->r, call->h, call->dimension);
        shared->answers[i].derivative = derivative(call->r, call->h, call->dimension);
    }
    channel->stage = REPEATING;
    for (size_t i = count; i-- > 0;) {
        const sphv_kernel_call *call = &shared->calls[i];
        channel->next = i;
        sphv_kernel_answer again = {value(call->r, call->h, call->dimension),
                                    derivative(call->r, call->h, call->dimension)};
        if (!same_bits(again.value, shared->answers[i].value) ||
            !same_bits(again.derivative, shared->answers[i].derivative)) {
            channel->differs = 1;
            channel->differing = i;
        }
    }
    channel->rounding_changed = fegetround() != FE_TONEAREST;
    fflush(NULL);
    channel->stage = DONE;
    _exit(0);
}

/// Waits for the child, and ends it and what it started when the time is over.
/// \return false when it had to be ended
static bool wait_for(pid_t child, double deadline, int *status)
{
    struct timespec pause = {0, 200000};
    bool in_time = true;
    for (;;) {
        siginfo_t info = {0};
        int failed = waitid(P_PID, (id_t)child, &info, WEXITED | WNOHANG | WNOWAIT);
        if (info.si_pid == child || (failed && errno != EINTR)) break;
        in_time = now() <= deadline;
        if (!in_time) break;
        nanosleep(&pause, NULL);
        if (pause.tv_nsec < 5000000) pause.tv_nsec *= 2;
    }
    // Before it is waited for, so that its number still means this child and its group.
    kill(-child, SIGKILL);
    kill(child, SIGKILL);
    while (waitpid(child, status, 0) < 0 && errno == EINTR) continue;
    return in_time;
}

static size_t count_printed(int output)
{
    char buffer[4096];
    size_t total = 0;
    ssize_t got;
    while ((got = read(output, buffer, sizeof buffer)) > 0) total += (size_t)got;
    return total;
}

/// Where the child was, in words.
static void say_where(const struct channel *channel, const sphv_kernel_call *calls, size_t count,
                      char *text, size_t size)
{
    size_t next = channel->next;
    if (channel->stage < LOADED)
        snprintf(text, size, "while it was loaded");
    else if (channel->stage < CALLING || next >= count)
        snprintf(text, size, "before the first call");
    else
        snprintf(text, size, "at r = %.10g, h = %.10g in %dD%s", calls[next].r, calls[next].h,
                 calls[next].dimension, channel->stage == REPEATING ? ", when called again" : "");
}

static void say_signal(int signal_number, const char *where, char *text, size_t size)
{
    static const struct {
        int number;
        const char *meaning;
    } meanings[] = {
        {SIGSEGV, "it reads or writes memory that is not its own, or recurses for ever"},
        {SIGBUS, "it reads or writes memory that is not there"},
        {SIGFPE, "a trapped arithmetic operation, such as an integer division by zero"},
        {SIGABRT, "it aborts (a failed assertion, or a corrupted heap)"},
        {SIGILL, "it runs an instruction this processor does not have, or meets a trap"},
        {SIGTRAP, "it meets a trap"},
        {SIGXFSZ, "it writes to a file"},
        {SIGXCPU, "it uses up its processor time"},
    };
    const char *meaning = "something ended it";
    for (size_t i = 0; i < sizeof meanings / sizeof *meanings; i++)
        if (meanings[i].number == signal_number) meaning = meanings[i].meaning;
    snprintf(text, size, "signal %d (%s) %s: %s", signal_number, strsignal(signal_number), where,
             meaning);
}

static bool canary_lives(const struct shared *shared)
{
    for (size_t i = 0; i < CANARY_BYTES; i++)
        if (shared->canary[i] != canary) return false;
    return true;
}

static void conclude(const struct shared *shared, const sphv_kernel_call *calls, size_t count,
                     bool ended, int status, double time_limit, sphv_implementation_run *run)
{
    const struct channel *channel = shared->channel;
    int stage = channel->stage;
    char where[160];
    say_where(channel, calls, count, where, sizeof where);
    run->answered = stage >= REPEATING ? count : stage == CALLING ? channel->next : 0;
    if (run->answered > count) run->answered = count;
    run->repeatable = channel->differs == 0;
    run->differing = channel->differing < count ? channel->differing : 0;
    run->rounding_changed = channel->rounding_changed != 0;
    if (!ended) {
        run->outcome = SPHV_OUTCOME_TIMED_OUT;
        snprintf(run->message, sizeof run->message, "no answer within %g s %s: an endless loop?",
                 time_limit, where);
    } else if (WIFSIGNALED(status)) {
        run->outcome = SPHV_OUTCOME_TRAPPED;
        say_signal(WTERMSIG(status), where, run->message, sizeof run->message);
    } else if (channel->missing_symbol != 0) {
        run->outcome = SPHV_OUTCOME_NO_SYMBOL;
        snprintf(run->message, sizeof run->message, "%.299s", channel->message);
    } else if (stage < LOADED && channel->message[0]) {
        run->outcome = SPHV_OUTCOME_NOT_LOADED;
        snprintf(run->message, sizeof run->message, "it cannot be loaded: %.299s",
                 channel->message);
    } else if (!canary_lives(shared)) {
        run->outcome = SPHV_OUTCOME_TAMPERED;
        snprintf(run->message, sizeof run->message, "it wrote over memory that is not its own");
    } else if (stage != DONE) {
        run->outcome = SPHV_OUTCOME_EXITED;
        snprintf(run->message, sizeof run->message, "it ended the program with status %d %s",
                 WEXITSTATUS(status), where);
    } else {
        run->outcome = SPHV_OUTCOME_ANSWERED;
    }
    // Messages of the loader may hold anything that a file name holds.
    for (char *c = run->message; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 0x7f) *c = '?';
}

static sphv_status run_child(const char *path, double time_limit, const sphv_kernel_call *calls,
                             size_t count, struct shared *shared, sphv_implementation_run *run,
                             sphv_error *error)
{
    int output[2];
    if (pipe(output) != 0)
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "no pipe: %s", strerror(errno));
    // Neither side may wait for the other: a library that prints without end loses the rest.
    fcntl(output[0], F_SETFL, O_NONBLOCK);
    fcntl(output[1], F_SETFL, O_NONBLOCK);
    fflush(NULL); // or the child's exit would write what is buffered here again
    double start = now();
    pid_t child = fork();
    if (child == 0) {
        confine(time_limit, output[1]);
        serve(path, shared, count);
    }
    close(output[1]);
    if (child > 0) {
        int status = 0;
        setpgid(child, child);
        bool ended = wait_for(child, start + time_limit, &status);
        conclude(shared, calls, count, ended, status, time_limit, run);
        run->printed = count_printed(output[0]);
        run->seconds = now() - start;
    }
    close(output[0]);
    return child > 0 ? SPHV_OK
                     : sphv_fail(error, SPHV_RESOURCE_FAILURE, "no process: %s", strerror(errno));
}

sphv_status sphv_implementation_sample(const char *path, double time_limit,
                                       const sphv_kernel_call *calls, size_t count,
                                       sphv_kernel_answer *answers, sphv_implementation_run *run,
                                       sphv_error *error)
{
    *run = (sphv_implementation_run){.outcome = SPHV_OUTCOME_NOT_LOADED, .repeatable = true};
    struct stat about;
    bool there = stat(path, &about) == 0;
    if (!there || !S_ISREG(about.st_mode))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%.300s: %s; allowed: the file of a shared library", path,
                         there ? "not a file" : strerror(errno));
    char *full = realpath(path, NULL);
    struct shared shared;
    if (!full || !shared_make(&shared, calls, count)) {
        free(full);
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "no memory for %zu calls", count);
    }
    if (!(time_limit > 0)) time_limit = SPHV_IMPLEMENTATION_SECONDS;
    sphv_status status = run_child(full, time_limit, calls, count, &shared, run, error);
    for (size_t i = 0; i < count; i++)
        answers[i] = i < run->answered ? shared.answers[i] : (sphv_kernel_answer){NAN, NAN};
    munmap(shared.base, shared.size);
    free(full);
    return status;
}
