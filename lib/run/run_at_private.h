/* nevh: states of a run at given times.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RUN_AT_PRIVATE_H
#define NEVH_RUN_AT_PRIVATE_H

#include "run/branch_private.h"

typedef struct nevh__samples nevh__samples;

/* NULL with a status of the stepper where a time is out of order, the width is
   not 1, or memory is out. */
nevh__samples *nevh__samples_new(const nevh__running *);
void nevh__samples_free(nevh__samples *);
/* The next step whose state is needed; the others need not be shown. */
size_t nevh__samples_step(const nevh__samples *);
/* Takes the samples up to a state of the run; with fixed steps, also those before
   the next state.
   returns  as nevh_orbit_run */
int nevh__samples_at(nevh__samples *, double t, const double q[],
                     const double p[]);
int nevh__samples_after(nevh__samples *, double t, const double q[],
                        const double p[]);
/* After a failed step: those before the place where it failed, of schemes whose
   memory holds the orbit. */
void nevh__samples_rest(nevh__samples *, const double q[], const double p[]);

#endif
