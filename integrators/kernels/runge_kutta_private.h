/* nevh: explicit Runge-Kutta steps, one of h or many within h.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RUNGE_KUTTA_PRIVATE_H
#define NEVH_RUNGE_KUTTA_PRIVATE_H

#include "gradient/field_private.h"
#include <nevh/extend.h>

typedef struct nevh__repeated_stages nevh__repeated_stages;

/* A step of some lanes, their columns side by side, each by its own h from
   its own t. */
typedef struct {
    nevh_work *work;
    size_t columns;
    const double *t, *h;             /* columns each */
    const double *q, *p;             /* the state at t, n x columns each */
    const double *carry;             /* what its rounding lost, 2n x columns */
    double *slopes;                  /* stages rows of 2n x columns */
    size_t stride;                   /* from one such row to the next */
    double *change;                  /* 2n x columns */
    double *point;                   /* 2n x columns */
    double *time;                    /* columns */
    nevh__repeated_stages *repeated; /* one orbit's own way, or NULL */
    bool holds;                      /* the slopes are there */
} nevh__stages;

/* Stages of one orbit of a small system, where H can be called as it is.  To
 *stages; NULL: there is no such way.  NEVH_OK or NEVH_ENOMEM. */
int nevh__repeated_stages_plan(nevh_work *, nevh__repeated_stages **stages);
void nevh__repeated_stages_free(nevh__repeated_stages *);
/* Whether they may be taken in this step. */
bool nevh__repeated_stages_ready(nevh__repeated_stages *);
/* As nevh__stages_take, or false where something is not finite.  Of slopes the
   first, if taken alone, and the last are handed over. */
bool nevh__repeated_stages_take(const nevh__stages *, size_t first,
                                size_t until);
/* As nevh__stages_sum over all stages, by the weights of the table's b, error
   or coarse. */
void nevh__repeated_stages_sum(const nevh__stages *, const double weights[],
                               double sum[]);

/* What step control needs from a family of methods. */
typedef struct {
    size_t stages, rows; /* rows: of slopes that are kept */
    int error_power;     /* the power of h with which the estimate falls */
    bool last_is_first;  /* the last stage is the next step's first */
    bool coarse;         /* there is a second estimate */
    /* The slopes of stages `first` to `until` - 1; those before are there.  Of
       stage 0 alone: to the first row, as the derivative of q and p. */
    int (*take)(nevh__stages *, size_t first, size_t until);
    /* What the step adds to the state, and the estimates: 2n x columns each. */
    int (*finish)(const nevh__stages *, double change[], double error[],
                  double coarse[]);
    /* Hands the stages to the balance of the energy, where one is kept. */
    int (*account)(const nevh__stages *);
} nevh__family;

/* What the kernels keep. */
typedef struct nevh__adaptive nevh__adaptive;
typedef struct nevh__nystrom_state nevh__nystrom_state;
typedef struct {
    nevh__family family;
    nevh__repeated_stages *repeated; /* NULL: there is no such way */
    nevh__nystrom_state *nystrom;    /* of the Nystroem kernel alone */
    nevh__adaptive *adaptive;        /* NULL: steps do not adapt */
} nevh__stages_plan;

/* Steps that adapt, for w->options->tolerance > 0. */
int nevh__adaptive_plan(nevh_work *);
void nevh__adaptive_clear(nevh_work *);
int nevh__adaptive_step(nevh_work *, double t, double h, double q[],
                        double p[]);

#endif
