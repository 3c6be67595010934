/* nevh: how long steps may be in view of what reads t.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TIMING_PRIVATE_H
#define NEVH_TIMING_PRIVATE_H

#include <nevh/timing.h>

/* The distance from t that a series may reach without missing a change, breaks
   between not counted.  INFINITY if nothing changes. */
double nevh__timing_reach(const nevh_timing *, double t);
/* The next break after t, towards either side; NULL: there is none. */
const nevh_time_break *nevh__timing_next(const nevh_timing *, double t,
                                         bool forward);
/* The next time at which a stretch ends over which terms change at one rate;
   infinite: there is none. */
double nevh__timing_edge(const nevh_timing *, double t, bool forward);
/* True if a step between two times passes over a change of a term that takes less
   than half of the step. */
bool nevh__timing_is_fast(const nevh_timing *, double from, double to);

#endif
