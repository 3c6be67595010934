/* nevh: a step of a splitting of a state that is long, in long_driver.h: all operations
   on one part of the state before the next.

   A part of a slope is taken once all points that it reads are there, and points are
   moved once all slopes have been taken that read them: each operation lags behind the
   one before.  A step's arrays but for the state hold the parts
   that are in work, and are moved to the front where their space ends.

   The text needs what splitting_step.h does, a scene's kick_slope and drift_slope, sizes
   as splitting_groups.h does, and OPERATIONS, KICKS_FIRST, KEEPS and `lags` of the
   scheme.  lib/native hands it to the C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SPLITTING_PARTS_H
#define NEVH_SPLITTING_PARTS_H

#include "kernels/splitting_step.h"

struct nevh__splitting_owner {
    const double *N;
    wide *bad;
    size_t first, size;
};

NEVH__INLINE int nevh__splitting_slope(const nevh__splitting_step *x, int way,
                                       size_t i, bool kick, bool kept) {
    const struct nevh__splitting_owner *o = x->owner;
    double t = x->t + x->scheme->times[i] * x->h;
    const wide *q = x->q.point - o->first, *p = x->p.point - o->first;
    wide *slope = x->slope - o->first;
    (void)way;
    if (!kept)
        *o->bad += (kick ? kick_slope : drift_slope)(
            o->N, t, q, p, slope, 8 * o->first, 8 * (o->first + o->size));
    return 0;
}

static __attribute__((noinline)) void operate(const nevh__splitting_step *x,
                                              size_t size, size_t i, bool kick,
                                              bool kept) {
    if (kept)
        nevh__splitting_operate(x, 0, 1, size, i, KICKS_FIRST, true);
    else if (kick)
        nevh__splitting_operate(x, 0, 1, size, i, true, false);
    else
        nevh__splitting_operate(x, 0, 1, size, i, false, false);
}

NEVH__INLINE wide take_step(const nevh__steps_call *c, const double *N,
                            double t, wide *y, wide *lost, wide *kept,
                            wide *room) {
    wide *change = room, *point = change + 2 * WINDOW;
    wide *slope = point + 2 * WINDOW, bad = {0};
    nevh__splitting_scheme scheme = {c->operations, c->weights, c->times,
                                     KICKS_FIRST, KEEPS};
    double h = c->h;
    size_t origin = 0;
    for (size_t round = 0; round < PARTS + lags[OPERATIONS - 1]; round++) {
        if (round < PARTS && round * PART == origin + WINDOW) {
            size_t next = (round - IN_WORK) * PART;
            move_all(room, WINDOW, next - origin, 5);
            origin = next;
        }
        for (size_t i = 0; i <= OPERATIONS; i++) {
            size_t part = i ? round - lags[i - 1] : round;
            if (part >= PARTS)
                continue;
            size_t at = part * PART, here = at - origin;
            size_t size = DOF - at < PART ? DOF - at : PART;
            struct nevh__splitting_owner owner = {N, &bad, at, size};
            nevh__half q = {y + at, lost + at, change + here, point + here};
            nevh__half p = {y + DOF + at, lost + DOF + at,
                            change + WINDOW + here, point + WINDOW + here};
            nevh__splitting_step x = {
                t, h, &scheme, KEEPS, q, p, slope + here, kept + at, &owner};
            if (i == 0)
                nevh__splitting_place(&x, 1, size);
            else
                operate(&x, size, i - 1, KICKS_FIRST == (i % 2 == 1),
                        KEEPS && i == 1);
            if (i < OPERATIONS)
                continue;
            NEVH__EACH(k, 1, size) {
                bad += (x.q.point[k] - x.q.point[k]) +
                       (x.p.point[k] - x.p.point[k]);
            }
            nevh__splitting_commit_all(&x, 1, size, KEEPS);
        }
    }
    return bad;
}

#endif
