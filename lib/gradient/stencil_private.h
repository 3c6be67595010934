/* nevh: the points of central differences, as they are laid out when planned.
   SPDX-License-Identifier: GPL-3.0-or-later

   A column is (point * lanes + lane); the points of one variable stand side by
   side, + before -, nearest first. */
#ifndef NEVH_STENCIL_PRIVATE_H
#define NEVH_STENCIL_PRIVATE_H

#include "gradient/evaluation_private.h"

enum { NEVH__MOST_SLOPES = 64 };

/* The difference by one variable of one instance. */
typedef struct {
    size_t k;      /* the variable */
    size_t target; /* row of the half of the gradient that it belongs to */
    size_t first;  /* of its points */
    const nevh_gradient *method;
} nevh__stencil_slope;

/* The points and weights for dH/dq, dH/dp or both of a term. */
struct nevh__stencil {
    size_t points, padded;
    double *shift;     /* nv x padded */
    size_t *source;    /* nv x padded: what is shifted, of q or p */
    size_t *until;     /* points: where those of the same instance end */
    size_t *instance;  /* points */
    double *constants; /* of any places: nc rows of so many lanes */
    size_t lanes;      /* 0: of none yet */
    size_t slopes;
    nevh__stencil_slope slope[];
};

#endif
