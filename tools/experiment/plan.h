/* nevh: what is to be run.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PLAN_H
#define NEVH_PLAN_H

#include "cli/tool.h"

typedef struct stepper_cache stepper_cache;
typedef struct energies energies;
typedef struct start_scale start_scale;

/* plan.c: the rows to run, from options, scene and defaults. */
typedef struct {
    nevh_scene *scene;
    const nevh_system *system;
    const nevh_scene_run *run;
    const char *name;
    char *title; /* of the scene, and what options changed */
    char *unit, *per_unit, *energy_unit; /* " s", "/s", " J"; "": none */
    size_t n;
    double *q, *p; /* at t_start */
    double t_end;
    const double *dt, *tolerance;
    size_t dts, tolerances;
    double *given_dt, *at; /* by options; at: sorted */
    size_t ats;
    list integrators, gradients;
    size_t added; /* of the integrators, from there on by --transform; or 0 */
    double gradient_step;
    const double *gradient_steps; /* as in nevh_options */
    size_t repeats;               /* of timed runs; 0: chosen */
    bool portable, friction, time, balance;
    nevh_native_use native;
    bool no_cache;
    bool screening;    /* rows are finished later, and timed then */
    double work_limit; /* work that a row may take; 0: any */
    double follow;     /* work that its verdict may take; 0: as usual */
    bool match_work, diagnostics;
    bool
        by_state; /* errors that a search counts are of states, or observables */
    nevh_timing *timing;       /* NULL: H reads no time */
    nevh_timing *jumps;        /* of a longer time; NULL: there are none */
    nevh_reference *reference; /* NULL: not asked for, or there is none */
    double reference_end;
    double ends; /* when the solution does; NAN: not, as far as is known */
    char *no_reference;       /* why there is none */
    const char *observable;   /* whose errors count, not of states; NULL */
    bool outcome;             /* that is no value along the orbit */
    double outcome_value;     /* its own */
    double observable_scale;  /* that its errors are divided by */
    bool observable_level;    /* its size, not its range */
    double observable_error;  /* what that of the reference makes of it */
    energies *energies;       /* whose energies rows compare; NULL: none */
    bool error_bounds;        /* rows have one */
    stepper_cache *steppers;  /* of steppers */
    start_scale *start_scale; /* the energy scale that was found last, shared */
} plan;
/* The scene's own title, else its name, and what options change. */
char *plan_title(const nevh_scene *, const char *name, const options *);
/* returns  TOOL_OK, or TOOL_USAGE with the message printed */
int plan_make(plan *, const options *);
void plan_free(plan *);
/* Frees the reference, so that another can be made. */
void plan_forget_reference(plan *);
/* A field for values of H; to be freed. */
nevh_field *plan_values(const plan *);
double plan_longest_dt(const plan *);  /* 0: no dt is given */
double plan_shortest_dt(const plan *); /* the same */
/* A copy of the start: coordinates, then momenta. */
double *plan_state(const plan *);
nevh_options plan_options(const plan *, const char *gradient);
/* True if the effects that are on are all in A, whose flow is exact. */
bool plan_parts_are_all(const plan *);
/* True if the scheme solves H by a flow that is exact, with any step. */
bool plan_is_exact(const plan *, const nevh_integrator *);
/* Steps of h that the whole run takes. */
double plan_steps(const plan *, double h);
/* Says once why steps could not be compiled. */
void plan_native_report(const nevh_stepper *);
void plan_why_report(const char *why); /* "": no message */
/* The scheme of "gauss4" or "gauss4+transform", the scene's own included; NULL for
   other names. */
const nevh_integrator *plan_scheme(const plan *, const char *name,
                                   bool *transformed);
/* All schemes, the scene's own first; NULL: there are no more. */
const nevh_integrator *plan_scheme_at(const plan *, size_t i);
/* The transform that it is to be planned with: of names with "+transform", and
   of schemes that choose their own times; NULL: none. */
const nevh_system *plan_transform(const plan *, const char *name);
/* Options of the integrator of that name, which is found: its transform, and the
   first of the tolerances where it adapts. */
nevh_options plan_scheme_options(const plan *, const char *name,
                                 const char *gradient,
                                 const nevh_integrator **);
/* The integrator of that name, planned for the first gradient. */
nevh_stepper *plan_stepper(const plan *, const char *name);
/* The finer run of that kind, of the whole run with the first dt and tolerance; to be
   freed. */
nevh_finer *plan_finer(const plan *, const char *integrator, nevh_finer_kind);
/* The first integrator that fits, those of --transform before others, planned
   for the first gradient; NULL, with a message, when none does.
   name  out: what the plan calls it; NULL: not asked for */
nevh_stepper *plan_first(const plan *, const char **name);
/* True if one fits, as plan_first finds it: for commands that take no step. */
bool plan_fits(const plan *, const char **name);
/* Notes, for plans with several integrators or dt, which one is used. */
void plan_note_first(const plan *, const char *integrator, list *notes);
/* Notes why last digits of runs by these integrators may differ between machines, if
   they may. */
void plan_note_digits(const plan *, const list *integrators, list *notes);
/* Title, effects, structure of H, span. */
void plan_notes(const plan *, list *notes);
char *plan_structure(const plan *);

/* time_words.c: looks at what H does with time. */
void plan_look_at_time(plan *);
/* The largest angular frequency of a drive; 0: there is none.
   effect  out: whose */
double plan_drive(const plan *, const char **effect);
/* When the solution itself ends; NAN: not before the plan does; INFINITY: this is not
   known, as nevh_solution_ends has it.
   cost  a second at most */
double plan_ends(const plan *);
/* In words; NULL: it does not, or is not known to. */
char *ends_text(const plan *, double ends);
/* The same, or a message where it does not. */
char *why_until(const plan *, double ends, const char *message);
/* Refuses a plan whose solution ends before it does: TOOL_FAILED. */
int plan_refuse_end(const plan *);
/* Why a run failed: its message, or that the solution ends. */
char *plan_why(const plan *, const char *message);
/* Likewise of a member of the ensemble, where it starts elsewhere alone. */
char *member_why(const plan *, uint64_t member, const char *message);
/* The fault of a run that ended well, but whose energy changes by a good part, or
   that passes a pole: that, or that the solution ends; NULL: none.
   watch   the energy observed in that run */
char *plan_doubts(const plan *, const nevh_energy *watch, int status);
nevh_energy *plan_watch(const plan *);
/* The same of a run that nothing observed: the run again. */
char *plan_doubts_again(const plan *, const char *integrator, double dt);
/* Notes the times at which H jumps. */
void time_notes(const plan *, list *notes);

/* stepper_cache.c */
stepper_cache *stepper_cache_new(void);
void stepper_cache_free(stepper_cache *); /* NULL is allowed */

/* energies.c: energies of effects and bodies, of a plan with a reference. */
void plan_energies(plan *);
void energies_free(energies *); /* NULL is allowed */

/* stop.c: runs that end early, where the scene's `stop` says. */
typedef struct {
    nevh_scene *scene;
    bool reached;
    double t; /* of the last state seen */
    size_t step;
} stop;
/* A nevh_observe_fn; data is the stop.  NEVH_STOPPED where it is reached. */
int stop_observe(void *, size_t step, double t, const double q[],
                 const double p[]);
/* nevh_run_until, from the plan's start to its end, or to where it is to stop.
   stopped  out: the time where it was to stop; NAN
   returns  as nevh_run_until; NEVH_OK where the run came to either end */
int plan_run(const plan *, nevh_stepper *, double dt, const nevh_observer[],
             size_t count, double *stopped);
/* The same from another state, by the first dt.
   q, m  in and out, n each */
int plan_run_from(const plan *, nevh_stepper *, double q[], double m[],
                  const nevh_observer[], size_t count, double *stopped);

/* stability.c: a nevh_observe_fn that observes the energy, and stops where its error is above the
   limit. */
typedef struct {
    nevh_energy *energy;
    double limit, t; /* t: of the last state seen, as `step` */
    size_t step;
    bool passed; /* the limit */
} energy_limit;
int energy_limit_observe(void *, size_t step, double t, const double q[],
                         const double p[]);
char *stop_words(const plan *, double t);

/* The period of the coordinate that is shown; 0: none, or it is no coordinate. */
double plan_period(const plan *, const char *shown);
/* The energy that errors are relative to: the scene's, or H at the start. */
double plan_energy_scale(const plan *);
/* Errors are relative to it; to what the run meets, where the start tells of no
   energy at all. */
void plan_set_scale(const plan *, nevh_energy *);

/* impact.c: what nevh effects --impact prints. */
int impact(const options *, plan *);
/* needed.c: what nevh effects --needed prints. */
int needed(const options *, plan *);

/* Why neither chaos nor its absence is said of forces that jump. */
extern const char plan_kinks_text[];

#endif
