/* nevh: an orbit in quad precision.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_QUAD_ORBIT_PRIVATE_H
#define NEVH_QUAD_ORBIT_PRIVATE_H

#include "taylor/series_private.h"

#ifdef NEVH_QUADMATH
/* A chain of series; the present one begins at time t. */
typedef struct {
    const nevh__recurrence *recurrence;
    nevh__series_quad *series;
    size_t n, order, count; /* count: series so far */
    double tolerance;
    nevh__wide t, reach; /* the series holds so long, to either side */
    nevh__wide *rows;    /* 2n times order + 1 */
    nevh__wide *state;   /* 2n: as asked for last */
    double *most;        /* 2n: of each variable, so far */
} nevh__quad_orbit;

bool nevh__quad_orbit_init(nevh__quad_orbit *, const nevh__recurrence *,
                           double tolerance);
void nevh__quad_orbit_clear(nevh__quad_orbit *);
/* Each returns a status, with a message in the report. */
int nevh__quad_orbit_start(nevh__quad_orbit *, nevh__wide t,
                           const nevh__wide state[], nevh__report *);
/* The state at a time, in `state`. */
int nevh__quad_orbit_go(nevh__quad_orbit *, nevh__wide t, nevh__report *);
#endif

#endif
