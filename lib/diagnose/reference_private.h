/* nevh: inside a reference.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_REFERENCE_PRIVATE_H
#define NEVH_REFERENCE_PRIVATE_H

#include "diagnose/exact_private.h"
#include <nevh/reference.h>

/* States of a run: the k-th after k*every steps of h, coordinates first. */
typedef struct {
    double h;
    size_t every, count, room;
    double *states;
} nevh__track;

/* States that were asked for before, by their times. */
typedef struct {
    size_t slots, used; /* a power of two */
    uint64_t *keys;     /* 0: free */
    double *states;
} nevh__memo;

struct nevh_reference {
    nevh__report report;
    char text[160];
    const nevh_system *system;
    size_t n;
    double t0, t1;
    double *start;              /* 2n, as all states: coordinates first */
    double *low, *high, *range; /* 2n each */
    double error, horizon;
    nevh__exact *exact; /* NULL: a run */
    const nevh_integrator *integrator;
    size_t *kind; /* n: the first variable of the same kind; NULL: all differ */
    nevh__track track;
    nevh__memo memo;
    /* From the last checkpoint on, and from there to times between steps. */
    nevh_stepper *walker, *branch;
    double *walked; /* 2n */
    size_t steps;   /* walked since the start */
    bool walking;
};

/* Bytes of checkpoints, and of remembered states. */
enum { NEVH__MOST_TRACK = 16 << 20, NEVH__MOST_MEMO = 32 << 20 };

/* An exact gradient where all terms bring one, else central8; NULL when memory
   is out. */
nevh_stepper *nevh__reference_stepper(const nevh_reference *);
/* Makes a run with the steps that it needs, its ranges, error and horizon. */
int nevh__reference_run(nevh_reference *);
/* The state of a run, so long after its start. */
int nevh__reference_walk(nevh_reference *, double elapsed, double q[],
                         double p[]);
void nevh__reference_widen(const nevh_reference *, double low[], double high[],
                           const double state[]);
/* What differences of states are measured in. */
void nevh__reference_scale(const nevh_reference *, const double low[],
                           const double high[], double scale[]);

#endif
