/// \file lattice_table.h
/// The radial functions over the offsets of a lattice, and their sums over the parts of the support
/// that a box leaves.
///
/// On a lattice in a box every particle has the same offsets to its neighbours, cut by the sides.
/// What is left is one of few cuboids of offsets, its class, and a sum over a cuboid is a
/// difference of prefix sums.
#ifndef SPHVERIFY_EMPIRICAL_LATTICE_TABLE_H
#define SPHVERIFY_EMPIRICAL_LATTICE_TABLE_H

#include "evaluation.h"
#include "radial.h"

/// Offsets of the lattice's particles within the support, in units of the spacing.
typedef struct sphv_lattice_table {
    int dimension;
    size_t side, reach;  ///< offsets run from −reach to reach in each coordinate, reach < side
    size_t width, cells; ///< 2 reach + 1, and its d-th power
    size_t octant;       ///< (reach + 1)^d: offsets without negative coordinates
    double step, volume; ///< Δx/h and V/h^d
    int degree[3];       ///< highest of the level's monomials, per radial function; −1: none
    int lowest[3];       ///< m, the lowest degree of the level's moments
    double *p[3];        ///< p_k over the octant, 0 beyond the support
    /// Over the octant: |p_k| q^m, and what v p_k s^α is wrong by at most in units of v κ^(|α| −
    /// m), as seen by particles whose positions are rounded.
    double *size[3], *error[3];
    unsigned char *inside; ///< over the octant: within the support; 0 where rounding decides
    size_t ties;           ///< offsets at the support's edge, where rounding decides
    int (*tie)[SPHV_DIMENSIONS];
    size_t classes_a_side; ///< of one coordinate
    size_t *class_of;      ///< per place along a side
    size_t *low, *high;    ///< per class: how far the offsets reach down and up
    size_t classes;        ///< classes_a_side^d
} sphv_lattice_table;

/// Makes the table of an unperturbed lattice.
/// \return SPHV_INVALID_INPUT when the particles are no such lattice, or the radial functions jump
///         where a particle lies
sphv_status sphv_lattice_table_make(const sphv_evaluation *evaluation, sphv_lattice_table *table,
                                    sphv_error *error) SPHV_MUST_CHECK;
void sphv_lattice_table_free(sphv_lattice_table *table);

/// A quantity over the offsets: of the octant by its index, of the others by symmetry.
typedef struct sphv_offset_function {
    const double *octant;          ///< or NULL: `inside`
    double factor;                 ///< of all
    const sphv_monomial *monomial; ///< s^α to multiply by; NULL: none
} sphv_offset_function;

/// Its value at one offset, exactly even or odd in each coordinate.
double sphv_offset_value(const sphv_lattice_table *table, const sphv_offset_function *function,
                         const long offset[SPHV_DIMENSIONS]);

/// Sums over the cuboid of each class.
/// \param out receives `classes` sums, within sphv_cuboid_error Σ|all values| and a rounding
sphv_status sphv_cuboid_sums(const sphv_lattice_table *table, const sphv_offset_function *function,
                             double *out) SPHV_MUST_CHECK;
double sphv_cuboid_error(const sphv_lattice_table *table);

/// Places of particle n along each coordinate, and its class.
size_t sphv_lattice_class(const sphv_lattice_table *table, size_t n, size_t place[SPHV_DIMENSIONS]);

#endif
