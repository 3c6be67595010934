/* nevh: a step by parts, H = A + B: flows of A and kicks of B = V(t, q) in turn, for
   any number of orbits side by side.
   SPDX-License-Identifier: GPL-3.0-or-later

   Increments are summed from zero over the step and added to the state once, with
   compensation.  The time of a kick is that of the flows before it.  Where a step
   begins with a kick it ends with one, whose slope is kept for the next step.

   The text needs NEVH__INLINE, NEVH__EACH and nevh__number of vector_private.h, the C
   library's size_t and bool, and two functions of the includer.  parts_kernel.c
   compiles it for numbers; lib/native hands it to the C compiler with a scene's
   formulas. */
#ifndef NEVH_PARTS_STEP_H
#define NEVH_PARTS_STEP_H

#include "parts_scheme_private.h"
#include "system/vector_private.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct {
    const nevh__parts_scheme *scheme;
    double t, h;
    const nevh__number *state[2]; /* q and p at the start of the step */
    const nevh__number *lost[2];  /* digits that earlier steps lost */
    nevh__number *change[2];      /* the increment so far */
    nevh__number *point[2];       /* state + change + lost */
    nevh__number *slope[NEVH__KICKS];
    nevh__number *turn; /* dH/dp of B, where it turns coordinates */
    const struct nevh__parts_owner *owner; /* the includer's */
} nevh__parts_step;

/* The includer's: takes the slope of a kick at the point and the time.  first: of its
   kind at the beginning of a step that keeps slopes.  Returns 0, or what makes the
   step fail. */
NEVH__INLINE int nevh__parts_slope(const nevh__parts_step *x, size_t size,
                                   const nevh__part_operation *o, double t,
                                   bool first);
/* The includer's: adds a kick of B that turns coordinates to the change. */
NEVH__INLINE void nevh__parts_turn(const nevh__parts_step *x, double weight);
/* The includer's: adds a flow from the point to the change. */
NEVH__INLINE int nevh__parts_flow(const nevh__parts_step *x,
                                  const nevh__part_operation *o, double t);

NEVH__INLINE void nevh__parts_place(const nevh__parts_step *x, size_t size,
                                    int half) {
    const nevh__number *state = x->state[half], *lost = x->lost[half];
    nevh__number *change = x->change[half], *point = x->point[half];
    NEVH__EACH(i, 1, size) {
        point[i] = state[i] + (change[i] + lost[i]);
    }
}

/* Nothing has changed yet. */
NEVH__INLINE void nevh__parts_begin(const nevh__parts_step *x, size_t size) {
    for (int half = 0; half < 2; half++) {
        NEVH__EACH(i, 1, size) {
            x->change[half][i] = (nevh__number){0};
        }
        nevh__parts_place(x, size, half);
    }
}

NEVH__INLINE int nevh__parts_operate(const nevh__parts_step *x, size_t size,
                                     const nevh__part_operation *o,
                                     bool first) {
    double weight = o->weight * x->h, t = x->t + o->time * x->h;
    if (o->kind == NEVH__FLOW) {
        int status = nevh__parts_flow(x, o, t);
        nevh__parts_place(x, size, 0);
        nevh__parts_place(x, size, 1);
        return status;
    }
    int status = nevh__parts_slope(x, size, o, t, first);
    const nevh__number *slope = x->slope[o->kind];
    if (o->kind == NEVH__OUTER_KICK && x->scheme->turn) {
        nevh__parts_turn(x, weight);
        nevh__parts_place(x, size, 0);
    } else {
        NEVH__EACH(i, 1, size) {
            x->change[1][i] -= weight * slope[i];
        }
    }
    nevh__parts_place(x, size, 1);
    return status;
}

/* All operations in turn; the last point is the new state. */
NEVH__INLINE int nevh__parts_take(const nevh__parts_step *x, size_t size) {
    const nevh__parts_scheme *s = x->scheme;
    int status = 0;
    s->set(s->flow, x->h);
    nevh__parts_begin(x, size);
    for (size_t i = 0; !status && i < s->count; i++)
        status = nevh__parts_operate(x, size, &s->operations[i], i < s->kept);
    return status;
}

#endif
