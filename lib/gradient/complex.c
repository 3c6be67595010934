/* nevh: the complex step.

   For an analytic H, dH/dx = Im H(x + i s) / s up to s^2, without cancellation
   [W. Squire, G. Trapp, "Using complex variables to estimate derivatives of
   real functions", SIAM Rev. 40 (1998) 110-112]; with s = 1e-100 of the
   variable's scale nothing is left of the error but rounding in H itself.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <math.h>

static const double part = 0x1p-332; /* 1e-100, and no rounding in dividing */

/* Gathers one column as complex numbers, with the step in variable k. */
static void gather(const nevh_field *f, const nevh__planned *term,
                   const nevh__block *b, size_t column, size_t k, double step) {
    for (size_t j = 0; j < term->nv; j++) {
        f->one[2 * j] = nevh__row(f, b, j)[column];
        f->one[2 * j + 1] = j == k ? step : 0;
    }
    for (size_t j = 0; j < term->term->is.nc; j++)
        f->one[2 * term->nv + j] = nevh__row(f, b, term->nv + j)[column];
}

/* Adds the derivative with respect to variable k at one column. */
static int add_column(nevh_field *f, nevh__planned *term, const nevh__block *b,
                      size_t column, size_t k, double *out) {
    const nevh_term *is = &term->term->is;
    size_t instance = b->group + column / b->lanes;
    size_t i = nevh__index(term, instance, k), lane = column % b->lanes;
    double step =
        part * exp2(ceil(log2(f->scale[k < term->nq ? i : f->n + i])));
    double h[2] = {0, 0};
    const double(*one)[2] = (const double(*)[2])f->one;
    gather(f, term, b, column, k, step);
    is->complex_value(is->time ? f->times[column] : 0, one, one + term->nq,
                      f->one + 2 * term->nv, is->params, h);
    term->values++;
    double slope = h[1] / step;
    out[i * b->width + b->lane + lane] += slope;
    return isfinite(h[0]) && isfinite(slope)
               ? NEVH_OK
               : nevh__block_fail(f, term, b, column,
                                  isfinite(h[0]) ? "a derivative of " : "",
                                  isfinite(h[0]) ? slope : h[0]);
}

int nevh__gradient_complex(nevh_field *f, nevh__planned *term, size_t width,
                           const double t[], const double q[], const double p[],
                           double dh_dq[], double dh_dp[]) {
    nevh__block b = nevh__block_over(width, t, q, p, 1, 1);
    size_t first = dh_dq ? 0 : term->nq, end = dh_dp ? term->nv : term->nq;
    int status = NEVH_OK;
    while (!status && nevh__block_next(f, term, &b))
        for (size_t column = 0; !status && column < b.used; column++)
            for (size_t k = first; !status && k < end; k++)
                status = add_column(f, term, &b, column, k,
                                    k < term->nq ? dh_dq : dh_dp);
    return status;
}
