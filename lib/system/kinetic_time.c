/* nevh: does T depend on time?  Asked of the values of H alone.

   As in probe.c, of momenta and time: the mixed difference

       H(p1, t1) + H(p2, t2) - H(p1, t2) - H(p2, t1)

   at fixed coordinates vanishes if and only if what reads the momenta does not
   depend on time.  Periods of a driving are not known: spans of time are many,
   none a simple fraction of another.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/probe_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { SPANS = 22 }; /* two of them, four values each, fill a block */
static const double roundings = 16;

static void write_times(const nevh__origin *o, int round, double t[8]) {
    for (int k = 0; k < 8; k++) {
        double span = 1.618 * exp2(2 * (2 * round + k / 4) - SPANS);
        bool later = k % 4 == 1 || k % 4 == 2;
        t[k] = o->t + (later ? span : 0);
    }
}

static void write_momenta(nevh__origin *o, size_t i, double row[8]) {
    for (size_t span = 0; span < 2; span++) {
        double base = o->p ? o->p[i] : 0;
        double other = base + nevh__spread(o, o->p, o->n, i) *
                                  (1 + nevh__random(&o->random));
        for (size_t k = 4 * span; k < 4 * span + 4; k++)
            row[k] = k % 2 ? other : base;
    }
}

static bool steady_over(const double h[4]) {
    double size = fabs(h[0]) + fabs(h[1]) + fabs(h[2]) + fabs(h[3]);
    double mixed = fabs((h[0] - h[2]) + (h[1] - h[3]));
    return !isfinite(size) || mixed <= roundings * DBL_EPSILON * size;
}

/* rows: room for 9 of each variable and constant, and 24. */
static bool steady(const nevh__term_entry *term, size_t instance,
                   nevh__origin *o, double *rows) {
    const nevh_term *decl = &term->decl;
    double *q = rows, *p = q + 8 * decl->nq, *c = p + 8 * decl->np;
    double *t = c + 8 * decl->nc, *h = t + 8, *one = h + 8;
    for (size_t k = 0; k < 8 * decl->nc; k++)
        c[k] = decl->c[instance * decl->nc + k / 8];
    for (size_t k = 0; k < 8 * decl->nq; k++)
        q[k] = o->q ? o->q[decl->q[instance * decl->nq + k / 8]] : 0;
    for (int round = 0; round < SPANS / 2; round++) {
        write_times(o, round, t);
        for (size_t k = 0; k < decl->np; k++)
            write_momenta(o, decl->p[instance * decl->np + k], p + 8 * k);
        nevh__term_values(term, false, 8, 8, t, q, p, c, h, one);
        if (!steady_over(h) || !steady_over(h + 4))
            return false;
    }
    return true;
}

int nevh__system_probe_kinetic_time(const nevh_system *s, double t,
                                    const double q[], const double p[],
                                    const double scale[], const char **term) {
    nevh__origin o = nevh__origin_at(s->n, t, q, p, scale);
    *term = NULL;
    for (size_t i = 0; !*term && i < s->n_terms; i++) {
        const nevh_term *decl = &s->terms[i]->decl;
        if (!nevh__term_on(s, s->terms[i]) || !decl->np || !decl->time)
            continue;
        double *rows = nevh__array(9 * (decl->nq + decl->np + decl->nc) + 24,
                                   sizeof *rows);
        if (!rows)
            return NEVH_ENOMEM;
        for (size_t k = 0; !*term && k < decl->count; k++)
            if (!steady(s->terms[i], k, &o, rows))
                *term = decl->name;
        free(rows);
    }
    return NEVH_OK;
}
