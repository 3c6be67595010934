/* nevh: what an operation's results can be over a stretch of time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RANGE_PRIVATE_H
#define NEVH_RANGE_PRIVATE_H

#include "expression/tape_private.h"

/* All values lie between `low` and `high`, all derivatives by t between `down`
   and `up`, but for rounding.  broken: what may be passed, an or of these.  NAN:
   there is no value, at least at one time. */
enum { NEVH__KINK = 1, NEVH__POLE = 2 }; /* a jump is a kink, too */
typedef struct {
    double low, high, down, up;
    unsigned broken;
} nevh__range;

/* The range of one operation; b is ignored if it has one argument. */
nevh__range nevh__range_apply(nevh__tape_operation, nevh__range a,
                              nevh__range b);

#endif
