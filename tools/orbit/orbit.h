/* nevh: orbits to be drawn.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ORBIT_H
#define NEVH_ORBIT_H

#include "plot/thinned.h"
#include "trajectory.h"

/* One integrator and dt; its rows begin with t. */
typedef struct {
    plan plan; /* a copy with that dt alone; what it points to is shared */
    const char *integrator;
    char *name; /* among others */
    thinned rows;
    double t, *q, *p; /* the last state */
    int status;
} orbit;

/* The orbits chosen by name or by --dt: all that fit; else the one with the
   integrator and dt given. */
typedef struct {
    orbit *item;
    size_t count;
    list left_out; /* names */
} orbits;
orbits orbits_new(const options *, const plan *, const char *integrator);

/* Writes what is shown of a state. */
typedef void orbit_fill(void *data, double t, const double q[],
                        const double p[], double values[]);
/* Runs it anew.
   quiet    a failure is not printed
   returns  as trajectory_follow */
int orbit_follow(orbit *, const row_times *, size_t columns, orbit_fill *,
                 void *data, bool quiet);
/* The same of a reference, until the end of the plan or its horizon, at times that
   are closer where it is fast.
   returns  how many states it has */
size_t orbit_follow_reference(orbit *, nevh_reference *, size_t columns,
                              orbit_fill *, void *data);
/* At the steps, and between them where they are few, so that a curve looks like
   one. */
row_times orbit_dense_times(const plan *);
const double *orbit_row(const orbit *, size_t i); /* after t */
/* The number of turns of a column: its passages through the mean, over 2. */
double orbit_turns(const orbit *, size_t k);
/* The turns of the fastest coordinate or momentum in the plan's run, by its first
   integrator and dt; 0 where the run fails, or has too many steps for all to be kept. */
double orbit_turns_of(const plan *);

#endif
