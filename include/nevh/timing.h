/* nevh: how H changes with time: jumps, kinks, narrow peaks, drives.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TIMING_H
#define NEVH_TIMING_H

#include <nevh/system.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The time dependence of the enabled terms between two times.  The parts of
   formulas that read t alone are enclosed by interval arithmetic over intervals of
   time, which are halved where these parts change, so that nothing is missed
   between two samples.  Terms that are functions in C are sampled, at the state
   given, at irregular times, and more closely where they change. */
typedef struct nevh_timing nevh_timing;

/* q, p     n each: the state at which terms are sampled, and at which the
            frequency of sin(k*q - w*t) is taken
   returns  to be freed with nevh_timing_free; NULL when memory is out.  A
            system that reads no time has no breaks, no frequency and no
            shortest time.
   cost     of some drives a millisecond or so; at most about 1e7 operations
   The system is borrowed and must not be changed. */
NEVH_API nevh_timing *nevh_timing_new(const nevh_system *, double t0, double t1,
                                      const double q[], const double p[]);
NEVH_API void nevh_timing_free(nevh_timing *); /* NULL is allowed */

/* A time at which a term jumps, or at which its derivative does, or a pole. */
typedef struct {
    double before, after; /* next to each other, or nearly */
    bool jump;            /* false: a kink */
    bool pole;            /* then it is no jump: H has no value there */
    const char *effect;   /* of the system */
} nevh_time_break;
/* The number of breaks, in order of time. */
NEVH_API size_t nevh_timing_breaks(const nevh_timing *);
/* Break i; zeros if i is out of range. */
NEVH_API nevh_time_break nevh_timing_break(const nevh_timing *, size_t i);

/* The shortest time in which a part of a term changes by as much as it does in
   all between t0 and t1; a jump takes none and does not count.
   t        out, may be NULL: the middle of where that is
   effect   out, may be NULL: whose
   returns  the time; INFINITY where none changes */
NEVH_API double nevh_timing_shortest(const nevh_timing *, double *t,
                                     const char **effect);
/* The largest angular frequency of a drive; 0 where there is none. */
NEVH_API double nevh_timing_frequency(const nevh_timing *, const char **effect);
/* True if the search was complete: false if there are too many breaks to be found
   one by one, or if a term is a function in C and was only sampled. */
NEVH_API bool nevh_timing_whole(const nevh_timing *);

#ifdef __cplusplus
}
#endif
#endif
