/* nevh: explicit Runge-Kutta steps, one of h or many within h.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RUNGE_KUTTA_PRIVATE_H
#define NEVH_RUNGE_KUTTA_PRIVATE_H

#include "adaptive_step.h"
#include "gradient/field_private.h"
#include <nevh/extend.h>

/* A step of some lanes, their columns side by side, each by its own h from
   its own t. */
typedef struct {
    nevh_work *work;
    size_t columns;
    const double *t, *h;        /* columns each */
    const double *q, *p;        /* the state at t, n x columns each */
    const double *compensation; /* what its rounding lost, 2n x columns */
    double *
        slope; /* dH/dp and dH/dq at one stage, 2n x columns, or NULL: not wanted */
    size_t lanes; /* of the rows in which the stages were taken */
    bool planned; /* by planned calls */
} nevh__stages;

/* The interface of a family of methods to step control. */
typedef struct {
    size_t stages;
    int error_power;    /* the power of h with which the estimate falls */
    bool last_is_first; /* the last stage is the next step's first */
    bool coarse;        /* there is a second estimate */
    /* The slopes of stages `first` to `until` - 1.  From stage 1 on the first
       one is in `slope`; to there goes that of stage 0 alone, and of a last
       stage that is the next step's first. */
    int (*take)(nevh__stages *, size_t first, size_t until);
    /* The change of the state in the step, and the error estimates, 2n x columns
       each; error may be NULL. */
    int (*finish)(const nevh__stages *, double change[], double error[],
                  double coarse[]);
    /* Hands the stages to the balance of the energy, where one is kept. */
    int (*account)(const nevh__stages *);
} nevh__family;

/* The plan of the kernels. */
typedef struct nevh__adaptive nevh__adaptive;
typedef struct nevh__nystrom_state nevh__nystrom_state;
typedef struct nevh__runge_kutta_state nevh__runge_kutta_state;
typedef struct {
    nevh__family family;
    nevh__runge_kutta_state *runge_kutta; /* one of these two */
    nevh__nystrom_state *nystrom;
    nevh__adaptive *adaptive; /* NULL: steps do not adapt */
} nevh__stages_plan;

/* The properties of T found in planning, for other implementations of the stages. */
typedef struct {
    bool diagonal, moves;         /* as in nevh__nystrom_step */
    const double *rest, *inverse; /* n each: T_p(0); W, if it is diagonal */
} nevh__nystrom_kinetic;
nevh__nystrom_kinetic nevh__nystrom_kinetic_of(const nevh_work *);

/* For lanes with constants of their own: a lane takes those of a work of one orbit,
   or those of another lane.  False: T is at rest in only one of them. */
bool nevh__nystrom_lane_take(nevh_work *, size_t lane, const nevh_work *own);
void nevh__nystrom_lane_copy(nevh_work *, size_t from, size_t to);

/* A step of either kernel. */
int nevh__stages_step(nevh_work *, double t, double h, double q[], double p[]);
/* Steps that adapt, for w->options->tolerance > 0. */
int nevh__adaptive_plan(nevh_work *);
void nevh__adaptive_clear(nevh_work *);
/* The rule of step control of a work whose steps adapt. */
const nevh__adaptive_rule *nevh__adaptive_rule_of(const nevh_work *);

#endif
