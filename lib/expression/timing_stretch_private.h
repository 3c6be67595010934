/* nevh: stretches of time, over each of which terms change at a known rate.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TIMING_STRETCH_PRIVATE_H
#define NEVH_TIMING_STRETCH_PRIVATE_H

#include "expression/timing_parts_private.h"
#include "expression/timing_private.h"
#include <math.h>

static const double nevh__reach_slower = 0.25; /* reach, by the distance */

typedef struct {
    double low, high, rate; /* rate: 1/time of the fastest change */
    size_t effect;          /* whose that is, or whose break */
    bool broken, pole;
} nevh__time_stretch;

struct nevh_timing {
    nevh__time_parts parts;
    double low, high, least; /* least: of what is halved */
    double *range;           /* by part: over all the time */
    double *before;          /* by part, to be compared */
    nevh__time_stretch *cell;
    double *bound; /* by stretch: the reach from what lies before it */
    size_t cells, cell_capacity, halved, most_halved;
    nevh_time_break *breaks;
    size_t n_breaks, break_capacity;
    double shortest, shortest_at, frequency;
    size_t shortest_effect, frequency_effect;
    bool whole, failed;
};

static inline double nevh__stretch_reach(const nevh__time_stretch *c) {
    return c->rate > 0 ? 1 / c->rate : INFINITY;
}

#endif
