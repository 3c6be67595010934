/* nevh: how fast the substeps of a step get on, and when they are too many.

   An orbit that ends in finite time stops substeps from shrinking only where
   they get as short as times can tell apart.  Where its slopes are noisy before
   that, trials neither fail nor arrive: they become slower as a power of their
   number, while near a mere pericentre some hundreds of them make a decade.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PACE_H
#define NEVH_PACE_H

#include "system/vector_private.h"
#include <stdbool.h>

/* Trials that step control may make within one step of a lane. */
enum { NEVH__MOST_SUBSTEPS = 1000000 };
enum { NEVH__PACE_FIRST = 10000, NEVH__PACE_SLOWS = 2 };

/* Zeros at the start of a step. */
typedef struct {
    double substeps; /* trials so far */
    double begun;    /* of them, when the pace was last looked at */
    double done;     /* of the step, then */
    double each;     /* what one did, then */
    int slows;       /* times in a row it was hopeless, and fell */
} nevh__pace;

/* Counts one more, before it is tried; whether it should not be.  The pace is
   looked at while their number doubles: whether the rest would take ten times as
   many as are allowed, and the pace falls to less than a half, twice.
   length, done: of the step, without sign. */
NEVH__INLINE bool nevh__pace_count(nevh__pace *x, double length, double done) {
    double next = x->begun > 0 ? 2 * x->begun : NEVH__PACE_FIRST;
    if (x->substeps == NEVH__MOST_SUBSTEPS)
        return true;
    if (x->substeps++ < next)
        return false;
    double each = (done - x->done) / (next - x->begun);
    double rest = (length - done) / each;
    bool slow = rest > 10.0 * NEVH__MOST_SUBSTEPS && each < x->each / 2;
    x->begun = next;
    x->done = done;
    x->each = each;
    x->slows = slow ? x->slows + 1 : 0;
    return x->slows == NEVH__PACE_SLOWS;
}

#endif
