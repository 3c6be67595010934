/* nevh: whether an iteration over stages gets on.
   SPDX-License-Identifier: GPL-3.0-or-later

   It is not stopped at a tolerance, which would leave an error of one sign and
   let the energy drift [Hairer, McLachlan, Razakarivony, "Achieving Brouwer's
   law with implicit Runge-Kutta methods", BIT 48 (2008)].  The rule is that of
   Antonana, Makazaga, Murua ["Reducing and monitoring round-off error
   propagation for symplectic implicit Runge-Kutta schemes", Numer. Algorithms
   (2017)]: remember for each unknown the smallest change so far; sweep on while
   some unknown improves its own; when none does, allow one grace sweep, then
   stop.

   Their rule is believed only once the changes are small, since in the first
   sweeps of a hard step they may rise before they fall.  Small is 1e-10 of
   the unknown's scale, or what the rounding of H makes of a difference
   quotient.  And the largest change counts as one more unknown: where H is
   separable, sweeps take errors from momenta to coordinates and back in two
   chains that do not meet, and one of them may be at rounding by chance.  Under
   differences unknowns go on improving by chance, each drawing
   new noise in every sweep; there the iteration also ends when all changes are
   within that noise and the largest of them has ceased to fall.

   The text needs stage_progress.h and two functions of the includer. */
#ifndef NEVH_STAGE_JUDGE_H
#define NEVH_STAGE_JUDGE_H

#include "implicit/stage_progress.h"
#include <math.h>
#include <nevh/simd.h>
#include <stdbool.h>
#include <stddef.h>

/* Changes above this are not noise; a ratio of changes above this is hardly a
   decrease. */
#define NEVH__STAGE_MAYBE_NOISE 1e-4
#define NEVH__STAGE_HARDLY_LESS 0.9

/* The ends of an iteration: stalls; and consecutive sweeps that contract by less
   than this in two sweeps, in systems of so many unknowns and in larger ones. */
enum {
    NEVH__STAGE_STALLS = 8,
    NEVH__STAGE_SLOW = 4,
    NEVH__STAGE_FEW_UNKNOWNS = 32
};
#define NEVH__STAGE_SLOW_SMALL 0.25
#define NEVH__STAGE_SLOW_LARGE 0.5

/* An iteration that is judged.  Progress is that the changes of more than
   `chance` unknowns are smaller than ever. */
typedef struct {
    size_t chance;
    bool falls;  /* or that the largest is */
    bool noisy;  /* derivatives are differences */
    bool newton; /* Newton's iteration can take over */
    size_t unknowns;
    const struct nevh__stage_judge_owner *owner; /* the includer's */
} nevh__stage_judged;

/* The includer's: whether a change, in units of scale, is no more than
   rounding. */
NEVH__INLINE bool nevh__stage_is_small(const nevh__stage_judged *,
                                       double change);
/* The includer's, too: what noise makes of a step, in units of scale. */
NEVH__INLINE double nevh__stage_noise_level(const nevh__stage_judged *);

NEVH__INLINE void nevh__stage_forget(nevh__stage_lane *l) {
    l->grace = l->strays = false;
    l->stalls = l->slow = 0;
    l->change = l->before = l->least = l->first = INFINITY;
}

/* Differences only: the last sweep drew noise and nothing else. */
NEVH__INLINE bool nevh__stage_drowned(const nevh__stage_judged *x,
                                      const nevh__stage_lane *l,
                                      const nevh__stage_progress *made) {
    return x->noisy && made->change < NEVH__STAGE_MAYBE_NOISE &&
           made->change >= NEVH__STAGE_HARDLY_LESS * l->least &&
           made->change <= 0x1p-51 + nevh__stage_noise_level(x);
}

NEVH__INLINE nevh__stage_state
nevh__stage_judge_sweep(const nevh__stage_judged *x, nevh__stage_lane *l,
                        const nevh__stage_progress *made) {
    l->strays |= made->change > 1 ||
                 (made->change > l->change && made->change > NEVH__STAGE_TINY);
    l->before = l->change;
    l->change = made->change;
    l->first = l->before < INFINITY ? l->first : made->change;
    if (!made->moved || nevh__stage_drowned(x, l, made))
        return NEVH__DONE;
    bool falls = x->falls && made->change < l->least;
    l->least = made->change < l->least ? made->change : l->least;
    if (made->improved > x->chance || falls) {
        l->grace = false;
        return NEVH__GO_ON;
    }
    if (l->grace && nevh__stage_is_small(x, l->change))
        return NEVH__DONE;
    l->stalls += l->grace;
    l->grace = true;
    return l->stalls < NEVH__STAGE_STALLS ? NEVH__GO_ON : NEVH__STUCK;
}

/* True if fixed-point iteration would take too long; `before`: the change two
   sweeps ago. */
NEVH__INLINE bool nevh__stage_too_slow(const nevh__stage_judged *x,
                                       nevh__stage_lane *l, double before) {
    double most = x->unknowns <= NEVH__STAGE_FEW_UNKNOWNS
                      ? NEVH__STAGE_SLOW_SMALL
                      : NEVH__STAGE_SLOW_LARGE;
    bool slow = l->change > NEVH__STAGE_TINY && l->change > most * before;
    l->slow = slow ? l->slow + 1 : 0;
    return l->slow >= NEVH__STAGE_SLOW && !nevh__stage_is_small(x, l->change);
}

/* A sweep of fixed-point iteration. */
NEVH__INLINE nevh__stage_state
nevh__stage_judge_fixed_point(const nevh__stage_judged *x, nevh__stage_lane *l,
                              const nevh__stage_progress *made) {
    double before = l->before;
    nevh__stage_state state = nevh__stage_judge_sweep(x, l, made);
    return state == NEVH__GO_ON && x->newton &&
                   nevh__stage_too_slow(x, l, before)
               ? NEVH__STUCK
               : state;
}

#endif
