/* nevh: is H a sum T(p) + V(q)?  Asked of its values alone.

   For two states (q1, p1) and (q2, p2) the mixed difference
   D = H(q1,p1) + H(q2,p2) - H(q1,p2) - H(q2,p1) vanishes if and only if H is
   such a sum.  A term is tried at pairs of states around the one given, near
   and far, since a far one may lie outside the domain of H.  What is called
   rounding here is kept tight: to take a separable H for a coupled one leads
   to a refusal that says why, the opposite to a wrong orbit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/probe_private.h"
#include <fenv.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { PAIRS = 16 }; /* two of them, four values each, fill a block */
static const double roundings = 16;

static double probe_largest(const double x[], size_t n) {
    double most = 0;
    for (size_t i = 0; x && i < n; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

nevh__origin nevh__origin_at(size_t n, double t, const double q[],
                             const double p[], const double scale[]) {
    return (nevh__origin){
        .t = t,
        .q = q,
        .p = p,
        .scale = scale,
        .n = n,
        .random = 1,
        .largest = {probe_largest(q, n), probe_largest(p, n)}};
}

double nevh__spread(const nevh__origin *o, const double x[], size_t first,
                    size_t i) {
    if (o->scale)
        return o->scale[first + i];
    double most = x && x[i] != 0 ? fabs(x[i]) : o->largest[first > 0];
    return most > 0 ? most : 1;
}

/* Writes one variable of both pairs: lanes 0 ... 3 are the first pair's
   (1,1) (2,2) (1,2) (2,1), lanes 4 ... 7 the second's.  `second` says which
   lanes take the second state. */
static void probe_write_row(nevh__origin *o, const double x[], size_t first,
                            size_t i, const double amplitude[2],
                            const bool second[8], double row[8]) {
    for (size_t pair = 0; pair < 2; pair++) {
        double width = amplitude[pair] * nevh__spread(o, x, first, i);
        double base = x ? x[i] : 0;
        double one = base + width * nevh__random(&o->random);
        double two = base + width * nevh__random(&o->random);
        for (size_t k = 4 * pair; k < 4 * pair + 4; k++)
            row[k] = second[k] ? two : one;
    }
}

/* The largest mixed difference of an instance, relative; adds to *states. */
static double probe_instance(const nevh__term_entry *term, size_t instance,
                             nevh__origin *o, double *rows, size_t *states) {
    static const bool second_q[8] = {0, 1, 0, 1, 0, 1, 0, 1};
    static const bool second_p[8] = {0, 1, 1, 0, 0, 1, 1, 0};
    const nevh_term *decl = &term->decl;
    double *q = rows, *p = q + 8 * decl->nq, *c = p + 8 * decl->np;
    double *t = c + 8 * decl->nc, *h = t + 8, *one = h + 8, most = 0;
    for (size_t k = 0; k < 8 * decl->nc; k++)
        c[k] = decl->c[instance * decl->nc + k / 8];
    for (size_t k = 0; k < 8; k++)
        t[k] = decl->time ? o->t : 0;
    for (size_t round = 0; round < PAIRS / 2; round++) {
        double amplitude[2] = {ldexp(1, -(int)round), ldexp(0.7, -(int)round)};
        for (size_t k = 0; k < decl->nq; k++)
            probe_write_row(o, o->q, 0, decl->q[instance * decl->nq + k],
                            amplitude, second_q, q + 8 * k);
        for (size_t k = 0; k < decl->np; k++)
            probe_write_row(o, o->p, o->n, decl->p[instance * decl->np + k],
                            amplitude, second_p, p + 8 * k);
        nevh__term_values(term, false, 8, 8, t, q, p, c, h, one);
        for (double *v = h; v < h + 8; v += 4) {
            double size = fabs(v[0]) + fabs(v[1]) + fabs(v[2]) + fabs(v[3]);
            if (!isfinite(size))
                continue;
            ++*states;
            if (size > 0)
                most = fmax(most, fabs((v[0] - v[2]) + (v[1] - v[3])) / size);
        }
    }
    return most;
}

static int probe_term(const nevh__term_entry *term, nevh__origin *o,
                      nevh_separability *result) {
    const nevh_term *decl = &term->decl;
    double *rows =
        nevh__array(9 * (decl->nq + decl->np + decl->nc) + 16, sizeof *rows);
    if (!rows)
        return NEVH_ENOMEM;
    double mixed = 0;
    size_t states = 0;
    for (size_t i = 0; i < decl->count; i++)
        mixed = fmax(mixed, probe_instance(term, i, o, rows, &states));
    free(rows);
    bool separable = states > 0 && mixed <= roundings * DBL_EPSILON;
    if (!result->term || (result->separable && !separable) ||
        (result->separable == separable && mixed > result->mixed)) {
        result->term = decl->name;
        result->mixed = mixed;
        result->states = states;
    }
    result->separable = result->separable && separable;
    return states ? NEVH_OK : NEVH_EDOM;
}

int nevh_system_probe(const nevh_system *s, double t, const double q[],
                      const double p[], const double scale[],
                      nevh_separability *result) {
    if (!result)
        return NEVH_EINVAL;
    *result = (nevh_separability){.separable = true};
    if (nevh_system_status(s))
        return nevh_system_status(s);
    nevh__origin o = nevh__origin_at(s->n, t, q, p, scale);
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    int status = NEVH_OK;
    for (size_t i = 0; i < s->n_terms && status != NEVH_ENOMEM; i++) {
        const nevh__term_entry *term = s->terms[i];
        if (!nevh__term_on(s, term) || !term->decl.nq || !term->decl.np)
            continue;
        int one = probe_term(term, &o, result);
        status = one ? one : status;
    }
    fesetenv(&own);
    result->separable = result->separable && !status;
    return status;
}
