#include <math.h>

#include "convergence_facts.h"
#include "sphverify/report.h"
#include "text.h"

static void put_number(FILE *stream, double value)
{
    if (isfinite(value))
        fprintf(stream, ",%.17g", value);
    else
        fputc(',', stream);
}

static void put_text(FILE *stream, const char *text)
{
    fputc(',', stream);
    sphv_put_csv(stream, text);
}

static void put_particles(FILE *stream, const sphv_box *box)
{
    bool perturbed = box->layout == SPHV_PERTURBED, lattice = box->layout == SPHV_LATTICE;
    put_text(stream, sphv_layouts[box->layout].name);
    put_text(stream, lattice || perturbed ? sphv_placements[box->placement].name : "");
    put_text(stream, perturbed ? sphv_jitters[box->jitter].name : "");
    put_number(stream, perturbed ? box->amplitude : NAN);
    put_text(stream, sphv_volumes[box->volume].name);
    if (lattice)
        fputc(',', stream);
    else
        fprintf(stream, ",%llu", (unsigned long long)box->seed);
}

static void put_stage(FILE *stream, const sphv_scheme *scheme, const sphv_box *box,
                      const sphv_stage *stage)
{
    sphv_put_csv(stream, scheme->id);
    put_text(stream, scheme->label);
    put_text(stream, scheme->has_method ? sphv_methods[scheme->method].name : "");
    put_text(stream, sphv_kernel_name(scheme->kernel));
    put_particles(stream, box);
    fprintf(stream, ",%zu", stage->particles);
    put_number(stream, stage->spacing);
    put_number(stream, stage->h);
    fprintf(stream, ",%zu", stage->neighbours);
}

static void put_norms(FILE *stream, const sphv_stage *stage, const sphv_rate_point *point, int part)
{
    const sphv_norms *norms = part ? &point->interior : &point->whole;
    bool any = norms->counted > 0, predicted = point->predicted[part];
    put_number(stream, any ? norms->rmse : NAN);
    put_number(stream, any ? norms->bound : NAN);
    put_number(stream, any ? norms->rmse / (double)stage->neighbours : NAN);
    put_number(stream, any ? norms->mae : NAN);
    put_number(stream, any ? norms->maximum : NAN);
    put_number(stream, any ? norms->mean_square : NAN);
    put_number(stream, any ? norms->standard_deviation : NAN);
    put_number(stream, predicted ? point->prediction[part].value : NAN);
    put_number(stream, predicted ? point->prediction[part].bound : NAN);
    put_text(stream, predicted ? sphv_rigour_name(point->rigour) : "");
    put_text(stream, predicted ? sphv_verdict_name(point->verdict[part]) : "");
    fprintf(stream, ",%zu", norms->counted);
    for (int fault = SPHV_FAULT_NONE + 1; fault < SPHV_FAULTS; fault++)
        fprintf(stream, ",%zu", norms->excluded[fault]);
    fprintf(stream, ",%zu\n", norms->exact_undefined);
}

/// A scheme that only counts neighbours.
static void put_counted(FILE *stream)
{
    fputs(",,,,,,,,,,,,,,", stream);
    for (int fault = SPHV_FAULT_NONE + 1; fault < SPHV_FAULTS; fault++) fputc(',', stream);
    fputs(",\n", stream);
}

void sphv_convergence_csv(FILE *stream, const sphv_convergence_result *result)
{
    const sphv_convergence *scene = result->scene;
    fputs("scheme,label,method,kernel,layout,placement,jitter,amplitude,volume,seed,particles,"
          "spacing,h,neighbours,quantity,region,rmse,rmse_bound,rmse_per_neighbour,mae,maximum,"
          "mean_square,standard_deviation,predicted_rmse,predicted_bound,rigour,verdict,counted",
          stream);
    for (int fault = SPHV_FAULT_NONE + 1; fault < SPHV_FAULTS; fault++) {
        fputs(",excluded_", stream);
        for (const char *c = sphv_faults[fault].name; *c; c++) fputc(*c == '-' ? '_' : *c, stream);
    }
    fputs(",exact_undefined\n", stream);
    for (size_t s = 0; s < scene->scheme_count; s++)
        for (size_t l = 0; l < scene->level_count; l++) {
            const sphv_scheme *scheme = &scene->schemes[s];
            const sphv_box *box = &scene->boxes[scheme->box].box;
            const sphv_stage *stage = sphv_convergence_stage(result, l, s);
            for (size_t t = 0; t < scene->target_count; t++)
                for (int part = 0; part < 2; part++) {
                    if (!stage->points[t].there || scene->targets[t].altered) continue;
                    put_stage(stream, scheme, box, stage);
                    put_text(stream, scene->targets[t].name);
                    put_text(stream, part ? "interior" : "all");
                    put_norms(stream, stage, &stage->points[t], part);
                }
            if (scheme->has_method && scene->target_count) continue;
            put_stage(stream, scheme, box, stage);
            put_counted(stream);
        }
}
