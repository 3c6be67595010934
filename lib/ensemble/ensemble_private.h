/* nevh: inside an ensemble.

   A lane is an orbit under way: a column of the rows of the state, of the
   stepper's memory, and of all that is kept here.  Snapshots are of the states
   before the last step and before the one before that: shorter steps branch off
   from there, by a second stepper of one lane.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ENSEMBLE_PRIVATE_H
#define NEVH_ENSEMBLE_PRIVATE_H

#include "diagnose/energy_private.h"
#include "ensemble/outcomes/outcome_private.h"
#include "ensemble/own_private.h"
#include "run/section_private.h"
#include "run/stepper_private.h"
#include <gsl/gsl_roots.h>
#include <nevh/ensemble.h>
#include <nevh/frequencies.h>

typedef struct {
    double *q, *p, *memory; /* rows of `width` */
    double *t, *h;          /* width; h: of the step from there */
    double *value;          /* n_outcomes rows of `stride` */
} nevh__snapshot;

/* An outcome that is asked for. */
typedef struct {
    nevh_outcome decl;
    const nevh__outcome_type *type;
    char *records; /* width, of the type's size */
} nevh__outcome_entry;

typedef struct {
    bool busy, fresh, over;
    bool look, ends; /* it is to be looked at; its last step is taken */
    uint64_t member;
    size_t step;
    double t;
    nevh__report report;  /* of what failed */
    nevh_stepper *narrow; /* of its own system; NULL: lanes share one */
} nevh__lane;

typedef struct nevh__crossing_lanes nevh__crossing_lanes;
typedef struct nevh__chaotic nevh__chaotic;
typedef struct nevh__watch nevh__watch;

struct nevh_ensemble {
    const nevh_system *system;
    size_t n, width, stride; /* stride: of values, a multiple of NEVH__LANES */
    nevh_ensemble_options options;
    nevh__outcome_entry *outcomes;
    size_t n_outcomes, columns;
    nevh_stepper *stepper;        /* of all lanes */
    nevh_stepper *spare, *narrow; /* of one: narrow is spare, or a lane's */
    double h, steps;              /* whole ones; of fixed steps */
    bool whole;                   /* they fill the run */
    bool alone;    /* lanes are taken by nevh_run_until: there is one */
    bool together; /* H reads t: lanes begin together */
    bool looks_back, moving; /* snapshots, velocities are asked for */
    bool watches; /* each step; else ends are all that is asked for */
    bool planned;
    bool has_energy;
    nevh_energy *energy;     /* NULL: not asked for */
    nevh_sections *sections; /* NULL: not asked for */
    nevh_section *crossings; /* one an outcome that wants it */
    size_t *crossing_of, n_crossings;
    size_t crossing_lane;                 /* whose points are told */
    nevh__crossing_lanes *crossing_lanes; /* NULL: not asked for, or alone */
    nevh__chaotic *chaotic;               /* NULL: not asked for */
    nevh__watch *watch; /* of several steps at once; NULL: none can be */
    nevh_field *motion; /* of velocities; or NULL */
    gsl_root_fsolver *root;

    void *memory;          /* holds all arrays below */
    nevh__lane *lanes;     /* width */
    double *q, *p;         /* n rows of `width` */
    double *run_q, *run_p; /* n each: of nevh_run_until */
    double *run_memory;    /* of one lane, after a step */
    nevh__snapshot now;    /* of values alone, and times */
    nevh__snapshot ago1, ago2;
    double *stop; /* stride: values of what stops */
    double *v;    /* n rows of `stride` */
    double *wide_q,
        *wide_p; /* n rows of `stride`; q, p themselves, or copies */
    /* A state beside the orbits: of the narrow stepper, padded for values. */
    double *q1, *p1, *wide_q1, *wide_p1, *v1, *t1, *value1;
    bool *on;
    size_t *step;
    double *result; /* columns */
    nevh_member_fn next;
    nevh_result_fn done;
    nevh__own_fn own; /* NULL: members share a system */
    nevh__refused_fn refused;
    void *data;
    bool stopped;
    const volatile sig_atomic_t *ending; /* nevh__ensemble_set_stop; or NULL */
    nevh__report report;
};

static inline bool nevh__ensemble_ends(const nevh_ensemble *e) {
    return e->ending && *e->ending;
}

/* own.c: a lane's own system.  False: it is refused. */
bool nevh__own_take(nevh_ensemble *, size_t lane, uint64_t member);
void nevh__own_copy(nevh_ensemble *, size_t from, size_t to);
void nevh__own_drop(nevh_ensemble *, size_t lane);
int nevh__ensemble_stepper(nevh_ensemble *, const nevh_system *,
                           const nevh_options *, size_t width, nevh_stepper **);

/* observe.c: looks at the lanes that are to be looked at, after a step or at
   their start; sets `over`. */
void nevh__ensemble_look(nevh_ensemble *);
/* The lane ends, as it is: hands its outcomes on. */
void nevh__ensemble_end(nevh_ensemble *, size_t lane);
void nevh__ensemble_fail(nevh_ensemble *, size_t lane, const nevh__report *);
/* The record of an outcome of a lane under way. */
void *nevh__record_of(const nevh_ensemble *, size_t outcome, size_t lane);
/* Evaluate velocities, to e->v, if they are needed, and quantities, at states side
   by side in rows of `stride`. */
void nevh__ensemble_move(nevh_ensemble *, const double t[], const double q[],
                         const double p[]);
void nevh__ensemble_value(const nevh_ensemble *, size_t o, const double t[],
                          const double q[], const double p[], double values[]);

/* watch.c: values of all outcomes as compiled steps are taken.  Whether that could be:
   before the stepper is planned (false: memory is out), and after.  Neither leaves
   e->watch where it can not. */
bool nevh__ensemble_watch_plan(nevh_ensemble *);
int nevh__ensemble_watch_begin(nevh_ensemble *);
void nevh__ensemble_watch_free(nevh__watch *); /* NULL is allowed */
const nevh__watched *nevh__ensemble_watched(const nevh_ensemble *);
/* Takes steps of all lanes from number `from` on, up to the one whose state has to be
   looked at, but not more than `steps`.  Returns how many. */
size_t nevh__ensemble_watch(nevh_ensemble *, size_t from, size_t steps);

/* outcomes/crossings.c: crossings of lanes that are to be looked at and are not
   over. */
int nevh__ensemble_plan_crossings(nevh_ensemble *); /* where one counts */
void nevh__ensemble_free_crossings(nevh_ensemble *);
void nevh__ensemble_look_at_crossings(nevh_ensemble *);

/* outcomes/chaotic.c: outcomes that tell chaos. */
int nevh__chaotic_plan(nevh_ensemble *);  /* where one is asked for */
void nevh__chaotic_free(nevh__chaotic *); /* NULL is allowed */
/* Keeps where a lane's orbit starts: e->q1, e->p1. */
void nevh__chaotic_begin(nevh_ensemble *, size_t lane);
/* An orbit whose other outcomes, in e->result, are known. */
void nevh__chaotic_queue(nevh_ensemble *, size_t lane);
/* Runs the orbits that still wait. */
void nevh__chaotic_finish(nevh_ensemble *);
/* All orbits, where no other outcome is asked for; else returns false. */
bool nevh__chaotic_run(nevh_ensemble *);

/* lanes.c: the values and times of the last states become those of the ones before;
   the states are kept where an event may be looked for.  h: of the step from here. */
void nevh__ensemble_look_back(nevh_ensemble *, double h);
/* Moves of columns. */
void nevh__lane_to_narrow(nevh_ensemble *, const double q[], const double p[],
                          const double memory[], size_t lane);
/* A step of h of the narrow stepper. */
int nevh__narrow_step(nevh_ensemble *, double t, double h);
/* The value of an outcome's quantity at the state beside the orbits. */
double nevh__narrow_value(nevh_ensemble *, size_t o, double t);

#endif
