#include "sphverify/kernel.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kernel_internal.h"

sphv_kernel *sphv_kernel_new(void)
{
    sphv_kernel *kernel = calloc(1, sizeof *kernel);
    if (!kernel) return NULL;
    for (int d = 0; d < SPHV_DIMENSIONS; d++) mpq_init(kernel->constant[d]);
    return kernel;
}

void sphv_kernel_free(sphv_kernel *kernel)
{
    if (!kernel) return;
    for (int d = 0; d < SPHV_DIMENSIONS; d++) {
        sphv_exact_pieces_free(&kernel->exact[d]);
        mpq_clear(kernel->constant[d]);
        sphv_profile_free(&kernel->profile[d]);
        sphv_profile_free(&kernel->gradient_profile[d]);
        free(kernel->claims.constant[d]);
    }
    sphv_exact_pieces_free(&kernel->pieces);
    sphv_exact_pieces_free(&kernel->gradient);
    free(kernel->path);
    free(kernel->name);
    free(kernel->title);
    free(kernel->source);
    free(kernel);
}

/// The fourth-order transform: a = ∫q²w dV/∫q⁴w dV makes ∫q²w(1 − a q²) dV vanish.
static bool transform_coefficient(mpq_t a, const sphv_exact_pieces *pieces, int dimension)
{
    mpq_t fourth;
    mpq_init(fourth);
    sphv_exact_pieces_moment(a, pieces, 0, dimension + 1);
    sphv_exact_pieces_moment(fourth, pieces, 0, dimension + 3);
    bool exists = mpq_sgn(fourth) != 0;
    if (exists) mpq_div(a, a, fourth);
    mpq_clear(fourth);
    return exists;
}

/// C_d π^(d>1) = 1/(S ∫ q^(d−1) w dq) with S = 2, 2, 4.
static bool exact_constant(mpq_t constant, const sphv_exact_pieces *pieces, int dimension)
{
    mpq_t surface;
    mpq_init(surface);
    mpq_set_si(surface, sphv_sphere_factor(dimension), 1);
    sphv_exact_pieces_moment(constant, pieces, 0, dimension - 1);
    bool positive = mpq_sgn(constant) > 0;
    if (positive) {
        mpq_mul(constant, constant, surface);
        mpq_inv(constant, constant);
    }
    mpq_clear(surface);
    return positive;
}

static sphv_status compile_gradient(sphv_kernel *kernel, int d, sphv_error *error)
{
    sphv_exact_pieces scaled = {0};
    sphv_status status = sphv_exact_pieces_copy(&scaled, &kernel->gradient, 0, error);
    if (status != SPHV_OK) return status;
    sphv_exact_pieces_scale(&scaled, kernel->constant[d - 1]);
    status = sphv_profile_from_pieces(&kernel->gradient_profile[d - 1], d, &scaled,
                                      kernel->constant[d - 1], error);
    sphv_exact_pieces_free(&scaled);
    return status;
}

static sphv_status compile_polynomial(sphv_kernel *kernel, int d, sphv_error *error)
{
    sphv_exact_pieces *exact = &kernel->exact[d - 1];
    sphv_status status =
        sphv_exact_pieces_copy(exact, &kernel->pieces, kernel->fourth_order ? 2 : 0, error);
    if (status != SPHV_OK) return status;
    bool possible = true;
    if (kernel->fourth_order) {
        mpq_t a;
        mpq_init(a);
        possible = transform_coefficient(a, exact, d);
        if (possible) sphv_exact_pieces_transform(exact, a);
        mpq_clear(a);
    }
    if (!possible || !exact_constant(kernel->constant[d - 1], exact, d))
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "the integral of w over %d dimension%s is not positive, so no constant "
                         "normalises it",
                         d, d > 1 ? "s" : "");
    double constant = sphv_rational_round(kernel->constant[d - 1]);
    if (!(constant >= 1e-100 && constant <= 1e100))
        return sphv_fail(
            error, SPHV_INVALID_INPUT,
            "the constant that normalises w in %d dimension%s is %.3g; allowed: 1e-100 "
            "to 1e100",
            d, d > 1 ? "s" : "", constant);
    sphv_exact_pieces_scale(exact, kernel->constant[d - 1]);
    status =
        sphv_profile_from_pieces(&kernel->profile[d - 1], d, exact, kernel->constant[d - 1], error);
    if (status == SPHV_OK && kernel->gradient.count) status = compile_gradient(kernel, d, error);
    return status;
}

static sphv_status compile_form(sphv_kernel *kernel, int d, sphv_error *error)
{
    sphv_form form = kernel->form;
    form.dimension = d;
    return sphv_profile_from_form(&kernel->profile[d - 1], &form, kernel->support,
                                  kernel->fourth_order, error);
}

sphv_status sphv_kernel_compile(sphv_kernel *kernel, sphv_error *error)
{
    int legal = 0;
    sphv_error reason = {SPHV_OK, "no dimension is declared"};
    for (int d = 1; d <= SPHV_DIMENSIONS; d++) {
        if (!kernel->declared[d - 1]) {
            // Polynomials cost nothing to ask whether the dimension could have been declared.
            bool possible = !kernel->polynomial || kernel->fourth_order ||
                            exact_constant(kernel->constant[d - 1], &kernel->pieces, d);
            snprintf(kernel->refusal[d - 1], sizeof kernel->refusal[0],
                     "the kernel file does not declare dimension %d%s", d,
                     possible ? ""
                              : ": the integral of w there is not positive, so no constant "
                                "normalises it");
            continue;
        }
        sphv_status status = kernel->polynomial ? compile_polynomial(kernel, d, &reason)
                                                : compile_form(kernel, d, &reason);
        if (status == SPHV_RESOURCE_FAILURE) return sphv_fail(error, status, "%s", reason.message);
        if (status == SPHV_OK)
            legal++;
        else
            snprintf(kernel->refusal[d - 1], sizeof kernel->refusal[0], "%.150s", reason.message);
    }
    if (!legal)
        return sphv_fail(error, SPHV_INVALID_INPUT,
                         "%s; allowed: a kernel that can be normalised in a declared dimension",
                         reason.message);
    return SPHV_OK;
}

const char *sphv_kernel_name(const sphv_kernel *kernel)
{
    return kernel->name;
}

const char *sphv_kernel_title(const sphv_kernel *kernel)
{
    return kernel->title;
}

const char *sphv_kernel_source(const sphv_kernel *kernel)
{
    return kernel->source ? kernel->source : "";
}

const char *sphv_kernel_path(const sphv_kernel *kernel)
{
    return kernel->path;
}

const sphv_kernel_claims *sphv_kernel_get_claims(const sphv_kernel *kernel)
{
    return &kernel->claims;
}

const sphv_profile *sphv_kernel_profile(const sphv_kernel *kernel, int dimension)
{
    if (dimension < 1 || dimension > SPHV_DIMENSIONS || kernel->refusal[dimension - 1][0])
        return NULL;
    return &kernel->profile[dimension - 1];
}

const char *sphv_kernel_refusal(const sphv_kernel *kernel, int dimension)
{
    if (dimension < 1 || dimension > SPHV_DIMENSIONS) return "allowed dimensions: 1, 2, 3";
    return kernel->refusal[dimension - 1];
}

const sphv_profile *sphv_kernel_gradient(const sphv_kernel *kernel, int dimension)
{
    return kernel->gradient.count && sphv_kernel_profile(kernel, dimension)
               ? &kernel->gradient_profile[dimension - 1]
               : NULL;
}

static void print_rational(const mpq_t value, const char *suffix, char *text, size_t size)
{
    char *digits = mpq_get_str(NULL, 10, value);
    if (!digits || (size_t)snprintf(text, size, "%s%s", digits, suffix) >= size) text[0] = '\0';
    free(digits);
}

void sphv_kernel_constant_text(const sphv_kernel *kernel, int dimension, char *text, size_t size)
{
    text[0] = '\0';
    if (kernel->polynomial && sphv_kernel_profile(kernel, dimension))
        print_rational(kernel->constant[dimension - 1], dimension > 1 ? "/pi" : "", text, size);
}

void sphv_kernel_moment_text(const sphv_kernel *kernel, int dimension, int j, char *text,
                             size_t size)
{
    text[0] = '\0';
    if (!kernel->polynomial || !sphv_kernel_profile(kernel, dimension)) return;
    mpq_t moment, surface;
    mpq_inits(moment, surface, NULL);
    mpq_set_si(surface, sphv_sphere_factor(dimension), 1);
    sphv_exact_pieces_moment(moment, &kernel->exact[dimension - 1], 0, j + dimension - 1);
    mpq_mul(moment, moment, surface);
    print_rational(moment, "", text, size);
    mpq_clears(moment, surface, NULL);
}

bool sphv_kernel_exact_value(const sphv_kernel *kernel, int dimension, int derivative, double q,
                             double *value)
{
    if (!kernel->polynomial || !sphv_kernel_profile(kernel, dimension) || !isfinite(q))
        return false;
    const sphv_exact_pieces *pieces = &kernel->exact[dimension - 1];
    mpq_t at, sum, power;
    mpq_inits(at, sum, power, NULL);
    mpq_set_d(at, q);
    int i = 0;
    while (i < pieces->count && mpq_cmp(at, pieces->outer[i]) >= 0) i++;
    if (i < pieces->count) {
        const sphv_polynomial *p = &pieces->polynomial[i];
        mpz_t falling;
        mpz_init(falling);
        for (int k = p->degree; k >= derivative; k--) {
            mpq_mul(sum, sum, at);
            mpz_set_ui(falling, 1);
            for (int m = 0; m < derivative; m++) mpz_mul_ui(falling, falling, (unsigned)(k - m));
            mpq_set_z(power, falling);
            mpq_mul(power, power, p->coefficient[k]);
            mpq_add(sum, sum, power);
        }
        mpz_clear(falling);
    }
    *value = sphv_rational_round(sum) / sphv_sphere_pi(dimension);
    mpq_clears(at, sum, power, NULL);
    return true;
}
