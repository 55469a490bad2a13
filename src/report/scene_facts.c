#include "scene_facts.h"

#include <math.h>
#include <stdlib.h>

static const sphv_faults no_faults = {.worst_condition = NAN, .worst_h = NAN, .worst_spacing = NAN};

static void add_faults(sphv_faults *to, const sphv_faults *part)
{
    to->estimates += part->estimates;
    to->singular += part->singular;
    to->ill_conditioned += part->ill_conditioned;
    to->not_finite += part->not_finite;
    if (isnan(part->worst_condition) || part->worst_condition <= to->worst_condition) return;
    to->worst_condition = part->worst_condition;
    to->worst_h = part->worst_h;
    to->worst_spacing = part->worst_spacing;
    to->worst_scene = part->worst_scene;
}

static sphv_faults faults_of(const sphv_scene *scene, const sphv_sample *sample)
{
    const sphv_disorder_measurement *found = &sample->point.disorder;
    sphv_faults faults = no_faults;
    if (scene->abscissa == SPHV_OVER_Q) return faults;
    if (!sample->point.statistical) {
        faults.estimates = sample->point.empirical.particles;
        return faults;
    }
    return (sphv_faults){
        found->particles,       found->singular, found->ill_conditioned, found->not_finite,
        found->worst_condition, sample->h,       sample->spacing.value,  scene};
}

static void add_sample(sphv_curve_facts *facts, const sphv_scene *scene, const sphv_sample *sample)
{
    const sphv_point *point = &sample->point;
    facts->exact[point->verdict]++;
    if (sample->n >= 0) facts->paper[sample->paper_verdict]++;
    if (fabs(point->difference) > facts->difference) {
        facts->difference = fabs(point->difference);
        facts->bound = point->analytic.total.bound + point->empirical.total.bound;
    }
    if (scene->abscissa != SPHV_OVER_Q) {
        double off = fabs(point->analytic.l2.value / point->empirical.l2.value - 1);
        if (isfinite(off) && !(off <= facts->relative)) facts->relative = off;
    }
    sphv_faults faults = faults_of(scene, sample);
    add_faults(&facts->faults, &faults);
    if (!point->statistical) return;
    int realisations = point->disorder.realisations;
    if (!facts->statistical || realisations < facts->realisations_least)
        facts->realisations_least = realisations;
    if (realisations > facts->realisations_most) facts->realisations_most = realisations;
    facts->statistical = true;
}

sphv_curve_facts sphv_curve_facts_collect(const sphv_scene_result *result, size_t curve)
{
    const sphv_scene *scene = result->scene;
    const sphv_experiment *experiment = &scene->curves[curve].experiment;
    sphv_curve_facts facts = {.method = "",
                              .layout = "",
                              .volume = "",
                              .sigma = NAN,
                              .relative = NAN,
                              .faults = no_faults};
    if (scene->abscissa != SPHV_OVER_Q) {
        facts.method = sphv_methods[experiment->method].name;
        facts.layout = sphv_layouts[experiment->layout].name;
        facts.volume = sphv_volumes[experiment->volume].name;
        facts.random = experiment->layout == SPHV_RANDOM ||
                       experiment->layout == SPHV_QUASI_RANDOM ||
                       (experiment->layout == SPHV_PERTURBED && experiment->sigma > 0);
        if (experiment->layout == SPHV_PERTURBED) facts.sigma = experiment->sigma;
    }
    for (size_t i = 0; i < result->sample_count[curve]; i++)
        add_sample(&facts, scene, &result->samples[curve][i]);
    return facts;
}

bool sphv_scene_has_paper(const sphv_scene_result *result)
{
    return result->paper_agreeing + result->paper_disagreeing + result->paper_inconclusive > 0;
}

sphv_method_facts *sphv_method_facts_collect(const sphv_report *report, size_t *count)
{
    size_t methods = 0, used = 0;
    while (sphv_methods[methods].name) methods++;
    sphv_method_facts *facts = calloc(methods + 1, sizeof *facts);
    *count = 0;
    if (!facts) return NULL;
    for (size_t m = 0; m < methods; m++)
        facts[m] = (sphv_method_facts){sphv_methods[m].name, 0, no_faults};
    for (size_t s = 0; s < report->scene_count; s++) {
        const sphv_scene_result *result = report->scenes[s];
        if (result->scene->abscissa == SPHV_OVER_Q) continue;
        for (size_t c = 0; c < result->scene->curve_count; c++) {
            sphv_method_facts *of = &facts[result->scene->curves[c].experiment.method];
            sphv_curve_facts curve = sphv_curve_facts_collect(result, c);
            of->curves++;
            add_faults(&of->faults, &curve.faults);
        }
    }
    for (size_t m = 0; m < methods; m++)
        if (facts[m].curves) facts[used++] = facts[m];
    *count = used;
    return facts;
}

const char *sphv_realisations_text(char text[SPHV_REALISATIONS_TEXT], const sphv_curve_facts *facts)
{
    if (!facts->statistical)
        snprintf(text, SPHV_REALISATIONS_TEXT, "–");
    else if (facts->realisations_least == facts->realisations_most)
        snprintf(text, SPHV_REALISATIONS_TEXT, "%d", facts->realisations_most);
    else
        snprintf(text, SPHV_REALISATIONS_TEXT, "%d–%d", facts->realisations_least,
                 facts->realisations_most);
    return text;
}

void sphv_faults_text(char *text, size_t size, const sphv_faults *faults)
{
    const struct {
        const char *name;
        long count;
    } reasons[] = {{"singular", faults->singular},
                   {"ill-conditioned", faults->ill_conditioned},
                   {"not finite", faults->not_finite}};
    size_t used = 0;
    snprintf(text, size, "none");
    for (size_t i = 0; i < sizeof reasons / sizeof *reasons; i++)
        if (reasons[i].count && used < size)
            used += (size_t)snprintf(text + used, size - used, "%s%s %ld", used ? ", " : "",
                                     reasons[i].name, reasons[i].count);
}
