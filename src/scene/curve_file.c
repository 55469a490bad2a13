#include <stdio.h>

#include "scene_reader.h"

/// h and spacing of a curve: each given where it is not the abscissa.
static sphv_status read_fixed(const struct sphv_scene_reader *of, unsigned index, const char *key,
                              const char *text, bool wanted, sphv_number *out)
{
    char place[64];
    snprintf(place, sizeof place, "curves.%u.%s", index, key);
    if (wanted != (text != NULL))
        return sphv_yaml_fail(of->yaml, place, of->error,
                              "curve '%s' %s '%s'; allowed: a curve fixes what is not the abscissa",
                              of->file->curves[index].id, wanted ? "lacks" : "gives", key);
    return text ? sphv_scene_number(of, place, text, out) : SPHV_OK;
}

/// Rejects a curve that would leave the range of arguments anywhere on the abscissa.
static sphv_status check_range(const struct sphv_scene_reader *of, unsigned index,
                               const sphv_curve *curve)
{
    const sphv_scene *scene = of->scene;
    if (scene->abscissa == SPHV_OVER_Q) return SPHV_OK;
    sphv_error reason;
    const double ends[] = {scene->from, scene->to};
    for (int i = 0; i < 2; i++) {
        bool over_h = scene->abscissa == SPHV_OVER_H;
        double h = over_h ? ends[i] : curve->h;
        sphv_number spacing =
            over_h ? sphv_curve_spacing(scene, curve, h) : sphv_number_from_double(ends[i]);
        if (sphv_check_point(curve->profile, h, spacing, &reason) == SPHV_OK) continue;
        char place[64];
        snprintf(place, sizeof place, "curves.%u", index);
        return sphv_yaml_fail(of->yaml, place, of->error, "curve '%s': %s", curve->id,
                              reason.message);
    }
    return SPHV_OK;
}

/// The realisations that the whole scene asks for; a width of 2 % from 8 to 64 unless it says.
static sphv_status read_realisations(const struct sphv_scene_reader *of, sphv_experiment *out)
{
    const struct sphv_file_realisations *file = of->file->realisations;
    *out =
        (sphv_experiment){.seed = 1, .width = 0.02, .realisations_min = 8, .realisations_max = 64};
    if (!file) return SPHV_OK;
    sphv_number width;
    sphv_status status = sphv_scene_number(of, "realisations.width", file->width, &width);
    if (status != SPHV_OK) return status;
    if (!(width.value > 0 && width.value < 1) || file->least < 2 || file->most < file->least ||
        file->most > 100000)
        return sphv_yaml_fail(of->yaml, "realisations", of->error,
                              "%d to %d realisations for a width of %s; allowed: 2 to 100000, "
                              "ascending, and a width between 0 and 1",
                              file->least, file->most, file->width);
    out->width = width.value;
    out->realisations_min = file->least;
    out->realisations_max = file->most;
    if (file->seed) out->seed = (uint64_t)*file->seed;
    return SPHV_OK;
}

/// Method, layout, volume rule and σ of a curve.
static sphv_status read_experiment(const struct sphv_scene_reader *of, unsigned index,
                                   sphv_curve *curve)
{
    const struct sphv_file_curve *file = &of->file->curves[index];
    sphv_experiment *experiment = &curve->experiment;
    sphv_error reason = {SPHV_OK, ""};
    sphv_number sigma = {0, 0}, exponent = {0, 0};
    char place[64];
    snprintf(place, sizeof place, "curves.%u", index);
    sphv_status status = read_realisations(of, experiment);
    if (status != SPHV_OK) return status;
    if (file->method) status = sphv_method_parse(file->method, &experiment->method, &reason);
    if (status == SPHV_OK && file->layout)
        status = sphv_layout_parse(file->layout, &experiment->layout, &reason);
    if (status == SPHV_OK && file->volume)
        status = sphv_volume_parse(file->volume, &experiment->volume, &reason);
    if (status == SPHV_OK && file->sigma) status = sphv_number_parse(file->sigma, &sigma, &reason);
    if (status == SPHV_OK && file->spacing_exponent)
        status = sphv_number_parse(file->spacing_exponent, &exponent, &reason);
    experiment->sigma = sigma.value;
    experiment->profile = curve->profile;
    experiment->h = 1; // h and spacing are those of each point; here they only have to be sound
    experiment->spacing = sphv_number_from_double(1);
    curve->spacing_exponent = exponent.value;
    if (status == SPHV_OK) status = sphv_experiment_check(experiment, &reason);
    if (status == SPHV_OK && file->spacing_exponent && of->scene->abscissa != SPHV_OVER_H)
        status = sphv_fail(&reason, SPHV_INVALID_INPUT,
                           "'spacing_exponent'; allowed: where h is the abscissa");
    if (status != SPHV_OK)
        return sphv_yaml_fail(of->yaml, place, of->error, "curve '%s': %s", curve->id,
                              reason.message);
    if (experiment->method != SPHV_SPH || experiment->layout != SPHV_LATTICE ||
        experiment->volume != SPHV_VOLUME_LATTICE)
        of->scene->statistical = true;
    return SPHV_OK;
}

sphv_status sphv_scene_read_curve(const struct sphv_scene_reader *of, unsigned index)
{
    const struct sphv_file_curve *file = &of->file->curves[index];
    sphv_curve *curve = &of->scene->curves[index];
    sphv_abscissa abscissa = of->scene->abscissa;
    sphv_number h = {0, 0};
    char place[64];
    sphv_status status = sphv_copy_text(file->id, &curve->id, of->error);
    if (status == SPHV_OK) status = sphv_copy_text(file->label, &curve->label, of->error);
    if (status == SPHV_OK) status = sphv_copy_text(file->spacing, &curve->spacing_text, of->error);
    if (status == SPHV_OK)
        status = read_fixed(of, index, "h", file->h, abscissa == SPHV_OVER_SPACING, &h);
    if (status == SPHV_OK)
        status = read_fixed(of, index, "spacing", file->spacing, abscissa == SPHV_OVER_H,
                            &curve->spacing);
    if (status != SPHV_OK) return status;
    curve->h = h.value;
    snprintf(place, sizeof place, "curves.%u.kernel", index);
    status = sphv_read_kernel(of->yaml, place, of->data_directory, file->kernel, &curve->kernel,
                              of->error);
    if (status != SPHV_OK) return status;
    curve->profile = sphv_kernel_profile(curve->kernel, 1);
    if (!curve->profile)
        return sphv_yaml_fail(of->yaml, place, of->error,
                              "kernel '%s' is not legal in 1 dimension; allowed: %s", file->kernel,
                              sphv_kernel_refusal(curve->kernel, 1));
    status = read_experiment(of, index, curve);
    return status == SPHV_OK ? check_range(of, index, curve) : status;
}
