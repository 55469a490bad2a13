#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "convergence_internal.h"

/// Exact values of every field and quantity at the particles of one level.
struct exact_values {
    size_t quantities;
    double **values; ///< [field * quantities + quantity]
};

/// A level of one pass being measured.
struct pass {
    const sphv_convergence *scene;
    size_t level, first; ///< first: the scheme that stands for the pass
    size_t method_count;
    sphv_method methods[SPHV_SCHEMES_MAX]; ///< each once
    const sphv_particles *particles;
    const struct exact_values *exact;
};

/// Progress of one pass as a part of the whole.
struct share {
    sphv_progress progress;
    void *context;
    double from, width;
};

static void pass_on(void *context, double done)
{
    const struct share *share = context;
    if (share->progress) share->progress(share->context, share->from + share->width * done);
}

static sphv_status no_memory(sphv_error *error)
{
    return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
}

static void free_exact(struct exact_values *exact, size_t fields)
{
    for (size_t i = 0; exact->values && i < fields * exact->quantities; i++) free(exact->values[i]);
    free(exact->values);
    exact->values = NULL;
}

static void fill_exact(const sphv_convergence *scene, const sphv_particles *particles,
                       struct exact_values *exact, size_t field)
{
    size_t quantities = exact->quantities;
#pragma omp parallel for schedule(static)
    for (size_t a = 0; a < particles->count; a++) {
        double x[SPHV_DIMENSIONS] = {0}, all[SPHV_QUANTITIES_MAX];
        for (int i = 0; i < particles->dimension; i++) x[i] = particles->x[i][a];
        sphv_field_derivatives(&scene->fields[field], 2, x, all);
        for (size_t q = 0; q < quantities; q++) exact->values[field * quantities + q][a] = all[q];
    }
}

static sphv_status make_exact(const sphv_convergence *scene, const sphv_particles *particles,
                              struct exact_values *exact, sphv_error *error)
{
    exact->quantities = sphv_monomial_count(scene->dimension, 2);
    size_t arrays = scene->field_count * exact->quantities;
    exact->values = calloc(arrays + 1, sizeof *exact->values);
    if (!exact->values) return no_memory(error);
    for (size_t i = 0; i < arrays; i++)
        if (!(exact->values[i] = malloc(particles->count * sizeof **exact->values)))
            return no_memory(error);
    for (size_t f = 0; f < scene->field_count; f++) fill_exact(scene, particles, exact, f);
    return SPHV_OK;
}

/// n_nb: particles nearer than κh to the middle of the box.
static size_t count_about_middle(const sphv_particles *particles, double radius)
{
    size_t count = 0;
#pragma omp parallel for schedule(static) reduction(+ : count)
    for (size_t a = 0; a < particles->count; a++) {
        double square = 0;
        for (int i = 0; i < particles->dimension; i++) {
            double off = particles->x[i][a] - 0.5;
            square += off * off;
        }
        count += square < radius * radius;
    }
    return count;
}

static void count_faults(const sphv_method_estimates *estimates, size_t count, sphv_stage *stage)
{
    memset(stage->faults, 0, sizeof stage->faults);
    stage->worst_condition = NAN;
    for (size_t a = 0; a < count; a++) {
        double condition = estimates->condition[a];
        if (estimates->fault[a] < SPHV_FAULTS) stage->faults[estimates->fault[a]]++;
        if (isfinite(condition) && !(condition <= stage->worst_condition))
            stage->worst_condition = condition;
    }
}

/// Norms of one target; an altered one is compared with an exact value that lacks some terms.
static sphv_status measure_target(const struct pass *pass, const sphv_estimates *estimates,
                                  size_t method, size_t target, sphv_stage *stage,
                                  sphv_error *error)
{
    const sphv_target *of = &pass->scene->targets[target];
    const sphv_particles *particles = pass->particles;
    sphv_rate_point *point = &stage->points[target];
    const double *exact = pass->exact->values[of->field * pass->exact->quantities + of->quantity];
    double *changed = NULL;
    if (of->quantity >= estimates->methods[method].quantities) return SPHV_OK;
    if (of->altered) {
        static const int value[SPHV_DIMENSIONS] = {0, 0, 0};
        changed = malloc(particles->count * sizeof *changed);
        if (!changed) return no_memory(error);
        for (size_t a = 0; a < particles->count; a++) {
            double x[SPHV_DIMENSIONS] = {0};
            for (int i = 0; i < particles->dimension; i++) x[i] = particles->x[i][a];
            changed[a] = of->alone ? 0 : exact[a] - sphv_field_derivative(&of->without, value, x);
        }
        exact = changed;
    }
    point->there = true;
    point->whole =
        sphv_error_norms(particles, estimates, method, of->field, of->quantity, exact, 0);
    // On a lattice κh may be a multiple of Δx: what stands there to rounding is interior on all
    // sides.
    double margin = pass->scene->schemes[pass->first].profile->support * stage->h;
    point->interior =
        sphv_error_norms(particles, estimates, method, of->field, of->quantity, exact, margin);
    free(changed);
    return SPHV_OK;
}

static sphv_status measure_scheme(const struct pass *pass, const sphv_estimates *estimates,
                                  size_t scheme, sphv_stage *stage, sphv_error *error)
{
    size_t method = 0;
    while (pass->methods[method] != pass->scene->schemes[scheme].method) method++;
    count_faults(&estimates->methods[method], estimates->count, stage);
    sphv_status status = SPHV_OK;
    for (size_t t = 0; status == SPHV_OK && t < pass->scene->target_count; t++)
        status = measure_target(pass, estimates, method, t, stage, error);
    return status;
}

static void collect_methods(struct pass *pass)
{
    const sphv_convergence *scene = pass->scene;
    pass->method_count = 0;
    for (size_t s = pass->first; s < scene->scheme_count; s++) {
        const sphv_scheme *scheme = &scene->schemes[s];
        size_t m = 0;
        if (scheme->pass != pass->first || !scheme->has_method) continue;
        while (m < pass->method_count && pass->methods[m] != scheme->method) m++;
        if (m == pass->method_count) pass->methods[pass->method_count++] = scheme->method;
    }
}

/// Measures all schemes of one pass at one level.
static sphv_status measure_pass(sphv_convergence_result *result, struct pass *pass,
                                struct share *share, sphv_error *error)
{
    const sphv_convergence *scene = pass->scene;
    const sphv_scheme *leader = &scene->schemes[pass->first];
    double h = sphv_scheme_h(scene, leader, pass->level);
    size_t neighbours = count_about_middle(pass->particles, leader->profile->support * h);
    for (size_t s = pass->first; s < scene->scheme_count; s++) {
        sphv_stage *stage = &result->stages[pass->level * scene->scheme_count + s];
        if (scene->schemes[s].pass != pass->first) continue;
        stage->particles = pass->particles->count;
        stage->spacing = pass->particles->spacing;
        stage->h = h;
        stage->neighbours = neighbours;
        stage->worst_condition = NAN;
    }
    collect_methods(pass);
    if (!pass->method_count || !scene->field_count) return SPHV_OK;
    const double *fields[SPHV_RATE_FIELDS_MAX];
    for (size_t f = 0; f < scene->field_count; f++)
        fields[f] = pass->exact->values[f * pass->exact->quantities];
    sphv_request request = {.profile = leader->profile,
                            .h = h,
                            .method_count = pass->method_count,
                            .methods = pass->methods,
                            .field_count = scene->field_count,
                            .fields = fields,
                            .route = SPHV_ROUTE_AUTOMATIC};
    sphv_estimates estimates;
    sphv_status status =
        sphv_estimate_particles(pass->particles, &request, pass_on, share, &estimates, error);
    if (status != SPHV_OK) return status;
    result->pairs += estimates.pairs;
    for (size_t s = pass->first; status == SPHV_OK && s < scene->scheme_count; s++)
        if (scene->schemes[s].pass == pass->first && scene->schemes[s].has_method)
            status = measure_scheme(pass, &estimates, s,
                                    &result->stages[pass->level * scene->scheme_count + s], error);
    sphv_estimates_free(&estimates);
    return status;
}

/// Work of a pass in pairs, near enough for a progress bar.
static double work_of(const sphv_convergence *scene, size_t level, size_t scheme)
{
    const sphv_scheme *of = &scene->schemes[scheme];
    sphv_box box = sphv_scheme_box(scene, of, level);
    double count = pow((double)box.side, box.dimension);
    double reach = of->profile->support * sphv_scheme_h(scene, of, level) / sphv_box_spacing(&box);
    return count * (300 + fmin(count, pow(2 * reach + 1, box.dimension)));
}

static double all_work(const sphv_convergence *scene)
{
    double work = 0;
    for (size_t l = 0; l < scene->level_count; l++)
        for (size_t s = 0; s < scene->scheme_count; s++)
            if (scene->schemes[s].pass == s) work += work_of(scene, l, s);
    return work;
}

/// Measures all passes over one box at one level. Density volumes depend on kernel and h, so each
/// pass has particles of its own then.
static sphv_status measure_box(sphv_convergence_result *result, size_t level, size_t box,
                               struct share *share, double per_work, sphv_error *error)
{
    const sphv_convergence *scene = result->scene;
    bool density = scene->boxes[box].box.volume == SPHV_VOLUME_DENSITY, made = false;
    sphv_particles particles = {0};
    struct exact_values exact = {0, NULL};
    sphv_status status = SPHV_OK;
    for (size_t s = 0; status == SPHV_OK && s < scene->scheme_count; s++) {
        const sphv_scheme *scheme = &scene->schemes[s];
        if (scheme->pass != s || scheme->box != box) continue;
        if (!made || density) {
            sphv_box of = sphv_scheme_box(scene, scheme, level);
            if (made) sphv_particles_free(&particles);
            free_exact(&exact, scene->field_count);
            status = sphv_particles_make(&of, density ? scheme->profile : NULL,
                                         density ? sphv_scheme_h(scene, scheme, level) : 0,
                                         &particles, error);
            made = status == SPHV_OK;
            if (made) status = make_exact(scene, &particles, &exact, error);
            if (status != SPHV_OK) break;
        }
        struct pass pass = {
            .scene = scene, .level = level, .first = s, .particles = &particles, .exact = &exact};
        share->width = per_work * work_of(scene, level, s);
        status = measure_pass(result, &pass, share, error);
        share->from += share->width;
    }
    free_exact(&exact, scene->field_count);
    if (made) sphv_particles_free(&particles);
    return status;
}

static sphv_status measure(sphv_convergence_result *result, sphv_progress progress, void *context,
                           sphv_error *error)
{
    const sphv_convergence *scene = result->scene;
    struct share share = {progress, context, 0, 0};
    // The rest of the bar is theory's.
    double per_work = 0.9 / all_work(scene);
    sphv_status status = SPHV_OK;
    for (size_t l = 0; status == SPHV_OK && l < scene->level_count; l++)
        for (size_t b = 0; status == SPHV_OK && b < scene->box_count; b++)
            status = measure_box(result, l, b, &share, per_work, error);
    return status;
}

static sphv_status allocate(sphv_convergence_result *result, sphv_error *error)
{
    const sphv_convergence *scene = result->scene;
    const sphv_rate_table *table = scene->table;
    size_t stages = scene->level_count * scene->scheme_count;
    result->stages = calloc(stages, sizeof *result->stages);
    result->claims = calloc(scene->claim_count + 1, sizeof *result->claims);
    if (!result->stages || !result->claims) return no_memory(error);
    for (size_t i = 0; i < stages; i++) {
        result->stages[i].points =
            calloc(scene->target_count + 1, sizeof *result->stages[i].points);
        if (!result->stages[i].points) return no_memory(error);
    }
    if (!table) return SPHV_OK;
    result->cells = calloc(table->row_count * table->column_count, sizeof *result->cells);
    result->groups = calloc(table->group_count, sizeof *result->groups);
    if (!result->cells || !result->groups) return no_memory(error);
    for (size_t i = 0; i < table->row_count * table->column_count; i++) {
        result->cells[i].evidence =
            calloc(table->cells[i].evidence_count + 1, sizeof *result->cells[i].evidence);
        if (!result->cells[i].evidence) return no_memory(error);
    }
    return SPHV_OK;
}

sphv_status sphv_convergence_run(const sphv_convergence *scene, sphv_progress progress,
                                 void *context, sphv_convergence_result **out, sphv_error *error)
{
    struct timespec start, end;
    clock_gettime(CLOCK_MONOTONIC, &start);
    sphv_error reason;
    sphv_convergence_result *result = calloc(1, sizeof *result);
    if (!result) return no_memory(error);
    result->scene = scene;
    sphv_status status = allocate(result, &reason);
    if (status == SPHV_OK) status = measure(result, progress, context, &reason);
    if (status == SPHV_OK) status = sphv_convergence_predict(result, progress, context, &reason);
    if (status != SPHV_OK) {
        sphv_convergence_result_free(result);
        return sphv_fail(error, status, "%s: %s", scene->name, reason.message);
    }
    sphv_convergence_judge(result);
    if (progress) progress(context, 1);
    clock_gettime(CLOCK_MONOTONIC, &end);
    result->seconds =
        (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    *out = result;
    return SPHV_OK;
}

void sphv_convergence_result_free(sphv_convergence_result *result)
{
    if (!result) return;
    const sphv_convergence *scene = result->scene;
    for (size_t i = 0; result->stages && i < scene->level_count * scene->scheme_count; i++)
        free(result->stages[i].points);
    for (size_t i = 0; result->cells && i < scene->table->row_count * scene->table->column_count;
         i++)
        free(result->cells[i].evidence);
    free(result->stages);
    free(result->cells);
    free(result->groups);
    free(result->claims);
    free(result);
}
