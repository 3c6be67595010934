/* nevh: the derivatives that terms bring themselves.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <math.h>
#include <nevh/body.h>

/* Adds one number a lane to `out`; returns whether one is not finite. */
NEVH_SIMD static bool add_lanes(size_t lanes, const double *row, double *out) {
    int64_t bad = 0;
    for (size_t lane = 0; lane < lanes; lane++)
        out[lane] += row[lane];
    for (size_t lane = 0; lane < lanes; lane++)
        bad |= row[lane] - row[lane] != 0;
    return bad != 0;
}

/* Adds a variable's derivatives; returns whether one is not finite. */
static bool add_row(const nevh__planned *term, const nevh__block *b, size_t k,
                    const double *row, double *out) {
    bool bad = false;
    for (size_t group = 0; group < b->groups; group++, row += b->lanes) {
        size_t i = nevh__index(term, b->group + group, k);
        double *to = out + i * b->width + b->lane;
        if (b->lanes == 1) {
            *to += *row;
            bad |= *row - *row != 0;
        } else
            bad |= add_lanes(b->lanes, row, to);
    }
    return bad;
}

static int fail(nevh_field *f, const nevh__planned *term, const nevh__block *b,
                const double *row) {
    size_t column = 0;
    while (column + 1 < b->used && isfinite(row[column]))
        column++;
    return nevh__block_fail(f, term, b, column, "a derivative of ",
                            row[column]);
}

static int exact_block(nevh_field *f, nevh__planned *term, nevh__block *b,
                       double dh_dq[], double dh_dp[]) {
    const nevh_term *decl = &term->term->decl;
    const double *q = f->rows, *p = q + term->nq * b->stride;
    const double *c = p + term->np * b->stride;
    double *slopes_p = f->slopes + term->nq * b->stride;
    decl->gradient(b->stride, decl->time ? f->times : f->zeros, q, p, c,
                   decl->params, dh_dq ? f->slopes : NULL,
                   dh_dp ? slopes_p : NULL);
    for (size_t k = dh_dq ? 0 : term->nq; k < (dh_dp ? term->nv : term->nq);
         k++) {
        const double *row = f->slopes + k * b->stride;
        if (add_row(term, b, k, row, k < term->nq ? dh_dq : dh_dp))
            return fail(f, term, b, row);
    }
    return NEVH_OK;
}

int nevh__gradient_exact(nevh_field *f, nevh__planned *term, size_t width,
                         const double t[], const double q[], const double p[],
                         double dh_dq[], double dh_dp[]) {
    nevh__block b = nevh__block_over(width, t, q, p, 1, 1);
    int status = NEVH_OK;
    while (!status && nevh__block_next(f, term, &b))
        status = exact_block(f, term, &b, dh_dq, dh_dp);
    return status;
}
