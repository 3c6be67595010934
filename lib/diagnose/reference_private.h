/* nevh: inside a reference.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_REFERENCE_PRIVATE_H
#define NEVH_REFERENCE_PRIVATE_H

#include "diagnose/exact_private.h"
#include <nevh/reference.h>
#include <nevh/timing.h>

/* States of a run: the k-th after k*every steps of h, coordinates first. */
typedef struct {
    double h;
    size_t every, count, capacity;
    double *states;
} nevh__reference_orbit;

/* States that were asked for before, by their times. */
typedef struct {
    size_t slots, used; /* a power of two */
    uint64_t *keys;     /* 0: free */
    double *states;
} nevh__memo;

struct nevh_reference {
    nevh__report report;
    char text[160];
    const nevh_system *system;
    size_t n;
    double t0, t1;
    nevh_timing *timing;        /* NULL: H reads no time */
    double ends;                /* NAN, or when the solution does */
    double *start;              /* 2n, as all states: coordinates first */
    double *low, *high, *range; /* 2n each */
    double error, horizon, exponent, growth;
    nevh_reference_end end;
    double longest;                        /* step of a run; 0: not said */
    bool finest;                           /* as the options say */
    bool may_jump;                         /* a function of H, at an edge */
    nevh__exact_solution *exact;           /* NULL: a run */
    struct nevh__reference_series *series; /* NULL: a run of another kind */
    const nevh_integrator *integrator;
    size_t *kind; /* n: the first variable of the same kind; NULL: all differ */
    size_t *component; /* n, of nevh__components */
    double *beside;    /* 2n: room for scales */
    nevh__reference_orbit orbit;
    nevh__memo memo;
    /* From the last checkpoint on, and from there to times between steps. */
    nevh_stepper *walker, *branch;
    double *walked, *found; /* 2n each */
    long double *state;     /* 2n */
    size_t steps;           /* walked since the start */
    bool walking;
};

/* A change of H that its derivatives do not explain. */
typedef struct {
    bool found;    /* false: it changes within a step, but does not jump */
    double by;     /* how much */
    double part;   /* of the step */
    size_t effect; /* which of the system's does most of it */
} nevh__jump;

/* The test that a run keeps H, if it should, or passes no jump. */
typedef struct {
    nevh_field *field; /* for values */
    bool constant;     /* H is */
    size_t n;
    double t; /* of the step */
    const double *start;
    double *before, *between, *after; /* 2n each: the last state; to try */
    double *effects, *others;         /* of the system, each */
    long double h0;
    double changed; /* H of the fine orbit, at most */
    double apart;   /* of H, the two orbits */
    double size;    /* of all terms together */
    nevh__jump jump;
} nevh__watch;

int nevh__watch_init(nevh__watch *, const nevh_reference *);
void nevh__watch_clear(nevh__watch *);
void nevh__watch_begin(nevh__watch *);
/* False where H of the fine orbit has changed by far more than the orbits
   differ, or jumps; then `jump` tells where. */
bool nevh__watch_step(nevh__watch *, const double coarse[],
                      const double fine[]);
/* Says that H jumps, near that time. */
int nevh__watch_fail(nevh_reference *, const nevh__jump *, double t);
/* Tests an exact solution; adds to its own error where H is kept. */
int nevh__watch_exact(nevh_reference *, bool *kept);
/* The part of the run's own error that the change of H adds; 0 if the error of the
   runs explains it. */
double nevh__watch_error(const nevh__watch *);
/* Refuses a run from rest on a kink: that with half the step agrees with it, though
   another orbit may go on from there. */
int nevh__reference_refuse_kink(nevh_reference *);

/* True if the orbit is chaotic, by the indicators of nevh_chaos_find over the time
   of the reference, or eight times that; `exponent` becomes that of chaos.
   growth  out: of a displacement until `reached`; 0 where it is not known; NULL:
           not wanted */
bool nevh__reference_is_chaotic(nevh_reference *, double reached,
                                double *growth);

/* The own error that is wanted, in ranges. */
static const double nevh__reference_wanted = 1e-15;

/* Bytes of checkpoints, and of remembered states. */
enum { NEVH__MOST_TRACK = 16 << 20, NEVH__MOST_MEMO = 32 << 20 };

/* An exact gradient where all terms bring one, else central8; NULL when memory
   is out. */
nevh_stepper *nevh__reference_stepper(const nevh_reference *);
/* Makes a run of Taylor series, where it can be had and afforded.
   returns  NEVH_OK; else a status, and all is as before but the report */
int nevh__reference_series(nevh_reference *);
void nevh__reference_series_free(struct nevh__reference_series *); /* NULL */
/* The state so long after its start. */
void nevh__reference_series_state(const nevh_reference *, long double elapsed,
                                  long double state[]);
/* The state of any reference, with all its digits.
   returns  as nevh_reference_state_after */
int nevh__reference_find(nevh_reference *, long double elapsed,
                         long double state[]);
/* Makes a run with the steps that it needs, its ranges, error and horizon. */
int nevh__reference_run(nevh_reference *);
/* The state of a run, so long after its start. */
int nevh__reference_walk(nevh_reference *, double elapsed, double q[],
                         double p[]);
void nevh__reference_widen(const nevh_reference *, double low[], double high[],
                           const double state[]);
/* The units in which differences of states are measured. */
void nevh__reference_scale(const nevh_reference *, const double low[],
                           const double high[], double scale[]);

#endif
