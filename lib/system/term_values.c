/* nevh: the values of a term, in blocks or one by one.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/system_private.h"

void nevh__term_values(const nevh__term_entry *term, bool scalar, size_t width,
                       size_t used, const double t[], const double q[],
                       const double p[], const double c[], double h[],
                       double one[]) {
    const nevh_term *decl = &term->decl;
    if (decl->block && !(scalar && decl->value)) {
        decl->block(width, t, q, p, c, decl->params, h);
        return;
    }
    double *one_p = one + decl->nq, *one_c = one_p + decl->np;
    for (size_t lane = 0; lane < used; lane++) {
        for (size_t k = 0; k < decl->nq; k++)
            one[k] = q[k * width + lane];
        for (size_t k = 0; k < decl->np; k++)
            one_p[k] = p[k * width + lane];
        for (size_t k = 0; k < decl->nc; k++)
            one_c[k] = c[k * width + lane];
        h[lane] = decl->value(t[lane], one, one_p, one_c, decl->params);
    }
}
