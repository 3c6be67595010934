/* nevh: a long series in few points.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ENVELOPE_H
#define NEVH_ENVELOPE_H

#include "row.h"

enum { ENVELOPE_PARTS = 1000 };

/* The largest |value| in each of equal parts of a span of time, and when. */
typedef struct envelope {
    double begin, end;
    struct {
        double t, value; /* value: below 0 where there is none */
    } part[ENVELOPE_PARTS];
} envelope;

envelope *envelope_new(double begin, double end);

/* A nevh_observe_fn: adds the energy error that `energy`, an observer called
   before, has just found. */
typedef struct {
    envelope *envelope;
    const nevh_energy *energy;
} energy_trace;
int energy_trace_observe(void *, size_t step, double t, const double q[],
                         const double p[]);

#endif
