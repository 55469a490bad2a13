#include <math.h>
#include <stdlib.h>

#include "convergence_reader.h"
#include "scene_reader.h"

sphv_box sphv_scheme_box(const sphv_convergence *scene, const sphv_scheme *scheme, size_t level)
{
    sphv_box box = scene->boxes[scheme->box].box;
    box.side = scene->levels[level].side;
    return box;
}

double sphv_scheme_h(const sphv_convergence *scene, const sphv_scheme *scheme, size_t level)
{
    sphv_box box = sphv_scheme_box(scene, scheme, level);
    switch (scheme->rule) {
    case SPHV_H_OF_PARTICLES:
        return scheme->factor * pow(pow((double)box.side, box.dimension), scheme->exponent);
    case SPHV_H_OF_RATIO:
        return scheme->factor * scene->levels[level].ratio * sphv_box_spacing(&box);
    default:
        return scheme->factor * sphv_box_spacing(&box);
    }
}

static sphv_status read_convergence(const char *data_directory, const char *path,
                                    const sphv_yaml *yaml, sphv_convergence **out,
                                    sphv_error *error)
{
    struct sphv_rates_reader of = {data_directory, yaml, sphv_yaml_data(yaml),
                                   calloc(1, sizeof *of.scene), error};
    if (!of.scene) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    sphv_status status = sphv_read_head(yaml, path, &of.file->head, SPHV_HEAD_OF(of.scene), error);
    if (status == SPHV_OK) status = sphv_rates_read_particles(&of);
    if (status == SPHV_OK) status = sphv_rates_read_schemes(&of);
    if (status == SPHV_OK) status = sphv_rates_read_targets(&of);
    if (status == SPHV_OK) status = sphv_rates_read_measures(&of);
    if (status == SPHV_OK) status = sphv_rates_read_table(&of);
    if (status == SPHV_OK) status = sphv_rates_read_claims(&of);
    if (status == SPHV_OK) status = sphv_rates_read_plots(&of);
    if (status == SPHV_OK)
        *out = of.scene;
    else
        sphv_convergence_free(of.scene);
    return status;
}

sphv_status sphv_any_scene_load(const char *data_directory, const char *path, sphv_any_scene *out,
                                sphv_error *error)
{
    const sphv_yaml_kind kinds[] = {
        {NULL, &sphv_scene_schema}, {"convergence", &sphv_rates_schema}, {NULL, NULL}};
    sphv_yaml *yaml;
    int which;
    *out = (sphv_any_scene){NULL, NULL};
    sphv_status status = sphv_yaml_load_kind(path, kinds, &which, &yaml, error);
    if (status != SPHV_OK) return status;
    if (which == 1)
        status = read_convergence(data_directory, path, yaml, &out->convergence, error);
    else
        status = sphv_scene_read(data_directory, path, yaml, &out->scene, error);
    sphv_yaml_free(yaml);
    return status;
}

void sphv_any_scene_free(sphv_any_scene *scene)
{
    sphv_scene_free(scene->scene);
    sphv_convergence_free(scene->convergence);
    *scene = (sphv_any_scene){NULL, NULL};
}

static void free_table(sphv_rate_table *table)
{
    if (!table) return;
    for (size_t g = 0; g < table->group_count; g++) {
        free(table->groups[g].label);
        free(table->groups[g].reason);
    }
    for (size_t i = 0; table->cells && i < table->row_count * table->column_count; i++) {
        sphv_cell *cell = &table->cells[i];
        for (size_t e = 0; e < cell->evidence_count; e++) free(cell->evidence[e].statement);
        free(cell->evidence);
        free(cell->text);
        free(cell->why);
    }
    free(table->rows);
    free(table->columns);
    free(table->group);
    free(table->groups);
    free(table->cells);
    free(table);
}

static void free_listed(sphv_level_list *list, size_t levels)
{
    if (!list) return;
    for (size_t i = 0; i < levels; i++) {
        if (list->neighbours) free(list->neighbours[i]);
        if (list->h) free(list->h[i]);
    }
    free(list->neighbours);
    free(list->h);
    free(list);
}

static void free_claims_and_plots(sphv_convergence *scene)
{
    for (size_t i = 0; i < scene->claim_count; i++)
        sphv_free_claim_texts(SPHV_TEXTS_OF(&scene->claims[i]));
    for (size_t i = 0; i < scene->plot_count; i++) {
        free(scene->plots[i].id);
        free(scene->plots[i].title);
        free(scene->plots[i].schemes);
    }
    free(scene->claims);
    free(scene->plots);
}

void sphv_convergence_free(sphv_convergence *scene)
{
    if (!scene) return;
    free_table(scene->table);
    free_listed(scene->listed, scene->level_count);
    free_claims_and_plots(scene);
    for (size_t i = 0; i < scene->box_count; i++) free(scene->boxes[i].id);
    for (size_t i = 0; i < scene->field_count; i++) free(scene->field_ids[i]);
    for (size_t i = 0; i < scene->target_count; i++) free(scene->targets[i].name);
    for (size_t i = 0; i < scene->scheme_count; i++) {
        free(scene->schemes[i].id);
        free(scene->schemes[i].label);
        free(scene->schemes[i].factor_text);
        sphv_kernel_free(scene->schemes[i].kernel);
    }
    free(scene->measures);
    free(scene->boxes);
    free(scene->field_ids);
    free(scene->fields);
    free(scene->targets);
    free(scene->schemes);
    free(scene->levels);
    sphv_free_head(SPHV_HEAD_OF(scene));
    free(scene);
}
