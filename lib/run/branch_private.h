/* nevh: a step that branches off from the main orbit to a given time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_BRANCH_PRIVATE_H
#define NEVH_BRANCH_PRIVATE_H

#include "run/stepper_private.h"

/* The way from a state of the main orbit to a time before its next step
   ends. */
typedef struct {
    nevh_stepper *stepper;
    double t, t_end, h;
    double roundoff;        /* of t, by rounding */
    double elapsed;         /* by a step of h */
    double *q, *p, *memory; /* the main orbit's */
    double *q_end, *p_end;  /* after nevh__branch_step */
} nevh__branch;

/* Zeros before; closed also where it failed. */
int nevh__branch_open(nevh__branch *, nevh_stepper *);
void nevh__branch_close(nevh__branch *);
/* Keeps the main orbit's state and the stepper's memory, and puts the memory
   back. */
void nevh__branch_keep(nevh__branch *, double t, const double q[],
                       const double p[]);
void nevh__branch_resume(const nevh__branch *);
/* Finds `elapsed`, by a step of h. */
int nevh__branch_measure(nevh__branch *);
/* The step that ends at t_end: h itself, or the part of h that takes this time
   where times are the scheme's own.  The memory is that of after the step. */
int nevh__branch_step(nevh__branch *);

#endif
