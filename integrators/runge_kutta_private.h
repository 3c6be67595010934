/* nevh: explicit Runge-Kutta steps, one of h or many within h.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RUNGE_KUTTA_PRIVATE_H
#define NEVH_RUNGE_KUTTA_PRIVATE_H

#include <nevh/extend.h>

/* A step of some lanes, their columns side by side, each by its own h from
   its own t. */
typedef struct {
    nevh_work *work;
    size_t columns;
    const double *t, *h; /* columns each */
    const double *q, *p; /* the state at t, n x columns each */
    const double *carry; /* what its rounding lost, 2n x columns */
    double *slopes;      /* stages x 2n x columns */
    double *change;      /* 2n x columns */
    double *point;       /* 2n x columns */
    double *time;        /* columns */
} nevh__stages;

/* The slopes of stages `first` to `until` - 1; those before are there. */
int nevh__stages_take(const nevh__stages *, size_t first, size_t until);
/* sum = h times the sum over `count` stages of weights[j] slopes[j]. */
void nevh__stages_sum(const nevh__stages *, size_t count,
                      const double weights[], double sum[]);
/* Hands the stages to the balance of the energy, where one is kept. */
int nevh__stages_account(const nevh__stages *);

/* Steps that adapt, for w->options->tolerance > 0. */
int nevh__adaptive_plan(nevh_work *);
void nevh__adaptive_unplan(nevh_work *);
int nevh__adaptive_step(nevh_work *, double t, double h, double q[],
                        double p[]);

#endif
