/* nevh: fixed-point sweeps over the stages of one orbit, or of a few, as vectors.
   SPDX-License-Identifier: GPL-3.0-or-later

   Of one orbit a row is what belongs to one variable, a number a stage, with
   room for whole vectors; what is behind the stages repeats the first one, and
   so decides nothing.  Of several orbits a row has a number an orbit, stage by
   stage.  All is done operation by operation as in implicit_kernel.c and
   lib/implicit/judge.c, and comes out the same, bit for bit. */
#ifndef NEVH_STAGE_SWEEPS_PRIVATE_H
#define NEVH_STAGE_SWEEPS_PRIVATE_H

#include "implicit/implicit_private.h"
#include "tableau_private.h"

typedef struct nevh__sweeps nevh__sweeps;

/* Orbits that are worth the work of eight. */
enum { NEVH__FEWEST_TOGETHER = 5 };

/* Whether sweeps of one lane, or of NEVH__LANES, may be of use. */
bool nevh__sweeps_suit(const nevh_work *, size_t stages, size_t lanes);
/* The tableau and hb, the stages' h b_j, outlive it.  NULL: out of memory. */
nevh__sweeps *nevh__sweeps_new(nevh_work *, const nevh__tableau *,
                               const double hb[], bool partitioned,
                               size_t lanes);
void nevh__sweeps_free(nevh__sweeps *);
/* Takes the coefficients of a tableau. */
void nevh__sweeps_take(nevh__sweeps *, const nevh__tableau *);

/* A step by h from t of `count` orbits, from `first` on, of `width`: rows of so
   many numbers. */
typedef struct {
    size_t width, first, count;
    double t, h;
    const double *q, *p;  /* n rows each */
    const double *carry;  /* 2n rows */
    const double *unit;   /* 2n rows: |h| over the scale */
    const double *last;   /* the slopes solved for in the last step, to be */
    const double *last_h; /* continued where that was by h too; one row */
} nevh__sweep_start;
/* Whether they can be swept, which one always can. */
bool nevh__sweeps_begin(nevh__sweeps *, const nevh__sweep_start *);
/* One sweep, and what it did to each lane. */
int nevh__sweeps_sweep(nevh__sweeps *, nevh__stage_progress made[]);
/* Counts what so many sweeps of one lane have evaluated. */
void nevh__sweeps_count(const nevh__sweeps *, size_t sweeps);
/* All slopes of one lane, 2n x stages rows of `width` numbers, of which it gets
   the first; those that are not solved for as they were in the last sweep. */
void nevh__sweeps_fetch(const nevh__sweeps *, size_t lane, size_t width,
                        double slopes[]);

#endif
