/* nevh: a step of a splitting in block_driver.h, or of a state that is long in
   long_driver.h: each operation on the whole state.

   The text needs what splitting_step.h does, a scene's kick_slope and drift_slope,
   KICKS_FIRST and KEEPS of the scheme, and in programs OPERATIONS and the tables W
   and T.  lib/native hands it to the C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SPLITTING_WHOLE_H
#define NEVH_SPLITTING_WHOLE_H

#include "kernels/splitting_step.h"

struct nevh__splitting_owner {
    nevh__number *bad;
    NEVH__COMPILED(const double *N;)
};

NEVH__INLINE int nevh__splitting_slope(const nevh__splitting_step *x, int way,
                                       size_t i, bool kick, bool kept) {
    double t = x->t + x->scheme->times[i] * x->h;
    (void)way;
#ifdef NEVH__FOR_READERS
    if (!kept)
        *x->owner->bad +=
            kick ? kick_slope(t, x->q.point, x->p.point, x->slope)
                 : drift_slope(t, x->q.point, x->p.point, x->slope);
#else
    const double *N = x->owner->N;
    if (!kept)
        for (size_t k = 0; k < DOF; k += ONE)
            *x->owner->bad +=
                kick ? kick_slope(N, t, x->q.point + k, x->p.point + k,
                                  x->slope + k NEVH__WHOLE)
                     : drift_slope(N, t, x->q.point + k, x->p.point + k,
                                   x->slope + k NEVH__WHOLE);
#endif
    return 0;
}

#ifdef NEVH__FOR_READERS
/* A step of the state y, q and then p.  Returns 0 if all is finite. */
static double take_step(double t, double h, double *y, double *lost,
                        double *kept) {
    static const nevh__splitting_scheme scheme = {OPERATIONS, W, T, KICKS_FIRST,
                                                  KEEPS};
    bool has_kept = KEEPS && kept[DOF] != 0;
#ifdef NEVH__LOOPS
    static double change[2 * DOF], point[2 * DOF], slope[DOF];
#else
    double change[2 * DOF], point[2 * DOF], slope[DOF];
#endif
#else
NEVH__INLINE nevh__number take_step(const nevh__steps_call *c, const double *N,
                                    double t, nevh__number *y,
                                    nevh__number *lost, nevh__number *kept,
                                    nevh__number *room) {
    nevh__splitting_scheme scheme = {c->operations, c->weights, c->times,
                                     KICKS_FIRST, KEEPS};
    double h = c->h;
    bool has_kept = KEEPS;
    NEVH__ROWS(change, 0, 2);
    NEVH__ROWS(point, 2, 2);
    NEVH__ROWS(slope, 4, 1);
    (void)room;
#endif
    nevh__number bad = {0};
    struct nevh__splitting_owner owner = {&bad NEVH__COMPILED(, N)};
    nevh__half q = {y, lost, change, point};
    nevh__half p = {y + DOF, lost + DOF, change + DOF, point + DOF};
    nevh__splitting_step x = {t, h,     &scheme, has_kept, q,
                              p, slope, kept,    &owner};
#ifdef NEVH__FOR_READERS
    if (nevh__splitting_take(&x, 0, 1, DOF) != 0)
        return 1;
    if (KEEPS)
        kept[DOF] = 1;
#else
    nevh__splitting_take(&x, 0, 1, DOF);
    NEVH__EACH(k, 1, 2 * DOF) {
        bad += point[k] - point[k];
    }
#endif
    return bad;
}

#endif
