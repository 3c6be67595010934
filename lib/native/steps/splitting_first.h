/* nevh: the slope that a splitting keeps, and what splitting_step.h asks for, in
   compiled steps.

   The text needs KICKS_FIRST and KEEPS of the scheme, and a scene's kick_slope and
   drift_slope.  lib/native hands it to the C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SPLITTING_FIRST_H
#define NEVH_SPLITTING_FIRST_H

#include "kernels/splitting_step.h"

NEVH__INLINE const nevh__number *
nevh__splitting_inverse(const nevh__splitting_step *x, int way) {
    (void)x, (void)way;
    return NULL;
}

enum { KEPT = KEEPS ? DOF : 0 };
static __attribute__((noinline)) nevh__number
take_first(const nevh__steps_call *c, const double *N, const nevh__number *y,
           const nevh__number *lost, nevh__number *kept, nevh__number *room) {
    double t = c->t0 + (double)c->from * c->h + c->times[0] * c->h;
    nevh__number bad = {0};
    NEVH__ROWS(point, 0, 2);
    (void)room;
    NEVH__EACH(k, 1, 2 * DOF) {
        point[k] = y[k] + lost[k];
    }
    for (size_t i = 0; KEEPS && i < DOF; i += ONE)
        bad += (KICKS_FIRST ? kick_slope : drift_slope)(
            N, t, point + i, point + DOF + i, kept + i NEVH__WHOLE);
    return bad;
}

#ifdef NEVH__LOOPS
/* Rows of so many vectors are moved to the front. */
NEVH__INLINE void move_all(wide *x, size_t size, size_t by, int rows) {
    for (; rows > 0; rows--, x += size)
        __builtin_memmove(x, x + by, (size - by) * sizeof *x);
}
#endif

#endif
