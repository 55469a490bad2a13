/// \file kernel.h
/// Kernels: what a kernel file says, and the normalised profile Ŵ that both halves evaluate.
///
/// Notation of the whole project
///
/// | symbol    | in code            | meaning                                                     |
/// |-----------|--------------------|-------------------------------------------------------------|
/// | λ         | 1                  | wavelength of the field; the unit of length                 |
/// | k         | 2π                 | wavenumber 2π/λ                                             |
/// | h         | `h`                | smoothing length                                            |
/// | κ         | `support`          | support radius in units of h: W = 0 for r ≥ κh              |
/// | q, s      | `q`, `s`           | r/h ≥ 0, and the signed offset (x − x_a)/h                  |
/// | w(q)      |                    | the unnormalised function of the kernel file                |
/// | C_d       | `constant`         | normalisation constant in d dimensions                      |
/// | Ŵ(s)      | `sphv_profile`     | h^d W = C_d w(|s|), the dimensionless kernel                |
/// | Δx, Δs    | `spacing` is Δs    | particle spacing, and the spacing ratio Δx/h                |
/// | n         | `n`                | particles on each side when Δs = 2κ/(2n+1), see below       |
/// | β         | boundary smoothness| Ŵ and its derivatives up to order β vanish at κ; −1: none   |
/// | knot      | `sphv_knot`        | where a derivative of Ŵ(|s|) jumps                          |
/// | c         | `order`            | order of the lowest derivative that jumps at a knot         |
/// | μ_j       | `moment[j]`        | ∫ |s|^j Ŵ dV                                                |
/// | E         | `total`            | relative error of the gradient estimate, signed             |
///
/// The papers' special spacings Δx/h = 4/(2n+1) are those of κ = 2; for a kernel of another
/// support 2κ/(2n+1) puts the edge half-way between two particles.
#ifndef SPHVERIFY_KERNEL_H
#define SPHVERIFY_KERNEL_H

#include <stdbool.h>
#include <stddef.h>

#include "sphverify/number.h"
#include "sphverify/status.h"

enum {
    SPHV_DIMENSIONS = 3,  ///< kernels live in 1 to 3 dimensions
    SPHV_JET_MAX = 96,    ///< highest Taylor order of a profile that may be asked for
    SPHV_MOMENT_MAX = 64, ///< highest moment kept
    SPHV_PIECES_MAX = 32, ///< pieces of a kernel file
    SPHV_DEGREE_MAX = 40, ///< degree of a piece
};

/// A place where a derivative of Ŵ(|s|) jumps. For 0 < position every knot stands for the pair
/// ±position; a knot at 0 is there when Ŵ(|s|) is not smooth at the origin.
typedef struct sphv_knot {
    sphv_number position;
    int order;          ///< c: lowest derivative that jumps
    int terms;          ///< number of entries in `jump`
    const double *jump; ///< jump[i] = [Ŵ^(i)(position−) − Ŵ^(i)(position+)]/i!, 0 for i < order
} sphv_knot;

/// One smooth piece of Ŵ, on inner ≤ q < outer. A polynomial piece is kept as Taylor expansions
/// about several centres, from its inner to its outer end, and evaluated about the one that serves.
typedef struct sphv_piece {
    double inner, outer;
    int degree;                ///< of a polynomial piece; −1 for a closed form
    int centres;               ///< number of expansions
    double per_length;         ///< expansions per unit of q
    const sphv_number *centre; ///< about which each is made; the ends exactly
    /// For each centre degree + 1 coefficients, ascending powers, then degree + 1 weights: the
    /// rounding of the value is at most u Σ weight[i] |q − centre|^i.
    const double *taylor;
    const int *serving;       ///< [k]: the expansion used where the k-th centre is nearest
    double *derivative_bound; ///< [n] ≥ sup |Ŵ^(n)|/n! on the piece, n = 0 … SPHV_JET_MAX
} sphv_piece;

/// The normalised kernel Ŵ in one dimension count, compiled for evaluation. Read-only once made,
/// so any number of threads may share it.
typedef struct sphv_profile {
    int dimension;
    double support; ///< κ
    sphv_number support_exact;
    sphv_result constant;    ///< C_d, recomputed from w, never the file's claim
    int boundary_smoothness; ///< β, found at κ; SPHV_JET_MAX when Ŵ ends before κ
    int piece_count;
    sphv_piece *pieces;
    int knot_count;
    sphv_knot *knots; ///< ascending; the last is the edge κ
    /// moment[j] = ∫ |s|^j Ŵ dV.
    sphv_result moment[SPHV_MOMENT_MAX + 1];
    /// slope_moment[j] = −∫ |s|^(j+1) Ŵ′ dV/(j+d), Ŵ′ taken piece by piece. Equal to moment[j]
    /// when Ŵ is continuous and vanishes at κ (integration by parts).
    sphv_result slope_moment[SPHV_MOMENT_MAX + 1];
    double excess;                ///< moment[0] − 1 without cancellation: 0 unless truncated
    double slope_excess;          ///< slope_moment[0] − 1 without cancellation
    const struct sphv_form *form; ///< how closed forms are evaluated; private to the core
} sphv_profile;

/// What a kernel file says of its kernel beyond its shape; each is verified, never trusted.
typedef struct sphv_kernel_claims {
    char *constant[SPHV_DIMENSIONS]; ///< text of C_1, C_2, C_3, or NULL
    const int *boundary_smoothness;  ///< β, or NULL
    const int *smoothing_order;      ///< order of the smoothing error in h, or NULL
    const int *monotone;             ///< 1 when w is claimed to decrease everywhere, or NULL
    const int *non_negative;         ///< 1 when w is claimed to be nowhere negative, or NULL
} sphv_kernel_claims;

/// A kernel: identity, claims, and a profile for each dimension it is legal in.
typedef struct sphv_kernel sphv_kernel;

/// Reads a kernel file.
/// \param path   a YAML file as described in README, section "Kernel files"
/// \param out    receives the kernel, to be released with sphv_kernel_free
/// \param error  receives `file:line: what is wrong; what is allowed`
/// \return SPHV_OK, SPHV_INVALID_INPUT for a file that is not a kernel, or SPHV_RESOURCE_FAILURE
sphv_status sphv_kernel_load(const char *path, sphv_kernel **out,
                             sphv_error *error) SPHV_MUST_CHECK;
void sphv_kernel_free(sphv_kernel *kernel);

const char *sphv_kernel_name(const sphv_kernel *kernel);
const char *sphv_kernel_title(const sphv_kernel *kernel);
const char *sphv_kernel_source(const sphv_kernel *kernel); ///< "" when the file names none
const char *sphv_kernel_path(const sphv_kernel *kernel);
const sphv_kernel_claims *sphv_kernel_get_claims(const sphv_kernel *kernel);

/// The profile in d dimensions, or NULL when the kernel is not legal there.
const sphv_profile *sphv_kernel_profile(const sphv_kernel *kernel, int dimension);

/// Why a dimension is refused; "" when it is not.
const char *sphv_kernel_refusal(const sphv_kernel *kernel, int dimension);

/// The file's own gradient (its `derivative:` pieces), normalised like the profile, or NULL.
const sphv_profile *sphv_kernel_gradient(const sphv_kernel *kernel, int dimension);

/// C_d as an exact expression such as `5/14/pi`, or "" when no rational form exists.
/// \param text receives the expression; \param size its capacity
void sphv_kernel_constant_text(const sphv_kernel *kernel, int dimension, char *text, size_t size);

/// μ_j = ∫|s|^j Ŵ dV as an exact rational, or "" when none exists. \pre 0 <= j <= SPHV_MOMENT_MAX
void sphv_kernel_moment_text(const sphv_kernel *kernel, int dimension, int j, char *text,
                             size_t size);

/// Ŵ(q) in exact rational arithmetic from the file's own powers of q, rounded once at the end: the
/// reference for the floating-point evaluation. False when the kernel has no polynomial pieces.
bool sphv_kernel_exact_value(const sphv_kernel *kernel, int dimension, int derivative, double q,
                             double *value);

/// Ŵ^(derivative)(q), derivative 0, 1, 2 …, with a running rounding bound; 0 for q ≥ κ. At a knot
/// the outer piece is taken. \pre q >= 0, 0 <= derivative <= SPHV_JET_MAX
sphv_result sphv_profile_derivative(const sphv_profile *profile, int derivative, double q);

/// Ŵ, Ŵ′ and Ŵ″ at q in one go, each with a running rounding bound; zeros for q ≥ κ. At a knot the
/// outer piece is taken. \pre q >= 0
void sphv_profile_values(const sphv_profile *profile, double q, sphv_result out[3]);

/// Taylor coefficients Ŵ^(i)(q)/i!, i = 0 … order, of one piece about q, which may be its ends.
/// \param jet receives order + 1 numbers. \pre order <= SPHV_JET_MAX
void sphv_profile_jet(const sphv_profile *profile, int piece, double q, int order, double *jet);

/// The knot at κ, or NULL when Ŵ ends there without any jump (it ended before).
const sphv_knot *sphv_profile_edge(const sphv_profile *profile);

/// A spacing ratio Δs = 2κ/(2n+1) of this profile; 4/(2n+1) for κ = 2 (Quinlan eq. 17).
sphv_number sphv_profile_special_spacing(const sphv_profile *profile, int n);

/// The kernels of a data directory, sorted by name.
typedef struct sphv_catalogue {
    size_t count;
    sphv_kernel **kernels;
} sphv_catalogue;

/// Loads every `kernels/*.yaml` below a data directory; the first bad file ends it.
sphv_status sphv_catalogue_load(const char *data_directory, sphv_catalogue *out,
                                sphv_error *error) SPHV_MUST_CHECK;
void sphv_catalogue_free(sphv_catalogue *catalogue);

/// Loads one kernel by catalogue name, or by path when the text holds a `/` or ends in `.yaml`.
sphv_status sphv_catalogue_find(const char *data_directory, const char *name_or_path,
                                sphv_kernel **out, sphv_error *error) SPHV_MUST_CHECK;

#endif
