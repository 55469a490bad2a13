#include "dense.h"

SPHV_CLONES void sphv_dense_factor_large(int n, sphv_dense *of)
{
    sphv_dense_factor_inline(n, of);
}

SPHV_CLONES void sphv_dense_solve_large(int n, const sphv_dense *of, const sphv_bounded *b,
                                        sphv_bounded *out)
{
    sphv_dense_solve_inline(n, of, b, out);
}
