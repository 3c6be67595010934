/* nevh tests: orbits side by side are what each is alone.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_LANES_H
#define NEVH_TESTS_LANES_H

#include "support.h"

/* Orbits side by side, n x width numbers of a start each.  */
typedef struct {
    const nevh_system *system;
    const nevh_integrator *scheme;
    const nevh_options *options; /* but for the width and the start; they give
                                    what planning would find from the start */
    size_t n, width, steps;
    double t, h;
    const double *q, *p;
    bool jumps;            /* half-way the last orbit is moved elsewhere */
    void (*planned)(void); /* called before the first step; may be NULL */
} many_orbits;
/* Runs them, to q and p. */
nevh_counts many_orbits_run(const many_orbits *, double q[], double p[]);
/* Runs one of them by itself: the first half step by step, the second by another
   stepper, which is told what the first one knows. */
void many_orbits_run_one(const many_orbits *, size_t lane, double q[],
                         double p[]);
/* That this gives what the lane has in q and p, to the last bit. */
void assert_alone(const many_orbits *, size_t lane, const double q[],
                  const double p[]);
/* The same of all lanes, but one that jumps. */
nevh_counts assert_lanes_are_alone(const many_orbits *);

#endif
