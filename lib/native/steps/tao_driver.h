/* nevh: a step of Tao's schemes in block_driver.h.

   The text needs what tao_step.h does, a scene's kick_slope and drift_slope, and
   numbers of the scheme: PARTS, WEIGHTS, RATIOS, OMEGA.  lib/native hands it to the
   C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TAO_DRIVER_H
#define NEVH_TAO_DRIVER_H

#include "kernels/tao_step.h"

struct nevh__tao_owner {
    nevh__number *bad;
    NEVH__COMPILED(const double *N;)
};

NEVH__INLINE int nevh__tao_slope(const nevh__tao_step *z,
                                 const nevh__tao_group *g, double t) {
    const struct nevh__tao_owner *o = z->owner;
    *o->bad += kick_slope(NEVH__COMPILED(o->N, ) t, g->q, g->p, g->dh_dq);
    *o->bad += drift_slope(NEVH__COMPILED(o->N, ) t, g->q, g->p, g->dh_dp);
    return 0;
}

#ifndef NEVH__FOR_READERS
NEVH__INLINE int nevh__tao_account(const nevh__tao_step *z,
                                   const nevh__tao_group *g, double h) {
    (void)z, (void)g, (void)h;
    return 0;
}

/* The memory behind digits that sums have lost: the second copy less the first,
   and the gradient where the step begins. */
enum { KEPT = 4 * DOF };
static __attribute__((noinline)) nevh__number
take_first(const nevh__steps_call *c, const double *N, const nevh__number *y,
           const nevh__number *lost, nevh__number *kept, nevh__number *room) {
    double t = c->t0 + (double)c->from * c->h;
    nevh__number point[2 * DOF], bad;
    (void)room;
    NEVH__EACH(k, 1, DOF) {
        point[k] = y[k] + lost[k];
        point[DOF + k] = y[DOF + k] + (kept[DOF + k] + lost[DOF + k]);
    }
    bad = (nevh__number){0} +
          kick_slope(N, t, point, point + DOF, kept + 2 * DOF);
    bad += drift_slope(N, t, point, point + DOF, kept + 3 * DOF);
    return bad;
}
#endif

/* Changes where a step begins, none and those of the second copy, and the slopes. */
NEVH__INLINE void tao_open(const nevh__number *kept, nevh__number *moved,
                           nevh__number *slopes) {
    NEVH__EACH(k, 1, 2 * DOF) {
        moved[k] = (nevh__number){0};
        moved[2 * DOF + k] = kept[k];
        slopes[k] = kept[2 * DOF + k];
    }
}

/* The state where it ends, and what is kept; returns 0 if all is finite. */
NEVH__INLINE nevh__number tao_close(nevh__number bad, const nevh__number *moved,
                                    const nevh__number *slopes, nevh__number *y,
                                    nevh__number *lost, nevh__number *kept) {
    NEVH__EACH(k, 1, 2 * DOF) {
        nevh__number change = moved[k] + lost[k], next = y[k] + change;
        bad += (next - next) + (moved[2 * DOF + k] - moved[2 * DOF + k]);
        lost[k] = nevh__roundoff(next, y[k], change);
        y[k] = next;
    }
#ifdef NEVH__FOR_READERS
    if (bad != 0)
        return bad;
    kept[4 * DOF] = 1;
#endif
    NEVH__EACH(k, 1, 2 * DOF) {
        kept[k] = moved[2 * DOF + k];
        kept[2 * DOF + k] = slopes[k];
    }
    return bad;
}

/* A step of the state y, q and then p, and of the second copy.  Returns 0 if all is
   finite.  W: h, and what tao_prepare makes of it. */
NEVH__INLINE nevh__number
step_copies(NEVH__COMPILED(const double *N, ) double *W, double t, double h,
            nevh__number *y, nevh__number *lost, nevh__number *kept) {
    nevh__number moved[4 * DOF], points[4 * DOF], slopes[4 * DOF];
    nevh__number bad = {0};
    struct nevh__tao_owner owner = {&bad NEVH__COMPILED(, N)};
    nevh__tao_step z = {.size = DOF,
                        .width = 1,
                        .parts = PARTS,
                        .lengths = W + 1,
                        .ratio = RATIOS,
                        .start_q = y,
                        .start_p = y + DOF,
                        .compensation = lost,
                        .q = moved,
                        .p = moved + DOF,
                        .x = moved + 2 * DOF,
                        .y = moved + 3 * DOF,
                        .a = {points, points + DOF, slopes, slopes + DOF},
                        .b = {points + 2 * DOF, points + 3 * DOF,
                              slopes + 2 * DOF, slopes + 3 * DOF},
                        .owner = &owner};
    if (W[0] != h)
        nevh__tao_prepare(PARTS / 2, WEIGHTS, OMEGA, h, W + 1);
    W[0] = h;
    tao_open(kept, moved, slopes);
#ifdef NEVH__FOR_READERS
    if (kept[4 * DOF] == 0) {
        nevh__tao_place(&z, &z.a, z.q, z.y);
        nevh__tao_slope(&z, &z.a, t);
    }
#endif
    nevh__tao_take(&z, t);
    return tao_close(bad, moved, slopes, y, lost, kept);
}

#ifdef NEVH__FOR_READERS
static double take_step(double t, double h, double *y, double *lost,
                        double *kept) {
    static double W[3 * PARTS + 1];
    return step_copies(W, t, h, y, lost, kept);
}
#else
NEVH__INLINE nevh__number take_step(const nevh__steps_call *c, const double *N,
                                    double t, nevh__number *y,
                                    nevh__number *lost, nevh__number *kept,
                                    nevh__number *room) {
    (void)room;
    return step_copies(N, c->weights, t, c->h, y, lost, kept);
}
#endif

#endif
