/* nevh: work and precision: what cost and recommend share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_LADDER_H
#define NEVH_LADDER_H

#include "experiment/row.h"

/* grid.c: step sizes to choose from, and what errors over them tell.  No run is
   made here. */
enum {
    GRID_STRIDE = 12, /* a factor of about 2 in dt, of 10 in tolerance */
    GRID_COARSE = 4   /* of 1.25 in dt, of 2 in tolerance */
};
/* Finer with k: forty a decade, 1 at k = 0; tolerances twelve a decade. */
double grid_dt(int k);
double grid_tolerance(int k);
/* The coarsest k whose step is not longer than dt. */
int grid_dt_place(double dt);
/* Where a line through two points, on logarithmic axes, has that error. */
double grid_between(const double dt[2], const double error[2], double target);
/* What one digit more multiplies the work by: the slope of a line through log
   work over -log error; NAN where fewer than two errors differ. */
double grid_digit_factor(const double error[], const double work[],
                         size_t count);
/* Where the error is at most the target, the index of the least work; `count`
   where it is nowhere. */
size_t grid_cheapest(const double error[], const double work[], size_t count,
                     double target);

typedef enum {
    LADDER_OPEN,
    LADDER_FLOOR, /* shorter steps do not lessen the error */
    LADDER_LIMIT, /* they would take longer than allowed */
    LADDER_GIVEN, /* the steps asked for, and no others */
    LADDER_REFUSED,
    LADDER_FAILED /* in its first step, however short that is */
} ladder_end;
typedef struct {
    const char *integrator, *gradient;
    const nevh_integrator *scheme;
    row *rung; /* coarse to fine */
    int *k;    /* their places on the grid */
    size_t count, capacity;
    int topped; /* gap to which steps beyond the coarsest were tried; 0 */
    bool keeps; /* the energy, also at steps that are far too long */
    ladder_end end;
} ladder;
typedef struct {
    plan plan; /* a copy, in a hurry */
    bool by_state, quiet;
    bool keeping;   /* steps of those that keep the energy at any are of use */
    size_t repeats; /* 0: chosen */
    double budget;  /* work for all rows */
    double spent;
    double started;         /* seconds */
    double landing;         /* dt of adaptive schemes */
    double *dt, *tolerance; /* coarse to fine; NULL: those of the grid */
    size_t dts, tolerances;
    size_t runs;
} search;

/* search.c: what a search may cost.  With --dt, only these steps, and the
 * tolerances of the plan. */
search search_begin(const plan *, const options *, double budget);
bool search_is_over(const search *, double share); /* of the budget */
/* Whether times may be measured again: seconds, of which no row depends. */
bool search_may_time(const search *);
/* Says on stderr, after a second, what is running. */
void search_progress(const search *, const row *);
void search_end(search *);
double search_longest_dt(const plan *);

/* ladder.c: one integrator and gradient at many steps. */
ladder ladder_new(const char *integrator, const char *gradient);
/* The same integrator with another gradient, or for another end. */
ladder ladder_like(const ladder *, const char *gradient);
void ladder_free(ladder *);
/* Finds the coarsest usable step, from the scene's on. */
void ladder_begin(search *, ladder *);
/* Next: the one with the least work in its next rung; NULL: none is open. */
ladder *ladder_next(ladder ladders[], size_t count);
void ladder_descend(search *, ladder *);
/* Whether another is so far ahead that shorter steps will not change it. */
bool ladder_is_behind(const search *, const ladder *, const ladder others[],
                      size_t count);
/* Measures the time of a rung again, as often as asked for. */
void ladder_time(const search *, ladder *, size_t rung);
/* Rungs between those there are, until the coarsest that keeps the target is no
   more than `gap` places finer than one that does not. */
void ladder_refine(search *, ladder *, double target, int gap);
/* Rungs in the widest gaps until there are so many. */
void ladder_fill(search *, ladder *, size_t count);
size_t ladder_run(search *, ladder *, int k); /* index of the rung */
/* Of states, or of the observable where rows have one; INFINITY: none. */
double ladder_error(const row *, bool by_state);
const char *search_error(const search *); /* "energy", "state", "observable" */
/* A rung that failed, where none ran; NULL: some ran, or were refused. */
const row *ladder_failure(const ladder *);
/* The cheapest rung by seconds, or by work; NULL: none keeps the target. */
const row *ladder_cheapest(const ladder *, double target, bool by_state);
const row *ladder_least_work(const ladder *, double target, bool by_state);
/* Whether the energy says nothing of its orbits, being kept at any step: as
   ladder_begin found. */
bool ladder_keeps_energy(const ladder *);

/* fit.c: names of the schemes, and of the gradients, that fit. */
void fitting_integrators(const plan *, list *names);
bool gradient_fits(const plan *, const char *gradient, char **why);
/* Makes the reference.  Otherwise the message is printed and the exit status
   returned. */
int state_errors_mean_something(plan *);

/* Ends the plan earlier where runs of its integrators would take too long;
   returns the end that it had. */
double plan_shorten(plan *, double budget);
/* TOOL_FAILED, with a message, where the run is to stop at its start. */
int plan_goes_anywhere(const plan *);
/* How much a search may work. */
enum { SEARCH_BUDGET = 15 };

/* Every scheme that fits, and the gradient that costs least, unless others are
   asked for; TOOL_USAGE, with a message, when none fits. */
int plan_search(plan *, const options *);

#endif
