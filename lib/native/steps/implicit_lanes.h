/* nevh: a step of orbits side by side, for implicit_driver.h, which has what this
   text needs.  Those that are done wait for the others.  Values are counted as the
   kernel takes them, which sweeps the last FEW one by one.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_IMPLICIT_LANES_H
#define NEVH_IMPLICIT_LANES_H

#include "native/steps/implicit_driver.h"

typedef struct {
    double y[2 * DOF * 8], lost[2 * DOF * 8], slopes[2 * DOF * STRIDE];
    double past[UNKNOWN * PAST * STRIDE];
    double steps[8], first_change[8];
} block;

NEVH__INLINE void load_block(const double *N, double h, const double *Q,
                             const double *P, const double *M, sweeps_room *r,
                             block *to) {
    for (size_t k = 0; k < 2 * DOF; k++) {
        const double *from = (k < DOF ? Q : P) + k % DOF * WIDTH;
        NEVH_LANES(i, 8) {
            double one = from[i], size = fabs(one),
                   most = SCALES[k * SCALES_APART + (SCALES_APART > 1 ? i : 0)];
            double scale = size > most ? size : most;
            to->y[k * 8 + i] = one;
            to->lost[k * 8 + i] = M[k * WIDTH + i];
            r->scale[k * 8 + i] = scale;
            r->unit[k * 8 + i] = fabs(h) / scale;
        }
    }
    for (size_t i = 0; i < 8; i++)
        to->steps[i] = M[H_AT * WIDTH + i] == h ? M[STEPS_AT * WIDTH + i] : 0;
    for (size_t k = 0; k < UNKNOWN * KEPT_STAGES; k++)
        NEVH_LANES(i, 8) {
            to->past[k * 8 + i] = M[(SLOPES_AT + k) * WIDTH + i];
        }
}

NEVH__INLINE bool add_block(const step_weights *w, block *to) {
    double check[8];
    NEVH_LANES(i, 8) {
        check[i] = 0;
    }
    for (size_t k = 0; k < 2 * DOF; k++) {
        nevh__stage_advance(STAGES, order, k < DOF ? w->plus : w->minus, 8, 8,
                            to->slopes + k * STRIDE, to->y + k * 8,
                            to->lost + k * 8);
        NEVH_LANES(i, 8) {
            check[i] += to->y[k * 8 + i] - to->y[k * 8 + i];
        }
    }
    return nevh__sum_lanes(check) == 0;
}

/* The orbits of a block as they iterate: what nevh__stage_lane has of each, the
   smallest change being in r.lowest; and 1 where one is done. */
typedef struct {
    const double *N;
    block *to;
    double t, h;
    sweeps_room r;
    double change[8], before[8], first[8], grace[8], stalls[8], slow[8];
    double settled[8], level[8], unknown;
    size_t left, *counted;
} iteration;

NEVH__INLINE void begin_sweeps(const nevh__stage_step *x,
                               const nevh__stage_changes *changes,
                               iteration *it) {
    block *to = it->to;
    NEVH_LANES(i, STRIDE) {
        it->r.times[i] = it->t + nodes[i / 8] * it->h;
    }
    nevh__stage_begin_sweeps(x, changes, 8, long_guess, KEPT_STAGES, to->past,
                             PAST * STRIDE);
    for (size_t i = 0; i < 8; i++)
        if (to->steps[i] < PAST)
            nevh__stage_begin_lane(x, changes, i, guess,
                                   to->steps[i] > 0 ? STAGES : 0, to->past,
                                   PAST * STRIDE);
}

/* Passes the orbits whose changes fall so much that nevh__stage_judge_fixed_point
   tells them to go on; `open`: 0 for those, and for those that are done. */
NEVH__INLINE void pass_falling(iteration *it,
                               const nevh__stage_comparison *found,
                               double open[8]) {
    const double most = UNKNOWN * STAGES <= NEVH__STAGE_FEW_UNKNOWNS
                            ? NEVH__STAGE_SLOW_SMALL
                            : NEVH__STAGE_SLOW_LARGE;
    NEVH_LANES(i, 8) {
        double change = found->most[i], last = it->change[i];
        double ahead = NEWTON ? most * it->before[i] : INFINITY;
        double enough = ahead > NEVH__STAGE_TINY ? ahead : NEVH__STAGE_TINY;
        double bar = NEVH__STAGE_HARDLY_LESS * it->r.lowest[i];
        double not_yet = (change < bar ? 0 : 1) + (change <= 1 ? 0 : 1) +
                         (change <= enough ? 0 : 1) +
                         (found->all[i] > 0 ? 0 : 1) +
                         (found->all[i] < INFINITY ? 0 : 1);
        bool falls = not_yet == 0;
        open[i] = it->settled[i] > 0 ? 0 : not_yet;
        it->first[i] = falls && !(last < INFINITY) ? change : it->first[i];
        it->before[i] = falls ? last : it->before[i];
        it->change[i] = falls ? change : last;
        it->r.lowest[i] = falls ? change : it->r.lowest[i];
        it->grace[i] = falls ? 0 : it->grace[i];
        it->slow[i] = falls ? 0 : it->slow[i];
    }
}

/* Judges a sweep of orbit i. */
NEVH__INLINE nevh__stage_state
judge_orbit(iteration *it, size_t i, const nevh__stage_comparison *found) {
    struct nevh__stage_judge_owner owner = {
        it->N, it->to->y + i, it->r.scale + i, it->t,
        it->h, &it->level[i], &it->unknown,    &it->counted[1]};
    nevh__stage_judged judged = {0,     true, NOISY, NEWTON, UNKNOWN * STAGES,
                                 &owner};
    nevh__stage_lane lane = {.grace = it->grace[i] > 0,
                             .stalls = (unsigned)it->stalls[i],
                             .slow = (unsigned)it->slow[i],
                             .change = it->change[i],
                             .before = it->before[i],
                             .least = it->r.lowest[i],
                             .first = it->first[i]};
    nevh__stage_progress made;
    nevh__stage_tell(found->all[i], found->better[i], found->most[i],
                     &it->r.lowest[i], &made);
    if (!(made.change < INFINITY))
        return NEVH__STUCK;
    nevh__stage_state state =
        nevh__stage_judge_fixed_point(&judged, &lane, &made);
    it->grace[i] = lane.grace;
    it->stalls[i] = lane.stalls;
    it->slow[i] = lane.slow;
    it->change[i] = lane.change;
    it->before[i] = lane.before;
    it->first[i] = lane.first;
    return state;
}

/* Judges sweep number `sweeps` of all, and keeps the slopes of those that are done;
   false: one does not get on. */
NEVH__INLINE bool judge_sweep(iteration *it, size_t sweeps,
                              const nevh__stage_comparison *found) {
    double open[8];
    pass_falling(it, found, open);
    if (nevh__sum_lanes(open) > 0)
        for (size_t i = 0; i < 8; i++) {
            nevh__stage_state state =
                open[i] > 0 ? judge_orbit(it, i, found) : NEVH__GO_ON;
            if (state == NEVH__STUCK)
                return false;
            if (state != NEVH__DONE)
                continue;
            it->settled[i] = 1;
            it->to->first_change[i] = it->first[i];
            it->left--;
            it->counted[0] += sweeps;
            for (size_t k = i; k < 2 * DOF * STRIDE; k += 8)
                it->to->slopes[k] = it->r.gradient[k];
        }
    return it->left == 0 || sweeps < NEVH__STAGE_SWEEPS;
}

NEVH__INLINE bool take_block(iteration *it, const step_weights *w,
                             const double *Q, const double *P,
                             const double *M) {
    double products[STRIDE];
    nevh__vector bad = {0};
    nevh__stage_comparison found;
    sweeps_room *r = &it->r;
    struct nevh__stage_owner owner = {it->N, r->times, &bad};
    nevh__stage_step x = sweeps_of(r, w, it->to->y, it->to->lost, &owner);
    x.products = products;
    nevh__stage_changes changes = {FIRST,     UNKNOWN,  r->unit,
                                   r->before, r->least, r->lowest};
    for (size_t i = 0; i < 8; i++) {
        if (M[HOLD_AT * WIDTH + i] > 0)
            return false;
        it->change[i] = it->before[i] = it->first[i] = INFINITY;
        it->grace[i] = it->stalls[i] = it->slow[i] = it->settled[i] = 0;
        r->lowest[i] = INFINITY;
        it->level[i] = -1;
    }
    load_block(it->N, it->h, Q, P, M, r, it->to);
    begin_sweeps(&x, &changes, it);
    for (size_t sweeps = 1; it->left > 0; sweeps++) {
        it->counted[2] += it->left > FEW ? 8 : it->left;
        if (nevh__stage_map(&x, 8))
            return false;
        nevh__stage_compare_changes(&x, &changes, 8, &found);
        if (!judge_sweep(it, sweeps, &found))
            return false;
    }
    return !is_bad(bad) && it->unknown == 0 && add_block(w, it->to);
}

NEVH__INLINE void store_block(double h, const block *from, double *Q, double *P,
                              double *M) {
    for (size_t k = 0; k < 2 * DOF; k++) {
        double *to = (k < DOF ? Q : P) + k % DOF * WIDTH;
        NEVH_LANES(i, 8) {
            to[i] = from->y[k * 8 + i];
            M[k * WIDTH + i] = from->lost[k * 8 + i];
        }
    }
    for (size_t k = 0; k < UNKNOWN; k++) {
        double sign = FIRST + k < DOF ? 1 : -1;
        double *kept = M + (SLOPES_AT + k * KEPT_STAGES) * WIDTH;
        for (size_t j = KEPT_STAGES; j-- > 0;)
            NEVH_LANES(i, 8) {
                kept[j * WIDTH + i] =
                    j < STAGES
                        ? sign * from->slopes[(FIRST + k) * STRIDE + j * 8 + i]
                        : kept[(j - STAGES) * WIDTH + i];
            }
    }
    for (size_t i = 0; i < 8; i++) {
        M[STEPS_AT * WIDTH + i] =
            nevh__stage_remember(from->steps[i], PAST, from->first_change[i]);
        M[H_AT * WIDTH + i] = h;
    }
}

NEVH__INLINE bool take_step(const double *N, double t, double *Q, double *P,
                            double *M, const step_weights *w, size_t *counted) {
    block next[BLOCKS];
    size_t found[3] = {0, 0, 0};
    for (size_t b = 0; b < BLOCKS; b++) {
        iteration it;
        it.N = TABLE(b);
        it.to = &next[b];
        it.t = t;
        it.h = w->h;
        it.unknown = 0;
        it.left = 8;
        it.counted = found;
        if (!take_block(&it, w, Q + 8 * b, P + 8 * b, M + 8 * b))
            return false;
    }
    for (size_t b = 0; b < BLOCKS; b++)
        store_block(w->h, &next[b], Q + 8 * b, P + 8 * b, M + 8 * b);
    for (size_t i = 0; i < 3; i++)
        counted[i] += found[i];
    return true;
}

#endif
