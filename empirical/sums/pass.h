/// \file pass.h
/// One pass: a group of targets, one in each lane of a vector, over ranges of sources.
///
/// The same source (pass.c) is compiled for each instruction set; the best that the processor has
/// is taken at run time.
#ifndef SPHVERIFY_EMPIRICAL_PASS_H
#define SPHVERIFY_EMPIRICAL_PASS_H

#include <stdint.h>

#include "radial.h"

enum {
    SPHV_LANES_MAX = 8,
    SPHV_PASS_FIELDS = 2, ///< fields in one pass
    SPHV_PASS_PART = 256, ///< longest run of sources summed plainly; longer ones in parts
    SPHV_PASS_SUMS = 256, ///< of one pass: moments, sizes, field sums
    SPHV_HALF_TILE = 4,   ///< targets at most that meet a vector of sources together
    SPHV_SPARE = 32, ///< places behind all sources, and behind a row, that a half pass may read
    SPHV_HALF_SUMS = SPHV_PASS_FIELDS * (1 + SPHV_DIMENSIONS), ///< of one half pass
};

/// Particles as arrays, in units in which h is of the order of 1.
typedef struct sphv_sources {
    const double *x[SPHV_DIMENSIONS];
    const double *v; ///< V/h^d
    const double *field[SPHV_PASS_FIELDS];
} sphv_sources;

/// Sources that are looked at; those from `sure` to `sure_to` are neighbours of every target of the
/// group, beyond doubt.
typedef struct sphv_range {
    size_t from, to, sure, sure_to;
} sphv_range;

/// Targets, and room for their sums: all of them, sum k of lane l in sums[k * SPHV_LANES_MAX + l],
/// in the order of a layout with `fields` fields, but as Σ v p_k d^α with d = x_b − x_a.
typedef struct sphv_pass {
    const sphv_radial *radial;
    const sphv_sum_layout *layout;
    sphv_sources sources;
    double x[SPHV_DIMENSIONS][SPHV_LANES_MAX], a[SPHV_PASS_FIELDS][SPHV_LANES_MAX];
    double neighbours[SPHV_LANES_MAX];
    double *sums;
} sphv_pass;

typedef void sphv_pass_function(sphv_pass *pass, size_t count, const sphv_range *ranges);

/// Targets of one row that are close together.
typedef struct sphv_half_tile {
    uint32_t target[SPHV_HALF_TILE], count;
    uint32_t first, last; ///< the least and the greatest of them
    double low[SPHV_DIMENSIONS], high[SPHV_DIMENSIONS];
} sphv_half_tile;

/// A tile, and the sources of one row that may be its neighbours; `sure` only where the tile has as
/// many targets as the pass takes together.
typedef struct sphv_half_visit {
    const sphv_half_tile *tile;
    bool own; ///< the row is their own: each meets the sources behind it
    sphv_range range;
} sphv_half_visit;

/// Pairs that are visited once, for the sums of the level PLAIN: a tile of targets after the other,
/// sources of one row in the lanes of a vector. The pass adds to the sums of both.
typedef struct sphv_half_pass {
    const sphv_radial *radial;
    sphv_sources
        sources; ///< fields are v A; arrays begin on a line of the cache, have 32 places to spare
    size_t count;
    const sphv_half_visit *visit;
    double *total; ///< sum k of target a: total[k * stride + a]
    size_t stride;
    double *row; ///< sum k of source b: row[k * room + b − first]
    size_t first, room, first_target;
    double *neighbours; ///< of target a: those met in this pass, at a − first_target
    double *met;        ///< of source b − first, but for what `sure` knows
    double *sure;       ///< runs of sources met: their number where one begins, less behind its end
} sphv_half_pass;

typedef void sphv_half_pass_function(sphv_half_pass *pass);

/// The sources of some ranges whose distance from a box may be below `limit`, copied one after the
/// other. \param limit squared. \return their number
typedef size_t sphv_gather_function(const sphv_sources *from, int dimension, int fields,
                                    const double centre[SPHV_DIMENSIONS],
                                    const double extent[SPHV_DIMENSIONS], double limit,
                                    size_t count, const sphv_range *ranges, double *const *to);

/// What an instruction set offers.
typedef struct sphv_pass_set {
    const char *name;
    int lanes;
    /// \param fields 1 or 2. \return the pass for such sums; it may take two fields for one
    sphv_pass_function *(*choose)(int dimension, sphv_sum_level level, int fields,
                                  const sphv_radial *radial);
    sphv_gather_function *gather;
    /// \param tile receives how many targets the pass takes together
    /// \return the pass that visits pairs once, NULL where there is none
    sphv_half_pass_function *(*choose_half)(int dimension, int fields, const sphv_radial *radial,
                                            size_t *tile);
} sphv_pass_set;

/// Instruction sets that this processor has, best first, ended by NULL.
const sphv_pass_set *const *sphv_pass_sets(void);

#endif
