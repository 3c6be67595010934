/* nevh: steps of an explicit Runge-Kutta method in block_driver.h or long_driver.h,
   and under a tolerance (NEVH__ADAPTS) trials of one orbit for adaptive_driver.h.

   The text needs what runge_kutta_step.h does, a scene's kick_slope and drift_slope,
   STAGES, `sums` over them and their `times`, RATES where NEVH__FRICTION is defined,
   and in compiled steps NEVH__EACH_STAGE(do), do(i) for each stage that a step or a
   trial takes.  lib/native hands it to the C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RUNGE_KUTTA_DRIVER_H
#define NEVH_RUNGE_KUTTA_DRIVER_H

#include "kernels/runge_kutta_step.h"

struct nevh__runge_kutta_owner {
    double t, h;
    nevh__number *bad;
    NEVH__COMPILED(const double *N;)
};

NEVH__INLINE int nevh__runge_kutta_slope(const nevh__runge_kutta_step *x,
                                         int way, size_t stage) {
    const struct nevh__runge_kutta_owner *o = x->owner;
    nevh__number *slopes = x->slopes + stage * x->stride;
    double t = o->t + times[stage] * o->h;
    (void)way;
#ifdef NEVH__FOR_READERS
    *o->bad += kick_slope(t, x->point, x->point + DOF, slopes + DOF);
    *o->bad += drift_slope(t, x->point, x->point + DOF, slopes);
#else
    for (size_t i = 0; i < DOF; i += ONE) {
        const nevh__number *q = x->point + i, *p = q + DOF;
        *o->bad += kick_slope(o->N, t, q, p, slopes + DOF + i NEVH__WHOLE);
        *o->bad += drift_slope(o->N, t, q, p, slopes + i NEVH__WHOLE);
    }
#endif
#ifdef NEVH__FRICTION
    /* dp/dt = -(dH/dq + rate p). */
    NEVH__EACH(k, 1, DOF) {
        slopes[DOF + k] += RATES[k NEVH__COMPILED(% ONE)] * x->point[DOF + k];
    }
#endif
    return 0;
}

#ifndef NEVH__FOR_READERS
#define NEVH__TAKE_STAGE(i) nevh__runge_kutta_take(&x, 0, i, i + 1);
#endif

#ifdef NEVH__ADAPTS
/* The slope at the state. */
static double take_first(NEVH__COMPILED(const double *N, ) double t, double h,
                         double *y, double *lost, double *first) {
    double bad = 0, step[2 * DOF], point[2 * DOF];
    struct nevh__runge_kutta_owner owner = {t, h, &bad NEVH__COMPILED(, N)};
    nevh__runge_kutta_step x = {sums, 2 * DOF, 2 * DOF, y,     lost,
                                step, point,   first,   &owner};
    NEVH__EACH(k, 1, 2 * DOF) {
        step[k] = k < DOF ? h : -h;
    }
    nevh__runge_kutta_take(&x, 0, 0, 1);
    NEVH__EACH(k, 1, 2 * DOF) {
        bad += first[k] - first[k];
    }
    return bad;
}

/* The other stages. */
NEVH__INLINE double take_trial(NEVH__COMPILED(const double *N, ) double t,
                               double h, double *y, double *lost, double *first,
                               double *ahead, double *change, double *error,
                               double *coarse) {
    double bad = 0, step[2 * DOF], point[2 * DOF], slopes[STAGES * 2 * DOF];
    struct nevh__runge_kutta_owner owner = {t, h, &bad NEVH__COMPILED(, N)};
    nevh__runge_kutta_step x = {sums, 2 * DOF, 2 * DOF, y,     lost,
                                step, point,   slopes,  &owner};
    NEVH__EACH(k, 1, 2 * DOF) {
        step[k] = k < DOF ? h : -h;
        slopes[k] = first[k];
    }
#ifdef NEVH__FOR_READERS
    nevh__runge_kutta_take(&x, 0, 1, STAGES);
#else
    NEVH__EACH_STAGE(NEVH__TAKE_STAGE)
#endif
    NEVH__EACH(k, 1, 2 * DOF) {
        nevh__runge_kutta_sum(&x, &sums[STAGES], 1, k, &change[k]);
        nevh__runge_kutta_sum(&x, &sums[STAGES + 1], 1, k, &error[k]);
        nevh__runge_kutta_sum(&x, &sums[STAGES + 2], 1, k, &coarse[k]);
        ahead[k] = slopes[(STAGES - 1) * 2 * DOF + k];
    }
    for (size_t k = 0; k < STAGES * 2 * DOF; k++)
        bad += slopes[k] - slopes[k];
    return bad;
}
#else
#ifdef NEVH__FOR_READERS
/* A step of the state y, q and then p.  Returns 0 if all is finite. */
static double take_step(double t, double h, double *y, double *lost) {
#ifdef NEVH__LOOPS
    static double step[2 * DOF], point[2 * DOF], slopes[STAGES * 2 * DOF];
#else
    double step[2 * DOF], point[2 * DOF], slopes[STAGES * 2 * DOF];
#endif
#else
NEVH__INLINE nevh__number take_step(const nevh__steps_call *c, const double *N,
                                    double t, nevh__number *y,
                                    nevh__number *lost, nevh__number *kept,
                                    nevh__number *room) {
    double h = c->h;
    NEVH__ROWS(step, 0, 2);
    NEVH__ROWS(point, 2, 2);
    NEVH__ROWS(slopes, 4, 2 * STAGES);
    (void)kept, (void)room;
#endif
    nevh__number bad = {0};
    struct nevh__runge_kutta_owner owner = {t, h, &bad NEVH__COMPILED(, N)};
    nevh__runge_kutta_step x = {sums, 2 * DOF, 2 * DOF, y,     lost,
                                step, point,   slopes,  &owner};
    NEVH__EACH(k, 1, DOF) {
        step[k] = (nevh__number){0} + h;
        step[DOF + k] = -step[k];
    }
#ifdef NEVH__FOR_READERS
    nevh__runge_kutta_take(&x, 0, 0, STAGES);
#else
    NEVH__EACH_STAGE(NEVH__TAKE_STAGE)
#endif
    NEVH__EACH(k, 1, 2 * DOF) {
        nevh__number change, next;
        nevh__runge_kutta_sum(&x, &sums[STAGES], 1, k, &change);
        change += lost[k];
        next = y[k] + change;
        bad += next - next;
        lost[k] = nevh__roundoff(next, y[k], change);
        y[k] = next;
    }
    return bad;
}
#endif

#endif
