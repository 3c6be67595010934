/* nevh: inside the Runge-Kutta-Nystroem kernel.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_NYSTROM_PRIVATE_H
#define NEVH_NYSTROM_PRIVATE_H

#include "runge_kutta_private.h"
#include "gradient/evaluation_private.h"
#include "stage_sums_private.h"

/* Sums besides those of the stages. */
enum { OF_Q, OF_P, ERROR_OF_Q, ERROR_OF_P, ENDS };

struct nevh__nystrom_state {
    nevh_work *work;
    const nevh_nystrom *table;
    size_t n, lanes;       /* lanes: of the step under way */
    size_t size;           /* n x lanes */
    size_t stride;         /* from the slopes of a stage to the next */
    void *memory;          /* holds all that follow, rows of lanes */
    double *q, *p, *carry; /* the start; carry: 2n rows */
    double *h;             /* n rows, of equal ones */
    double *way;           /* h T_p(p), n rows; with a diagonal W */
    double *gain;          /* h^2 W, n rows */
    double *at_rest;       /* T_p(0), n rows */
    double *momenta;       /* n rows: at which T_p is asked for */
    double *velocities;    /* n rows: what it is */
    double *points;        /* n rows: q_i */
    double *slopes;        /* D_i: n rows a stage */
    double *time;          /* a row */
    double *rest;          /* n: T_p(0) */
    double *inverse;       /* n: W; NULL: it is not diagonal by declaration */
    double known_h;        /* that lanes of h are for */
    bool moves;            /* T_p(0) is not 0 */
    size_t call_lanes;     /* of the calls; 0: there are none */
    nevh__call *kicks, drift;
    double *weights;
    size_t *offsets;
    nevh__sum *sums; /* those of the stages, and of the ends */
};

static inline nevh__nystrom_state *nevh__nystrom_of(const nevh_work *w) {
    return ((const nevh__stages_plan *)w->plan)->nystrom;
}

/* As a nevh__family has them. */
int nevh__nystrom_take(nevh__stages *, size_t first, size_t until);
int nevh__nystrom_finish(const nevh__stages *, double change[], double error[],
                         double coarse[]);
/* The state of a stage that was taken, to points, and its time. */
int nevh__nystrom_place(const nevh__nystrom_state *, const nevh__stages *,
                        size_t stage);

#endif
