/* nevh: the variational equations as a Hamiltonian system of twice the size.

   K(q, dq; dp, p) = sum of dq dH/dq + dp dH/dp, where dp belongs to q and p to
   dq: dK/d(dp) = dH/dp moves q, and -dK/dq = -(H_qq dq + H_qp dp) moves dp.  What
   is separable stays so, friction acts on p and on dp alike.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/chaos_private.h"
#include "expression/tape_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A term in C: its columns are taken eight at a time, on the stack. */
enum { LANES = NEVH__LANES, MOST = 128 };

/* Sixth-order differences: slopes of three chords. */
static const double weights[3] = {1.5, -0.6, 0.1};
static const double spread = 0x1p-7; /* of the lengths */

/* z = (q, p): nq + np rows; the lengths are constants after those of the term. */
typedef struct {
    const nevh_term *decl;
    size_t m;
    double t[LANES], z[MOST * LANES], d[MOST * LANES], c[MOST * LANES];
    double length[MOST * LANES];
} eight;

static void values(const eight *e, const double z[], double h[]) {
    const nevh_term *decl = e->decl;
    double one[2 * MOST];
    nevh__term_entry entry = {.decl = *decl};
    nevh__term_values(&entry, false, LANES, LANES, e->t, z,
                      z + decl->nq * LANES, e->c, h, one);
}

/* The derivative by one variable, from values. */
static void slope_by(const eight *e, double z[], size_t k, double g[]) {
    double *row = z + k * LANES, kept[LANES], h[LANES];
    memcpy(kept, row, sizeof kept);
    memset(g, 0, sizeof kept);
    for (int i = 0; i < 6; i++) {
        double move = (i / 2 + 1) * (i % 2 ? -spread : spread);
        for (size_t j = 0; j < LANES; j++)
            row[j] = kept[j] + move * e->length[k * LANES + j];
        values(e, z, h);
        for (size_t j = 0; j < LANES; j++)
            g[j] +=
                weights[i / 2] * h[j] / (2 * move * e->length[k * LANES + j]);
    }
    memcpy(row, kept, sizeof kept);
}

static void variational_slopes(const eight *e, double z[], double g[]) {
    const nevh_term *decl = e->decl;
    if (decl->gradient)
        decl->gradient(LANES, e->t, z, z + decl->nq * LANES, e->c, decl->params,
                       decl->nq ? g : NULL,
                       decl->np ? g + decl->nq * LANES : NULL);
    else
        for (size_t k = 0; k < e->m; k++)
            slope_by(e, z, k, g + k * LANES);
}

static void copy_rows(double *to, const double *from, size_t rows, size_t width,
                      size_t at) {
    for (size_t k = 0; k < rows; k++)
        memcpy(to + k * LANES, from + k * width + at, LANES * sizeof *to);
}

static void variational_take(eight *e, const void *params, size_t width,
                             size_t at, const double t[], const double q[],
                             const double p[], const double c[]) {
    const nevh_term *decl = params;
    size_t nq = decl->nq, np = decl->np;
    e->decl = decl;
    e->m = nq + np;
    memcpy(e->t, t + at, sizeof e->t);
    copy_rows(e->z, q, nq, width, at);
    copy_rows(e->z + nq * LANES, p, np, width, at);
    copy_rows(e->d, q + nq * width, nq, width, at);
    copy_rows(e->d + nq * LANES, p + np * width, np, width, at);
    copy_rows(e->c, c, decl->nc, width, at);
    copy_rows(e->length, c + decl->nc * width, e->m, width, at);
}

static void along_block(size_t width, const double t[], const double q[],
                        const double p[], const double c[], const void *params,
                        double h[]) {
    eight e;
    double g[MOST * LANES];
    for (size_t at = 0; at < width; at += LANES) {
        variational_take(&e, params, width, at, t, q, p, c);
        variational_slopes(&e, e.z, g);
        for (size_t j = 0; j < LANES; j++) {
            h[at + j] = 0;
            for (size_t k = 0; k < e.m; k++)
                h[at + j] += g[k * LANES + j] * e.d[k * LANES + j];
        }
    }
}

/* The product of the Hessian with d, by differences of slopes. */
static void hessian_along(eight *e, double product[]) {
    double g[MOST * LANES], step[LANES] = {0}, moved[MOST * LANES];
    for (size_t k = 0; k < e->m * LANES; k++)
        step[k % LANES] = fmax(step[k % LANES], fabs(e->d[k]) / e->length[k]);
    for (size_t j = 0; j < LANES; j++)
        step[j] = step[j] > 0 ? spread / step[j] : 1;
    memset(product, 0, e->m * LANES * sizeof *product);
    for (int i = 0; i < 6; i++) {
        double move = (i / 2 + 1) * (i % 2 ? -1 : 1);
        for (size_t k = 0; k < e->m * LANES; k++)
            moved[k] = e->z[k] + move * step[k % LANES] * e->d[k];
        variational_slopes(e, moved, g);
        for (size_t k = 0; k < e->m * LANES; k++)
            product[k] +=
                weights[i / 2] / (2 * move) * (g[k] / step[k % LANES]);
    }
}

static void put_rows(double *to, const double *from, size_t rows, size_t width,
                     size_t at) {
    for (size_t k = 0; to && k < rows; k++)
        memcpy(to + k * width + at, from + k * LANES, LANES * sizeof *to);
}

static void along_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    eight e;
    double g[MOST * LANES], product[MOST * LANES];
    for (size_t at = 0; at < width; at += LANES) {
        variational_take(&e, params, width, at, t, q, p, c);
        size_t nq = e.decl->nq, np = e.decl->np;
        variational_slopes(&e, e.z, g);
        hessian_along(&e, product);
        put_rows(dq, product, nq, width, at);
        put_rows(dq ? dq + nq * width : NULL, g, nq, width, at);
        put_rows(dp, product + nq * LANES, np, width, at);
        put_rows(dp ? dp + np * width : NULL, g + nq * LANES, np, width, at);
    }
}

/* Indices of an instance: of the variables, then of their displacements. */
static size_t *doubled(const size_t *from, size_t count, size_t each,
                       size_t first, size_t second) {
    size_t *to = nevh__array(2 * count * each, sizeof *to);
    for (size_t i = 0; to && i < count; i++)
        for (size_t k = 0; k < each; k++) {
            to[2 * i * each + k] = first + from[i * each + k];
            to[(2 * i + 1) * each + k] = second + from[i * each + k];
        }
    return to;
}

/* The term's constants, and, unless it is a tape, lengths. */
static double *variational_constants(const nevh_term *d, const double scale[],
                                     size_t n, bool tape) {
    size_t each = d->nc + (tape ? 0 : d->nq + d->np);
    double *to = nevh__array(d->count * each, sizeof *to);
    for (size_t i = 0; to && i < d->count; i++) {
        double *row = to + i * each;
        for (size_t k = 0; k < d->nc; k++)
            row[k] = d->c[i * d->nc + k];
        for (size_t k = 0; !tape && k < d->nq; k++)
            row[d->nc + k] = scale[d->q[i * d->nq + k]];
        for (size_t k = 0; !tape && k < d->np; k++)
            row[d->nc + d->nq + k] = scale[n + d->p[i * d->np + k]];
    }
    return to;
}

static int shape(nevh_term *to, const nevh_term *d, void **tape,
                 nevh__report *report) {
    int status = NEVH_ENOGRAD;
    if (d->block == nevh__tape_block)
        *tape = nevh__tape_along(d->params, &status);
    if (*tape) {
        nevh__tape_shape(to, *tape);
        return NEVH_OK;
    }
    if (status == NEVH_ENOMEM)
        return nevh__fail(report, status, "out of memory");
    if (d->nq + d->np > MOST || d->nc > MOST)
        return nevh__fail(report, NEVH_ENOGRAD,
                          "term \"%s\" reads more than %d variables in C",
                          d->name, MOST);
    to->block = along_block;
    to->gradient = along_gradient;
    to->params = d;
    to->time = d->time;
    to->nc = d->nc + d->nq + d->np;
    return NEVH_OK;
}

static int variational_add_term(nevh__variational *v, const nevh_term *d,
                                size_t n, const double scale[],
                                nevh__report *report) {
    void **tape = &v->tapes[v->count++];
    nevh_term to = {.effect = d->effect, .count = d->count};
    int status = shape(&to, d, tape, report);
    if (status)
        return status;
    to.nq = 2 * d->nq;
    to.np = 2 * d->np;
    if (*tape)
        to.nc = d->nc;
    size_t *q = doubled(d->q, d->count, d->nq, 0, n);
    size_t *p = doubled(d->p, d->count, d->np, n, 0);
    double *c = variational_constants(d, scale, n, *tape);
    to.q = q;
    to.p = p;
    to.c = c;
    status = q && p && c ? nevh_system_add(v->system, &to) : (int)NEVH_ENOMEM;
    if (status)
        nevh__fail(report, status, "%s",
                   q && p && c ? nevh_system_message(v->system)
                               : "out of memory");
    free(q);
    free(p);
    free(c);
    return status;
}

static int variational_add_friction(nevh__variational *v,
                                    const nevh_system *s) {
    double *rates = nevh__array(2 * s->n, sizeof *rates);
    int status = rates ? NEVH_OK : NEVH_ENOMEM;
    if (rates && nevh_system_friction(s, rates)) {
        memcpy(rates + s->n, rates, s->n * sizeof *rates);
        status = nevh_system_add_friction(v->system, "friction", rates);
    }
    free(rates);
    return status;
}

/* A displacement has the name of its variable.  False when memory is out. */
static bool variational_name(nevh__variational *v, const nevh_system *s) {
    if (!s->names)
        return true;
    v->names = nevh__array(2 * s->n, sizeof *v->names);
    for (size_t k = 0; v->names && k < 2 * s->n; k++)
        v->names[k] = s->names[k % s->n];
    v->system->names = v->names;
    return v->names;
}

static int variational_fill(nevh__variational *v, const nevh_system *s,
                            const double scale[], nevh__report *report) {
    v->system = nevh_system_new(2 * s->n);
    v->tapes = nevh__array(s->n_terms, sizeof *v->tapes);
    int status =
        v->system && v->tapes && variational_name(v, s) ? NEVH_OK : NEVH_ENOMEM;
    for (size_t i = 0; !status && i < s->n_terms; i++)
        if (nevh__term_on(s, s->terms[i]) &&
            s->terms[i]->decl.nq + s->terms[i]->decl.np)
            status = variational_add_term(v, &s->terms[i]->decl, s->n, scale,
                                          report);
    if (!status)
        status = variational_add_friction(v, s);
    if (status && !report->status)
        nevh__fail(report, status, "out of memory");
    return status;
}

nevh__variational *nevh__variational_new(const nevh_system *s,
                                         const double scale[],
                                         nevh__report *report) {
    nevh__variational *v = nevh__array(1, sizeof *v);
    if (!v)
        nevh__no_memory(report);
    else if (!variational_fill(v, s, scale, report))
        return v;
    nevh__variational_free(v);
    return NULL;
}

void nevh__variational_free(nevh__variational *v) {
    if (!v)
        return;
    nevh_system_free(v->system);
    free(v->names);
    for (size_t i = 0; i < v->count; i++)
        nevh__tape_free(v->tapes[i]);
    free(v->tapes);
    free(v);
}
