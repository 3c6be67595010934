/* nevh: the equations of implicit stages.
   SPDX-License-Identifier: GPL-3.0-or-later

   Unknown are the slopes x at each stage; they solve x = G(x), where G puts
   the slopes into the scheme, gets states, and takes the field there.  Layout:

       x[(k * stages + stage) * width + lane],

   k < n for slopes of coordinates, then of momenta. */
#ifndef NEVH_IMPLICIT_PRIVATE_H
#define NEVH_IMPLICIT_PRIVATE_H

#include <nevh/extend.h>
#include <stdbool.h>

typedef struct nevh__stage_solver nevh__stage_solver;

/* One step's equations. */
typedef struct {
    double t, h;
    const double *q, *p; /* the state at the start of the step */
    double *x;           /* in: first guess; out: solution */
    /* out = G(x) at the given lanes, side by side: out[row*active + a]. */
    int (*map)(void *data, size_t active, const size_t lanes[],
               const double x[], double out[]);
    void *data;
    /* How far rounding in H may move each of a lane's 2n slopes; NULL: as far
       as it moves the field's gradient. */
    int (*noise)(void *data, size_t lane, double noise[]);
} nevh__stage_problem;

/* For the work's n and width.  NULL when memory is out. */
nevh__stage_solver *nevh__stage_solver_new(nevh_work *, size_t stages);
void nevh__stage_solver_free(nevh__stage_solver *);
/* Solves to the rounding floor, or fails with a message. */
int nevh__stage_solve(nevh__stage_solver *, const nevh__stage_problem *);

/* For the two halves of the solver. */
struct nevh__stage_solver {
    nevh_work *work;
    size_t stages, rows; /* rows = 2 n stages: unknowns of a lane */
    double *scale;       /* 2n x width: sizes that changes are held against */
    double *out;         /* rows x width */
    double *least;       /* rows x width: smallest change so far */
    double *noise;       /* 2n, of one lane */
    size_t *lanes;       /* lanes under way */
    struct nevh__stage_lane *lane;
    struct nevh__rescue *rescue; /* NULL for large systems */
    const nevh__stage_problem *problem;
    int status; /* of the noise, where it was asked for */
};

/* What is known of the iteration of one lane. */
typedef struct nevh__stage_lane {
    bool grace;      /* the last sweep was a grace sweep */
    bool grew;       /* the largest change grew from one sweep to another */
    unsigned stalls; /* sweeps without progress while changes are large */
    double change;   /* largest of the last sweep, in units of scale */
    double least;    /* the smallest of those so far */
} nevh__stage_lane;

/* Whether a change, in units of scale, is no more than rounding. */
bool nevh__stage_small(nevh__stage_solver *, size_t lane, double change);

struct nevh__rescue *nevh__rescue_new(nevh__stage_solver *);
void nevh__rescue_free(struct nevh__rescue *);
/* One lane by GSL's multiroot solver. */
int nevh__rescue_lane(nevh__stage_solver *, size_t lane);

#endif
