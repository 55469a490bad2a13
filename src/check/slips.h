/// \file slips.h
/// The search for a mistake in a kernel's pieces: what each slip works on.
#ifndef SPHVERIFY_CHECK_SLIPS_H
#define SPHVERIFY_CHECK_SLIPS_H

#include "candidate.h"

/// The search: the file's pieces, a copy to try on, and the words for what fitted.
struct sphv_search {
    const sphv_kernel *kernel;
    sphv_exact_pieces trial;
    char *text;
    size_t size;
    int suspect; ///< the knot at which the last candidate failed, looked at first
    int tries;
};

/// Does the trial meet the kernel's claims? False, too, once too many have been tried.
bool sphv_search_fits(struct sphv_search *search);
int sphv_search_terms(const struct sphv_search *search, int piece);
mpq_t *sphv_search_coefficient(struct sphv_search *search, int piece, int k);
/// Puts the file's own pieces back.
void sphv_search_reset(struct sphv_search *search);
/// Short rationals as such, others as decimals.
void sphv_search_number(const mpq_t value, char *text, size_t size);

/// Each undoes one kind of slip in the trial. True: it fits, and `text` says what was wrong; false:
/// the trial is what it was.
bool sphv_try_signs(struct sphv_search *search);
bool sphv_try_swaps(struct sphv_search *search);
bool sphv_try_coefficients(struct sphv_search *search);
bool sphv_try_shifts(struct sphv_search *search);
bool sphv_try_rounding(struct sphv_search *search);
bool sphv_try_piece_swaps(struct sphv_search *search);
bool sphv_try_knots(struct sphv_search *search);
bool sphv_try_scaled_argument(struct sphv_search *search);
bool sphv_try_jumps(struct sphv_search *search);
bool sphv_try_odd_part(struct sphv_search *search);
bool sphv_try_truncation(struct sphv_search *search);

/// Names the known kernel that a faulty one differs from in few coefficients, or by rounding.
void sphv_name_resemblance(const sphv_kernel *kernel, const sphv_catalogue *reference, char *text,
                           size_t size);

#endif
