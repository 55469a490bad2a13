/// \file implementation_check.h
/// What a library answered, beside what its kernel file says.
#ifndef SPHVERIFY_CHECK_IMPLEMENTATION_CHECK_H
#define SPHVERIFY_CHECK_IMPLEMENTATION_CHECK_H

#include "check_internal.h"
#include "implementation.h"

/// Why a call is made.
typedef enum sphv_probe_kind {
    SPHV_PROBE_SHAPE,   ///< at h = 1, over the support
    SPHV_PROBE_SCALED,  ///< the same places at other smoothing lengths
    SPHV_PROBE_OUTSIDE, ///< at and beyond κ
    SPHV_PROBE_STAIR,   ///< a place next to the previous one, closer than single precision tells
    SPHV_PROBE_LATTICE, ///< a neighbour on a lattice
} sphv_probe_kind;

/// One call with its answer and its reference.
typedef struct sphv_probe {
    sphv_probe_kind kind;
    sphv_kernel_call call;
    double q;
    size_t unscaled; ///< of a scaled probe: the one at the same q and h = 1
    double weight;   ///< of a neighbour: 2Δx sin(2πr)/2π
    sphv_kernel_answer answer;
    sphv_result reference[3]; ///< h^d W, h^(d+1) W′, h^(d+2) W″ of the file's kernel
    double size[2];           ///< Σ|terms| of value and derivative in powers of q, × C_d
} sphv_probe;

/// One point on a lattice, and its neighbours among the probes.
typedef struct sphv_lattice_probe {
    double h;
    sphv_number spacing;
    size_t first, count;
} sphv_lattice_probe;

typedef struct sphv_implementation_data {
    const sphv_kernel *kernel;
    size_t count, capacity;
    sphv_probe *probes;
    size_t lattice_count;
    sphv_lattice_probe lattice[64];
    sphv_implementation_run run;
    bool single;     ///< the library works in single precision
    double roundoff; ///< its unit roundoff
    int degree;      ///< of the kernel's pieces; that of a comparable polynomial for a closed form
} sphv_implementation_data;

/// Plans all calls for the dimensions examined. \return false without memory
bool sphv_implementation_plan(const sphv_examination *of, sphv_implementation_data *data);

/// Once the answers are there: what the file's kernel has to say at each place, and in which
/// precision the library works.
void sphv_implementation_refer(sphv_implementation_data *data);

/// What an answer may be wrong by in the library's own precision, in units of h^−d or h^−(d+1).
/// \param which 0: value, 1: derivative
double sphv_implementation_tolerance(const sphv_implementation_data *data, const sphv_probe *probe,
                                     int which);

/// The answer in the same units.
double sphv_implementation_answer(const sphv_probe *probe, int which);

/// Names what is wrong with values or derivatives, by hypotheses that must fit every place.
void sphv_implementation_name_cause(const sphv_examination *of,
                                    const sphv_implementation_data *data, int dimension, int which,
                                    sphv_check_result *result);

/// Names a wrong power of h.
void sphv_implementation_name_scaling(const sphv_implementation_data *data, int dimension,
                                      sphv_check_result *result);

#endif
