/* nevh: a step of Tao's schemes, for any number of orbits side by side;
   tao_kernel.c has the formulas.
   SPDX-License-Identifier: GPL-3.0-or-later

   The text needs vector_private.h, cos and sin, and two functions of the includer;
   tao_kernel.c compiles it for rows of any width, lib/native hands it to the C
   compiler with a scene's formulas. */
#ifndef NEVH_TAO_STEP_H
#define NEVH_TAO_STEP_H

#include "system/vector_private.h"
#include <math.h>
#include <stddef.h>

/* The states of a group of evaluations, and their results: n rows each. */
typedef struct {
    nevh__number *q, *p, *dh_dq, *dh_dp;
} nevh__tao_group;

/* A step under way: changes since its beginning, of the first copy's q and p and
   of x and y, those being counted from q and p there. */
typedef struct {
    size_t size, width;    /* n rows of so many */
    size_t parts;          /* steps of order 2 that it is composed of */
    const double *lengths; /* nevh__tao_prepare's */
    const double *ratio;   /* n: r_k */
    const nevh__number *start_q, *start_p, *compensation; /* n, n, 2n rows */
    nevh__number *q, *p, *x, *y;                          /* n rows each */
    nevh__tao_group a, b;                /* at (q, y) and (x, p) */
    const struct nevh__tao_owner *owner; /* the includer's */
} nevh__tao_step;

/* The includer's: takes dH/dq and dH/dp at the group's q and p.  Returns 0, or
   what makes the step fail. */
NEVH__INLINE int nevh__tao_slope(const nevh__tao_step *z,
                                 const nevh__tao_group *g, double t);
#ifndef NEVH__FOR_READERS
/* The includer's, too: the group's slopes have moved by h, a part of the step. */
NEVH__INLINE int nevh__tao_account(const nevh__tao_step *z,
                                   const nevh__tao_group *g, double h);
#endif

/* The part of h that step i of a composition takes, as a time; of `count`
   weights, the one in the middle follows from the others. */
NEVH__INLINE double nevh__tao_part(size_t count, const double weights[],
                                   size_t i, double h) {
    double rest = h;
    if (i > count)
        i = 2 * count - i;
    if (i < count)
        return h * weights[i];
    for (size_t k = 0; k < count; k++)
        rest -= 2 * (h * weights[k]);
    return rest;
}

/* The lengths of parts, and cosines and sines of 2 omega times these: 3 parts
   numbers. */
NEVH__INLINE void nevh__tao_prepare(size_t count, const double weights[],
                                    double omega, double h, double lengths[]) {
    size_t parts = 2 * count + 1;
    for (size_t i = 0; i < parts; i++) {
        double part = nevh__tao_part(count, weights, i, h);
        double angle = 2 * omega * part;
        lengths[i] = part;
        lengths[parts + i] = nevh_simd_cos(angle);
        lengths[2 * parts + i] = nevh_simd_sin(angle);
    }
}

NEVH__INLINE void nevh__tao_place(const nevh__tao_step *z,
                                  const nevh__tao_group *g,
                                  const nevh__number *q,
                                  const nevh__number *p) {
    const nevh__number *compensation_p = z->compensation + z->size;
    NEVH__KNOWN_COUNT
    for (size_t i = 0; i < z->size; i++) {
        g->q[i] = z->start_q[i] + (q[i] + z->compensation[i]);
        g->p[i] = z->start_p[i] + (p[i] + compensation_p[i]);
    }
}

/* Moves what the group does not read; H counts twice in the doubled one. */
NEVH__INLINE int nevh__tao_move(const nevh__tao_step *z,
                                const nevh__tao_group *g, nevh__number *p,
                                nevh__number *q, double h) {
    NEVH__KNOWN_COUNT
    for (size_t i = 0; i < z->size; i++) {
        p[i] -= h * g->dh_dq[i];
        q[i] += h * g->dh_dp[i];
    }
#ifndef NEVH__FOR_READERS
    return nevh__tao_account(z, g, h / 2);
#else
    return 0;
#endif
}

/* Turns (x - q, y - p) about the middle of the two. */
NEVH__INLINE void nevh__tao_bind(const nevh__tao_step *z, double cosine,
                                 double sine) {
    if (sine == 0)
        return;
    NEVH__KNOWN_COUNT
    for (size_t i = 0; i < z->size; i++) {
        double r = z->ratio[i / z->width];
        nevh__number d = z->x[i] - z->q[i], e = z->y[i] - z->p[i];
        nevh__number half_d = (d - (cosine * d + sine * (e / r))) / 2;
        nevh__number half_e = (e - (cosine * e - sine * (d * r))) / 2;
        z->q[i] += half_d;
        z->x[i] -= half_d;
        z->p[i] += half_e;
        z->y[i] -= half_e;
    }
}

/* B C B, between two A. */
NEVH__INLINE int nevh__tao_turn(const nevh__tao_step *z, double t, size_t i) {
    double h = z->lengths[i];
    int status;
    nevh__tao_place(z, &z->b, z->x, z->p);
    status = nevh__tao_slope(z, &z->b, t);
    if (!status)
        status = nevh__tao_move(z, &z->b, z->y, z->q, h / 2);
    if (status)
        return status;
    nevh__tao_bind(z, z->lengths[z->parts + i], z->lengths[2 * z->parts + i]);
    nevh__tao_place(z, &z->b, z->x, z->p);
    status = nevh__tao_slope(z, &z->b, t + h);
    return status ? status : nevh__tao_move(z, &z->b, z->y, z->q, h / 2);
}

/* All parts, from time t; slopes of the group a at the start are there.  Unless
   0, nothing is done; else x and y are counted from q and p at the end. */
NEVH__INLINE int nevh__tao_take(const nevh__tao_step *z, double t) {
    double passed = 0, last = 0;
    int status = 0;
    for (size_t i = 0; !status && i < z->parts; i++) {
        double part = z->lengths[i];
        status = nevh__tao_move(z, &z->a, z->p, z->x, (last + part) / 2);
        if (!status)
            status = nevh__tao_turn(z, t + passed, i);
        passed += last = part;
        nevh__tao_place(z, &z->a, z->q, z->y);
        if (!status)
            status = nevh__tao_slope(z, &z->a, t + passed);
    }
    if (!status)
        status = nevh__tao_move(z, &z->a, z->p, z->x, last / 2);
    NEVH__KNOWN_COUNT
    for (size_t i = 0; i < z->size; i++) {
        z->x[i] -= z->q[i];
        z->y[i] -= z->p[i];
    }
    return status;
}

#endif
