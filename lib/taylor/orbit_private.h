/* nevh: orbits with more digits than doubles.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ORBIT_PRIVATE_H
#define NEVH_ORBIT_PRIVATE_H

#include "expression/timing_private.h"
#include "taylor/series_private.h"
#include <signal.h>

/* The place where the series of an orbit were shortest: their length and, of coordinates
   and of momenta, the largest when they were longest, and up to there. */
typedef struct {
    double longest, shortest, at; /* at: when the shortest begins */
    double before[2], most[2];
    bool over; /* series are longer again */
} nevh__narrow;

/* True if series got shorter by that factor. */
bool nevh__narrow_is(const nevh__narrow *, double shorter);
/* True if runs of one orbit do not agree on how large it became there.  Of a pole of
   even order, as 1/t^2, a rounding makes 1/(t^2 + 1e-30), which is passed. */
bool nevh__narrow_unlike(const nevh__narrow *, const nevh__narrow *);

/* A chain of series in numbers of one kind; the present one begins at time t.
   Functions return a status, with a message in the report. */
enum { NEVH__ORBIT_PAST = 128 };
#define NEVH__ORBIT(kind, real, number)                                               \
    typedef struct nevh__series_orbit_##kind {                                        \
        const nevh__recurrence *recurrence;                                           \
        struct nevh__series_##kind *series;                                           \
        struct nevh__series_##kind *probe; /* of low order, elsewhere */              \
        size_t n, order, count;            /* count: series so far */                 \
        double tolerance;                                                             \
        double longest;  /* of a series; INFINITY: any */                             \
        double shortest; /* of the time that is left */                               \
        double unit;     /* of time, in rows: a power of two */                       \
        real t, reach;   /* the series holds so long, to either side */               \
        real whole;      /* as long as coefficients say, no edge being met */         \
        number *rows;    /* 2n times order + 1 */                                     \
        number *probed;  /* 2n times the probe's order + 1 */                         \
        real *elsewhere; /* 2n: of the probe */                                       \
        real *start;     /* 2n: of the series */                                      \
        real *state;     /* 2n: as asked for last */                                  \
        double *most;    /* 2n: of each variable, so far */                           \
        double usual[2]; /* of either half: the first that is not 0, or 1 */          \
        double *seen;    /* 2n: the same, and within series */                        \
        double *term; /* 2n: the largest term of a series, so far, which     \
                           rounding is in proportion to */        \
        /* For the last series: the time for which they held, and the rate of    \
           change of the state at their beginning. */    \
        double held[NEVH__ORBIT_PAST], speed[NEVH__ORBIT_PAST];                       \
        nevh__narrow narrow;                                                          \
        /* The sizes of coordinates and of momenta, and the parts of these by       \
           which they change in a series. */ \
        double extent[2][NEVH__ORBIT_PAST], change[2][NEVH__ORBIT_PAST];              \
        bool ended; /* where the last one got too short, without bound */             \
        const nevh_timing *timing; /* NULL: of no concern; borrowed */                \
        const volatile sig_atomic_t                                                   \
            *ending;          /* not 0: no further series; or NULL */                 \
        bool backward, stops; /* stops: the series holds up to a break, */            \
        real stop;            /* after which the next one begins */                   \
    } nevh__series_orbit_##kind;                                                      \
    bool nevh__series_orbit_init_##kind(nevh__series_orbit_##kind *,                  \
                                        const nevh__recurrence *,                     \
                                        double tolerance);                            \
    void nevh__series_orbit_clear_##kind(nevh__series_orbit_##kind *);                \
    int nevh__series_orbit_start_##kind(nevh__series_orbit_##kind *, real t,          \
                                        const real state[], nevh__report *);          \
    /* The next series, towards a time; */                                            \
    int nevh__series_orbit_next_##kind(nevh__series_orbit_##kind *, real t,           \
                                       nevh__report *);                               \
    /* the state at a time, in `state`. */                                            \
    int nevh__series_orbit_go_##kind(nevh__series_orbit_##kind *, real t,             \
                                     nevh__report *);                                 \
    /* The rows of the present series, by a unit of 1. */                             \
    void nevh__series_orbit_rows_##kind(const nevh__series_orbit_##kind *,            \
                                        long double rows[]);                          \
    /* The cost, in about nanoseconds: the same on any machine. */                    \
    double nevh__series_orbit_work_##kind(const nevh__series_orbit_##kind *);

/* Names of the kind of orbit that references are of, and its bits; states are
   nevh__wide. */
#ifdef NEVH_QUADMATH
NEVH__ORBIT(quad, nevh__wide, nevh__wide)
NEVH__ORBIT(dd, nevh__wide, nevh__dd)
#define NEVH__FINE(name) name##_dd
enum { NEVH__FINE_BITS = 106 };
#else
#include <float.h>
NEVH__ORBIT(long, long double, long double)
#define NEVH__FINE(name) name##_long
enum { NEVH__FINE_BITS = LDBL_MANT_DIG };
#endif

#endif
