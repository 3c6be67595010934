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

/* A step from t to t + h in as many substeps as the tolerance needs; false:
   they do not get there, and nothing has changed. */
NEVH__INLINE bool take_step(NEVH__COMPILED(const double *N, ) double t,
                            double h, double *Q, double *P,
                            double *M NEVH__COMPILED(, size_t *counted)) {
    double y[2 * DOF], lost[2 * DOF], first[2 * DOF], ahead[2 * DOF];
    double next[2 * DOF], next_lost[2 * DOF];
    double change[2 * DOF], error[2 * DOF], coarse[2 * DOF];
    const nevh__adaptive_rule rule = {.size = 2 * DOF,
                                      .power = POWER,
                                      .coarse = COARSE,
                                      .keeps = KEEPS,
                                      .tolerance = TOLERANCE,
                                      .part = FIRST_PART,
                                      .scale = SCALES};
    nevh__substeps l = {.size = M[LENGTH_AT],
                        .last = M[LAST_AT],
                        .before = M[BEFORE_AT],
                        .excess = M[EXCESS_AT],
                        .has_first = KEEPS && M[HAS_FIRST_AT] != 0};
    NEVH__COMPILED(size_t firsts = 0, trials = 0;)
    NEVH__EACH(k, 1, 2 * DOF) {
        y[k] = k < DOF ? Q[k] : P[k - DOF];
        lost[k] = M[k];
        first[k] = KEEPS ? M[FIRST_AT + k] : 0;
    }
    while (l.done < fabs(h)) {
        double begin = t + copysign(l.done, h), bad = 0, err;
        if (!l.has_first) {
            bad += take_first(NEVH__COMPILED(N, ) begin, h, y, lost, first);
            l.has_first = true;
            NEVH__COMPILED(firsts++;)
        }
        if (l.size == 0)
            l.size = nevh__substeps_first(&rule, h, 1, y, first);
        if (bad != 0 || nevh__substeps_too_short(&l, h) ||
            nevh__pace_count(&l.pace, fabs(h), l.done) ||
            nevh__substeps_exceed(&l))
            return false;
        nevh__substeps_choose(&l, h);
        bad = take_trial(NEVH__COMPILED(N, ) begin, copysign(l.step, h), y,
                         lost, first, ahead, change, error, coarse);
        NEVH__EACH(k, 1, 2 * DOF) {
            double moved = change[k] + lost[k];
            next[k] = y[k] + moved;
            bad += next[k] - next[k];
            next_lost[k] = nevh__roundoff(next[k], y[k], moved);
        }
#ifdef NEVH__FOR_READERS
        if (bad != 0) {
            if (!nevh__substeps_retreat(&l, h))
                return false;
            continue;
        }
#else
        trials++;
        if (bad != 0)
            return false;
#endif
        err = nevh__substeps_judge(&rule, 1, error, coarse, y, next);
        if (!(err <= 1)) {
            if (!nevh__substeps_reject(&rule, &l, h, err))
                return false;
            continue;
        }
        nevh__substeps_accept(&rule, &l, h, err);
        NEVH__EACH(k, 1, 2 * DOF) {
            y[k] = next[k];
            lost[k] = next_lost[k];
            first[k] = KEEPS ? ahead[k] : 0;
        }
    }
    NEVH__EACH(k, 1, 2 * DOF) {
        *(k < DOF ? Q + k : P + (k - DOF)) = y[k];
        M[k] = lost[k];
        if (KEEPS)
            M[FIRST_AT + k] = first[k];
    }
    M[LENGTH_AT] = l.size;
    M[LAST_AT] = l.last;
    M[BEFORE_AT] = l.before;
    M[EXCESS_AT] = nevh__substeps_excess(&l);
    if (KEEPS)
        M[HAS_FIRST_AT] = l.has_first;
#ifndef NEVH__FOR_READERS
    counted[0] += firsts;
    counted[1] += trials;
#endif
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
