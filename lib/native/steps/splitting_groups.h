/* nevh: steps of a splitting of a state that is long, in long_driver.h: operations
   are done in groups, part after part of the state, and each group lags one part
   behind the group before.

   The text needs what splitting_step.h does, a scene's kick_at and drift_at, which
   take one vector of the slopes, kick_vector and drift_vector for what that vector
   has left to the next, and sizes: PART vectors, PARTS of them, GROUPS of a step,
   AT_ONCE steps, WINDOW vectors that are in work, IN_WORK parts; and of the scheme
   KICKS_FIRST, KEEPS, IN_FIRST and IN_LAST, operations of the first and the last
   group, and LAST_AT, where the last begins.  lib/native hands it to the C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SPLITTING_GROUPS_H
#define NEVH_SPLITTING_GROUPS_H

#include "kernels/splitting_step.h"

/* Groups after the first begin with a kick, or else a drift. */
enum { BEGINS_WITH_KICK = KICKS_FIRST == (IN_FIRST % 2 == 0) };

struct nevh__splitting_owner {
    const double *N;
    size_t k;
    const wide *q, *p;
    wide *bad, *kick, *drift;
};

NEVH__INLINE int nevh__splitting_slope(const nevh__splitting_step *x, int way,
                                       size_t i, bool kick, bool kept) {
    const struct nevh__splitting_owner *o = x->owner;
    double t = x->t + x->scheme->times[i] * x->h;
    (void)way;
    if (kept)
        return 0;
    *x->slope = kick ? kick_at(o->N, t, KICK_REACHES ? o->q : x->q.point, o->k,
                               o->kick, o->bad)
                     : drift_at(o->N, t, DRIFT_REACHES ? o->p : x->p.point,
                                o->k, o->drift, o->bad);
    return 0;
}

/* A part, which begins at vector `at` of the state; `here`: in rows of change, which
   are of the part, and of points, which are of the parts in work. */
typedef struct {
    const double *N;
    const nevh__splitting_scheme *scheme;
    double t, h;
    wide *y, *lost, *kept, *change, *bad;
    const wide *from;
    wide *to;
    size_t at, here, size;
} part;

/* `count` operations from i on, of which the first is a kick or not; whether a step
   begins and ends with them. */
typedef struct {
    size_t i, count;
    bool kick, begins, ends;
} group;

/* The slopes that the vector before the part has left to its first one. */
NEVH__INLINE void take_left(const part *r, group g, wide *kick, wide *drift) {
    const wide *q = r->from + r->here, *p = q + WINDOW;
    double t = r->t + r->scheme->times[g.i] * r->h;
    wide none = {0};
    if (KICK_REACHES)
        kick_vector(r->N, t, q - 1, r->at - 1, kick, &none);
    if (DRIFT_REACHES)
        drift_vector(r->N, t, p - 1, r->at - 1, drift, &none);
}

/* A group, of the owner's vector of a part. */
NEVH__INLINE void operate_vector(const part *r, group g,
                                 struct nevh__splitting_owner owner) {
    wide *restrict state = r->y, *restrict rest = r->lost, *restrict to = r->to;
    wide *restrict slopes = r->kept, *restrict changes = r->change;
    size_t at = owner.k, here = r->here + (at - r->at);
    wide y[2] = {state[at], state[DOF + at]};
    wide lost[2] = {rest[at], rest[DOF + at]};
    wide change[2], point[2], slope, none = {0};
    wide kept = KEEPS && g.begins ? slopes[at] : none;
    nevh__half half_q = {y, lost, change, point};
    nevh__half half_p = {y + 1, lost + 1, change + 1, point + 1};
    nevh__splitting_step x = {r->t,   r->h,   r->scheme, KEEPS, half_q,
                              half_p, &slope, &kept,     &owner};
    if (g.begins)
        nevh__splitting_place(&x, 1, 1);
    else {
        change[0] = changes[here];
        change[1] = changes[WINDOW + here];
        point[0] = READS_Q ? *owner.q : none;
        point[1] = READS_P ? *owner.p : none;
    }
    if (g.count > 0)
        nevh__splitting_operate(&x, 0, 1, 1, g.i, g.kick, KEEPS && g.begins);
    if (g.count > 1)
        nevh__splitting_operate(&x, 0, 1, 1, g.i + 1, !g.kick, false);
    if (g.ends) {
        *owner.bad += point[0] + point[1];
        nevh__splitting_commit_all(&x, 1, 1, KEEPS);
        state[at] = y[0];
        state[DOF + at] = y[1];
        rest[at] = lost[0];
        rest[DOF + at] = lost[1];
        if (KEEPS)
            slopes[at] = kept;
    } else {
        changes[here] = change[0];
        changes[WINDOW + here] = change[1];
        if (READS_Q)
            to[here] = point[0];
        if (READS_P)
            to[WINDOW + here] = point[1];
    }
}

NEVH__INLINE void operate(const part *of, group g) {
    wide kick_left[kick_before] = {0}, drift_left[drift_before] = {0};
    wide check = {0};
    const nevh__splitting_scheme scheme = *of->scheme;
    part r = *of;
    struct nevh__splitting_owner owner = {
        .N = r.N, .bad = &check, .kick = kick_left, .drift = drift_left};
    r.scheme = &scheme;
    if (g.count > 0 && !g.begins && r.at > 0)
        take_left(&r, g, kick_left, drift_left);
    for (size_t k = 0; k < r.size; k++) {
        owner.k = r.at + k;
        owner.q = r.from + r.here + k;
        owner.p = owner.q + WINDOW;
        operate_vector(&r, g, owner);
    }
    *r.bad += check - check;
}

static __attribute__((noinline)) void first_group(const part *r) {
    operate(r, (group){0, IN_FIRST, KICKS_FIRST, true, GROUPS == 1});
}

static __attribute__((noinline)) void middle_group(const part *r, size_t i) {
    operate(r, (group){i, 2, BEGINS_WITH_KICK, false, false});
}

static __attribute__((noinline)) void last_group(const part *r) {
    operate(r, (group){LAST_AT, IN_LAST, BEGINS_WITH_KICK, false, true});
}

/* false: a step of those is bad, the state unknown. */
static bool take_steps(const nevh__steps_call *c, wide *y, wide *lost,
                       wide *kept, wide *room, size_t *done) {
    wide *change = room, *point = change + 2 * WINDOW;
    nevh__splitting_scheme scheme = {c->operations, c->weights, c->times,
                                     KICKS_FIRST, KEEPS};
    part r = {.N = c->numbers,
              .scheme = &scheme,
              .h = c->h,
              .y = y,
              .lost = lost,
              .kept = kept,
              .change = change};
    size_t left = c->steps - *done, count = left < AT_ONCE ? left : AT_ONCE;
    size_t all = count * GROUPS, origin = 0, fine = 0;
    wide bad[AT_ONCE] = {0};
    for (size_t round = 0; round < PARTS + all - 1; round++) {
        if (round < PARTS && round * PART == origin + WINDOW) {
            size_t next = (round - IN_WORK) * PART;
            move_all(room, WINDOW, next - origin, 6);
            origin = next;
        }
        for (size_t i = 0; i < all && i <= round; i++) {
            size_t at = (round - i) * PART, step = i / GROUPS, g = i % GROUPS;
            if (at >= DOF)
                continue;
            r.t = c->t0 + (double)(c->from + *done + step) * c->h;
            r.bad = bad + step;
            r.from = point + (i % 2 ? 0 : 2 * WINDOW);
            r.to = point + (i % 2 ? 2 * WINDOW : 0);
            r.at = at;
            r.here = at - origin;
            r.size = DOF - at < PART ? DOF - at : PART;
            if (g == 0)
                first_group(&r);
            else if (g == GROUPS - 1)
                last_group(&r);
            else
                middle_group(&r, IN_FIRST + 2 * (g - 1));
        }
    }
    while (fine < count && !is_bad(bad[fine]))
        fine++;
    *done += fine;
    return fine == count;
}

#endif
