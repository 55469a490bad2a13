/// \file estimate.h
/// The empirical half in one to three dimensions: estimates of fields and their derivatives on
/// particles, one pass over the neighbours for all methods and fields at once.
#ifndef SPHVERIFY_ESTIMATE_H
#define SPHVERIFY_ESTIMATE_H

#include "sphverify/box.h"
#include "sphverify/field.h"
#include "sphverify/measure.h"

/// Makes the particles of a box.
/// \param profile, h for volumes by density; may be NULL and 0 for the other rules
/// \param out receives the particles, to be released with sphv_particles_free
sphv_status sphv_particles_make(const sphv_box *box, const sphv_profile *profile, double h,
                                sphv_particles *out, sphv_error *error) SPHV_MUST_CHECK;
void sphv_particles_free(sphv_particles *particles);

/// How the sums are evaluated.
typedef enum sphv_route {
    SPHV_ROUTE_AUTOMATIC,   ///< the faster of the next two
    SPHV_ROUTE_DIRECT,      ///< cells and vector loops, any particles
    SPHV_ROUTE_CONVOLUTION, ///< Fourier and prefix sums; unperturbed lattices without periodicity
    SPHV_ROUTE_BRUTE_FORCE, ///< every pair of particles, kernel from the profile: the oracle
} sphv_route;

/// What is asked of an evaluation.
typedef struct sphv_request {
    const sphv_profile *profile; ///< of the particles' dimension
    double h;
    size_t method_count;
    const sphv_method *methods;
    size_t field_count;
    const double *const *fields; ///< A at each particle, per field
    sphv_route route;
} sphv_request;

/// Why an estimate is not to be trusted.
typedef enum sphv_fault {
    SPHV_FAULT_NONE,
    SPHV_FAULT_ISOLATED,        ///< no neighbour within the support
    SPHV_FAULT_TOO_FEW,         ///< fewer particles in the support than unknowns
    SPHV_FAULT_SINGULAR,        ///< no finite condition number
    SPHV_FAULT_ILL_CONDITIONED, ///< condition number above 1/√ε
    SPHV_FAULT_NOT_FINITE,      ///< the estimate overflows
    SPHV_FAULTS
} sphv_fault;

extern const sphv_name_row sphv_faults[]; ///< indexed by sphv_fault, ended by a NULL name

/// What one method found at every particle. Quantities are in the order of the monomials: value,
/// gradient, and second derivatives ∂²A/∂x², ∂²A/∂x∂y, … where the method gives them.
typedef struct sphv_method_estimates {
    sphv_method method;
    size_t quantities; ///< 1 + d, or (1 + d)(2 + d)/2 with second derivatives
    double **estimate; ///< [field * quantities + quantity][particle]; 0 where the fault leaves none
    double *condition; ///< 1-norm condition number of the scaled moment matrix; ∞ when singular
    unsigned char *fault; ///< sphv_fault
    /// [field * quantities + quantity]: largest bound of the rounding error of any particle without
    /// a fault.
    double *rounding;
} sphv_method_estimates;

typedef struct sphv_estimates {
    size_t count, field_count, method_count;
    sphv_method_estimates *methods;
    unsigned *neighbours; ///< particles with r < κh, itself included
    double pairs;         ///< in support, each particle with itself included
    double tested;        ///< pairs whose distance was computed
    double seconds;       ///< wall time, sorting included
    sphv_route route;     ///< the one taken
    void *memory;         ///< that the arrays over particles are cut from
} sphv_estimates;

/// Estimates fields and derivatives at all particles. The result is the same bit for bit for any
/// number of threads.
/// \return SPHV_INVALID_INPUT where the route does not fit the particles
sphv_status sphv_estimate_particles(const sphv_particles *particles, const sphv_request *request,
                                    sphv_progress progress, void *context, sphv_estimates *out,
                                    sphv_error *error) SPHV_MUST_CHECK;
void sphv_estimates_free(sphv_estimates *estimates);

/// How errors are summed up over particles.
typedef struct sphv_norms {
    double rmse;                  ///< √(Σe²/N) (Sigalotti eq. 32)
    double mae;                   ///< Σ|e|/N
    double maximum;               ///< max|e|
    double mean_square;           ///< Σe²/N
    double standard_deviation;    ///< of e about its mean
    double bound;                 ///< of rmse: rounding of the estimates and of the sum
    size_t counted;               ///< particles in the sums above
    size_t excluded[SPHV_FAULTS]; ///< particles left out, by their fault
    size_t exact_undefined;       ///< particles left out because the exact derivative is not finite
} sphv_norms;

/// The rule of the norms: a particle is left out when its estimate carries a fault, or when the
/// exact value is not finite there; both are counted. Where nothing is left, `counted` and all
/// norms are 0: a caller asks for `counted` first. Exact values are taken as exact. \param
/// estimates  sums of one evaluation; \param method, field, quantity which of its arrays \param
/// exact  the exact value at each particle \param margin only particles at least this far from
/// every side of the box count; 0 for all
sphv_norms sphv_error_norms(const sphv_particles *particles, const sphv_estimates *estimates,
                            size_t method, size_t field, size_t quantity, const double *exact,
                            double margin);

#endif
