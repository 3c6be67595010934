/* nevh: how long steps may be in view of what reads t.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TIMING_PRIVATE_H
#define NEVH_TIMING_PRIVATE_H

#include <nevh/timing.h>

/* How far from t a series may reach so that it sees what changes before it
   comes there; no break in between counts.  INFINITY where nothing changes. */
double nevh__timing_reach(const nevh_timing *, double t);
/* The next break after t, towards either side; NULL: there is none. */
const nevh_time_break *nevh__timing_next(const nevh_timing *, double t,
                                         bool forward);

#endif
