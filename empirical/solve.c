#include "clones.h"
#include "processor.h"
#include "solvers.h"

const sphv_name_row sphv_faults[] = {
    {"none", "sound"},
    {"isolated", "no neighbour within the support"},
    {"too-few", "fewer particles within the support than the method needs"},
    {"singular", "the moment matrix has no finite condition number"},
    {"ill-conditioned", "condition number of the moment matrix above 1/sqrt(epsilon) = 6.7e7"},
    {"not-finite", "the estimate overflows"},
    {NULL, NULL},
};

extern const sphv_solver_set sphv_solvers_plain;
#ifdef SPHV_X86_PASSES
extern const sphv_solver_set sphv_solvers_avx512, sphv_solvers_avx2;
#endif

const sphv_solver_set *const *sphv_solver_sets(void)
{
    static const sphv_solver_set *const all[] = {
#ifdef SPHV_X86_PASSES
        &sphv_solvers_avx512, &sphv_solvers_avx2,
#endif
        &sphv_solvers_plain, NULL};
    return all + sphv_processor_lacks();
}

void sphv_solve_block_with(const sphv_solver_set *set, const sphv_sum_block *block,
                           const sphv_request *request, const double *values,
                           sphv_method_estimates *out)
{
    sphv_solve_task task = {.block = block,
                            .request = request,
                            .values = values,
                            .out = out,
                            .least = sphv_method_least(out->method, block->layout->dimension),
                            .scale = {1, 1 / request->h, 1 / request->h / request->h}};
    task.reach[0] = 1;
    for (int i = 1; i <= SPHV_SUM_DEGREE_MAX; i++)
        task.reach[i] = task.reach[i - 1] * request->profile->support;
    set->solver[out->method](&task);
    sphv_leave_wide_registers();
}

void sphv_solve_block(const sphv_sum_block *block, const sphv_request *request,
                      const double *values, sphv_method_estimates *out)
{
    sphv_solve_block_with(*sphv_solver_sets(), block, request, values, out);
}
