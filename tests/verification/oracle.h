/// \file oracle.h
/// An independent judge: the lattice sum in 80-digit arithmetic (MPFR), from its own reading of a
/// kernel file and its own normalisation. It shares no code with the library.
#ifndef SPHVERIFY_TESTS_ORACLE_H
#define SPHVERIFY_TESTS_ORACLE_H

#include <gmp.h>
#include <mpfr.h>
#include <stdbool.h>

typedef struct oracle oracle;

/// Reads a kernel file and normalises the kernel in one dimension.
/// \return NULL when the file holds something that the oracle does not know, with the reason
oracle *oracle_load(const char *path, const char **reason);
void oracle_free(oracle *kernel);

const char *oracle_name(const oracle *kernel);

/// κ exactly.
void oracle_support(const oracle *kernel, mpq_t support);

/// E = 2 Δs Σ_{j ≥ 1, jΔs < κ} −sin(2πh jΔs)/(2πh) Ŵ′(jΔs) − 1 with Δs an exact rational, h a
/// double, rounded once at the end. Accurate to far below one unit in the last place of 1 + E,
/// and of E.
double oracle_lattice_error(oracle *kernel, double h, const mpq_t spacing);

/// The same without the rounding.
void oracle_lattice_error_mpfr(oracle *kernel, double h, const mpq_t spacing, mpfr_t error);

/// Ŵ′(q) for q ≥ 0, in one dimension.
void oracle_slope(oracle *kernel, const mpq_t q, mpfr_t slope);

/// The constant C_1.
double oracle_constant(const oracle *kernel);

/// Reads "a", "a/b" or a decimal, exactly. \return false when the text is something else
bool oracle_rational(const char *text, mpq_t out);

#endif
