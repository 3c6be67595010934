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

/* The slopes of stages `first` to `until` - 1; those before are there. */
int nevh__stages_take(nevh__stages *, size_t first, size_t until);
/* sum = h times the sum over `count` stages of weights[j] slopes[j]. */
void nevh__stages_sum(const nevh__stages *, size_t count,
                      const double weights[], double sum[]);
/* Hands the stages to the balance of the energy, where one is kept. */
int nevh__stages_account(const nevh__stages *);

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

/* What the kernel keeps. */
typedef struct nevh__adaptive nevh__adaptive;
typedef struct {
    nevh__repeated_stages *repeated; /* NULL: there is no such way */
    nevh__adaptive *adaptive;        /* NULL: steps do not adapt */
} nevh__stages_plan;

/* Steps that adapt, for w->options->tolerance > 0. */
int nevh__adaptive_plan(nevh_work *);
void nevh__adaptive_unplan(nevh_work *);
int nevh__adaptive_step(nevh_work *, double t, double h, double q[],
                        double p[]);

#endif
