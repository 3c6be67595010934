/* nevh: steps of one orbit under a tolerance, around the trials of a family.

   A compiled step whose trials leave the numbers, or that takes too many, is left
   to the kernel, which begins it anew.  The text needs what adaptive_step.h does,
   numbers of the rule (POWER, COARSE, KEEPS, TOLERANCE, FIRST_PART, SCALES), and two
   functions of the includer, which return 0 if all is well:

       double take_first(N, t, h, y, lost, first)
       double take_trial(N, t, h, y, lost, first, ahead, change, error, coarse)

   the slope at y, and what the other stages come to; ahead: the last stage's
   slope.  lib/native hands it to the C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ADAPTIVE_DRIVER_H
#define NEVH_ADAPTIVE_DRIVER_H

#include "kernels/adaptive_step.h"

/* The memory of the kernel, behind digits that sums have lost. */
enum {
    LENGTH_AT = 2 * DOF,
    LAST_AT,
    BEFORE_AT,
    EXCESS_AT,
    FIRST_AT,
    HAS_FIRST_AT = FIRST_AT + 2 * DOF
};

/* The state and the memory where a step begins. */
NEVH__INLINE nevh__substeps take_memory(const double *Q, const double *P,
                                        const double *M, double *y,
                                        double *lost, double *first) {
    NEVH__EACH(k, 1, 2 * DOF) {
        y[k] = k < DOF ? Q[k] : P[k - DOF];
        lost[k] = M[k];
        first[k] = KEEPS ? M[FIRST_AT + k] : 0;
    }
    return (nevh__substeps){.size = M[LENGTH_AT],
                            .last = M[LAST_AT],
                            .before = M[BEFORE_AT],
                            .excess = M[EXCESS_AT],
                            .has_first = KEEPS && M[HAS_FIRST_AT] != 0};
}

/* The state and the memory where a step ends. */
NEVH__INLINE void keep_memory(const nevh__substeps *l, double *Q, double *P,
                              double *M, const double *y, const double *lost,
                              const double *first) {
    NEVH__EACH(k, 1, 2 * DOF) {
        *(k < DOF ? Q + k : P + (k - DOF)) = y[k];
        M[k] = lost[k];
        if (KEEPS)
            M[FIRST_AT + k] = first[k];
    }
    M[LENGTH_AT] = l->size;
    M[LAST_AT] = l->last;
    M[BEFORE_AT] = l->before;
    M[EXCESS_AT] = nevh__substeps_excess(l);
    if (KEEPS)
        M[HAS_FIRST_AT] = l->has_first;
}

/* The state after a change; returns 0 if it is finite. */
NEVH__INLINE double add_change(const double *y, const double *lost,
                               const double *change, double *next,
                               double *next_lost) {
    double bad = 0;
    NEVH__EACH(k, 1, 2 * DOF) {
        double moved = change[k] + lost[k];
        next[k] = y[k] + moved;
        bad += next[k] - next[k];
        next_lost[k] = nevh__roundoff(next[k], y[k], moved);
    }
    return bad;
}

/* The next substep's length; false: it is too short, or too many were taken. */
NEVH__INLINE bool begin_trial(const nevh__adaptive_rule *rule,
                              nevh__substeps *l, double h, const double *y,
                              const double *first) {
    if (l->size == 0)
        l->size = nevh__substeps_first(rule, h, 1, y, first);
    if (nevh__substeps_too_short(l, h) ||
        nevh__pace_count(&l->pace, fabs(h), l->done) ||
        nevh__substeps_exceed(l))
        return false;
    nevh__substeps_choose(l, h);
    return true;
}

/* After a trial that left the numbers: whether a shorter one is to be taken. */
NEVH__INLINE bool leave_trial(nevh__substeps *l, double h) {
#ifdef NEVH__FOR_READERS
    return nevh__substeps_retreat(l, h);
#else
    (void)l, (void)h;
    return false;
#endif
}

/* A step from t to t + h in as many substeps as the tolerance needs; false:
   they do not get there, and nothing has changed. */
NEVH__INLINE bool take_step(NEVH__COMPILED(const double *N, ) double t,
                            double h, double *Q, double *P,
                            double *M NEVH__COMPILED(, size_t *counted)) {
    double y[2 * DOF], lost[2 * DOF], first[2 * DOF], ahead[2 * DOF];
    double next[2 * DOF], next_lost[2 * DOF];
    double change[2 * DOF], error[2 * DOF], coarse[2 * DOF];
    const nevh__adaptive_rule rule = {2 * DOF,   POWER,      COARSE, KEEPS,
                                      TOLERANCE, FIRST_PART, SCALES};
    nevh__substeps l = take_memory(Q, P, M, y, lost, first);
    NEVH__COMPILED(size_t firsts = 0, trials = 0;)
    while (l.done < fabs(h)) {
        double begin = t + copysign(l.done, h), bad = 0, err;
        if (!l.has_first) {
            bad += take_first(NEVH__COMPILED(N, ) begin, h, y, lost, first);
            l.has_first = true;
            NEVH__COMPILED(firsts++;)
        }
        if (bad != 0 || !begin_trial(&rule, &l, h, y, first))
            return false;
        bad = take_trial(NEVH__COMPILED(N, ) begin, copysign(l.step, h), y,
                         lost, first, ahead, change, error, coarse);
        bad += add_change(y, lost, change, next, next_lost);
        NEVH__COMPILED(trials++;)
        if (bad != 0 && !leave_trial(&l, h))
            return false;
        if (bad != 0)
            continue;
        err = nevh__substeps_judge(&rule, 1, error, coarse, y, next);
        if (err <= 1) {
            nevh__substeps_accept(&rule, &l, h, err);
            NEVH__EACH(k, 1, 2 * DOF) {
                y[k] = next[k];
                lost[k] = next_lost[k];
                first[k] = KEEPS ? ahead[k] : 0;
            }
        } else if (!nevh__substeps_reject(&rule, &l, h, err))
            return false;
    }
    keep_memory(&l, Q, P, M, y, lost, first);
    NEVH__COMPILED(counted[0] += firsts; counted[1] += trials;)
    return true;
}

/* Takes up to `steps` steps of h, the first being number `from`, and returns how
   many of them it could take. */
NEVH__INLINE size_t advance(NEVH__COMPILED(const double *N, ) double t0,
                            double h, size_t from, size_t steps, double *Q,
                            double *P,
                            double *M NEVH__COMPILED(, size_t *counted)) {
    size_t done = 0;
    while (done < steps &&
           take_step(NEVH__COMPILED(N, ) t0 + (double)(from + done) * h, h, Q,
                     P, M NEVH__COMPILED(, counted)))
        done++;
    return done;
}

#endif
