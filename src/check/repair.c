/// A search for the mistake in a kernel's pieces: undo one likely slip after another until the
/// kernel meets its own claims and what every kernel must meet. Exact arithmetic, so a repair that
/// fits does so to the last digit.
#include <stdio.h>

#include "slips.h"

/// A file of 32 pieces of degree 40 has millions of candidates; so many are tried.
enum { TRIES_MAX = 20000 };

bool sphv_search_fits(struct sphv_search *search)
{
    return ++search->tries <= TRIES_MAX &&
           sphv_candidate_fits(search->kernel, &search->trial, &search->suspect);
}

int sphv_search_terms(const struct sphv_search *search, int piece)
{
    return search->trial.polynomial[piece].degree + 1;
}

mpq_t *sphv_search_coefficient(struct sphv_search *search, int piece, int k)
{
    return &search->trial.polynomial[piece].coefficient[k];
}

void sphv_search_reset(struct sphv_search *search)
{
    const sphv_exact_pieces *given = &search->kernel->pieces;
    for (int i = 0; i < given->count; i++)
        for (int k = 0; k <= given->polynomial[i].degree; k++)
            mpq_set(search->trial.polynomial[i].coefficient[k],
                    given->polynomial[i].coefficient[k]);
}

void sphv_search_number(const mpq_t value, char *text, size_t size)
{
    // Short rationals as such, others as decimals.
    if (mpz_sizeinbase(mpq_numref(value), 10) + mpz_sizeinbase(mpq_denref(value), 10) < 24)
        gmp_snprintf(text, size, "%Qd", value);
    else
        snprintf(text, size, "%.15g", sphv_rational_round(value));
}

/// The slips, in the order in which they are tried; the first that fits is named.
static bool (*const slips[])(struct sphv_search *) = {
    sphv_try_signs,       sphv_try_swaps,    sphv_try_coefficients,    sphv_try_shifts,
    sphv_try_piece_swaps, sphv_try_knots,    sphv_try_scaled_argument, sphv_try_jumps,
    sphv_try_odd_part,    sphv_try_rounding, sphv_try_truncation,
};

static void seek(sphv_examination *of)
{
    struct sphv_search search = {of->kernel, {0, NULL, NULL, 0}, of->repair, sizeof of->repair, 0,
                                 0};
    if (sphv_exact_pieces_copy(&search.trial, &of->kernel->pieces, 0, NULL) != SPHV_OK) return;
    if (!sphv_search_fits(&search))
        for (size_t i = 0; !*of->repair && i < sizeof slips / sizeof *slips; i++) slips[i](&search);
    sphv_exact_pieces_free(&search.trial);
    if (!*of->repair)
        sphv_name_resemblance(of->kernel, of->options->reference, of->repair, sizeof of->repair);
}

void sphv_check_name_shape_cause(sphv_examination *of, sphv_check_result *result)
{
    if (!of->kernel->polynomial) return;
    if (!of->repair_sought) seek(of);
    of->repair_sought = true;
    if (*of->repair) sphv_check_cause(result, "%s", of->repair);
}
