/* nevh: the derivatives that terms bring themselves.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <math.h>

/* Adds a variable's derivatives to `out`; the first column that is not finite,
   or `used`. */
static size_t add_row(const nevh__planned *term, const nevh__block *b, size_t k,
                      const double *row, double *out) {
    for (size_t column = 0; column < b->used; column += b->lanes) {
        size_t instance = b->group + column / b->lanes;
        double *to = out + nevh__index(term, instance, k) * b->width + b->lane;
        for (size_t lane = 0; lane < b->lanes; lane++) {
            if (!isfinite(row[column + lane]))
                return column + lane;
            to[lane] += row[column + lane];
        }
    }
    return b->used;
}

static int exact_block(nevh_field *f, nevh__planned *term, nevh__block *b,
                       double dh_dq[], double dh_dp[]) {
    const nevh_term *is = &term->term->is;
    const double *q = f->rows, *p = q + term->nq * b->stride;
    const double *c = p + term->np * b->stride;
    double *slopes_p = f->slopes + term->nq * b->stride;
    is->gradient(b->stride, is->time ? f->times : f->zeros, q, p, c, is->params,
                 dh_dq ? f->slopes : NULL, dh_dp ? slopes_p : NULL);
    for (size_t k = dh_dq ? 0 : term->nq; k < (dh_dp ? term->nv : term->nq);
         k++) {
        const double *row = f->slopes + k * b->stride;
        size_t bad = add_row(term, b, k, row, k < term->nq ? dh_dq : dh_dp);
        if (bad < b->used)
            return nevh__block_fail(f, term, b, bad, "a derivative of ",
                                    row[bad]);
    }
    return NEVH_OK;
}

int nevh__exact(nevh_field *f, nevh__planned *term, size_t width,
                const double t[], const double q[], const double p[],
                double dh_dq[], double dh_dp[]) {
    nevh__block b = nevh__block_over(width, t, q, p, 1, 1);
    int status = NEVH_OK;
    while (!status && nevh__block_next(f, term, &b))
        status = exact_block(f, term, &b, dh_dq, dh_dp);
    return status;
}
