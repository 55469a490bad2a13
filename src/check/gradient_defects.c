/// Mistakes in the gradient that a file gives.
#include "defects.h"

static sphv_application scale_gradient(sphv_kernel *kernel, int variant, long numerator,
                                       unsigned long denominator)
{
    if (variant || !sphv_defect_give_gradient(kernel)) return SPHV_NO_MORE;
    sphv_defect_scale_all(&kernel->gradient, numerator, denominator);
    return SPHV_APPLIED;
}

static sphv_application gradient_sign(sphv_kernel *kernel, int variant)
{
    return scale_gradient(kernel, variant, -1, 1);
}

static sphv_application gradient_chain_rule(sphv_kernel *kernel, int variant)
{
    return scale_gradient(kernel, variant, 1, 2);
}

static sphv_application gradient_lacks_q(sphv_kernel *kernel, int variant)
{
    if (variant || !sphv_defect_give_gradient(kernel)) return SPHV_NO_MORE;
    for (int i = 0; i < kernel->gradient.count; i++) // w′/q must be a polynomial
        if (mpq_sgn(kernel->gradient.polynomial[i].coefficient[0]) != 0) return SPHV_NO_MORE;
    for (int i = 0; i < kernel->gradient.count; i++) {
        sphv_polynomial *p = &kernel->gradient.polynomial[i];
        for (int k = 0; k < p->degree; k++) mpq_swap(p->coefficient[k], p->coefficient[k + 1]);
    }
    return SPHV_APPLIED;
}

static sphv_application gradient_extra_q(sphv_kernel *kernel, int variant)
{
    if (variant || !sphv_defect_give_gradient(kernel)) return SPHV_NO_MORE;
    // The derivative leaves the highest coefficient free.
    for (int i = 0; i < kernel->gradient.count; i++) {
        sphv_polynomial *p = &kernel->gradient.polynomial[i];
        if (mpq_sgn(p->coefficient[p->degree]) != 0) return SPHV_NO_MORE;
        for (int k = p->degree; k > 0; k--) mpq_swap(p->coefficient[k], p->coefficient[k - 1]);
    }
    return SPHV_APPLIED;
}

static sphv_application gradient_is_value(sphv_kernel *kernel, int variant)
{
    if (variant || !sphv_defect_give_gradient(kernel)) return SPHV_NO_MORE;
    sphv_exact_pieces_free(&kernel->gradient);
    return sphv_exact_pieces_copy(&kernel->gradient, &kernel->pieces, 0, NULL) == SPHV_OK
               ? SPHV_APPLIED
               : SPHV_NOT_HERE;
}

static sphv_application gradient_coefficient_off(sphv_kernel *kernel, int variant)
{
    if (!sphv_defect_give_gradient(kernel)) return SPHV_NO_MORE;
    mpq_t *c = sphv_defect_coefficient(&kernel->gradient, variant);
    if (!c) return SPHV_NO_MORE;
    sphv_defect_scale(*c, 1000001, 1000000);
    return SPHV_APPLIED;
}

static sphv_application gradient_piece_lost(sphv_kernel *kernel, int variant)
{
    if (!sphv_defect_give_gradient(kernel) || variant >= kernel->gradient.count)
        return SPHV_NO_MORE;
    sphv_polynomial *p = &kernel->gradient.polynomial[variant];
    for (int k = 0; k <= p->degree; k++) mpq_set_ui(p->coefficient[k], 0, 1);
    return SPHV_APPLIED;
}

static sphv_application gradient_float(sphv_kernel *kernel, int variant)
{
    if (variant || !sphv_defect_give_gradient(kernel)) return SPHV_NO_MORE;
    sphv_defect_round_all(&kernel->gradient, 0);
    return SPHV_APPLIED;
}

const sphv_defect sphv_gradient_defects[] = {
    {"gradient-sign", "gradient with the wrong sign", "sign is flipped", gradient_sign},
    {"gradient-chain-rule", "gradient with respect to 2q", "times too large", gradient_chain_rule},
    {"gradient-lacks-q", "gradient without a factor q", "lacks a factor q", gradient_lacks_q},
    {"gradient-extra-q", "gradient with a factor q too many", "factor q too many",
     gradient_extra_q},
    {"gradient-is-value", "w itself given for its gradient", "w itself", gradient_is_value},
    {"gradient-1e-6", "one coefficient of the gradient off by 1e-6", "coefficient",
     gradient_coefficient_off},
    {"gradient-piece-lost", "one piece of the gradient left at zero", "coefficient",
     gradient_piece_lost},
    {"gradient-float", "gradient rounded to single precision", "rounded|coefficient",
     gradient_float},
    {NULL, NULL, NULL, NULL},
};
