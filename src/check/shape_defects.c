/// Mistakes in the pieces of w.
#include <math.h>
#include <stdlib.h>

#include "defects.h"

static mpq_t *nonzero(sphv_kernel *kernel, int index)
{
    return sphv_defect_coefficient(&kernel->pieces, index);
}

/// A polynomial kernel, and the only variant of a defect of all of it.
static bool once(const sphv_kernel *kernel, int variant)
{
    return variant == 0 && kernel->pieces.count > 0;
}

static sphv_application scale_coefficient(sphv_kernel *kernel, int variant, long over)
{
    mpq_t *c = nonzero(kernel, variant);
    if (!c) return SPHV_NO_MORE;
    sphv_defect_scale(*c, over + 1, (unsigned long)over);
    return SPHV_APPLIED;
}

static sphv_application coefficient_sixth(sphv_kernel *kernel, int variant)
{
    return scale_coefficient(kernel, variant, 1000000);
}

static sphv_application coefficient_fifth(sphv_kernel *kernel, int variant)
{
    return scale_coefficient(kernel, variant, 20000);
}

static sphv_application coefficient_sign(sphv_kernel *kernel, int variant)
{
    mpq_t *c = nonzero(kernel, variant);
    if (!c) return SPHV_NO_MORE;
    mpq_neg(*c, *c);
    return SPHV_APPLIED;
}

static sphv_application coefficient_dropped(sphv_kernel *kernel, int variant)
{
    mpq_t *c = nonzero(kernel, variant);
    if (!c) return SPHV_NO_MORE;
    mpq_set_ui(*c, 0, 1);
    return SPHV_APPLIED;
}

/// Swaps neighbours among the coefficients of a piece that are not zero.
static sphv_application coefficients_swapped(sphv_kernel *kernel, int variant)
{
    for (int i = 0; i < kernel->pieces.count; i++) {
        sphv_polynomial *p = &kernel->pieces.polynomial[i];
        mpq_t *before = NULL;
        for (int k = 0; k <= p->degree; k++) {
            if (mpq_sgn(p->coefficient[k]) == 0) continue;
            if (before && variant-- == 0) {
                mpq_swap(*before, p->coefficient[k]);
                return SPHV_APPLIED;
            }
            before = &p->coefficient[k];
        }
    }
    return SPHV_NO_MORE;
}

/// Leaves out one entry of the list, so that all further ones slip down one power.
static sphv_application entry_left_out(sphv_kernel *kernel, int variant)
{
    for (int i = 0; i < kernel->pieces.count; i++) {
        sphv_polynomial *p = &kernel->pieces.polynomial[i];
        for (int k = 0; k < p->degree; k++) {
            if (mpq_sgn(p->coefficient[k]) != 0 || variant-- > 0) continue;
            for (int m = k; m < p->degree; m++) mpq_swap(p->coefficient[m], p->coefficient[m + 1]);
            mpq_set_ui(p->coefficient[p->degree], 0, 1);
            return SPHV_APPLIED;
        }
    }
    return SPHV_NO_MORE;
}

static sphv_application pieces_swapped(sphv_kernel *kernel, int variant)
{
    if (variant + 1 >= kernel->pieces.count) return SPHV_NO_MORE;
    sphv_polynomial *p = kernel->pieces.polynomial, kept = p[variant];
    p[variant] = p[variant + 1];
    p[variant + 1] = kept;
    return SPHV_APPLIED;
}

static sphv_application knot_moved(sphv_kernel *kernel, int variant)
{
    if (variant + 1 >= kernel->pieces.count) return SPHV_NO_MORE;
    sphv_defect_scale(kernel->pieces.outer[variant], 51, 50);
    return SPHV_APPLIED;
}

/// Makes sure that a piece has a coefficient of q^degree. \return false without memory
static bool make_room(sphv_polynomial *p, int degree)
{
    if (p->degree >= degree) return true;
    mpq_t *grown = realloc(p->coefficient, (size_t)(degree + 1) * sizeof *grown);
    if (!grown) return false;
    p->coefficient = grown;
    while (p->degree < degree) mpq_init(p->coefficient[++p->degree]);
    return true;
}

/// p += factor · q^low (q − root)^m
static bool add_power(sphv_polynomial *p, const mpq_t factor, int low, const mpq_t root, int m)
{
    if (low + m > SPHV_DEGREE_MAX || !make_room(p, low + m)) return false;
    mpq_t part, negative;
    mpz_t binomial;
    mpq_inits(part, negative, NULL);
    mpz_init(binomial);
    mpq_neg(negative, root);
    for (int k = 0; k <= m; k++) {
        mpz_bin_uiui(binomial, (unsigned)m, (unsigned)k);
        sphv_rational_power(part, negative, m - k);
        mpq_mul(part, part, factor);
        mpz_mul(mpq_numref(part), mpq_numref(part), binomial);
        mpq_canonicalize(part);
        mpq_add(p->coefficient[low + k], p->coefficient[low + k], part);
    }
    mpz_clear(binomial);
    mpq_clears(part, negative, NULL);
    return true;
}

/// A thousandth of w(0), or of 1 where that is zero.
static void small_height(mpq_t out, const sphv_kernel *kernel)
{
    mpq_t thousand;
    mpq_init(thousand);
    mpq_set_ui(thousand, 1000, 1);
    mpq_set(out, kernel->pieces.polynomial[0].coefficient[0]);
    if (mpq_sgn(out) == 0) mpq_set_ui(out, 1, 1);
    mpq_div(out, out, thousand);
    mpq_clear(thousand);
}

/// Adds ε(q − knot)^m in all pieces beyond an interior knot; before κ in kernels of one piece.
static sphv_application add_jump(sphv_kernel *kernel, int variant, int m)
{
    sphv_exact_pieces *pieces = &kernel->pieces;
    int knot = variant, first = variant + 1;
    if (pieces->count == 1) first = knot = 0;
    if (variant && variant + 1 >= pieces->count) return SPHV_NO_MORE;
    if (!pieces->count) return SPHV_NO_MORE;
    mpq_t height;
    mpq_init(height);
    small_height(height, kernel);
    bool done = true;
    for (int i = first; i < pieces->count; i++)
        done = done && add_power(&pieces->polynomial[i], height, 0, pieces->outer[knot], m);
    mpq_clear(height);
    return done ? SPHV_APPLIED : SPHV_NOT_HERE;
}

static sphv_application value_jump(sphv_kernel *kernel, int variant)
{
    return add_jump(kernel, variant, 0);
}

static sphv_application slope_jump(sphv_kernel *kernel, int variant)
{
    return add_jump(kernel, variant, 1);
}

static sphv_application curvature_jump(sphv_kernel *kernel, int variant)
{
    return add_jump(kernel, variant, 2);
}

/// Adds ε q^low (q − κ)^m to the whole kernel.
static sphv_application add_everywhere(sphv_kernel *kernel, int variant, int low)
{
    sphv_exact_pieces *pieces = &kernel->pieces;
    if (variant || !pieces->count) return SPHV_NO_MORE;
    const int *beta = kernel->claims.boundary_smoothness;
    int m = beta && *beta > 0 ? *beta + 1 : 2;
    mpq_t height, scale;
    mpq_inits(height, scale, NULL);
    small_height(height, kernel);
    sphv_rational_power(scale, pieces->outer[pieces->count - 1], m + low);
    mpq_div(height, height, scale);
    bool done = true;
    for (int i = 0; i < pieces->count; i++)
        done = done &&
               add_power(&pieces->polynomial[i], height, low, pieces->outer[pieces->count - 1], m);
    mpq_clears(height, scale, NULL);
    return done ? SPHV_APPLIED : SPHV_NOT_HERE;
}

static sphv_application odd_part(sphv_kernel *kernel, int variant)
{
    return add_everywhere(kernel, variant, 1);
}

static sphv_application smooth_bump(sphv_kernel *kernel, int variant)
{
    return add_everywhere(kernel, variant, 2);
}

/// Sets pieces that are negative in their middle to zero.
static sphv_application negatives_clamped(sphv_kernel *kernel, int variant)
{
    sphv_exact_pieces *pieces = &kernel->pieces;
    if (variant || kernel->fourth_order) return SPHV_NO_MORE;
    sphv_application outcome = SPHV_NO_MORE;
    mpq_t middle, value;
    mpq_inits(middle, value, NULL);
    for (int i = 1; i < pieces->count; i++) {
        mpq_add(middle, pieces->outer[i - 1], pieces->outer[i]);
        mpq_div_2exp(middle, middle, 1);
        sphv_polynomial_value(value, &pieces->polynomial[i], middle);
        if (mpq_sgn(value) >= 0) continue;
        for (int k = 0; k <= pieces->polynomial[i].degree; k++)
            mpq_set_ui(pieces->polynomial[i].coefficient[k], 0, 1);
        outcome = SPHV_APPLIED;
    }
    mpq_clears(middle, value, NULL);
    return outcome;
}

static void set_support(sphv_kernel *kernel, const mpq_t support)
{
    kernel->support = sphv_rational_number(support);
}

/// Cuts the kernel off at 3κ/4 and leaves the constants as they are.
static sphv_application truncated(sphv_kernel *kernel, int variant)
{
    sphv_exact_pieces *pieces = &kernel->pieces;
    if (variant || !pieces->count) return SPHV_NO_MORE;
    mpq_t end;
    mpq_init(end);
    mpq_set_ui(end, 3, 4);
    mpq_mul(end, end, pieces->outer[pieces->count - 1]);
    while (pieces->count > 1 && mpq_cmp(pieces->outer[pieces->count - 2], end) >= 0) {
        pieces->count--;
        mpq_clear(pieces->outer[pieces->count]);
        sphv_polynomial_free(&pieces->polynomial[pieces->count]);
    }
    mpq_set(pieces->outer[pieces->count - 1], end);
    set_support(kernel, end);
    mpq_clear(end);
    return SPHV_APPLIED;
}

/// Declares half as much support again; w is zero there.
static sphv_application overstated(sphv_kernel *kernel, int variant)
{
    sphv_exact_pieces *pieces = &kernel->pieces, grown = {0, NULL, NULL, 0};
    if (variant || !pieces->count || kernel->gradient.count) return SPHV_NO_MORE;
    int count = pieces->count;
    if (sphv_exact_pieces_make(&grown, count + 1, NULL) != SPHV_OK) return SPHV_NOT_HERE;
    bool done = true;
    for (int i = 0; i < count; i++) {
        mpq_swap(grown.outer[i], pieces->outer[i]);
        grown.polynomial[i] = pieces->polynomial[i];
        pieces->polynomial[i] = (sphv_polynomial){-1, NULL};
    }
    done = sphv_polynomial_make(&grown.polynomial[count], 0, NULL) == SPHV_OK;
    mpq_set_ui(grown.outer[count], 3, 2);
    mpq_mul(grown.outer[count], grown.outer[count], grown.outer[count - 1]);
    set_support(kernel, grown.outer[count]);
    sphv_exact_pieces_free(pieces);
    *pieces = grown;
    return done ? SPHV_APPLIED : SPHV_NOT_HERE;
}

static sphv_application to_float(sphv_kernel *kernel, int variant)
{
    if (!once(kernel, variant)) return SPHV_NO_MORE;
    sphv_defect_round_all(&kernel->pieces, 0);
    return SPHV_APPLIED;
}

static sphv_application to_three_digits(sphv_kernel *kernel, int variant)
{
    if (!once(kernel, variant)) return SPHV_NO_MORE;
    sphv_defect_round_all(&kernel->pieces, 3);
    return SPHV_APPLIED;
}

static sphv_application to_six_digits(sphv_kernel *kernel, int variant)
{
    if (!once(kernel, variant)) return SPHV_NO_MORE;
    sphv_defect_round_all(&kernel->pieces, 6);
    return SPHV_APPLIED;
}

/// Multiplies the coefficient of q^k by 2^k: h taken for 2h inside w; or divides it.
static sphv_application scale_argument(sphv_kernel *kernel, int variant,
                                       void (*by)(mpq_t, const mpq_t, mp_bitcnt_t))
{
    if (!once(kernel, variant)) return SPHV_NO_MORE;
    for (int i = 0; i < kernel->pieces.count; i++) {
        sphv_polynomial *p = &kernel->pieces.polynomial[i];
        for (int k = 0; k <= p->degree; k++)
            by(p->coefficient[k], p->coefficient[k], (mp_bitcnt_t)k);
    }
    return SPHV_APPLIED;
}

static sphv_application argument_doubled(sphv_kernel *kernel, int variant)
{
    return scale_argument(kernel, variant, mpq_mul_2exp);
}

static sphv_application argument_halved(sphv_kernel *kernel, int variant)
{
    return scale_argument(kernel, variant, mpq_div_2exp);
}

static sphv_application shape_scaled(sphv_kernel *kernel, int variant)
{
    if (!once(kernel, variant)) return SPHV_NO_MORE;
    sphv_defect_scale_all(&kernel->pieces, 4, 3);
    return SPHV_APPLIED;
}

const sphv_defect sphv_shape_defects[] = {
    {"coefficient-1e-6", "one coefficient off by 1e-6 of itself", "coefficient of",
     coefficient_sixth},
    {"coefficient-digit-5", "one coefficient wrong in its fifth digit", "coefficient of",
     coefficient_fifth},
    {"coefficient-sign", "one coefficient with the wrong sign", "sign of the coefficient",
     coefficient_sign},
    {"coefficient-dropped", "one coefficient left at zero", "coefficient of", coefficient_dropped},
    {"coefficients-swapped", "two coefficients swapped", "swapped", coefficients_swapped},
    {"entry-left-out", "a zero left out of the list of coefficients", "left out|swapped",
     entry_left_out},
    {"pieces-swapped", "two pieces swapped", "swapped", pieces_swapped},
    {"knot-moved", "an interior knot moved by 2 %", "knot is moved", knot_moved},
    {"value-jump", "a jump of the value at a knot or at the edge",
     "jump|coefficient of q^0|not zero", value_jump},
    {"slope-jump", "a jump of the first derivative at a knot or at the edge", "slope of w",
     slope_jump},
    {"curvature-jump", "a jump of the second derivative at a knot or at the edge", "curvature of w",
     curvature_jump},
    {"odd-part", "an odd part added, smooth at the edge", "odd part|coefficient of", odd_part},
    {"smooth-bump", "an even part added, smooth at the edge", "constant|coefficient", smooth_bump},
    {"negatives-clamped", "negative values replaced by zero", "clamped", negatives_clamped},
    {"truncated", "cut off at 3/4 of the support without renormalising", "truncated|not zero",
     truncated},
    {"support-overstated", "a support half as large again as w has", "overstated", overstated},
    {"coefficients-float", "coefficients rounded to single precision", "rounded", to_float},
    {"coefficients-3-digits", "coefficients rounded to three digits", "rounded|coefficient",
     to_three_digits},
    {"coefficients-6-digits", "coefficients rounded to six digits", "rounded|coefficient",
     to_six_digits},
    {"argument-doubled", "w(2q) for w(q): h taken for 2h inside", "argument is scaled",
     argument_doubled},
    {"argument-halved", "w(q/2) for w(q): the support radius taken for h inside",
     "argument is scaled", argument_halved},
    {"shape-scaled", "w multiplied by 4/3, the constants left as they are",
     "different scalings|times", shape_scaled},
    {NULL, NULL, NULL, NULL},
};
