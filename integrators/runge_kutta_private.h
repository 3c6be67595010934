/* nevh: explicit Runge-Kutta steps, one of h or many within h.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RUNGE_KUTTA_PRIVATE_H
#define NEVH_RUNGE_KUTTA_PRIVATE_H

#include "gradient/field_private.h"
#include <nevh/extend.h>

/* One orbit of a small system: a state and its slopes (dH/dq, dH/dp), 2n rows
   each of one number repeated over a vector, and the call that leads from one
   to the other. */
typedef struct {
    double *points, *slopes, *time;
    nevh__call call;
    bool called; /* the call may be taken in this step */
    bool fresh;  /* slopes are those of the stage before the next one */
} nevh__wide;

/* A step of some lanes, their columns side by side, each by its own h from
   its own t. */
typedef struct {
    nevh_work *work;
    size_t columns;
    const double *t, *h; /* columns each */
    const double *q, *p; /* the state at t, n x columns each */
    const double *carry; /* what its rounding lost, 2n x columns */
    double *slopes;      /* stages rows of 2n x columns */
    size_t stride;       /* from one such row to the next */
    double *change;      /* 2n x columns */
    double *point;       /* 2n x columns */
    double *time;        /* columns */
    /* NULL, or of one orbit: p then follows q, and all that is 2n has room for
       `stride` numbers, whole vectors. */
    nevh__wide *wide;
} nevh__stages;

/* The slopes of stages `first` to `until` - 1; those before are there. */
int nevh__stages_take(const nevh__stages *, size_t first, size_t until);
/* sum = h times the sum over `count` stages of weights[j] slopes[j]. */
void nevh__stages_sum(const nevh__stages *, size_t count,
                      const double weights[], double sum[]);
/* Hands the stages to the balance of the energy, where one is kept. */
int nevh__stages_account(const nevh__stages *);

/* The room that 2n x width numbers take. */
size_t nevh__stages_stride(const nevh_work *);
/* Doubles of scratch that the stages of one orbit need, besides their rows, and
   to have these begin where vectors lie well; what they are ready with, or NULL
   where they go the general way. */
size_t nevh__wide_size(const nevh_work *);
double *nevh__wide_begin(const nevh_work *);
nevh__wide *nevh__wide_ready(nevh_work *, nevh__wide *, double *scratch);
/* As nevh__stages_sum; the stage's state and time, not to s->point if calls
   lead to slopes; the slopes there without friction, if these do and all are
   finite; else false, with s->point. */
void nevh__wide_sum(const nevh__stages *, size_t count, const double weights[],
                    double sum[]);
void nevh__wide_place(const nevh__stages *, size_t stage);
bool nevh__wide_take(const nevh__stages *, double slopes[]);

/* What the kernel keeps. */
typedef struct nevh__adaptive nevh__adaptive;
typedef struct {
    nevh__wide wide;
    nevh__adaptive *adaptive; /* NULL: steps do not adapt */
} nevh__stages_plan;

/* Steps that adapt, for w->options->tolerance > 0. */
int nevh__adaptive_plan(nevh_work *);
void nevh__adaptive_unplan(nevh_work *);
int nevh__adaptive_step(nevh_work *, double t, double h, double q[],
                        double p[]);

#endif
