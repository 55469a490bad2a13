#include "sphverify/check.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "candidate.h"
#include "core/constant_text.h"

/// When a check is run.
typedef enum occasion {
    ONCE,           ///< whatever the dimension
    EACH_SHAPE,     ///< once, or per dimension when w itself depends on it
    EACH_DIMENSION, ///< in every dimension examined
    DECLARED,       ///< in every dimension declared or claimed, legal or not
} occasion;

/// One check.
struct row {
    sphv_check_row about;
    occasion occasion;
    bool thorough; ///< left out by `quick`
    sphv_check_function run;
};

static const struct row rows[] = {
    {{"dimension", "∫W dV > 0, so that a constant normalises the kernel in that dimension"},
     DECLARED,
     false,
     sphv_check_dimension_legality},
    {{"support", "w vanishes at and beyond κ and nowhere before"},
     EACH_SHAPE,
     false,
     sphv_check_support},
    {{"peak", "w(0) > 0 is the largest value"}, EACH_SHAPE, false, sphv_check_peak},
    {{"evenness", "W(−x) = W(x) is smooth at the origin, or has a cone that is meant"},
     EACH_SHAPE,
     false,
     sphv_check_evenness},
    {{"boundary-smoothness", "β: w and its derivatives up to order β vanish at κ"},
     EACH_SHAPE,
     false,
     sphv_check_boundary},
    {{"continuity", "value, slope and curvature do not jump at interior knots"},
     EACH_SHAPE,
     false,
     sphv_check_continuity},
    {{"monotone", "w decreases from the origin to κ"}, EACH_SHAPE, false, sphv_check_monotone},
    {{"sign", "w is nowhere negative"}, EACH_SHAPE, false, sphv_check_sign},
    {{"derivative", "the file's own gradient is the derivative of w"},
     ONCE,
     false,
     sphv_check_derivative},
    {{"normalisation", "the claimed constant makes ∫W dV = 1"},
     EACH_DIMENSION,
     false,
     sphv_check_normalisation},
    {{"moments", "μ_j = ∫|s|^j Ŵ dV"}, EACH_DIMENSION, false, sphv_check_moments},
    {{"smoothing-order", "order in h of the smoothing error"},
     EACH_DIMENSION,
     false,
     sphv_check_smoothing_order},
    {{"truncation-error", "error of the gradient of a sine on a lattice"},
     EACH_DIMENSION,
     true,
     sphv_check_truncation},
    {{"discretisation-order", "order in Δx/h of the discretisation error"},
     EACH_DIMENSION,
     true,
     sphv_check_order},
    {{"fourier", "first wavenumber at which the Fourier transform is negative (pairing)"},
     EACH_DIMENSION,
     true,
     sphv_check_fourier},
    {{"implementation", "a compiled library behaves, and computes the file's kernel"},
     ONCE,
     false,
     sphv_check_implementation},
};

enum { ROWS = sizeof rows / sizeof *rows };

const sphv_check_row *sphv_check_row_at(size_t index)
{
    return index < ROWS ? &rows[index].about : NULL;
}

sphv_check_result *sphv_check_add(sphv_examination *of, const char *id, int dimension,
                                  sphv_error *error)
{
    sphv_check_report *report = of->report;
    if (report->count == report->capacity) {
        size_t capacity = report->capacity ? 2 * report->capacity : 32;
        sphv_check_result *grown = realloc(report->results, capacity * sizeof *grown);
        if (!grown) {
            (void)sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
            return NULL;
        }
        report->results = grown;
        report->capacity = capacity;
    }
    sphv_check_result *result = &report->results[report->count++];
    *result = (sphv_check_result){.id = id, .dimension = dimension};
    result->claimed = result->analytic = result->empirical = NAN;
    result->verdict = SPHV_AGREES;
    return result;
}

/// Ends a text that was cut off inside a UTF-8 character before that character.
static void mend_utf8(char *text)
{
    size_t length = strlen(text), start = length;
    while (start > 0 && ((unsigned char)text[start - 1] & 0xC0) == 0x80) start--;
    if (start == 0) return;
    unsigned char lead = (unsigned char)text[start - 1];
    size_t wanted = lead < 0x80 ? 0 : lead < 0xE0 ? 1 : lead < 0xF0 ? 2 : 3;
    if (length - start < wanted) text[start - 1] = '\0';
}

void sphv_check_claim(sphv_check_result *result, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(result->claim, sizeof result->claim, format, arguments);
    va_end(arguments);
    mend_utf8(result->claim);
}

void sphv_check_cause(sphv_check_result *result, const char *format, ...)
{
    size_t used = strlen(result->cause);
    if (used && used + 3 < sizeof result->cause) {
        memcpy(result->cause + used, "; ", 3);
        used += 2;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(result->cause + used, sizeof result->cause - used, format, arguments);
    va_end(arguments);
    mend_utf8(result->cause);
}

void sphv_check_numbers(sphv_check_result *result, double analytic, double empirical, double bound)
{
    result->analytic = analytic;
    result->empirical = empirical;
    result->bound = bound;
    double difference = fabs(analytic - empirical);
    if (!isfinite(difference) || !isfinite(bound))
        result->verdict = sphv_verdict_worse(result->verdict, SPHV_INCONCLUSIVE);
    else if (difference > bound)
        result->verdict = SPHV_DISAGREES;
}

void sphv_check_fail(sphv_check_result *result)
{
    result->verdict = SPHV_DISAGREES;
}

const sphv_profile *sphv_check_profile(const sphv_examination *of, int dimension)
{
    return sphv_kernel_profile(of->kernel, dimension ? dimension : of->first_dimension);
}

int sphv_check_shape_dimension(const sphv_examination *of, int dimension)
{
    return of->shape_varies ? dimension : 0;
}

bool sphv_check_truncated(const sphv_examination *of)
{
    return !of->kernel->polynomial && of->kernel->form.family->truncated;
}

/// Claimed constant over C_d, 1 where none is claimed.
static double claimed_ratio(const sphv_kernel *kernel, int d)
{
    const char *text = kernel->claims.constant[d - 1];
    const sphv_profile *profile = sphv_kernel_profile(kernel, d);
    sphv_error unused;
    long double value;
    if (!text || !profile || sphv_constant_parse(text, &value, &unused) != SPHV_OK) return 1;
    return (double)(value / (long double)profile->constant.value);
}

static bool examined(const sphv_examination *of, int d, occasion when)
{
    if (of->options->dimension && of->options->dimension != d) return false;
    if (when == DECLARED) return of->kernel->declared[d - 1] || of->kernel->claims.constant[d - 1];
    if (!sphv_kernel_profile(of->kernel, d)) return false;
    return when == EACH_DIMENSION || of->shape_varies || d == of->first_dimension;
}

static sphv_status run_row(sphv_examination *of, const struct row *row, sphv_error *error)
{
    sphv_status status = SPHV_OK;
    if (row->thorough && of->options->quick) return SPHV_OK;
    if (row->occasion == ONCE) return row->run(of, of->first_dimension, error);
    for (int d = 1; status == SPHV_OK && d <= SPHV_DIMENSIONS; d++)
        if (examined(of, d, row->occasion)) status = row->run(of, d, error);
    return status;
}

/// Is w another function in another dimension (a fourth-order transform, the super-Gaussian)?
static bool shape_varies(const sphv_kernel *kernel)
{
    const sphv_profile *first = NULL;
    if (kernel->fourth_order) return true;
    for (int d = 1; !kernel->polynomial && d <= SPHV_DIMENSIONS; d++) {
        const sphv_profile *other = sphv_kernel_profile(kernel, d);
        if (!other) continue;
        if (!first) first = other;
        double q = other->support / 3;
        double one = sphv_profile_derivative(first, 0, q).value / first->constant.value;
        double two = sphv_profile_derivative(other, 0, q).value / other->constant.value;
        if (fabs(one - two) > 1e-9 * fabs(one)) return true;
    }
    return false;
}

static void begin(sphv_examination *of, const sphv_kernel *kernel, sphv_check_report *out)
{
    snprintf(out->kernel, sizeof out->kernel, "%s", sphv_kernel_name(kernel));
    snprintf(out->title, sizeof out->title, "%s", sphv_kernel_title(kernel));
    snprintf(out->path, sizeof out->path, "%s", sphv_kernel_path(kernel));
    mend_utf8(out->title);
    mend_utf8(out->path);
    for (int d = SPHV_DIMENSIONS; d >= 1; d--) {
        of->claimed_ratio[d - 1] = claimed_ratio(kernel, d);
        of->tolerance[d - 1] = SPHV_CONSTANT_TOLERANCE;
        if (kernel->polynomial)
            of->tolerance[d - 1] += sphv_candidate_constant_rounding(&kernel->pieces, d);
        if (examined(of, d, EACH_DIMENSION)) of->first_dimension = d;
    }
    of->shape_varies = shape_varies(kernel);
}

/// The worst verdict, and the cause that tells most: a repair that fits, else the first one named.
static void conclude(sphv_examination *of)
{
    sphv_check_report *report = of->report;
    if (*of->repair) snprintf(report->cause, sizeof report->cause, "%s", of->repair);
    for (size_t i = 0; i < report->count; i++) {
        const sphv_check_result *result = &report->results[i];
        report->verdict = sphv_verdict_worse(report->verdict, result->verdict);
        if (result->verdict != SPHV_AGREES && !*report->cause)
            snprintf(report->cause, sizeof report->cause, "%s", result->cause);
    }
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

sphv_status sphv_check_kernel(const sphv_kernel *kernel, const sphv_check_options *options,
                              sphv_check_report *out, sphv_error *error)
{
    *out = (sphv_check_report){.verdict = SPHV_AGREES};
    sphv_examination of = {.kernel = kernel, .options = options, .report = out};
    double start = now();
    int d = options->dimension;
    if (d && (d < 1 || d > SPHV_DIMENSIONS || !kernel->declared[d - 1]))
        return sphv_fail(error, SPHV_INVALID_INPUT, "%s: %s; allowed: a declared dimension",
                         sphv_kernel_path(kernel), sphv_kernel_refusal(kernel, d));
    begin(&of, kernel, out);
    sphv_status status = SPHV_OK;
    for (int i = 0; status == SPHV_OK && i < ROWS; i++) {
        // Without a legal dimension there is nothing but the question of legality.
        if (!of.first_dimension && rows[i].occasion != DECLARED) continue;
        status = run_row(&of, &rows[i], error);
    }
    if (status != SPHV_OK) {
        sphv_check_free(out);
        return status;
    }
    conclude(&of);
    out->seconds = now() - start;
    return SPHV_OK;
}

void sphv_check_free(sphv_check_report *report)
{
    free(report->results);
    *report = (sphv_check_report){.verdict = SPHV_INCONCLUSIVE};
}
