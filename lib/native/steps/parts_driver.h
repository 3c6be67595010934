/* nevh: a step by parts in block_driver.h, or of a state that is long in
   long_driver.h.

   The text needs what parts_step.h does, a scene's kick_slope, its inner_slope, and
   how many slopes are KEPT_ROWS.  Operations and flows are the library's: the plan of
   the call is a nevh__parts_scheme.  lib/native hands it to the C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PARTS_DRIVER_H
#define NEVH_PARTS_DRIVER_H

#include "kernels/parts_step.h"

/* Rows of numbers side by side have their width; a long state is one row. */
#ifdef NEVH__LOOPS
enum { NEVH__ROW = 1 };
#else
enum { NEVH__ROW = sizeof(nevh__number) / sizeof(double) };
#endif

struct nevh__parts_owner {
    const double *N;
    nevh__number *bad;
    const nevh__number *kept;
};

NEVH__INLINE int nevh__parts_slope(const nevh__parts_step *x, size_t size,
                                   const nevh__part_operation *o, double t,
                                   bool first) {
    const struct nevh__parts_owner *with = x->owner;
    nevh__number *slope = x->slope[o->kind];
    if (first) {
        NEVH__EACH(i, 1, size) {
            slope[i] = with->kept[o->kind * DOF + i];
        }
    } else if (o->kind == NEVH__OUTER_KICK) {
        *with->bad +=
            kick_slope(with->N, t, x->point[0], x->point[1], slope NEVH__WHOLE);
        if (x->scheme->turn)
            *with->bad += drift_slope(with->N, t, x->point[0], x->point[1],
                                      x->turn NEVH__WHOLE);
        if (x->scheme->lessen)
            x->scheme->lessen(x->scheme->flow, NEVH__ROW,
                              (const double *)x->point[0], (double *)slope);
    } else
        *with->bad += inner_slope(with->N, t, x->point[0], x->point[1],
                                  slope NEVH__WHOLE);
    return 0;
}

NEVH__INLINE void nevh__parts_turn(const nevh__parts_step *x, double weight) {
    x->scheme->turn(x->scheme->turns, NEVH__ROW, weight,
                    (const double *)x->point[0], (const double *)x->point[1],
                    (const double *)x->slope[NEVH__OUTER_KICK],
                    (const double *)x->turn, (double *)x->change[0],
                    (double *)x->change[1]);
}

NEVH__INLINE int nevh__parts_flow(const nevh__parts_step *x,
                                  const nevh__part_operation *o, double t) {
    (void)t;
    x->scheme->add(x->scheme->flow, o->which, NEVH__ROW,
                   (const double *)x->point[0], (const double *)x->point[1],
                   (double *)x->change[0], (double *)x->change[1]);
    return 0;
}

enum { KEPT = KEPT_ROWS * DOF, NEVH__PART_ROWS = 7 };
NEVH__INLINE nevh__parts_step step_of(const nevh__steps_call *c, double t,
                                      const nevh__number *y,
                                      const nevh__number *lost,
                                      nevh__number *rows,
                                      const struct nevh__parts_owner *owner) {
    return (nevh__parts_step){.scheme = (const nevh__parts_scheme *)c->plan,
                              .t = t,
                              .h = c->h,
                              .state = {y, y + DOF},
                              .lost = {lost, lost + DOF},
                              .change = {rows, rows + DOF},
                              .point = {rows + 2 * DOF, rows + 3 * DOF},
                              .slope = {rows + 4 * DOF, rows + 5 * DOF},
                              .turn = rows + 6 * DOF,
                              .owner = owner};
}

static __attribute__((noinline)) nevh__number
take_first(const nevh__steps_call *c, const double *N, const nevh__number *y,
           const nevh__number *lost, nevh__number *kept, nevh__number *room) {
    nevh__number bad = {0};
    NEVH__ROWS(rows, 0, NEVH__PART_ROWS);
    struct nevh__parts_owner owner = {N, &bad, kept};
    nevh__parts_step x =
        step_of(c, c->t0 + (double)c->from * c->h, y, lost, rows, &owner);
    (void)room;
    nevh__parts_begin(&x, DOF);
    for (size_t i = 0; i < KEPT_ROWS; i++) {
        nevh__parts_slope(&x, DOF, &x.scheme->operations[i], x.t, false);
        NEVH__EACH(k, 1, DOF) {
            kept[i * DOF + k] = x.slope[i][k];
        }
    }
    return bad;
}

NEVH__INLINE nevh__number take_step(const nevh__steps_call *c, const double *N,
                                    double t, nevh__number *y,
                                    nevh__number *lost, nevh__number *kept,
                                    nevh__number *room) {
    nevh__number bad = {0};
    NEVH__ROWS(rows, 0, NEVH__PART_ROWS);
    struct nevh__parts_owner owner = {N, &bad, kept};
    nevh__parts_step x = step_of(c, t, y, lost, rows, &owner);
    (void)room;
    nevh__parts_take(&x, DOF);
    for (int half = 0; half < 2; half++) {
        NEVH__EACH(k, 1, DOF) {
            size_t i = half * DOF + k;
            nevh__number change = x.change[half][k] + lost[i];
            nevh__number next = y[i] + change;
            bad += next - next;
            lost[i] = nevh__roundoff(next, y[i], change);
            y[i] = next;
        }
    }
    for (size_t i = 0; i < KEPT_ROWS; i++) {
        NEVH__EACH(k, 1, DOF) {
            kept[i * DOF + k] = x.slope[i][k];
        }
    }
    return bad;
}

#endif
