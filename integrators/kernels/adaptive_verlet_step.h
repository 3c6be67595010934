/* nevh: a step of Verlet that varies; adaptive_verlet_kernel.c has the formulas.
   SPDX-License-Identifier: GPL-3.0-or-later

   The text needs vector_private.h, hypot and pow, and three functions of the
   includer; adaptive_verlet_kernel.c compiles it, lib/native hands it to the C
   compiler with a scene's formulas. */
#ifndef NEVH_ADAPTIVE_VERLET_STEP_H
#define NEVH_ADAPTIVE_VERLET_STEP_H

#include "system/vector_private.h"
#include <math.h>
#include <stddef.h>

/* The state of step control from one step to the next. */
typedef struct {
    double begun;
    double unit;    /* s at the start of the orbit, or |f| */
    double density; /* rho */
    double change;  /* G */
} nevh__density;

/* A step under way: n numbers each, but for the pair. */
typedef struct {
    size_t n;
    double unit_q, unit_p;      /* of coordinates and of momenta, for |f| */
    const double *compensation; /* of q, and then of p */
    double *q, *p;              /* the state under way */
    double *force, *speed;      /* dV/dq and dT/dp there */
    double *dq, *dp;            /* increments of the step */
    double *pair;               /* two states beside each other: q, p, */
    double *pair_slopes;        /* dV/dq, dT/dp */
    const struct nevh__leap_owner *owner; /* the includer's */
} nevh__leap;

/* The includer's, 0 if all is well: slopes at the state under way, of which a
   NULL is not wanted; those at the pair; and what a kick or a drift there
   leaves to be accounted for. */
NEVH__INLINE int nevh__leap_slopes(const nevh__leap *x, double t, double *force,
                                   double *speed);
NEVH__INLINE int nevh__leap_pair(const nevh__leap *x, double t);
#ifndef NEVH__FOR_READERS
NEVH__INLINE int nevh__leap_account(const nevh__leap *x, bool of_q, double t,
                                    double length);
#endif

/* s is |f| to the power of minus this. */
#define NEVH__LEAP_POWER 0.75
/* |f| counts as at least its size at the start over this. */
#define NEVH__LEAP_STRETCH 10.
/* The time of differences along the orbit, over 1/|f|. */
#define NEVH__LEAP_SPREAD 1e-2

/* |f|, in those units. */
NEVH__INLINE double nevh__leap_size(const nevh__leap *x) {
    double size = 0;
    NEVH__KNOWN_COUNT
    for (size_t k = 0; k < x->n; k++) {
        size = nevh_simd_hypot(size, x->speed[k] / x->unit_q);
        size = nevh_simd_hypot(size, x->force[k] / x->unit_p);
    }
    return size;
}

/* |f| squared over itself guarded from 0. */
NEVH__INLINE double nevh__leap_guard(double size, double unit) {
    double least = unit / NEVH__LEAP_STRETCH / size;
    return 1 / (1 + least * least);
}

/* The part of the field at the first or second of the pair along the unit
   vector of f. */
NEVH__INLINE double nevh__leap_along(const nevh__leap *x, double size,
                                     size_t which) {
    const double *force = x->pair_slopes + which, *speed = force + 2 * x->n;
    double sum = 0;
    NEVH__KNOWN_COUNT
    for (size_t k = 0; k < x->n; k++)
        sum += x->speed[k] / x->unit_q / size * (speed[2 * k] / x->unit_q) +
               x->force[k] / x->unit_p / size * (force[2 * k] / x->unit_p);
    return sum;
}

/* -d(ln s)/dt for s = |f|^-power, by a difference along the orbit. */
NEVH__INLINE int nevh__leap_change(const nevh__leap *x, double t, double unit,
                                   double *change) {
    double size = nevh__leap_size(x), time = NEVH__LEAP_SPREAD / size;
    double *q = x->pair, *p = q + 2 * x->n;
    *change = 0;
    if (!(size > 0))
        return 0;
    NEVH__KNOWN_COUNT
    for (size_t k = 0; k < x->n; k++) {
        q[2 * k] = x->q[k] + time * x->speed[k];
        q[2 * k + 1] = x->q[k] - time * x->speed[k];
        p[2 * k] = x->p[k] - time * x->force[k];
        p[2 * k + 1] = x->p[k] + time * x->force[k];
    }
    int status = nevh__leap_pair(x, t);
    if (status)
        return status;
    double ahead = nevh__leap_along(x, size, 0);
    double behind = nevh__leap_along(x, size, 1);
    *change = NEVH__LEAP_POWER * nevh__leap_guard(size, unit) *
              ((ahead - behind) / (2 * NEVH__LEAP_SPREAD));
    return 0;
}

/* s over its value at the start, for |f|. */
NEVH__INLINE double nevh__leap_stretch(const nevh__leap *x, double unit) {
    double size = nevh__leap_size(x), least = unit / NEVH__LEAP_STRETCH;
    double ratio = nevh_simd_hypot(unit, least) / nevh_simd_hypot(size, least);
    return ratio > 0 ? nevh_simd_pow(ratio, NEVH__LEAP_POWER) : 1;
}

/* The same of the density, which moves on by half of h. */
NEVH__INLINE double nevh__leap_rate(nevh__density *c, double h) {
    c->density += h / 2 * c->change;
    return 1 / c->density;
}

/* The state that a step begins at, and dV/dq there. */
NEVH__INLINE void nevh__leap_place(const nevh__leap *x, const double *q,
                                   const double *p, const double *force) {
    NEVH__KNOWN_COUNT
    for (size_t k = 0; k < x->n; k++) {
        x->q[k] = q[k] + x->compensation[k];
        x->p[k] = p[k] + x->compensation[x->n + k];
        x->force[k] = force[k];
        x->dq[k] = x->dp[k] = 0;
    }
}

NEVH__INLINE void nevh__leap_move(size_t n, const double *start,
                                  const double *compensation, double step,
                                  const double *slope, double *change,
                                  double *point) {
    NEVH__KNOWN_COUNT
    for (size_t k = 0; k < n; k++) {
        change[k] += step * slope[k];
        point[k] = start[k] + (change[k] + compensation[k]);
    }
}

/* Kick, drift, kick from q and p; leaves dV/dq and dT/dp of the new state. */
NEVH__INLINE int nevh__leap_take(const nevh__leap *x, double t, double step,
                                 const double *q, const double *p) {
    size_t n = x->n;
    const double *lost = x->compensation;
    int status = 0;
#ifndef NEVH__FOR_READERS
    status = nevh__leap_account(x, true, t, step / 2);
#endif
    nevh__leap_move(n, p, lost + n, -step / 2, x->force, x->dp, x->p);
    if (!status)
        status = nevh__leap_slopes(x, t + step / 2, NULL, x->speed);
#ifndef NEVH__FOR_READERS
    if (!status)
        status = nevh__leap_account(x, false, t + step / 2, step);
#endif
    if (status)
        return status;
    nevh__leap_move(n, q, lost, step, x->speed, x->dq, x->q);
    status = nevh__leap_slopes(x, t + step, x->force, NULL);
#ifndef NEVH__FOR_READERS
    if (!status)
        status = nevh__leap_account(x, true, t + step, step / 2);
#endif
    if (status)
        return status;
    nevh__leap_move(n, p, lost + n, -step / 2, x->force, x->dp, x->p);
    return nevh__leap_slopes(x, t + step, NULL, x->speed);
}

#endif
