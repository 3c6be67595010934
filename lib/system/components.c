/* nevh: which coordinates do terms connect?
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/forest_private.h"

static size_t *own_roots(size_t n) {
    size_t *up = nevh__array(n, sizeof *up);
    for (size_t k = 0; up && k < n; k++)
        up[k] = k;
    return up;
}

size_t *nevh__components(const nevh_system *s) {
    size_t *up = own_roots(s->n);
    for (size_t i = 0; up && i < s->n_terms; i++) {
        const nevh_term *decl = &s->terms[i]->decl;
        if (!nevh__term_on(s, s->terms[i]))
            continue;
        for (size_t k = 0; k < decl->count; k++) {
            const size_t *q = decl->q + k * decl->nq;
            const size_t *p = decl->p + k * decl->np;
            size_t first = decl->nq ? *q : decl->np ? *p : 0;
            for (size_t j = 0; j < decl->nq; j++)
                nevh__forest_join(up, first, q[j]);
            for (size_t j = 0; j < decl->np; j++)
                nevh__forest_join(up, first, p[j]);
        }
    }
    for (size_t k = 0; up && k < s->n; k++)
        up[k] = nevh__forest_root(up, k);
    return up;
}
