/* nevh: inside orbits with certain digits: two runs, and where both end.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_CERTAIN_INSIDE_PRIVATE_H
#define NEVH_CERTAIN_INSIDE_PRIVATE_H

#include "taylor/certain_private.h"

#ifdef NEVH_QUADMATH
/* Series of pairs of doubles, or of quad precision, which take some ten times as
   long. */
typedef struct {
    bool pairs;
    nevh__series_orbit_dd dd;
    nevh__series_orbit_quad quad;
} nevh__certain_orbit;

struct nevh_certain {
    nevh__report report;
    size_t n;
    int digits;
    nevh__recurrence *recurrence, *other; /* other: of the coarse run */
    nevh__certain_orbit fine, coarse;     /* both of pairs, or neither */
    const volatile sig_atomic_t *ending;  /* or NULL */
    double at;                            /* now, since t0, as the next two */
    double parted;         /* when both were far apart; INFINITY: never */
    double renewed;        /* when the coarse run began anew */
    bool passed;           /* an end: tolerances are then the finest */
    bool finest;           /* they are */
    bool underflows, lost; /* something was below the doubles, and matters */
    const nevh_system *system;
    nevh_timing *timing; /* from t0 until `seen`; NULL: H reads no time */
    double seen;
    nevh__wide t0, *start;
    nevh__wide t0_away, *computed; /* of the coarse run */
    nevh__wide *away;              /* the same, some roundings from there */
};

/* Takes one of the runs to a time. */
int nevh__certain_run(nevh_certain *, nevh__certain_orbit *, nevh__wide t);

/* certain_end.c: says when the solution ends, after a run that did, or that this is
   not known.
   status   of the runs: returned where neither of them ended */
int nevh__certain_end(nevh_certain *, int status);
/* Fails where both runs have passed an end of the solution. */
int nevh__certain_passed(nevh_certain *);
#endif

#endif
