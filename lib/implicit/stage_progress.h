/* nevh: what sweeps over stages do to one orbit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_STAGE_PROGRESS_H
#define NEVH_STAGE_PROGRESS_H

#include <nevh/simd.h>
#include <stdbool.h>
#include <stddef.h>

/* Changes, in units of scale, that need not be looked at; and how many times
   its estimate noise may be. */
#define NEVH__STAGE_TINY   1e-10
#define NEVH__STAGE_MARGIN 16
/* First guesses that are further off, in units of scale, are of no use for the
   next. */
#define NEVH__STAGE_FAR 0.25
/* Sweeps after which fixed-point iteration ends. */
enum { NEVH__STAGE_SWEEPS = 100 };

typedef struct {
    bool moved;      /* something changed */
    size_t improved; /* unknowns whose change was smaller than ever */
    double change;   /* the largest, in units of scale; infinite, where it is
                        not finite */
} nevh__stage_progress;

typedef enum { NEVH__GO_ON, NEVH__DONE, NEVH__STUCK } nevh__stage_state;

/* The progress of the iteration of one lane. */
typedef struct nevh__stage_lane {
    bool grace;      /* the last sweep was a grace sweep */
    bool strays;     /* the largest change has grown, or exceeds the scale */
    unsigned stalls; /* sweeps without progress while changes are large */
    unsigned slow;   /* sweeps on end that contracted too little */
    double change;   /* largest of the last sweep, in units of scale */
    double before;   /* that of the sweep before */
    double least;    /* the smallest of those so far */
    double first;    /* that of the first sweep */
} nevh__stage_lane;

/* The number of steps whose derivatives predict the next ones, after `steps`
   before, at most `most`: one if the last guess was far off. */
NEVH__INLINE double nevh__stage_remember(double steps, double most,
                                         double first_change) {
    return !(first_change <= NEVH__STAGE_FAR) ? 1
           : steps < most                     ? steps + 1
                                              : most;
}

#endif
