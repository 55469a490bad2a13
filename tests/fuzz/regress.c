/// Drives a fuzz target without libFuzzer:
///
///     regress FOLDER…    every file of the folders, whole, truncated and mutated, and a list of
///                        inputs made to hang or to exhaust parsers
///
/// The seed of the mutations is printed; SPHVERIFY_TEST_SEED repeats it. An input that takes
/// longer than the limit ends the test with its description.
#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "target.h"

enum { SECONDS = 20, MIB = 1 << 20, MUTATIONS = 25, CUTS = 24 };

static char description[4400];
static unsigned long inputs;
static uint64_t random_state;

static const uint8_t *current;
static size_t current_size;

/// Few inputs, for slow checkers such as valgrind.
static int is_quick(void)
{
    return getenv("SPHVERIFY_TEST_QUICK") != NULL;
}

/// Says which input it was, and shows it, on the way out.
static void tell(int number)
{
    const char *what = number == SIGALRM ? "too slow: " : "failed on: ";
    size_t shown = current_size < 4000 ? current_size : 4000;
    if (write(2, what, strlen(what)) < 0 || write(2, description, strlen(description)) < 0 ||
        write(2, current, shown) < 0)
        _exit(98);
    _exit(97);
}

static void feed(const void *bytes, size_t size)
{
    // an exact copy, so that reading one byte beyond it is seen by the sanitizers
    uint8_t *copy = malloc(size ? size : 1);
    if (!copy) exit(99);
    memcpy(copy, bytes, size);
    current = copy;
    current_size = size;
    alarm(SECONDS);
    LLVMFuzzerTestOneInput(copy, size);
    alarm(0);
    free(copy);
    inputs++;
}

/// Marsaglia's xorshift: the mutations need variety, not quality.
static size_t pick(size_t below)
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return (size_t)(random_state >> 11) % below;
}

/// Repeats a pattern up to a size.
static void feed_repeated(const char *head, const char *pattern, size_t size)
{
    size_t at = strlen(head), length = strlen(pattern);
    char *text = malloc(size + length + at + 1);
    if (!text) exit(99);
    memcpy(text, head, at);
    while (at + length <= size) {
        memcpy(text + at, pattern, length);
        at += length;
    }
    snprintf(description, sizeof description, "'%s' and then '%s' to %zu bytes\n", head, pattern,
             size);
    feed(text, at);
    free(text);
}

static void feed_traps(void)
{
    static const char *const patterns[] = {"[",
                                           "{",
                                           "- ",
                                           "? ",
                                           "a: ",
                                           "[a, ",
                                           "{a: ",
                                           "&a ",
                                           "*a ",
                                           "!",
                                           "!!",
                                           "'",
                                           "\"",
                                           "\"\\x41",
                                           "|\n ",
                                           ">\n ",
                                           "\t",
                                           "\n",
                                           "\r",
                                           "#",
                                           "%",
                                           "---\n",
                                           "...\n",
                                           "a\n",
                                           "k: 1\n",
                                           ": ",
                                           ",",
                                           "-",
                                           "&a [*a, ",
                                           "\xef\xbb\xbf",
                                           "\xff",
                                           "\xc3",
                                           "\xe2\x80\xa8",
                                           "1/",
                                           "9",
                                           "e9",
                                           ".",
                                           "name: x\n",
                                           "pieces: [",
                                           "  - {until: 1, coefficients: [\"1\"]}\n"};
    for (size_t i = 0; i < sizeof patterns / sizeof *patterns; i++) {
        feed_repeated("", patterns[i], is_quick() ? 20000 : MIB - 8);
        feed_repeated("name: ", patterns[i], 4096);
        feed_repeated("pieces:\n", patterns[i], is_quick() ? 5000 : 100000);
    }
    uint8_t zeros[4096] = {0};
    snprintf(description, sizeof description, "zeros\n");
    feed(zeros, sizeof zeros);
    feed(zeros, 0);
    for (int i = 0; i < 200; i++) {
        uint8_t noise[300];
        size_t size = pick(sizeof noise);
        for (size_t k = 0; k < size; k++) noise[k] = (uint8_t)pick(256);
        snprintf(description, sizeof description, "noise %d\n", i);
        feed(noise, size);
    }
}

/// Pieces that a mutation may put in place of others.
static const char *const tokens[] = {
    "0",        "-1",          "1e60", "1e-60", "1e-400",
    "nan",      "inf",         "1/0",  "1/3",   "99999999999999999999",
    "''",       "[]",          "{}",   "~",     "null",
    "true",     "*x",          "&x",   "!!int", "\n",
    ": ",       "- ",          "\0",   "\x80",  "1e300",
    "1e9",      "-0",          "0.01", "100",   "sinc",
    "gaussian", "fourth-order"};
enum { TOKENS = sizeof tokens / sizeof *tokens };

static size_t mutate(uint8_t *bytes, size_t size, size_t capacity)
{
    for (size_t round = pick(4) + 1; round > 0 && size > 0; round--) {
        size_t at = pick(size), kind = pick(5);
        const char *token = tokens[pick(TOKENS)];
        size_t length = strlen(token) + (token[0] == '\0');
        if (kind == 0) {
            bytes[at] = (uint8_t)pick(256);
        } else if (kind == 1) { // remove some
            size_t count = pick(size - at < 20 ? size - at : 20);
            memmove(bytes + at, bytes + at + count, size - at - count);
            size -= count;
        } else if (kind == 2 && size + length < capacity) { // insert a token
            memmove(bytes + at + length, bytes + at, size - at);
            memcpy(bytes + at, token, length);
            size += length;
        } else if (kind == 3) { // overwrite a number by a token
            while (at < size && (bytes[at] < '0' || bytes[at] > '9')) at++;
            size_t end = at;
            while (end < size && (bytes[end] == '/' || bytes[end] == '.' ||
                                  (bytes[end] >= '0' && bytes[end] <= '9')))
                end++;
            if (size - (end - at) + length >= capacity) continue;
            memmove(bytes + at + length, bytes + end, size - end);
            memcpy(bytes + at, token, length);
            size = size - (end - at) + length;
        } else if (size * 2 < capacity && pick(8) == 0) { // say it twice
            memcpy(bytes + size, bytes, size);
            size *= 2;
        }
    }
    return size;
}

static void feed_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file) return;
    static uint8_t whole[MIB], changed[MIB];
    size_t size = fread(whole, 1, sizeof whole, file);
    fclose(file);
    snprintf(description, sizeof description, "%s\n", path);
    feed(whole, size);
    for (size_t cut = 1; cut <= CUTS; cut += is_quick() ? 11 : 1) {
        snprintf(description, sizeof description, "%s cut at %zu\n", path, size * cut / CUTS);
        feed(whole, size * cut / CUTS);
    }
    for (int i = 0; i < (is_quick() ? 4 : MUTATIONS); i++) {
        memcpy(changed, whole, size);
        size_t length = mutate(changed, size, sizeof changed);
        snprintf(description, sizeof description, "%s mutation %d\n", path, i);
        feed(changed, length);
    }
}

static void feed_folder(const char *folder)
{
    struct dirent **entries;
    int count = scandir(folder, &entries, NULL, alphasort);
    for (int i = 0; i < count; i++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
        if (entries[i]->d_name[0] != '.') feed_file(path);
        free(entries[i]);
    }
    if (count >= 0) free(entries);
}

int main(int argc, char **argv)
{
    const char *wanted = getenv("SPHVERIFY_TEST_SEED");
    unsigned long seed = wanted ? strtoul(wanted, NULL, 10) : (unsigned long)time(NULL);
    printf("SPHVERIFY_TEST_SEED=%lu\n", seed);
    fflush(stdout);
    random_state = 0x9e3779b97f4a7c15U ^ (seed * 2654435761U);
    signal(SIGALRM, tell);
    signal(SIGABRT, tell);
    feed_traps();
    for (int i = 1; i < argc; i++) feed_folder(argv[i]);
    printf("%lu inputs\n", inputs);
    return 0;
}
