/* nevh: orbits with more digits than doubles.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ORBIT_PRIVATE_H
#define NEVH_ORBIT_PRIVATE_H

#include "taylor/series_private.h"

/* A chain of series in numbers of one kind; the present one begins at time t.
   Functions return a status, with a message in the report. */
#define NEVH__ORBIT(kind, real)                                                \
    typedef struct nevh__orbit_##kind {                                        \
        const nevh__recurrence *recurrence;                                    \
        struct nevh__series_##kind *series;                                    \
        size_t n, order, count; /* count: series so far */                     \
        double tolerance;                                                      \
        double longest; /* of a series; INFINITY: any */                       \
        real t, reach;  /* the series holds so long, to either side */         \
        real *rows;     /* 2n times order + 1 */                               \
        real *state;    /* 2n: as asked for last */                            \
        double *most;   /* 2n: of each variable, so far */                     \
    } nevh__orbit_##kind;                                                      \
    bool nevh__orbit_init_##kind(nevh__orbit_##kind *,                         \
                                 const nevh__recurrence *, double tolerance);  \
    void nevh__orbit_clear_##kind(nevh__orbit_##kind *);                       \
    int nevh__orbit_start_##kind(nevh__orbit_##kind *, real t,                 \
                                 const real state[], nevh__report *);          \
    /* The next series, towards a time; */                                     \
    int nevh__orbit_next_##kind(nevh__orbit_##kind *, real t, nevh__report *); \
    /* the state at a time, in `state`. */                                     \
    int nevh__orbit_go_##kind(nevh__orbit_##kind *, real t, nevh__report *);

NEVH__ORBIT(long, long double)
#ifdef NEVH_QUADMATH
NEVH__ORBIT(quad, nevh__wide)
#endif

#endif
