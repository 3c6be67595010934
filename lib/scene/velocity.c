/* nevh: values and v = dH/dp of a system of tapes, by themselves.

   Code that brings none is differenced; a kinetic energy is quadratic as a
   rule, and then any step will do.  A field would do the same, but it is
   planned around a state, and here the momenta are not known yet, or H is not
   finite.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <math.h>
#include <string.h>

enum { WIDTH = NEVH__LANES };

/* Doubles that one block of a term takes. */
static size_t block_size(const nevh_term *decl) {
    return WIDTH * (decl->nq + 2 * decl->np + decl->nc + 2);
}

double *nevh__velocity_buffer(const nevh_system *system) {
    size_t most = 0;
    for (size_t i = 0; i < system->n_terms; i++) {
        size_t size = block_size(&system->terms[i]->decl);
        most = size > most ? size : most;
    }
    return nevh__array(most, sizeof(double));
}

/* Columns of a block are instances; those beyond the last repeat it. */
static void velocity_gather(const double from[], const size_t indices[],
                            size_t each, size_t first, size_t count,
                            double rows[]) {
    for (size_t lane = 0; lane < WIDTH; lane++) {
        size_t i = first + lane < count ? first + lane : count - 1;
        for (size_t k = 0; k < each; k++)
            rows[k * WIDTH + lane] =
                from[indices ? indices[i * each + k] : i * each + k];
    }
}

/* The variables of a block of instances, and room for its results. */
typedef struct {
    double *t, *q, *p, *c, *result;
} block;

static block read_block(const nevh_term *decl, size_t first, double t,
                        const double q[], const double p[], double buffer[]) {
    block b = {.t = buffer, .q = buffer + WIDTH};
    b.p = b.q + WIDTH * decl->nq;
    b.c = b.p + WIDTH * decl->np;
    b.result = b.c + WIDTH * decl->nc;
    for (size_t lane = 0; lane < WIDTH; lane++)
        b.t[lane] = decl->time ? t : 0;
    velocity_gather(q, decl->q, decl->nq, first, decl->count, b.q);
    velocity_gather(p, decl->p, decl->np, first, decl->count, b.p);
    velocity_gather(decl->c, NULL, decl->nc, first, decl->count, b.c);
    return b;
}

static const double part = 0x1p-10; /* of a momentum: a step */

/* d/dp[k] of order 4 of one instance; p is as before afterwards. */
static double velocity_difference(const nevh_term *decl, double t,
                                  const double q[], double p[],
                                  const double c[], size_t k) {
    const double at = p[k], step = at != 0 ? part * fabs(at) : part;
    double h[4];
    for (int i = 0; i < 4; i++) {
        p[k] = at + (i < 2 ? i - 2 : i - 1) * step;
        h[i] = decl->value(t, q, p, c, decl->params);
    }
    p[k] = at;
    return (8 * (h[2] - h[1]) - (h[3] - h[0])) / (12 * step);
}

/* Adds differences of terms without a gradient, which have one instance. */
static void add_differences(const nevh_term *decl, double t, const double q[],
                            const double p[], double buffer[], double v[]) {
    double *own_q = buffer, *own_p = own_q + decl->nq;
    for (size_t k = 0; k < decl->nq; k++)
        own_q[k] = q[decl->q[k]];
    for (size_t k = 0; k < decl->np; k++)
        own_p[k] = p[decl->p[k]];
    for (size_t k = 0; k < decl->np; k++)
        v[decl->p[k]] += velocity_difference(decl, decl->time ? t : 0, own_q,
                                             own_p, decl->c, k);
}

static void velocity_add_block(const nevh_term *decl, size_t first, double t,
                               const double q[], const double p[],
                               double buffer[], double v[]) {
    block b = read_block(decl, first, t, q, p, buffer);
    decl->gradient(WIDTH, b.t, b.q, b.p, b.c, decl->params, NULL, b.result);
    for (size_t lane = 0; lane < WIDTH && first + lane < decl->count; lane++)
        for (size_t k = 0; k < decl->np; k++)
            v[decl->p[(first + lane) * decl->np + k]] +=
                b.result[k * WIDTH + lane];
}

void nevh__velocities(const nevh_system *system, double t, const double q[],
                      const double p[], double buffer[], double v[]) {
    memset(v, 0, system->n * sizeof *v);
    for (size_t i = 0; i < system->n_terms; i++) {
        const nevh_term *decl = &system->terms[i]->decl;
        if (!nevh__term_on(system, system->terms[i]) || !decl->np)
            continue;
        if (!decl->gradient)
            add_differences(decl, t, q, p, buffer, v);
        for (size_t first = 0; decl->gradient && first < decl->count;
             first += WIDTH)
            velocity_add_block(decl, first, t, q, p, buffer, v);
    }
}

static bool is_finite(const nevh_term *decl, double t, const double q[],
                      const double p[], double buffer[]) {
    for (size_t first = 0; first < decl->count; first += WIDTH) {
        block b = read_block(decl, first, t, q, p, buffer);
        decl->block(WIDTH, b.t, b.q, b.p, b.c, decl->params, b.result);
        for (size_t lane = 0; lane < WIDTH; lane++)
            if (!isfinite(b.result[lane]))
                return false;
    }
    return true;
}

const char *nevh__effect_not_finite(const nevh_system *system, double t,
                                    const double q[], const double p[],
                                    double buffer[]) {
    for (size_t i = 0; i < system->n_terms; i++) {
        const nevh_term *decl = &system->terms[i]->decl;
        if (nevh__term_on(system, system->terms[i]) && decl->block &&
            !is_finite(decl, t, q, p, buffer))
            return decl->effect;
    }
    return NULL;
}
