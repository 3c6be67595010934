/* nevh: the values of a term, in blocks or one by one.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/system_private.h"

void nevh__term_values(const nevh__term *term, bool scalar, size_t width,
                       size_t used, const double t[], const double q[],
                       const double p[], const double c[], double h[],
                       double one[]) {
    const nevh_term *is = &term->is;
    if (is->block && !(scalar && is->value)) {
        is->block(width, t, q, p, c, is->params, h);
        return;
    }
    double *one_p = one + is->nq, *one_c = one_p + is->np;
    for (size_t lane = 0; lane < used; lane++) {
        for (size_t k = 0; k < is->nq; k++)
            one[k] = q[k * width + lane];
        for (size_t k = 0; k < is->np; k++)
            one_p[k] = p[k * width + lane];
        for (size_t k = 0; k < is->nc; k++)
            one_c[k] = c[k * width + lane];
        h[lane] = is->value(t[lane], one, one_p, one_c, is->params);
    }
}
