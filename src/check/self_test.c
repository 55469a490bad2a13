#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "defects.h"

enum { VARIANTS_MAX = 64, ROWS_MAX = 32 };

/// The outcome of all variants of one defect on one kernel.
struct outcome {
    int applied, unchanged, caught, named;
    int by[ROWS_MAX]; ///< how many were caught by each row of the table of checks
    char missed[120], unnamed[120];
};

static const sphv_defect *const tables[] = {sphv_shape_defects, sphv_claim_defects,
                                            sphv_gradient_defects};

static size_t count_defects(void)
{
    size_t count = 0;
    for (size_t t = 0; t < sizeof tables / sizeof *tables; t++)
        for (const sphv_defect *defect = tables[t]; defect->id; defect++) count++;
    return count;
}

static const sphv_defect *defect_at(size_t index)
{
    for (size_t t = 0; t < sizeof tables / sizeof *tables; t++)
        for (const sphv_defect *defect = tables[t]; defect->id; defect++)
            if (index-- == 0) return defect;
    return NULL;
}

static int row_of(const char *id)
{
    // `unit-integral` belongs to the row that computes it.
    if (strcmp(id, "unit-integral") == 0) id = "normalisation";
    int i = 0;
    for (const sphv_check_row *row; (row = sphv_check_row_at((size_t)i)) && i + 1 < ROWS_MAX; i++)
        if (strcmp(row->id, id) == 0) break;
    return i;
}

/// Does a text contain one of several words, separated by `|`?
static bool contains_any(const char *text, const char *words)
{
    char word[64];
    while (*words) {
        size_t length = strcspn(words, "|");
        if (length < sizeof word) {
            memcpy(word, words, length);
            word[length] = '\0';
            if (strstr(text, word)) return true;
        }
        words += length + (words[length] == '|');
    }
    return false;
}

static void record(struct outcome *outcome, const sphv_check_report *report,
                   const sphv_defect *defect, int variant)
{
    bool by[ROWS_MAX] = {false}, named = false;
    for (size_t i = 0; i < report->count; i++) {
        if (report->results[i].verdict == SPHV_AGREES) continue;
        by[row_of(report->results[i].id)] = true;
        named = named || contains_any(report->results[i].cause, defect->cause);
    }
    for (int i = 0; i < ROWS_MAX; i++) outcome->by[i] += by[i];
    outcome->caught++;
    outcome->named += named;
    if (!named && !*outcome->unnamed)
        snprintf(outcome->unnamed, sizeof outcome->unnamed, "%s variant %d", report->kernel,
                 variant);
}

static sphv_status try_variant(const sphv_kernel *sound, const sphv_catalogue *catalogue,
                               const sphv_defect *defect, int variant, bool *more,
                               struct outcome *outcome, sphv_error *error)
{
    sphv_kernel *faulty = sphv_defect_copy(sound);
    if (!faulty) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    sphv_application application = defect->apply(faulty, variant);
    sphv_status status = SPHV_OK;
    *more = application != SPHV_NO_MORE;
    if (application == SPHV_APPLIED && !sphv_defect_changes(sound, faulty)) {
        outcome->unchanged++;
    } else if (application == SPHV_APPLIED) {
        sphv_check_options options = {.quick = true, .reference = catalogue};
        sphv_check_report report;
        outcome->applied++;
        // One that no dimension can normalise is checked all the same, as the command does.
        status = sphv_kernel_compile(faulty, error);
        if (status != SPHV_RESOURCE_FAILURE)
            status = sphv_check_kernel(faulty, &options, &report, error);
        if (status == SPHV_OK && report.verdict != SPHV_AGREES)
            record(outcome, &report, defect, variant);
        else if (status == SPHV_OK && !*outcome->missed)
            snprintf(outcome->missed, sizeof outcome->missed, "%s variant %d",
                     sphv_kernel_name(sound), variant);
        if (status == SPHV_OK) sphv_check_free(&report);
    }
    sphv_kernel_free(faulty);
    return status;
}

static sphv_status try_defect(const sphv_kernel *sound, const sphv_catalogue *catalogue,
                              const sphv_defect *defect, struct outcome *outcome, sphv_error *error)
{
    sphv_status status = SPHV_OK;
    bool more = true;
    for (int variant = 0; status == SPHV_OK && more && variant < VARIANTS_MAX; variant++)
        status = try_variant(sound, catalogue, defect, variant, &more, outcome, error);
    return status;
}

static void append_check(sphv_defect_tally *tally, const char *id, int count)
{
    size_t used = strlen(tally->checks);
    if (count)
        snprintf(tally->checks + used, sizeof tally->checks - used, "%s%s %d", used ? ", " : "", id,
                 count);
}

/// Adds up the outcomes over kernels, most frequent check first.
static void tally_up(sphv_defect_tally *tally, const struct outcome *outcomes, size_t kernels)
{
    int by[ROWS_MAX] = {0};
    for (size_t k = 0; k < kernels; k++) {
        const struct outcome *outcome = &outcomes[k];
        tally->applied += outcome->applied;
        tally->unchanged += outcome->unchanged;
        tally->caught += outcome->caught;
        tally->named += outcome->named;
        for (int i = 0; i < ROWS_MAX; i++) by[i] += outcome->by[i];
        if (*outcome->missed && !*tally->missed)
            snprintf(tally->missed, sizeof tally->missed, "%s", outcome->missed);
        if (*outcome->unnamed && !*tally->unnamed)
            snprintf(tally->unnamed, sizeof tally->unnamed, "%s", outcome->unnamed);
    }
    for (;;) {
        int most = 0;
        for (int i = 1; i < ROWS_MAX; i++)
            if (by[i] > by[most]) most = i;
        const sphv_check_row *row = sphv_check_row_at((size_t)most);
        if (!row || by[most] == 0) break;
        append_check(tally, row->id, by[most]);
        by[most] = 0;
    }
}

static sphv_status check_sound(const sphv_catalogue *catalogue, sphv_self_test *out,
                               sphv_error *error)
{
    sphv_status status = SPHV_OK;
#pragma omp parallel for schedule(dynamic)
    for (size_t k = 0; k < catalogue->count; k++) {
        sphv_check_options options = {.reference = catalogue};
        sphv_check_report report;
        sphv_error own;
        sphv_status found = sphv_check_kernel(catalogue->kernels[k], &options, &report, &own);
#pragma omp critical(sphv_self_test)
        {
            out->kernels++;
            if (found != SPHV_OK) {
                status = found;
                *error = own;
            } else if (report.verdict != SPHV_AGREES) {
                out->false_alarms++;
                for (size_t i = 0; i < report.count && !*out->alarm; i++)
                    if (report.results[i].verdict != SPHV_AGREES)
                        snprintf(out->alarm, sizeof out->alarm, "%s: %s", report.kernel,
                                 report.results[i].id);
            }
        }
        if (found == SPHV_OK) sphv_check_free(&report);
    }
    return status;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static sphv_status check_faulty(const sphv_catalogue *catalogue, struct outcome *outcomes,
                                sphv_progress progress, void *context, sphv_error *error)
{
    size_t defects = count_defects(), jobs = defects * catalogue->count, done = 0;
    sphv_status status = SPHV_OK;
#pragma omp parallel for schedule(dynamic)
    for (size_t job = 0; job < jobs; job++) {
        sphv_error own;
        sphv_status found = try_defect(catalogue->kernels[job % catalogue->count], catalogue,
                                       defect_at(job / catalogue->count), &outcomes[job], &own);
#pragma omp critical(sphv_self_test)
        {
            if (found != SPHV_OK) {
                status = found;
                *error = own;
            }
            if (progress) progress(context, (double)++done / (double)jobs);
        }
    }
    return status;
}

sphv_status sphv_check_self_test(const sphv_catalogue *catalogue, sphv_progress progress,
                                 void *context, sphv_self_test *out, sphv_error *error)
{
    double start = now();
    size_t defects = count_defects();
    *out = (sphv_self_test){.verdict = SPHV_AGREES};
    struct outcome *outcomes = calloc(defects * catalogue->count + 1, sizeof *outcomes);
    out->defects = calloc(defects, sizeof *out->defects);
    sphv_status status = SPHV_OK;
    if (!outcomes || !out->defects)
        status = sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    if (status == SPHV_OK) status = check_sound(catalogue, out, error);
    if (status == SPHV_OK) status = check_faulty(catalogue, outcomes, progress, context, error);
    for (size_t i = 0; status == SPHV_OK && i < defects; i++) {
        sphv_defect_tally *tally = &out->defects[out->count++];
        tally->id = defect_at(i)->id;
        tally->meaning = defect_at(i)->meaning;
        tally_up(tally, &outcomes[i * catalogue->count], catalogue->count);
        if (tally->caught < tally->applied) out->verdict = SPHV_DISAGREES;
    }
    if (out->false_alarms) out->verdict = SPHV_DISAGREES;
    free(outcomes);
    out->seconds = now() - start;
    if (status != SPHV_OK) sphv_self_test_free(out);
    return status;
}

void sphv_self_test_free(sphv_self_test *test)
{
    free(test->defects);
    *test = (sphv_self_test){.verdict = SPHV_INCONCLUSIVE};
}
