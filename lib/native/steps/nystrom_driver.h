/* nevh: steps of a Runge-Kutta-Nystroem method in block_driver.h, and under a
   tolerance (NEVH__ADAPTS) trials for adaptive_driver.h; of one orbit.

   The text needs what nystrom_step.h does, a scene's kick_slope and drift_slope,
   STAGES, `sums` over them and their `times`, AT_REST and INVERSE, which are T_p(0)
   and W, DIAGONAL and MOVES, and in compiled steps NEVH__EACH_STAGE(do), do(i) for
   each stage that a step or a trial takes.  lib/native hands it to the C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_NYSTROM_DRIVER_H
#define NEVH_NYSTROM_DRIVER_H

#include "kernels/nystrom_step.h"

/* Arrays of the stages of a step; now: the time of what is asked for. */
typedef struct {
    double steps[DOF], ways[DOF], gain[DOF], rest[DOF], momenta[DOF];
    double velocities[DOF], points[DOF], slopes[STAGES * DOF];
    double now, bad;
} stages;

struct nevh__nystrom_owner {
    double t, h;
    stages *s;
    NEVH__COMPILED(const double *N;)
};

NEVH__INLINE void nevh__nystrom_time(const nevh__nystrom_step *x, int way,
                                     double c) {
    (void)way;
    x->owner->s->now = x->owner->t + c * x->owner->h;
}

NEVH__INLINE int nevh__nystrom_drift(const nevh__nystrom_step *x, int way) {
    const struct nevh__nystrom_owner *o = x->owner;
    (void)way;
    o->s->bad += drift_slope(NEVH__COMPILED(o->N, ) o->s->now, x->points,
                             x->momenta, x->velocities);
    return 0;
}

NEVH__INLINE int nevh__nystrom_kick(const nevh__nystrom_step *x, int way,
                                    size_t stage) {
    const struct nevh__nystrom_owner *o = x->owner;
    (void)way;
    o->s->bad += kick_slope(NEVH__COMPILED(o->N, ) o->s->now, x->points, x->p,
                            x->slopes + stage * x->stride);
    return 0;
}

NEVH__INLINE nevh__nystrom_step step_of(double *y, double *lost,
                                        const struct nevh__nystrom_owner *o) {
    stages *s = o->s;
    s->now = o->t;
    s->bad = 0;
    NEVH__EACH(k, 1, DOF) {
        s->steps[k] = o->h;
        s->rest[k] = AT_REST[k];
        s->gain[k] = o->h * o->h * INVERSE[k];
    }
    return (nevh__nystrom_step){.c = times,
                                .sums = sums,
                                .lanes = 1,
                                .size = DOF,
                                .stride = DOF,
                                .diagonal = DIAGONAL,
                                .moves = MOVES,
                                .q = y,
                                .p = y + DOF,
                                .compensation = lost,
                                .h = s->steps,
                                .way = s->ways,
                                .gain = s->gain,
                                .at_rest = s->rest,
                                .momenta = s->momenta,
                                .velocities = s->velocities,
                                .points = s->points,
                                .slopes = s->slopes,
                                .owner = o};
}

/* The stages from the first one on, which is 0 or 1. */
NEVH__INLINE void take_stages(const nevh__nystrom_step *x, size_t first) {
#ifdef NEVH__FOR_READERS
    nevh__nystrom_take(x, 0, false, first, STAGES);
#else
#define NEVH__TAKE_STAGE(i)                                                    \
    nevh__nystrom_place(x, 0, i);                                              \
    nevh__nystrom_kick(x, 0, i);
    nevh__nystrom_place_start(x);
    nevh__nystrom_time(x, 0, 0);
    if (x->diagonal)
        nevh__nystrom_find_way(x, 0, first > 0);
    NEVH__EACH_STAGE(NEVH__TAKE_STAGE)
#endif
}

#ifdef NEVH__ADAPTS
/* T_p and the first slope at the state. */
static double take_first(NEVH__COMPILED(const double *N, ) double t, double h,
                         double *y, double *lost, double *first) {
    stages s;
    struct nevh__nystrom_owner owner = {t, h, &s NEVH__COMPILED(, N)};
    nevh__nystrom_step x = step_of(y, lost, &owner);
    nevh__nystrom_take(&x, 0, false, 0, 1);
    NEVH__EACH(k, 1, DOF) {
        first[k] = s.velocities[k];
        first[DOF + k] = s.slopes[k];
        s.bad += s.slopes[k] - s.slopes[k];
    }
    return s.bad;
}

/* The other stages. */
NEVH__INLINE double take_trial(NEVH__COMPILED(const double *N, ) double t,
                               double h, double *y, double *lost, double *first,
                               double *ahead, double *change, double *error,
                               double *coarse) {
    stages s;
    struct nevh__nystrom_owner owner = {t, h, &s NEVH__COMPILED(, N)};
    nevh__nystrom_step x = step_of(y, lost, &owner);
    NEVH__EACH(k, 1, DOF) {
        s.velocities[k] = first[k];
        s.slopes[k] = first[DOF + k];
    }
    take_stages(&x, 1);
    NEVH__EACH(k, 1, 2 * DOF) {
        ahead[k] = coarse[k] = 0;
    }
    nevh__nystrom_sum_kicks(&x, &sums[STAGES + 1], 1, change + DOF);
    nevh__nystrom_sum_drifts(&x, 0, &sums[STAGES], 1, 1, change);
    nevh__nystrom_sum_kicks(&x, &sums[STAGES + 3], 1, error + DOF);
    nevh__nystrom_sum_drifts(&x, 0, &sums[STAGES + 2], 0, 1, error);
    for (size_t k = 0; k < STAGES * DOF; k++)
        s.bad += s.slopes[k] - s.slopes[k];
    return s.bad;
}
#else
#ifdef NEVH__FOR_READERS
/* A step of the state y, q and then p.  Returns 0 if all is finite. */
static double take_step(double t, double h, double *y, double *lost) {
#else
NEVH__INLINE double take_step(const nevh__steps_call *c, const double *N,
                              double t, double *y, double *lost, double *kept,
                              double *room) {
    double h = c->h;
    (void)kept, (void)room;
#endif
    double change[2 * DOF];
    stages s;
    struct nevh__nystrom_owner owner = {t, h, &s NEVH__COMPILED(, N)};
    nevh__nystrom_step x = step_of(y, lost, &owner);
    take_stages(&x, 0);
    nevh__nystrom_sum_kicks(&x, &sums[STAGES + 1], 1, change + DOF);
    nevh__nystrom_sum_drifts(&x, 0, &sums[STAGES], 1, 1, change);
    NEVH__EACH(k, 1, 2 * DOF) {
        double moved = change[k] + lost[k], next = y[k] + moved;
        s.bad += next - next;
        lost[k] = nevh__roundoff(next, y[k], moved);
        y[k] = next;
    }
    return s.bad;
}
#endif

#endif
