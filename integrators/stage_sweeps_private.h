/* nevh: fixed-point sweeps over the stages of one orbit, as vectors.
   SPDX-License-Identifier: GPL-3.0-or-later

   A row is what belongs to one variable, a number a stage, with room for whole
   vectors: `stride` numbers.  What is behind the stages repeats the first one,
   and so decides nothing.  All is done operation by operation as in
   implicit_kernel.c and lib/implicit/judge.c, and comes out the same, bit for
   bit. */
#ifndef NEVH_STAGE_SWEEPS_PRIVATE_H
#define NEVH_STAGE_SWEEPS_PRIVATE_H

#include "implicit/implicit_private.h"
#include "tableau_private.h"

typedef struct nevh__sweeps nevh__sweeps;

/* Whether that is worth while: one orbit, whose states behind the stages cost
   little. */
bool nevh__sweeps_suit(const nevh_work *, size_t stages);
/* The tableau and hb, the stages' h b_j, outlive it.  NULL: out of memory. */
nevh__sweeps *nevh__sweeps_new(nevh_work *, const nevh__tableau *,
                               const double hb[], bool partitioned);
void nevh__sweeps_free(nevh__sweeps *);

/* A step from q and p, which lost carry[2n]; `last`, the slopes solved for in
   the last step by h, is continued; NULL: there was none. */
void nevh__sweeps_begin(nevh__sweeps *, double t, double h, const double q[],
                        const double p[], const double carry[],
                        const double last[]);
/* For nevh__stage_problem. */
int nevh__sweeps_sweep(void *sweeps, const double unit[],
                       nevh__stage_progress *);
/* All slopes, 2n x stages, those that are not solved for as they were in the
   last sweep. */
void nevh__sweeps_fetch(const nevh__sweeps *, double slopes[]);

#endif
