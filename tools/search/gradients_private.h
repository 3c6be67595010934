/* nevh gradients: an orbit, and what is found along it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_GRADIENTS_PRIVATE_H
#define NEVH_GRADIENTS_PRIVATE_H

#include "experiment/plan.h"

/* States of the orbit, and energies, at steps evenly apart. */
typedef struct {
    size_t n, count, every;
    double *t, *q, *p; /* n each state */
    double *h;
    nevh_field *field; /* for h */
} orbit_states;

typedef struct {
    const plan *plan;
    const char *integrator;
    double dt, scale;
    size_t steps;
    orbit_states exact; /* of the yardstick */
    const char *yardstick;
    double *dq, *dp; /* its gradients, n a state */
    double size;     /* largest component among them */
} gradients_job;

/* Runs the orbit with the most exact gradient that there is.
   job      out, of zeros; exact.field is to be freed in any case; borrows the plan
   returns  TOOL_OK; TOOL_FAILED or TOOL_USAGE with the message printed */
int gradients_job_make(gradients_job *, const plan *);

typedef struct {
    const char *gradient;
    double step;                        /* 0: auto */
    double error, truncation, rounding; /* relative to the largest component */
    double evaluations, nanoseconds;
    double energy, influx, floor; /* relative to the scale of energies */
    bool good, first;             /* first: of its method */
    char *why;
    nevh_field *field;
} finding;

/* All but the influx.
   step  0: chosen */
finding gradient_find(const gradients_job *, const char *gradient, double step);
/* The influx of all, along one orbit. */
void gradients_influx(const gradients_job *, finding[], size_t count);
/* The shortest half-spread chosen by differences of full order; INFINITY. */
double gradient_own_step(const gradients_job *, const char *gradient);

/* The largest error at the states, relative to the largest component.
   steps    half-spreads of all variables, 2n; NULL: chosen
   returns  INFINITY where the gradient fails */
double gradient_error(const gradients_job *, const char *gradient,
                      const double steps[]);

/* gradients_plot.c: as plot_write. */
int gradients_plot(const options *, const gradients_job *);

#endif
