/* nevh: a step of one orbit, for implicit_driver.h, which has what this text needs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_IMPLICIT_ORBIT_H
#define NEVH_IMPLICIT_ORBIT_H

#include "native/steps/implicit_driver.h"

/* The new state from the slopes, which the next step continues. */
NEVH__INLINE bool add_step(const step_weights *w, const double *gradient,
                           double first_change, double *y, double *M,
                           double h) {
    double sum[2 * DOF], lost[2 * DOF], check = 0;
    NEVH__EACH(k, 1, 2 * DOF) {
        sum[k] = y[k];
        lost[k] = M[k];
        nevh__stage_advance(STAGES, order, k < DOF ? w->plus : w->minus, 1, 1,
                            gradient + k * ROW, &sum[k], &lost[k]);
        check += sum[k] - sum[k];
    }
    if (check != 0)
        return false;
    NEVH__EACH(k, 1, 2 * DOF) {
        y[k] = sum[k];
        M[k] = lost[k];
    }
    for (size_t k = 0; k < UNKNOWN; k++) {
        double older[KEPT_STAGES], *kept = M + SLOPES_AT + k * KEPT_STAGES;
        for (size_t i = STAGES; i < KEPT_STAGES; i++)
            older[i] = kept[i - STAGES];
        NEVH__EACH(i, 1, STAGES) {
            double slope = gradient[(FIRST + k) * ROW + i];
            kept[i] = FIRST + k < DOF ? slope : -slope;
        }
        for (size_t i = STAGES; i < KEPT_STAGES; i++)
            kept[i] = older[i];
    }
    M[STEPS_AT] = nevh__stage_remember(M[H_AT] == h ? M[STEPS_AT] : 0, PAST,
                                       first_change);
    M[H_AT] = h;
    return true;
}

/* The state, its scales, and the times of stages. */
NEVH__INLINE void load_orbit(NEVH__COMPILED(const double *N, ) double t,
                             double h, const double *Q, const double *P,
                             double *y, sweeps_room *r) {
    NEVH__EACH(k, 1, 2 * DOF) {
        double size, most = SCALES[k];
        y[k] = k < DOF ? Q[k] : P[k - DOF];
        size = fabs(y[k]);
        r->scale[k] = size > most ? size : most;
        r->unit[k] = fabs(h) / r->scale[k];
    }
    NEVH_LANES(i, ROW) {
        r->times[i] = t + nodes[i] * h;
    }
    r->lowest[0] = INFINITY;
}

/* Guesses slopes from those of the steps before, where these were as long. */
NEVH__INLINE void begin_sweeps(const nevh__stage_step *x,
                               const nevh__stage_changes *changes,
                               const double *M, double h) {
    if (M[H_AT] == h && M[STEPS_AT] >= PAST)
        nevh__stage_begin_sweeps(x, changes, NEVH__STAGES_TOGETHER, long_guess,
                                 KEPT_STAGES, M + SLOPES_AT, KEPT_STAGES);
    else
        nevh__stage_begin_sweeps(x, changes, NEVH__STAGES_TOGETHER, guess,
                                 M[H_AT] == h && M[STEPS_AT] > 0 ? STAGES : 0,
                                 M + SLOPES_AT, KEPT_STAGES);
}

/* Sweeps until the slopes are those at the points that they lead to, but for
   rounding.  Returns after how many; 0: they do not get there. */
NEVH__INLINE size_t sweep_stages(const nevh__stage_step *x,
                                 const nevh__stage_changes *changes,
                                 const nevh__stage_judged *judged,
                                 nevh__stage_lane *lane) {
    nevh__stage_progress made;
    for (size_t sweeps = 1; sweeps <= NEVH__STAGE_SWEEPS; sweeps++) {
        nevh__stage_state state;
        if (nevh__stage_map(x, NEVH__STAGES_TOGETHER))
            return 0;
        nevh__stage_compare_sweep(x, changes, NEVH__STAGES_TOGETHER, &made);
        if (!(made.change < INFINITY))
            return 0;
        state = nevh__stage_judge_fixed_point(judged, lane, &made);
        if (state != NEVH__GO_ON)
            return state == NEVH__DONE ? sweeps : 0;
    }
    return 0;
}

NEVH__INLINE bool
take_step(NEVH__COMPILED(const double *N, ) double t, double *Q, double *P,
          double *M, const step_weights *w NEVH__COMPILED(, size_t *counted)) {
    double h = w->h, y[2 * DOF];
    double level = -1, unknown = 0;
    sweeps_room r;
    nevh__vector bad = {0};
    size_t sweeps, noises = 0;
    struct nevh__stage_owner owner = {NEVH__COMPILED(N, ) r.times, &bad};
    struct nevh__stage_judge_owner judge_owner = {
        NEVH__COMPILED(N, ) y, r.scale, t, h, &level, &unknown, &noises};
    nevh__stage_step x = sweeps_of(&r, w, y, M, &owner);
    nevh__stage_changes changes = {FIRST,    UNKNOWN, r.unit,
                                   r.before, r.least, r.lowest};
    nevh__stage_judged judged = {
        0, true, NOISY, NEWTON, UNKNOWN * STAGES, &judge_owner};
    nevh__stage_lane lane;
    if (M[HOLD_AT] > 0)
        return false;
    load_orbit(NEVH__COMPILED(N, ) t, h, Q, P, y, &r);
    nevh__stage_forget(&lane);
    begin_sweeps(&x, &changes, M, h);
    sweeps = sweep_stages(&x, &changes, &judged, &lane);
    if (sweeps == 0 || is_bad(bad) || unknown != 0 ||
        !add_step(w, r.gradient, lane.first, y, M, h))
        return false;
    NEVH__EACH(k, 1, DOF) {
        Q[k] = y[k];
        P[k] = y[DOF + k];
    }
#ifdef NEVH__FOR_READERS
    M[SWEEPS_AT] += (double)sweeps;
#else
    counted[0] += sweeps;
    counted[1] += noises;
    counted[2] += sweeps;
#endif
    return true;
}

#endif
