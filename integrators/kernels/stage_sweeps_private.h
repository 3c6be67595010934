/* nevh: sweeps over the stages of one orbit, of eight, or of any number.
   SPDX-License-Identifier: GPL-3.0-or-later

   A sweep is stage_step.h.  Of one orbit the lanes of a vector are stages; of
   eight, orbits at one stage; any number of orbits have rows of their own, of
   which as much as may be are vectors. */
#ifndef NEVH_STAGE_SWEEPS_PRIVATE_H
#define NEVH_STAGE_SWEEPS_PRIVATE_H

#include "implicit/implicit_private.h"
#include "tableau_private.h"

/* A tableau and its weights in a step by h, as sweeps take them. */
typedef struct {
    size_t stages, row;  /* row: stages, padded to whole vectors */
    size_t steps;        /* see nevh__guess_steps */
    void *memory;        /* holds all that follow */
    double *mu_q, *mu_p; /* the tableau's, columns of `row` */
    double *guess, *long_guess;
    double *c;           /* a row */
    double *hb;          /* h b_j */
    double *to_q, *to_p; /* h b_j, - h b_j: vectors of each */
    double h;            /* 0: none yet */
} nevh__stage_weights;

nevh__stage_weights *nevh__stage_weights_new(const nevh__tableau *);
void nevh__stage_weights_free(nevh__stage_weights *);
/* Takes the coefficients of a tableau. */
void nevh__stage_weights_take(nevh__stage_weights *, const nevh__tableau *);
/* h b_j; the outer two share what the rounded others leave of h. */
void nevh__stage_weights_set(nevh__stage_weights *, const nevh__tableau *,
                             double h);

/* True if sweeps treat H as T(p) + V(q). */
static inline bool nevh__stages_are_partitioned(const nevh_work *w) {
    return !w->transform && (nevh_system_traits(w->system) & NEVH_SEPARABLE);
}

/* True if the equations are small enough for Newton's iteration. */
static inline bool nevh__stages_have_newton(const nevh_work *w, size_t stages) {
    return 2 * w->n * stages <= NEVH__MOST_DENSE;
}

/* Predicts a variable's derivative at stage i from those of so many steps, `width`
   apart: of all that are kept, or of one.  0: there are none. */
double nevh__stage_continue(const nevh__stage_weights *, size_t i, size_t width,
                            double steps, const double past[]);

/* Orbits that are worth the work of eight. */
enum { NEVH__FEWEST_TOGETHER = 5 };
/* Orbits of eight that had better be swept one by one, if stages fill vectors:
   a sweep of one then costs about a sixth of one of eight. */
enum { NEVH__FEW_TOGETHER = 2 };
typedef enum { NEVH__ONE_ORBIT, NEVH__EIGHT_ORBITS, NEVH__ORBITS } nevh__swept;

typedef struct nevh__stage_owner nevh__sweeps; /* see stage_step.h */

/* True if sweeps of one orbit, or of eight, are useful. */
bool nevh__sweeps_suit(const nevh_work *, size_t stages, nevh__swept);
/* The weights outlive it.  NULL: out of memory. */
nevh__sweeps *nevh__sweeps_new(nevh_work *, const nevh__stage_weights *,
                               bool partitioned, nevh__swept);
void nevh__sweeps_free(nevh__sweeps *);

/* A step by h from t of `count` of `width` orbits: rows of so many numbers, of
   which `lanes` says which are taken. */
typedef struct {
    size_t width, count;
    const size_t *lanes;
    double t, h;
    const double *q, *p;        /* n rows each */
    const double *compensation; /* 2n rows */
    const double *unit;         /* 2n rows: |h| over the scale */
    const double *past;   /* the slopes solved for in the last steps, to be */
    const double *steps;  /* continued: of how many, one row */
    const double *past_h; /* by which these were; one row */
} nevh__sweep_start;

/* For one orbit, or for lanes next to each other; false if these cannot be swept
   together. */
bool nevh__sweeps_begin(nevh__sweeps *, const nevh__sweep_start *);
/* Goes on with one orbit that is a lane of others' sweeps. */
void nevh__sweeps_take_over(nevh__sweeps *, const nevh__sweep_start *,
                            const nevh__sweeps *others, size_t lane);
/* One sweep, and what it did to each lane. */
int nevh__sweeps_sweep(nevh__sweeps *, nevh__stage_progress made[]);
/* Counts what so many sweeps of one lane have evaluated. */
void nevh__sweeps_count(const nevh__sweeps *, size_t sweeps);
/* All slopes of one lane, 2n x stages rows of `width` numbers, of which it gets
   the first; those that are not solved for as they were in the last sweep. */
void nevh__sweeps_fetch(const nevh__sweeps *, size_t lane, size_t width,
                        double slopes[]);

/* For any orbits: the derivatives that the unknown ones of `slopes`, 2n x stages
   rows of `width`, lead to, to out[row*count + i]; the others go to `slopes`. */
int nevh__sweeps_map(nevh__sweeps *, const nevh__sweep_start *, double slopes[],
                     double out[]);
/* The states of the stages that slopes lead to. */
void nevh__sweeps_place(nevh__sweeps *, const nevh__sweep_start *,
                        const double slopes[]);
/* One of them, 2n rows of `count`; returns their times. */
const double *nevh__sweeps_stage(const nevh__sweeps *, size_t stage,
                                 double state[]);

/* y += sum_j h b_j x_j of `rows` rows of a state, and what that loses to compensation;
   rows of slopes are stages x width. */
void nevh__stages_advance(const nevh__tableau *, const double hb[], size_t rows,
                          size_t width, const double slopes[], double sum[],
                          double compensation[]);

#endif
