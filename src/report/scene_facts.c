#include "scene_facts.h"

#include <math.h>
#include <stdlib.h>

static const sphv_fault_counts no_faults = {
    .worst_condition = NAN, .worst_h = NAN, .worst_spacing = NAN};

static void add_faults(sphv_fault_counts *to, const sphv_fault_counts *part)
{
    to->estimates += part->estimates;
    to->isolated += part->isolated;
    to->too_few += part->too_few;
    to->singular += part->singular;
    to->ill_conditioned += part->ill_conditioned;
    to->not_finite += part->not_finite;
    if (isnan(part->worst_condition) || part->worst_condition <= to->worst_condition) return;
    to->worst_condition = part->worst_condition;
    to->worst_h = part->worst_h;
    to->worst_spacing = part->worst_spacing;
    to->worst_scene = part->worst_scene;
}

static sphv_fault_counts faults_of(const sphv_scene *scene, const sphv_sample *sample)
{
    const sphv_disorder_measurement *found = &sample->point.disorder;
    sphv_fault_counts faults = no_faults;
    if (scene->abscissa == SPHV_OVER_Q) return faults;
    if (!sample->point.statistical) {
        faults.estimates = sample->point.empirical.particles;
        return faults;
    }
    return (sphv_fault_counts){.estimates = found->particles,
                               .singular = found->singular,
                               .ill_conditioned = found->ill_conditioned,
                               .not_finite = found->not_finite,
                               .worst_condition = found->worst_condition,
                               .worst_h = sample->h,
                               .worst_spacing = sample->spacing.value,
                               .worst_scene = scene->name};
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
    sphv_fault_counts faults = faults_of(scene, sample);
    add_faults(&facts->faults, &faults);
    if (!point->statistical) return;
    int realisations = point->disorder.realisations;
    if (!facts->statistical || realisations < facts->realisations_least)
        facts->realisations_least = realisations;
    if (realisations > facts->realisations_most) facts->realisations_most = realisations;
    facts->statistical = true;
}

long sphv_faults_sum(const sphv_fault_counts *faults)
{
    return faults->isolated + faults->too_few + faults->singular + faults->ill_conditioned +
           faults->not_finite;
}

sphv_fault_counts sphv_scheme_faults(const sphv_convergence_result *result, size_t scheme)
{
    sphv_fault_counts faults = no_faults;
    if (!result->scene->schemes[scheme].has_method) return faults;
    for (size_t l = 0; l < result->scene->level_count; l++) {
        const sphv_stage *stage = sphv_convergence_stage(result, l, scheme);
        const size_t *of = stage->faults;
        sphv_fault_counts part = {.estimates = (long)stage->particles,
                                  .isolated = (long)of[SPHV_FAULT_ISOLATED],
                                  .too_few = (long)of[SPHV_FAULT_TOO_FEW],
                                  .singular = (long)of[SPHV_FAULT_SINGULAR],
                                  .ill_conditioned = (long)of[SPHV_FAULT_ILL_CONDITIONED],
                                  .not_finite = (long)of[SPHV_FAULT_NOT_FINITE],
                                  .worst_condition = stage->worst_condition,
                                  .worst_h = stage->h,
                                  .worst_spacing = stage->spacing / stage->h,
                                  .worst_scene = result->scene->name};
        add_faults(&faults, &part);
    }
    return faults;
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
    for (size_t c = 0; c < report->convergence_count; c++) {
        const sphv_convergence_result *result = report->convergences[c];
        for (size_t i = 0; i < result->scene->scheme_count; i++) {
            if (!result->scene->schemes[i].has_method) continue;
            sphv_method_facts *of = &facts[result->scene->schemes[i].method];
            sphv_fault_counts scheme = sphv_scheme_faults(result, i);
            of->curves++;
            add_faults(&of->faults, &scheme);
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

void sphv_faults_text(char *text, size_t size, const sphv_fault_counts *faults)
{
    const struct {
        const char *name;
        long count;
    } reasons[] = {{"isolated", faults->isolated},
                   {"too few neighbours", faults->too_few},
                   {"singular", faults->singular},
                   {"ill-conditioned", faults->ill_conditioned},
                   {"not finite", faults->not_finite}};
    size_t used = 0;
    snprintf(text, size, "none");
    for (size_t i = 0; i < sizeof reasons / sizeof *reasons; i++)
        if (reasons[i].count && used < size)
            used += (size_t)snprintf(text + used, size - used, "%s%s %ld", used ? ", " : "",
                                     reasons[i].name, reasons[i].count);
}
