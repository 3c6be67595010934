/* nevh: work and precision: what cost and recommend share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_STUDY_H
#define NEVH_STUDY_H

#include "experiment/row.h"

/* grid.c: step sizes to choose from, and what errors over them tell.  No run is
   made here. */
enum {
    GRID_STRIDE = 12, /* a factor of about 2 in dt, of 10 in tolerance */
    GRID_COARSE = 4   /* of 1.25 in dt, of 2 in tolerance */
};
/* Finer with k: forty a decade, `unit` at k = 0, in six digits; tolerances twelve a
   decade, 1 at k = 0. */
double grid_dt(double unit, int k);
double grid_tolerance(int k);
/* The step at which a line through two points, on logarithmic axes, has that error. */
double grid_between(const double dt[2], const double error[2], double target);
/* The factor of work for one digit more: the slope of a line through log work over
   -log error; NAN if fewer than two errors differ. */
double grid_digit_factor(const double error[], const double work[],
                         size_t count);
/* The index of the least work with an error of at most the target; `count`: none. */
size_t grid_cheapest(const double error[], const double work[], size_t count,
                     double target);

typedef enum {
    STUDY_OPEN,
    STUDY_FLOOR, /* shorter steps do not lessen the error */
    STUDY_LIMIT, /* they would take longer than allowed */
    STUDY_GIVEN, /* the steps asked for, and no others */
    STUDY_REFUSED,
    STUDY_FAILED /* in its first step, however short that is */
} study_end;
typedef struct {
    const char *integrator, *gradient;
    const nevh_integrator *scheme;
    row *level; /* coarse to fine */
    int *k;     /* their places on the grid */
    size_t count;
    int topped; /* gap to which steps beyond the coarsest were tried; 0 */
    bool keeps; /* the energy, also at steps that are far too long */
    bool exact; /* its steps solve this H: there is no error but rounding */
    study_end end;
} study;
typedef struct {
    plan plan; /* a copy, for screening */
    bool quiet;
    bool keeping;   /* steps of those that keep the energy at any are of use */
    size_t repeats; /* 0: chosen */
    double budget;  /* work for all rows */
    double seconds; /* for all rows, whatever the work */
    double spent;
    double started;         /* seconds */
    double compiled;        /* seconds of compilers until then */
    double unit;            /* of steps: the scene's, in its unit of time */
    double landing;         /* dt of adaptive schemes */
    double *dt, *tolerance; /* coarse to fine; NULL: those of the grid */
    size_t dts, tolerances;
    size_t runs;
} search;

/* search.c: what a search may cost.  With --dt, only these steps, and the
 * tolerances of the plan. */
search search_begin(const plan *, const options *, double budget);
bool search_is_over(const search *, double share); /* of the budget */
/* True if that share of the seconds has passed. */
bool search_out_of_time(const search *, double share);
/* True if times may be measured again: this takes seconds, and changes no other
   column. */
bool search_may_time(const search *);
/* Says on stderr, after a second, what is running. */
void search_progress(const search *, const row *);
void search_end(search *);

/* study.c: one integrator and gradient at many steps. */
study study_new(const plan *, const char *integrator, const char *gradient);
/* The same integrator with another gradient, or for another end. */
study study_like(const study *, const char *gradient);
/* Finds the coarsest usable step, from the scene's on. */
void study_begin(search *, study *);
/* Next: the one with the least work in its next level; NULL: none is open. */
study *study_next(study studies[], size_t count);
void study_descend(search *, study *);
/* True if some steps of that place fit into the run. */
bool study_fits_steps(const search *, int k);
/* True if shorter steps would not lessen the error, by its levels. */
bool study_ends_level(const study *);
/* True if another study is so far ahead that shorter steps will not change it. */
bool study_is_behind(const search *, const study *, const study others[],
                     size_t count);
/* Measures the time of a level again, as often as asked for. */
void study_time(const search *, study *, size_t level);
/* Levels between those there are, until the coarsest that keeps the target is no
   more than `gap` places finer than one that does not. */
void study_refine(search *, study *, double target, int gap);
/* Levels in the widest gaps until there are so many. */
void study_fill(search *, study *, size_t count);
size_t study_run(search *, study *, int k); /* index of the level */
/* The error of states, or of the observable if rows have one; INFINITY: none. */
double study_error(const row *);
const char *search_error(const search *); /* "energy", "state", "observable" */
/* True if its scheme takes gradients; Taylor series take none. */
bool study_takes_gradients(const study *);
/* A level that failed, where none ran; NULL: some ran, or were refused. */
const row *study_failure(const study *);
/* The level of least work: of one scheme and gradient that is the cheapest, on a
   busy machine too; NULL: none keeps the target. */
row *study_cheapest(const study *, double target);
/* True if the energy is kept at any step, and so gives no error of the orbit: found
   by study_begin. */
bool study_keeps_energy(const study *);

/* applicable.c: true if a gradient of that name fits. */
bool gradient_fits(const plan *, const char *gradient, char **why);
/* Makes the reference.  Otherwise the message is printed and the exit status
   returned. */
int plan_require_reference(plan *);

/* Ends the plan earlier where runs of its integrators would take too long;
   returns the end that it had. */
double plan_shorten(plan *, double budget);
/* The default budget of work of a search. */
enum { SEARCH_BUDGET = 15 };

/* Every scheme that fits, and the gradient that costs least, unless others are
   asked for; TOOL_USAGE, with a message, when none fits. */
int plan_search(plan *, const options *);

#endif
