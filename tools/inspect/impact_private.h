/* nevh effects --impact: orbits, and how far they are apart.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_IMPACT_PRIVATE_H
#define NEVH_IMPACT_PRIVATE_H

#include "plot/plot.h"

/* A run, and where it came by: `kept` states after every `every` steps. */
typedef struct {
    const plan *plan;
    size_t every, kept, most;
    double *states, *last, t;     /* some x 2n, 2n */
    double *low, *high;           /* 2n */
    double energy, seconds, work; /* energy at the end; work: evaluations */
    double stopped;               /* where the scene's `stop` said; NAN */
    int status;
    char *message;
} trace;

typedef struct {
    double at_end, largest, since; /* of the range; at_end, since: or NAN */
} difference;

/* Runs one orbit with the first dt and gradient. */
trace trace_run(const plan *, const char *integrator);
/* The same without times, with at most so many states. */
trace trace_sampled(const plan *, const char *integrator, size_t most);
/* With so many that a curve looks like one. */
trace trace_dense(const plan *, const char *integrator);
difference trace_difference(const trace *, const trace *);

/* Switches an effect; the plan follows.  The start stays that of the scene as it is,
   also where initial velocities would give other momenta.  Returns whether it could. */
bool impact_switch(plan *, const char *effect, bool on);

/* impact_plot.c: a panel, the first making the plot: the coordinate that an
   effect changes most, without it and with it.
   dense  without, with */
void impact_draw(plot **, const plan *, const char *effect,
                 const trace dense[2], const difference *);

#endif
