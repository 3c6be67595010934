/* nevh: inside a stepper.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_STEPPER_PRIVATE_H
#define NEVH_STEPPER_PRIVATE_H

#include "system/parts_private.h"
#include "native/native_private.h"
#include <nevh/extend.h>

struct nevh_stepper {
    nevh_work work;
    nevh_options options; /* arrays are the stepper's own */
    nevh__report report;
    bool planned, own_time;
    bool holds_traps; /* what is implicit, or measures errors, divides by 0 */
    unsigned long revision; /* of the transform's system when planned */
    /* The kernel's memory begins a larger one: then the compensation of friction, n
       rows, or what the transform keeps, and the ledger's two.  A lane that
       starts afresh keeps the last. */
    size_t rows, fresh_rows;
    double *buffer; /* holds the memory, aligned for vectors */
    double *rates;  /* n of friction; NULL: there is none */
    struct nevh__friction_step *friction; /* NULL: no friction around steps */
    /* The result of the last step. */
    bool has_last;
    double last_t, *last_q, *last_p;
    double last_h;  /* asked of it; not saved */
    bool forgot;    /* the last step or run began with less than `before` */
    double *before; /* the memory before that */
    size_t taken;
    double *now_q, *now_p; /* the state of a run under way, or NULL */
    double time_roundoff;  /* of last_t, where steps vary, by rounding */
    double before_t, before_roundoff; /* last_t and time_roundoff before that */
    char why_native[NEVH__WHY_NATIVE]; /* why steps are not native, or "" */
    const nevh__watched *watched; /* by compiled steps, while it is planned */
};

/* nevh_stepper_new, for orbits side by side of which that is watched, if it can be:
   nevh__native_watch. */
nevh_stepper *nevh__stepper_watching(const nevh_system *,
                                     const nevh_integrator *,
                                     const nevh_options *,
                                     const nevh__watched *);
/* For schemes by parts: chooses the terms whose flow is taken, one element a term of
   the system; else NULL.  To be freed; a failure is recorded. */
int nevh__choose_parts(nevh_stepper *, nevh__part_role **part);
/* Why a scheme does not fit the system, or NEVH_OK. */
int nevh__check_structure(nevh_stepper *);
/* A step without looking whether the state is the one last returned. */
int nevh__advance(nevh_stepper *, double t, double h, double q[], double p[]);
/* True if a step is the kernel's step and nothing else. */
bool nevh__steps_are_plain(const nevh_stepper *);
/* Such steps, from number s->taken on until number `until`, which nobody looks at; goes
   as far as it can. */
int nevh__advance_unseen(nevh_stepper *, double t0, double h, size_t until,
                         double q[], double p[]);
/* Forgets what does not belong to the state; NEVH_OK if the step may begin. */
int nevh__begin(nevh_stepper *, double t, double h, const double q[],
                const double p[]);

/* A run under way. */
typedef struct {
    nevh_stepper *stepper;
    const nevh_orbit *orbit;
    double h; /* as adjusted to the end */
    double *q, *p;
    struct nevh__samples *samples; /* NULL: none */
} nevh__running;

/* Shows the state to the observers whose turn it is, and the last one to all. */
int nevh__show(nevh__running *, bool last, double t);
/* The time after the step just taken: t0 + i h, or the sum of the times that
   the scheme took, with compensation. */
double nevh__next_time(const nevh_stepper *, double t0, double h);
/* The time of the first state. */
double nevh__start_time(const nevh__running *);
int nevh__begin_run(nevh__running *);
/* Until `steps` are taken.  ends: the last of them is the last of the run. */
int nevh__run_steps(nevh__running *, size_t steps, bool ends);
void nevh__end_run(nevh__running *);
/* NEVH_OK where some number of steps leads from t0 to t_end; not where one of the
   three is no number. */
int nevh__span_check(nevh_stepper *, double t0, double h, double t_end);
/* Finds the friction, and whether the scheme takes it. */
int nevh__plan_friction(nevh_stepper *);
/* Makes room for friction around steps; after the kernel's plan. */
int nevh__friction_step_plan(nevh_stepper *);
void nevh__friction_step_free(
    struct nevh__friction_step *); /* NULL is allowed */
/* A step with friction around it. */
int nevh__friction_step_apply(nevh_stepper *, double t, double h, double q[],
                              double p[]);

/* True if nevh_stepper_gain is known: the energy that came in, or 0. */
bool nevh__balanced(const nevh_stepper *);

/* No step was taken: memory and time are what they were before nevh__begin. */
void nevh__undo(nevh_stepper *);
/* Keeps the state that a step or run returns. */
void nevh__remember(nevh_stepper *, const double q[], const double p[]);

#endif
