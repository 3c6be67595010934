/* nevh: a step of an explicit symplectic splitting of H = T(p) + V(q), for any
   number of orbits side by side.
   SPDX-License-Identifier: GPL-3.0-or-later

   The text needs NEVH__INLINE, NEVH__EACH, nevh__number, nevh__roundoff and
   nevh__not_finite of vector_private.h, the C library's size_t and bool, and two
   functions of the includer.  splitting_kernel.c compiles it for numbers, for
   vectors, and for rows of any width; lib/native hands it to the C compiler with
   a scene's formulas. */
#ifndef NEVH_SPLITTING_STEP_H
#define NEVH_SPLITTING_STEP_H

#include "system/vector_private.h"
#include <stdbool.h>
#include <stddef.h>

/*     change_q = e_q,  change_p = e_p,  Q = q + e_q,  P = p + e_p
       for each operation i
           kick:   change_p -= w_i h dV/dq(Q),  P = p + change_p
           drift:  change_q += w_i h dT/dp(P),  Q = q + change_q
       q = Q,  p = P, and e is what that lost to rounding. */

/* One half of the state: q under drifts, p under kicks.  Rows of lanes. */
typedef struct {
    nevh__number *state;        /* at the start of the step */
    nevh__number *compensation; /* e: digits that earlier steps lost */
    nevh__number *change;       /* e and the increment so far */
    nevh__number *point;        /* state + change */
} nevh__half;

typedef struct {
    size_t count;    /* of kicks and drifts */
    double *weights; /* count */
    double *times;   /* count: parts of h at which slopes are taken */
    bool kicks_first;
    bool keeps; /* the last slope of a step is the first of the next */
} nevh__splitting_scheme;

typedef struct {
    double t, h;
    const nevh__splitting_scheme *scheme;
    bool has_kept; /* the step before has left a slope */
    nevh__half q, p;
    nevh__number *slope, *kept;
    const struct nevh__splitting_owner *owner; /* the includer's */
} nevh__splitting_step;

/* The new state is not a finite number; the old one is as it was. */
enum { NEVH__SPLITTING_RANGE = -1 };

/* The includer's: for operation i, a kick or else a drift, takes dH/dq or dH/dp
   at the points q.point, p.point and t + times[i] h to x->slope.  `kept`: there
   is one in x->kept, which needs not be taken.  Returns 0, or what makes the
   step fail.  way: what the includer has handed to nevh__splitting_take. */
NEVH__INLINE int nevh__splitting_slope(const nevh__splitting_step *x, int way,
                                       size_t i, bool kick, bool kept);
#ifndef NEVH__FOR_READERS
/* The includer's, too: where T is that of known masses, what momenta are
   multiplied by, as many as slopes; else NULL. */
NEVH__INLINE const nevh__number *
nevh__splitting_inverse(const nevh__splitting_step *x, int way);
#endif

NEVH__INLINE void nevh__splitting_advance(size_t lanes, size_t size,
                                          const nevh__half *x, double step,
                                          const nevh__number *restrict slope) {
    nevh__number *restrict change = x->change, *restrict point = x->point;
    const nevh__number *restrict state = x->state;
    NEVH__EACH(i, lanes, size) {
        nevh__number sum = change[i] + step * slope[i];
        change[i] = sum;
        point[i] = state[i] + sum;
    }
}

/* A kick, or else a drift. */
NEVH__INLINE int nevh__splitting_operate(const nevh__splitting_step *x, int way,
                                         size_t lanes, size_t size, size_t i,
                                         bool kick, bool kept) {
    double dt = x->scheme->weights[i] * x->h;
    int status = nevh__splitting_slope(x, way, i, kick, kept);
    if (!status)
        nevh__splitting_advance(lanes, size, kick ? &x->p : &x->q,
                                kick ? -dt : dt, kept ? x->kept : x->slope);
    return status;
}

#ifndef NEVH__FOR_READERS
/* A kick and a drift where T is that of known masses: velocities are momenta
   times these, and need not go through memory (15 to 25 % of a step of
   several kicks). */
NEVH__INLINE int nevh__splitting_operate_both(const nevh__splitting_step *x,
                                              int way, size_t lanes,
                                              size_t size, size_t i) {
    const nevh__half *q = &x->q, *p = &x->p;
    nevh__number *restrict slope = x->slope;
    const nevh__number *restrict inverse = nevh__splitting_inverse(x, way);
    double kick = -(x->scheme->weights[i] * x->h),
           drift = x->scheme->weights[i + 1] * x->h;
    int status = nevh__splitting_slope(x, way, i, true, false);
    if (status)
        return status;
    NEVH__EACH(k, lanes, size) {
        nevh__number sum = p->change[k] + kick * slope[k];
        nevh__number momentum = p->state[k] + sum;
        nevh__number velocity = inverse[k] * momentum;
        nevh__number moved = q->change[k] + drift * velocity;
        slope[k] = velocity;
        p->change[k] = sum;
        p->point[k] = momentum;
        q->change[k] = moved;
        q->point[k] = q->state[k] + moved;
    }
    return 0;
}
#endif

/* All kicks and drifts in turn. */
NEVH__INLINE int nevh__splitting_operate_all(const nevh__splitting_step *x,
                                             int way, size_t lanes,
                                             size_t size) {
    size_t i = 0, count = x->scheme->count;
    bool kick = x->scheme->kicks_first;
    int status = 0;
    if (x->has_kept) {
        status =
            kick ? nevh__splitting_operate(x, way, lanes, size, i++, true, true)
                 : nevh__splitting_operate(x, way, lanes, size, i++, false,
                                           true);
        kick = !kick;
    }
    if (!kick && !status)
        status =
            nevh__splitting_operate(x, way, lanes, size, i++, false, false);
    for (; !status && i + 1 < count; i += 2) {
#ifndef NEVH__FOR_READERS
        if (nevh__splitting_inverse(x, way)) {
            status = nevh__splitting_operate_both(x, way, lanes, size, i);
            continue;
        }
#endif
        status = nevh__splitting_operate(x, way, lanes, size, i, true, false);
        if (!status)
            status = nevh__splitting_operate(x, way, lanes, size, i + 1, false,
                                             false);
    }
    if (!status && i < count)
        status = nevh__splitting_operate(x, way, lanes, size, i, true, false);
    return status;
}

NEVH__INLINE void nevh__splitting_commit(const nevh__half *x, size_t i) {
    x->compensation[i] = nevh__roundoff(x->point[i], x->state[i], x->change[i]);
    x->state[i] = x->point[i];
}

/* The last points are the new state; `keeps`: and the last slope is kept. */
NEVH__INLINE void nevh__splitting_commit_all(const nevh__splitting_step *x,
                                             size_t lanes, size_t size,
                                             bool keeps) {
    NEVH__EACH(i, lanes, size) {
        nevh__splitting_commit(&x->q, i);
        nevh__splitting_commit(&x->p, i);
        if (keeps)
            x->kept[i] = x->slope[i];
    }
}

/* Nothing has changed yet. */
NEVH__INLINE void nevh__splitting_place(const nevh__splitting_step *x,
                                        size_t lanes, size_t size) {
    NEVH__EACH(i, lanes, size) {
        x->q.change[i] = x->q.compensation[i];
        x->p.change[i] = x->p.compensation[i];
        x->q.point[i] = x->q.state[i] + x->q.compensation[i];
        x->p.point[i] = x->p.state[i] + x->p.compensation[i];
    }
}

/* A step.  size: of the halves; lanes: a constant that divides it, by which
   rows are gone through.  Unless 0, the state is as it was. */
NEVH__INLINE int nevh__splitting_take(const nevh__splitting_step *x, int way,
                                      size_t lanes, size_t size) {
    nevh__splitting_place(x, lanes, size);
    int status = nevh__splitting_operate_all(x, way, lanes, size);
    if (status)
        return status;
    if (nevh__not_finite(lanes, size, x->q.point, x->p.point))
        return NEVH__SPLITTING_RANGE;
    if (x->scheme->keeps)
        nevh__splitting_commit_all(x, lanes, size, true);
    else
        nevh__splitting_commit_all(x, lanes, size, false);
    return 0;
}

#endif
