/* nevh: discrete gradients.

   D(z, z') is a discrete gradient of H if D . (z' - z) = H(z') - H(z) and
   D(z, z) = dH(z); then z' = z + h J D(z, z') keeps H.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_DISCRETE_GRADIENT_PRIVATE_H
#define NEVH_DISCRETE_GRADIENT_PRIVATE_H

#include "tableau_private.h"
#include <nevh/extend.h>

/* H at a few states: h + roundoff, and what its rounding is held against. */
typedef struct {
    double *h, *roundoff, *size;
} nevh__values;

/* One part of a step under way.  Variables are numbered from 0 to 2n,
   coordinates first; `active` lanes stand side by side. */
typedef struct {
    nevh_work *work;
    double t, h;                /* the middle of the part, and its length */
    size_t part;                /* which one it is */
    double *z;                  /* 2n x width: where it starts */
    const double *compensation; /* 2n x width: what earlier sums lost */
    double *x;                  /* 2n x width: mean slopes, the unknowns */
    double *ends;               /* 2n x active: where these lead */
    double *times;              /* width: all are t */
    nevh__values start;         /* width: H(t, z) */
    double *deficit;      /* width: what H(t, z) lacks of the orbit's energy */
    nevh__values end;     /* active: H(t, ends) */
    const double *length; /* 2n: over which H varies */
    const double *metric; /* 2n: by which H varies most over lengths of 1; 0 for
                             what H does not read: its conjugate is conserved,
                             and is left alone */
    const nevh__tableau *nodes;
    double *points; /* 2n x nodes x active, and times at the nodes */
    double *slopes; /* 2n x nodes x active */
    double *own;    /* of the scheme: own_size doubles */
} nevh__gradient_step;

/* Puts D_k at the row of the slope that it makes: out[conjugate * active]. */
typedef int (*nevh__discrete_fn)(const nevh__gradient_step *, size_t active,
                                 const size_t lanes[], const double x[],
                                 double out[]);

typedef struct {
    size_t parts;    /* equal parts that a step is made of */
    bool averages;   /* dH at as many Gauss nodes as there are stages */
    bool takes_ends; /* H at both ends, with which the energy is balanced */
    nevh__discrete_fn gradient;
    /* As nevh__stage_problem's; NULL: that of the field's gradient. */
    int (*noise)(void *step, size_t lane, double noise[]);
    size_t (*own_size)(const nevh_work *); /* NULL: none */
} nevh__discrete_gradient;

extern const nevh_kernel nevh__discrete_gradient_kernel;

/* The number of the variable whose slope is +-D_k. */
static inline size_t nevh__conjugate(const nevh_work *w, size_t k) {
    return k < w->n ? k + w->n : k - w->n;
}

/* The states at a few nodes on the way from z to ends, and behind them their
   times, to points. */
void nevh__find_nodes(const nevh__gradient_step *, size_t first, size_t nodes,
                      size_t active, const size_t lanes[], const double x[]);
/* The mean of dH over all nodes; a nevh__discrete_fn. */
int nevh__average_gradient(const nevh__gradient_step *, size_t active,
                           const size_t lanes[], const double x[],
                           double out[]);

#endif
