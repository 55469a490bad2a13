#include "solve.h"

extern const sphv_solver_set SPHV_SOLVER_SET;

const sphv_solver_set SPHV_SOLVER_SET = {
    .name = SPHV_SET_NAME,
    .solver =
        {
            [SPHV_SPH] = SPHV_SOLVER(standard),
            [SPHV_SPH_DIFFERENCE] = SPHV_SOLVER(difference),
            [SPHV_SHEPARD] = SPHV_SOLVER(shepard),
            [SPHV_RKPM_0] = SPHV_SOLVER(shepard),
            [SPHV_BONET_LOK] = SPHV_SOLVER(bonet_lok),
            [SPHV_CSPM] = SPHV_SOLVER(cspm),
            [SPHV_FPM] = SPHV_SOLVER(fpm),
            [SPHV_MSPH] = SPHV_SOLVER(msph),
            [SPHV_RKPM] = SPHV_SOLVER(rkpm_1),
            [SPHV_RKPM_2] = SPHV_SOLVER(rkpm_2),
        },
};
