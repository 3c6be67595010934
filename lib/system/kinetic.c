/* nevh: is T quadratic in the momenta?  Asked of the values of H alone.

   On a line through the momenta, at fixed coordinates, a quadratic T has no
   third difference.  What is found of one is compared with the values that it
   was taken of, and with the largest change that the term shows on any line:
   (p + c)^2/2, multiplied out, is rounded like p^2 where it is small, too.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/probe_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { LINES = 16 }; /* two of them, four values each, fill a block */
static const double roundings = 16;

typedef struct {
    double third[LINES], size[LINES];
    double change;
    size_t count; /* of lines on which the term is finite */
} lines;

/* Writes one variable of two lines: lanes 0 ... 3 and 4 ... 7. */
static void kinetic_write_row(nevh__origin *o, const double x[], size_t first,
                              size_t i, const double amplitude[2],
                              double row[8]) {
    bool moves = first > 0;
    for (size_t line = 0; line < 2; line++) {
        double width = amplitude[line] * nevh__spread(o, x, first, i);
        double base = (x ? x[i] : 0) + width * nevh__random(&o->random);
        double step = moves ? width * nevh__random(&o->random) : 0;
        for (size_t k = 0; k < 4; k++)
            row[4 * line + k] = base + (double)k * step;
    }
}

static void add_line(lines *l, const double h[4]) {
    double size = fabs(h[0]) + 3 * fabs(h[1]) + 3 * fabs(h[2]) + fabs(h[3]);
    if (!isfinite(size))
        return;
    l->third[l->count] = fabs((h[3] - h[0]) - 3 * (h[2] - h[1]));
    l->size[l->count++] = size;
    for (size_t k = 1; k < 4; k++)
        l->change = fmax(l->change, fabs(h[k] - h[0]));
}

/* The lines of an instance, from four times the lengths of its variables down
   to a fiftieth. */
static lines find_lines(const nevh__term_entry *term, size_t instance,
                        nevh__origin *o, double *rows) {
    const nevh_term *decl = &term->decl;
    double *q = rows, *p = q + 8 * decl->nq, *c = p + 8 * decl->np;
    double *t = c + 8 * decl->nc, *h = t + 8, *one = h + 8;
    lines l = {.count = 0};
    for (size_t k = 0; k < 8 * decl->nc; k++)
        c[k] = decl->c[instance * decl->nc + k / 8];
    for (size_t k = 0; k < 8; k++)
        t[k] = decl->time ? o->t : 0;
    for (int round = 0; round < LINES / 2; round++) {
        double amplitude[2] = {ldexp(4, -round), ldexp(2.8, -round)};
        for (size_t k = 0; k < decl->nq; k++)
            kinetic_write_row(o, o->q, 0, decl->q[instance * decl->nq + k],
                              amplitude, q + 8 * k);
        for (size_t k = 0; k < decl->np; k++)
            kinetic_write_row(o, o->p, o->n, decl->p[instance * decl->np + k],
                              amplitude, p + 8 * k);
        nevh__term_values(term, false, 8, 8, t, q, p, c, h, one);
        add_line(&l, h);
        add_line(&l, h + 4);
    }
    return l;
}

static double largest_third(const lines *l) {
    double most = 0;
    for (size_t i = 0; i < l->count; i++)
        if (l->third[i] > 0)
            most = fmax(most, l->third[i] / (l->size[i] + l->change));
    return most;
}

static int probe_term(const nevh__term_entry *term, nevh__origin *o,
                      nevh__kinetic *result) {
    const nevh_term *decl = &term->decl;
    double *rows =
        nevh__array(9 * (decl->nq + decl->np + decl->nc) + 16, sizeof *rows);
    if (!rows)
        return NEVH_ENOMEM;
    double third = 0;
    size_t count = 0;
    for (size_t i = 0; i < decl->count; i++) {
        lines l = find_lines(term, i, o, rows);
        third = fmax(third, largest_third(&l));
        count += l.count;
    }
    free(rows);
    if (!result->term || !count || third > result->third) {
        result->term = decl->name;
        result->third = third;
    }
    return count ? NEVH_OK : NEVH_EDOM;
}

int nevh__system_probe_kinetic(const nevh_system *s, double t, const double q[],
                               const double p[], const double scale[],
                               nevh__kinetic *result) {
    nevh__origin o = nevh__origin_at(s->n, t, q, p, scale);
    *result = (nevh__kinetic){.quadratic = false};
    for (size_t i = 0; i < s->n_terms; i++) {
        const nevh__term_entry *term = s->terms[i];
        if (!nevh__term_on(s, term) || !term->decl.np)
            continue;
        int status = probe_term(term, &o, result);
        if (status)
            return status;
    }
    result->quadratic = result->third <= roundings * DBL_EPSILON;
    return NEVH_OK;
}
