#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "convergence_reader.h"
#include "core/directory.h"

/// More than a day of one processor.
static const double pairs_max = 1e14;

static sphv_status no_memory(sphv_error *error)
{
    return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
}

/// `side` with side^d == N.
static sphv_status read_side(const struct sphv_rates_reader *of, unsigned index, size_t *side)
{
    char place[64];
    double count = 0;
    const char *text = of->file->particles[index];
    snprintf(place, sizeof place, "particles.%u", index);
    sphv_status status = sphv_rates_number(of, place, text, 0, &count);
    if (status != SPHV_OK) return status;
    double root = floor(pow(fmax(count, 0), 1.0 / of->scene->dimension) + 0.5);
    if (!(count >= 1 && count <= SPHV_BOX_PARTICLES_MAX) ||
        pow(root, of->scene->dimension) != count)
        return SPHV_RATES_FAIL(of, place,
                               "%s particles in %d dimensions; allowed: side^%d, at most %g", text,
                               of->scene->dimension, of->scene->dimension, SPHV_BOX_PARTICLES_MAX);
    *side = (size_t)root;
    return SPHV_OK;
}

static sphv_status read_levels(const struct sphv_rates_reader *of)
{
    const struct sphv_rates_file *file = of->file;
    sphv_convergence *scene = of->scene;
    scene->over_ratio = file->ratios_count > 0;
    scene->level_count = scene->over_ratio ? file->ratios_count : file->particles_count;
    scene->levels = calloc(scene->level_count + 1, sizeof *scene->levels);
    if (!scene->levels) return no_memory(of->error);
    if (scene->over_ratio && file->particles_count != 1)
        return SPHV_RATES_FAIL(of, "particles",
                               "%u numbers of particles beside 'ratios'; allowed: "
                               "one",
                               file->particles_count);
    sphv_status status = SPHV_OK;
    for (unsigned i = 0; status == SPHV_OK && i < scene->level_count; i++) {
        status = read_side(of, scene->over_ratio ? 0 : i, &scene->levels[i].side);
        if (status != SPHV_OK || !scene->over_ratio) continue;
        char place[64];
        snprintf(place, sizeof place, "ratios.%u", i);
        status = sphv_rates_number(of, place, file->ratios[i], 0, &scene->levels[i].ratio);
        if (status == SPHV_OK && !(scene->levels[i].ratio > 0 && scene->levels[i].ratio <= 1000))
            status = SPHV_RATES_FAIL(of, place, "h/Δx = %s; allowed: above 0 and at most 1000",
                                     file->ratios[i]);
    }
    return status;
}

static sphv_status read_box(const struct sphv_rates_reader *of, unsigned index)
{
    const struct sphv_rates_box *file = &of->file->boxes[index];
    sphv_named_box *named = &of->scene->boxes[index];
    sphv_box *box = &named->box;
    char place[64];
    int layout = 0, placement = 0, jitter = 0, volume = 0;
    snprintf(place, sizeof place, "boxes.%u", index);
    for (unsigned i = 0; i < index; i++)
        if (strcmp(of->file->boxes[i].id, file->id) == 0)
            return SPHV_RATES_FAIL(of, place, "box '%s' again; allowed: each id once", file->id);
    sphv_status status = sphv_copy_text(file->id, &named->id, of->error);
    if (status == SPHV_OK)
        status = sphv_rates_name(of, place, file->layout, sphv_layouts, 0, &layout);
    if (status == SPHV_OK)
        status = sphv_rates_name(of, place, file->placement, sphv_placements, SPHV_PLACEMENT_VERTEX,
                                 &placement);
    if (status == SPHV_OK)
        status =
            sphv_rates_name(of, place, file->jitter, sphv_jitters, SPHV_JITTER_UNIFORM, &jitter);
    if (status == SPHV_OK)
        status = sphv_rates_name(of, place, file->volume, sphv_volumes, 0, &volume);
    if (status == SPHV_OK)
        status = sphv_rates_number(of, place, file->amplitude, 0, &box->amplitude);
    if (status != SPHV_OK) return status;
    box->dimension = of->scene->dimension;
    box->layout = (sphv_layout)layout;
    box->placement = (sphv_placement)placement;
    box->jitter = (sphv_jitter)jitter;
    box->volume = (sphv_volume)volume;
    box->reflected = file->reflected && *file->reflected;
    box->seed = file->seed ? *file->seed : 1;
    for (size_t i = 0; i < of->scene->level_count; i++) {
        sphv_error reason;
        box->side = of->scene->levels[i].side;
        if (sphv_box_check(box, &reason) != SPHV_OK)
            return SPHV_RATES_FAIL(of, place, "box '%s': %s", file->id, reason.message);
    }
    return SPHV_OK;
}

sphv_status sphv_rates_read_particles(const struct sphv_rates_reader *of)
{
    sphv_convergence *scene = of->scene;
    scene->dimension = of->file->dimension;
    if (scene->dimension < 1 || scene->dimension > SPHV_DIMENSIONS)
        return SPHV_RATES_FAIL(of, "dimension", "%d dimensions; allowed: 1 to %d", scene->dimension,
                               SPHV_DIMENSIONS);
    sphv_status status = read_levels(of);
    if (status != SPHV_OK) return status;
    scene->boxes = calloc(of->file->boxes_count, sizeof *scene->boxes);
    if (!scene->boxes) return no_memory(of->error);
    for (unsigned i = 0; status == SPHV_OK && i < of->file->boxes_count; i++) {
        scene->box_count = i + 1;
        status = read_box(of, i);
    }
    return status;
}

static sphv_status read_h(const struct sphv_rates_reader *of, unsigned index, sphv_scheme *scheme)
{
    const struct sphv_rates_h *file = &of->file->schemes[index].h;
    static const sphv_name_row rules[] = {
        {"spacing", ""}, {"particles", ""}, {"ratio", ""}, {NULL, NULL}};
    char place[64];
    int rule = 0;
    snprintf(place, sizeof place, "schemes.%u.h", index);
    sphv_status status = sphv_rates_name(of, place, file->of, rules, 0, &rule);
    if (status == SPHV_OK) status = sphv_copy_text(file->factor, &scheme->factor_text, of->error);
    if (status == SPHV_OK)
        status = sphv_rates_constant(of, place, file->factor, 1, &scheme->factor);
    if (status == SPHV_OK)
        status = sphv_rates_number(of, place, file->exponent, 0, &scheme->exponent);
    if (status != SPHV_OK) return status;
    scheme->rule = (sphv_h_rule)rule;
    if ((file->exponent != NULL) != (scheme->rule == SPHV_H_OF_PARTICLES))
        return SPHV_RATES_FAIL(of, place,
                               "scheme '%s': 'exponent' %s; allowed: with and only with "
                               "'of: particles'",
                               scheme->id, file->exponent ? "is given" : "is missing");
    if ((scheme->rule == SPHV_H_OF_RATIO) != of->scene->over_ratio)
        return SPHV_RATES_FAIL(of, place,
                               "scheme '%s': h of %s; allowed: 'of: ratio' with and "
                               "only with 'ratios'",
                               scheme->id, file->of);
    // Both ends of the levels, and with them all.
    for (size_t i = 0; i < of->scene->level_count; i++) {
        sphv_box box = of->scene->boxes[scheme->box].box;
        box.side = of->scene->levels[i].side;
        double h = sphv_scheme_h(of->scene, scheme, i),
               count = pow((double)box.side, box.dimension);
        double near = fmin(count, pow(2 * scheme->profile->support * h / sphv_box_spacing(&box) + 1,
                                      box.dimension));
        if (!(h > 0 && h <= SPHV_H_MAX) || !(count * near <= pairs_max))
            return SPHV_RATES_FAIL(of, place,
                                   "scheme '%s': h = %.6g with %.0f particles; allowed: "
                                   "above 0, at most %g, and %g pairs",
                                   scheme->id, h, count, SPHV_H_MAX, pairs_max);
    }
    return SPHV_OK;
}

static bool same_pass(const sphv_scheme *a, const sphv_scheme *b)
{
    return a->box == b->box && a->rule == b->rule && a->factor == b->factor &&
           a->exponent == b->exponent &&
           strcmp(sphv_kernel_path(a->kernel), sphv_kernel_path(b->kernel)) == 0;
}

static sphv_status read_scheme(const struct sphv_rates_reader *of, unsigned index)
{
    const struct sphv_rates_scheme *file = &of->file->schemes[index];
    sphv_convergence *scene = of->scene;
    sphv_scheme *scheme = &scene->schemes[index];
    sphv_error reason;
    char place[64];
    snprintf(place, sizeof place, "schemes.%u", index);
    for (unsigned i = 0; i < index; i++)
        if (strcmp(of->file->schemes[i].id, file->id) == 0)
            return SPHV_RATES_FAIL(of, place, "scheme '%s' again; allowed: each id once", file->id);
    sphv_status status = sphv_copy_text(file->id, &scheme->id, of->error);
    if (status == SPHV_OK) status = sphv_copy_text(file->label, &scheme->label, of->error);
    if (status != SPHV_OK) return status;
    while (file->box && scheme->box < scene->box_count &&
           strcmp(scene->boxes[scheme->box].id, file->box) != 0)
        scheme->box++;
    if (scheme->box == scene->box_count)
        return SPHV_RATES_FAIL(of, place, "no box '%s'; allowed: the ids of this scene's boxes",
                               file->box);
    status = sphv_read_kernel(of->yaml, place, of->data_directory, file->kernel, &scheme->kernel,
                              of->error);
    if (status != SPHV_OK) return status;
    scheme->profile = sphv_kernel_profile(scheme->kernel, scene->dimension);
    if (!scheme->profile)
        return SPHV_RATES_FAIL(of, place, "kernel '%s' is not legal in %d dimensions: %s",
                               file->kernel, scene->dimension,
                               sphv_kernel_refusal(scheme->kernel, scene->dimension));
    scheme->has_method = file->method != NULL;
    if (file->method && sphv_method_parse(file->method, &scheme->method, &reason) != SPHV_OK)
        return SPHV_RATES_FAIL(of, place, "%s", reason.message);
    status = read_h(of, index, scheme);
    scheme->pass = 0;
    while (status == SPHV_OK && scheme->pass < index &&
           !same_pass(&scene->schemes[scheme->pass], scheme))
        scheme->pass++;
    return status;
}

sphv_status sphv_rates_read_schemes(const struct sphv_rates_reader *of)
{
    sphv_convergence *scene = of->scene;
    scene->schemes = calloc(of->file->schemes_count, sizeof *scene->schemes);
    if (!scene->schemes) return no_memory(of->error);
    sphv_status status = SPHV_OK;
    for (unsigned i = 0; status == SPHV_OK && i < of->file->schemes_count; i++) {
        scene->scheme_count = i + 1;
        status = read_scheme(of, i);
    }
    return status;
}

static sphv_status read_field(const struct sphv_rates_reader *of, unsigned index)
{
    const struct sphv_rates_field *file = &of->file->fields[index];
    sphv_convergence *scene = of->scene;
    sphv_error reason;
    char place[64];
    snprintf(place, sizeof place, "fields.%u", index);
    for (unsigned i = 0; i < index; i++)
        if (strcmp(of->file->fields[i].id, file->id) == 0)
            return SPHV_RATES_FAIL(of, place, "field '%s' again; allowed: each id once", file->id);
    if (!sphv_plain_name(file->id) || strchr(file->id, '_'))
        return SPHV_RATES_FAIL(of, place, "field id '%s'; allowed: letters, digits, '-' and '.'",
                               file->id);
    if (sphv_field_parse(file->field, scene->dimension, &scene->fields[index], &reason) != SPHV_OK)
        return SPHV_RATES_FAIL(of, place, "%s", reason.message);
    return sphv_copy_text(file->id, &scene->field_ids[index], of->error);
}

/// The targets of one field, from its value to its second derivatives: f, f_x, f_y, f_xx, …
static sphv_status add_targets(const struct sphv_rates_reader *of, size_t field)
{
    sphv_convergence *scene = of->scene;
    const sphv_monomial *monomials = sphv_monomials(scene->dimension);
    for (size_t q = 0; q < sphv_monomial_count(scene->dimension, 2); q++) {
        char name[64];
        int used = snprintf(name, sizeof name, "%s%s", scene->field_ids[field], q ? "_" : "");
        for (int i = 0; i < scene->dimension; i++)
            for (int k = 0; k < monomials[q].power[i]; k++) name[used++] = (char)('x' + i);
        name[used] = '\0';
        sphv_target *target = &scene->targets[scene->target_count++];
        *target = (sphv_target){.field = field, .quantity = q};
        sphv_status status = sphv_copy_text(name, &target->name, of->error);
        if (status != SPHV_OK) return status;
    }
    return SPHV_OK;
}

/// Most targets with a wrong exact value, or none, that a file can ask for.
static size_t altered_count(const struct sphv_rates_file *file)
{
    size_t count = file->claims_count + file->plots_count;
    for (unsigned i = 0; file->table && i < file->table->exceptions_count; i++)
        count += file->table->exceptions[i].evidence_count;
    return count;
}

sphv_status sphv_rates_read_targets(const struct sphv_rates_reader *of)
{
    sphv_convergence *scene = of->scene;
    size_t count = of->file->fields_count;
    scene->fields = calloc(count + 1, sizeof *scene->fields);
    scene->field_ids = calloc(count + 1, sizeof *scene->field_ids);
    scene->targets =
        calloc(count * SPHV_QUANTITIES_MAX + altered_count(of->file) + 1, sizeof *scene->targets);
    if (!scene->fields || !scene->field_ids || !scene->targets) return no_memory(of->error);
    sphv_status status = SPHV_OK;
    for (unsigned i = 0; status == SPHV_OK && i < count; i++) {
        scene->field_count = i + 1;
        status = read_field(of, i);
        if (status == SPHV_OK) status = add_targets(of, i);
    }
    return status;
}

sphv_status sphv_rates_add_alone(const struct sphv_rates_reader *of, size_t target, size_t *out)
{
    sphv_convergence *scene = of->scene;
    const sphv_target *like = &scene->targets[target];
    for (*out = 0; *out < scene->target_count; ++*out)
        if (scene->targets[*out].alone && scene->targets[*out].field == like->field &&
            scene->targets[*out].quantity == like->quantity)
            return SPHV_OK;
    sphv_target *alone = &scene->targets[scene->target_count++];
    *alone = (sphv_target){
        .field = like->field, .quantity = like->quantity, .altered = true, .alone = true};
    char name[80];
    snprintf(name, sizeof name, "estimated %.60s", like->name);
    return sphv_copy_text(name, &alone->name, of->error);
}

sphv_status sphv_rates_add_altered(const struct sphv_rates_reader *of, const char *place,
                                   size_t target, const struct sphv_rates_evidence *file,
                                   size_t *out)
{
    sphv_convergence *scene = of->scene;
    sphv_target *altered = &scene->targets[scene->target_count];
    *altered = scene->targets[target];
    altered->name = NULL;
    altered->altered = true;
    altered->without = (sphv_field){.name = "left out", .dimension = scene->dimension, .terms = 0};
    *out = scene->target_count++;
    sphv_status status = sphv_copy_text(scene->targets[target].name, &altered->name, of->error);
    for (unsigned t = 0; status == SPHV_OK && t < file->without_count; t++) {
        const struct sphv_rates_term *from = &file->without[t];
        sphv_field_term *term = &altered->without.term[altered->without.terms++];
        if ((int)from->powers_count != scene->dimension)
            return SPHV_RATES_FAIL(of, place, "%u powers in %d dimensions", from->powers_count,
                                   scene->dimension);
        status = sphv_rates_number(of, place, from->coefficient, 0, &term->coefficient);
        for (unsigned i = 0; status == SPHV_OK && i < from->powers_count; i++) {
            term->factor[i].kind = SPHV_FACTOR_POWER;
            status = sphv_rates_number(of, place, from->powers[i], 0, &term->factor[i].parameter);
            if (status == SPHV_OK && !(term->factor[i].parameter >= 0 &&
                                       term->factor[i].parameter <= SPHV_FIELD_POWER_MAX))
                return SPHV_RATES_FAIL(of, place, "power %s; allowed: 0 to %d", from->powers[i],
                                       SPHV_FIELD_POWER_MAX);
        }
    }
    return status;
}
