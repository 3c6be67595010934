/* nevh: the complex step.

   For an analytic H, dH/dx = Im H(x + i s) / s up to s^2, without cancellation
   [W. Squire, G. Trapp, "Using complex variables to estimate derivatives of
   real functions", SIAM Rev. 40 (1998) 110-112]; with s = 1e-100
   nothing is left of the error but rounding in H itself.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/block_private.h"
#include <math.h>

static const double step = 0x1p-332; /* 1e-100; dividing does not round */

/* Gathers one column as complex numbers without imaginary parts. */
static void complex_gather(const nevh_field *f, const nevh__planned *term,
                           const nevh__block *b, size_t column) {
    for (size_t j = 0; j < term->nv; j++) {
        f->one[2 * j] = nevh__row(f, b, j)[column];
        f->one[2 * j + 1] = 0;
    }
    for (size_t j = 0; j < term->term->decl.nc; j++)
        f->one[2 * term->nv + j] = nevh__row(f, b, term->nv + j)[column];
}

/* Adds the derivative with respect to variable k at the column gathered. */
static int add_column(nevh_field *f, nevh__planned *term, const nevh__block *b,
                      size_t column, size_t k, double *out) {
    const nevh_term *decl = &term->term->decl;
    size_t i = nevh__index(term, b->group + column / b->lanes, k);
    size_t lane = b->lane + column % b->lanes;
    double h[2] = {0, 0};
    const double(*one)[2] = (const double(*)[2])f->one;
    f->one[2 * k + 1] = step;
    decl->complex_value(decl->time ? f->times[column] : 0, one, one + term->nq,
                        f->one + 2 * term->nv, decl->params, h);
    f->one[2 * k + 1] = 0;
    double slope = h[1] * (1 / step);
    out[i * b->width + lane] += slope;
    if ((h[0] - h[0]) + (slope - slope) == 0)
        return NEVH_OK;
    bool of_value = !isfinite(h[0]);
    return nevh__block_fail(f, term, b, column,
                            of_value ? "" : "a derivative of ",
                            of_value ? h[0] : slope);
}

int nevh__gradient_complex(nevh_field *f, nevh__planned *term,
                           const nevh__places *at) {
    nevh__block b = nevh__block_over(at->width, at->t, at->q, at->p, 1, 1);
    size_t first = at->dh_dq ? 0 : term->nq;
    size_t end = at->dh_dp ? term->nv : term->nq;
    int status = NEVH_OK;
    while (!status && nevh__block_next(f, term, &b))
        for (size_t column = 0; !status && column < b.used; column++) {
            complex_gather(f, term, &b, column);
            term->values += end - first;
            for (size_t k = first; !status && k < end; k++)
                status = add_column(f, term, &b, column, k,
                                    k < term->nq ? at->dh_dq : at->dh_dp);
        }
    return status;
}
