/* nevh: two runs of a reference, with steps of h and of h/2.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_REFERENCE_PAIR_PRIVATE_H
#define NEVH_REFERENCE_PAIR_PRIVATE_H

#include "diagnose/reference_private.h"

/* The work limits, in gradients and in evaluations of terms. */
static const double nevh__most_gradients = 1e7, nevh__most_values = 2e8;

/* Two orbits side by side. */
typedef struct {
    nevh_reference *reference;
    nevh_stepper *coarse, *fine;
    double *a, *b;      /* states: of the coarse one, of the fine one */
    double *low, *high; /* of the fine one */
    double *difference; /* the largest so far */
    double *scale;
    double *memory;              /* of all these */
    nevh__reference_orbit orbit; /* of the fine one */
    nevh__watch watch;
} nevh__pair;

/* The progress of both. */
typedef struct {
    int status;     /* of the last step */
    double h;       /* of the coarse one */
    double reached; /* time since t0, of either sign */
    double error;
    bool whole;        /* they came to the end */
    bool stepped_over; /* H changed, and not by what they differ, or jumped */
} nevh__pair_outcome;

/* The error of one step from the start, relative to what it changes, and to the
   state. */
typedef struct {
    double of_change, of_state;
} nevh__step_error;

/* Returns a status, which the reference carries. */
int nevh__pair_init(nevh__pair *);
void nevh__pair_clear(nevh__pair *);
/* The part of what may be spent that has been. */
double nevh__pair_spent(const nevh__pair *);
/* Until they differ by more than `most`, or may cost no more. */
nevh__pair_outcome nevh__pair_run(nevh__pair *, double h, double most);
/* INFINITY when the step cannot be taken. */
nevh__step_error nevh__pair_first_error(nevh__pair *, double h);
#endif
