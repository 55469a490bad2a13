/// \file boundary_internal.h
/// Shared by the files of the theory of boundaries.
///
/// A box cuts the support into 2^d octants about the particle, {0 <= ±s_i < t_i}. A moment is the
/// sum of its octants' with the sign of s^α in each, so only positive octants are ever evaluated.
#ifndef SPHVERIFY_ANALYTIC_BOUNDARY_INTERNAL_H
#define SPHVERIFY_ANALYTIC_BOUNDARY_INTERNAL_H

#include "internal.h"
#include "sphverify/boundary.h"

enum {
    SPHV_RADIALS = 3,      ///< p_0, p_1, p_2
    SPHV_SHAPE_DEGREE = 3, ///< of the polynomials that multiply them in a shape function
    SPHV_SHAPE_TERMS = 20, ///< monomials up to that degree in three dimensions
};

/// p_0, p_1 and q² p_2 at q, the last of which stays finite at the origin. Rounding is a few units
/// in the last place of the profile's derivatives, q of them for a place known that well.
void sphv_radial_functions(const sphv_profile *profile, double q, double out[SPHV_RADIALS]);

/// Moments over octants, by how many lines of the lattice they hold.
typedef struct sphv_octants {
    int dimension, reach, degree; ///< reach R: the last line of the lattice within the support
    double spacing;               ///< Δs
    size_t monomials, rests, tails, places;
    /// moment[k][place * monomials + α] = ∫ or Δs^d Σ p_k s^α over the lines 0 … I_i of each
    /// direction; line 0 counts half. A place is (I_1, …, I_d) with I_1 running slowest.
    double *moment[SPHV_RADIALS];
    /// row[k][(node * rests + γ) * tails + tail]: the same over all directions but the first, at
    /// the node's s_1; a tail is (I_2, …, I_d), γ a monomial of the other coordinates.
    double *row[SPHV_RADIALS];
    int nodes_per_line;        ///< 1: the lattice; more: Gauss nodes in each of its cells
    int nodes;                 ///< nodes_per_line (R + 1)
    double *place, *share;     ///< s_1 of each node, and its weight
    double *sign;              ///< [octant * monomials + α]: of s^α there
    double size[SPHV_RADIALS]; ///< Σ v|p_k| q^k over the whole support
    double flat;               ///< Σ v|p_1|
    double rounding;           ///< of a moment, relative to its size
    double *memory;
} sphv_octants;

/// \param nodes_per_line 1 for sums over the lattice; else the continuum, by Gauss–Legendre
///        quadrature of that many nodes in each direction of each cell
sphv_status sphv_octants_make(const sphv_profile *profile, double spacing, int nodes_per_line,
                              int degree, sphv_octants *out, sphv_error *error) SPHV_MUST_CHECK;
void sphv_octants_free(sphv_octants *octants);

/// Moments of p_k up to the table's degree, of a particle with that many lines within reach on
/// either side in each direction. \param out [k] receives `monomials` numbers, or is NULL
void sphv_octants_moments(const sphv_octants *octants, const int *below, const int *above,
                          double *const out[SPHV_RADIALS]);

/// A method's estimates as sums over neighbours: that of h^|β| ∂^βA is
/// Σ_b v A_b Σ_{k,α} weight[β][k][α] p_k s^α − self[β] A_a.
typedef struct sphv_shape {
    int dimension, quantities;
    double weight[SPHV_QUANTITIES_MAX][SPHV_RADIALS][SPHV_SHAPE_TERMS];
    double self[SPHV_QUANTITIES_MAX];
    double condition; ///< of the moment matrix, as scaled by h; ∞ when singular
} sphv_shape;

/// Highest degree of a monomial with a weight in a method's shape function.
int sphv_shape_degree(sphv_method method);

/// Degree up to which a quantity is estimated exactly whatever the moments; −1: none.
int sphv_shape_exactness(sphv_method method, int degree_of_quantity);

/// \param moment [k] of the monomials, as far as degree 5
void sphv_shape_make(sphv_method method, int dimension, const double *const moment[SPHV_RADIALS],
                     sphv_shape *out);

/// The particles along one side of a box.
typedef struct sphv_side {
    size_t count;
    double spacing, offset; ///< x = (i + offset) spacing
    int reach;
    bool periodic;
    double margin;    ///< what is nearer to an end than this is not interior
    double amplitude; ///< of perturbations, in spacings
    sphv_jitter jitter;
    double singular_until; ///< up to here the field has no Taylor series; negative: nowhere
} sphv_side;

enum { SPHV_SUM_RULE = 32 };

/// Gauss's rule for the sum over 0 … count − 1, exact to degree 2 order − 1.
/// \param order  at most count
/// \param place, weight receive `order` numbers, places from 0 to count − 1
bool sphv_sum_rule(int order, double count, double *place, double *weight);

/// A particle of a side, or a node that stands for `weight` of them.
typedef struct sphv_line {
    double x, weight;
    int below, above; ///< lattice lines within reach on either side
    double inside;    ///< how likely the coordinate is to be the margin away from both ends
    bool singular;
    /// factor[t * orders + n] = h^n φ_t^(n)(x), the field's t-th term in this coordinate
    const double *factor;
} sphv_line;

typedef struct sphv_lines {
    int count;
    sphv_line *line;
    bool exhaustive; ///< every particle stands for itself
} sphv_lines;

enum { SPHV_STRIP_WHOLE = 1 << 30 }; ///< strip order that takes every line

/// \param order       nodes of a panel, at most SPHV_SUM_RULE
/// \param strip_order lines taken of a strip: even, at most SPHV_SUM_RULE, or SPHV_STRIP_WHOLE. A
///        strip of up to twice as many is taken whole
sphv_status sphv_lines_make(const sphv_side *side, int order, int strip_order, sphv_lines *out,
                            sphv_error *error) SPHV_MUST_CHECK;
void sphv_lines_free(sphv_lines *lines);

/// What the theory must know of a field.
typedef struct sphv_field_theory {
    const sphv_field *field;
    bool singular;   ///< a power of the first coordinate that is not whole
    bool narrow;     ///< bells, which a rule may miss
    int rest_degree; ///< highest order of a derivative in the other coordinates
} sphv_field_theory;

sphv_status sphv_field_theory_make(const sphv_field *field, sphv_field_theory *out,
                                   sphv_error *error) SPHV_MUST_CHECK;

enum { SPHV_TAIL = 64 };

/// Bounds of the Taylor series' remainders within distance r of a place with first coordinate x.
/// \param rest_only  the series is that of the other coordinates only, the first's factors <= 1
/// \param tail [D] receives the bound of all terms of degree above D, D < SPHV_TAIL
void sphv_taylor_tail(const sphv_field *field, bool rest_only, double x, double r, double *tail);

#endif
