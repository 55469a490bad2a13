#include "report_support.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

char *text_copy(const char *text)
{
    char *out = strdup(text);
    assert_non_null(out);
    return out;
}

void stage_make(struct stage *stage, sphv_abscissa abscissa, const char *text)
{
    sphv_error error;
    memset(stage, 0, sizeof *stage);
    stage->kernel = load_kernel("quinlan-w10");
    stage->nasty = text_copy(text);
    for (int i = 0; i < 2; i++)
        stage->curves[i] = (sphv_curve){.id = stage->nasty,
                                        .label = stage->nasty,
                                        .kernel = stage->kernel,
                                        .profile = sphv_kernel_profile(stage->kernel, 1),
                                        .h = 0.01 * (1 + i),
                                        .spacing = sphv_number_from_ratio(4, 11 + 8 * i),
                                        .spacing_text = stage->nasty};
    for (int i = 0; i < 2; i++)
        stage->claims[i] = (sphv_claim){.id = stage->nasty,
                                        .statement = stage->nasty,
                                        .measure = &sphv_claim_measures[0],
                                        .from = 0.001,
                                        .to = 2,
                                        .expected = 2,
                                        .tolerance = i ? 10 : 1e-9,
                                        .reason = stage->nasty,
                                        .refuted = i ? NULL : stage->nasty};
    stage->scene = (sphv_scene){.path = stage->nasty,
                                .name = stage->nasty,
                                .title = stage->nasty,
                                .source = stage->nasty,
                                .notes = stage->nasty,
                                .abscissa = abscissa,
                                .from = abscissa == SPHV_OVER_Q ? 0 : 0.05,
                                .to = abscissa == SPHV_OVER_H ? 0.3 : 1.2,
                                .logarithmic = abscissa != SPHV_OVER_Q,
                                .points = 30,
                                .markers = 8,
                                .curve_count = 2,
                                .claim_count = abscissa == SPHV_OVER_Q ? 0 : 2,
                                .curves = stage->curves,
                                .claims = stage->claims};
    assert_ok(sphv_scene_run(&stage->scene, NULL, NULL, &stage->result, &error), error);
}

void stage_free(struct stage *stage)
{
    sphv_scene_result_free(stage->result);
    sphv_kernel_free(stage->kernel);
    free(stage->nasty);
}

size_t count(const char *text, const char *part)
{
    size_t found = 0;
    for (const char *c = text; (c = strstr(c, part)); c++) found++;
    return found;
}

bool have_gnuplot(void)
{
    return system("command -v gnuplot >/dev/null 2>&1") == 0;
}

void assert_untouched(void)
{
    struct stat about;
    assert_int_not_equal(stat("touched", &about), 0);
}
