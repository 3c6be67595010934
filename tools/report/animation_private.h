/* nevh report: animated orbits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ANIMATION_PRIVATE_H
#define NEVH_ANIMATION_PRIVATE_H

#include "experiment/plan.h"

/* An orbit, a row a step, the start included. */
typedef struct {
    const char *integrator;
    size_t frames, columns;
    double *place; /* frames*columns: x, y of ends of rods, then of bobs */
    double *error; /* of the energy, relative; frames */
} recording;

/* A symplectic scheme, and the classical Runge-Kutta method, at one step. */
typedef struct {
    plan *plan;
    size_t rods, bobs, most; /* most: frames */
    double dt;
    bool shows_drift; /* rk4 loses or gains what the other keeps */
    recording recording[2];
} animation;

/* animation.c: false: there is no picture, no scheme fits, it would be too large, or
   there is friction, with which no scheme is symplectic.
   bytes  that its places may take */
bool animation_make(animation *, plan *, size_t bytes);

/* animation_html.c: a figure that plays where scripts run, and is still elsewhere. */
void animation_html(const animation *, FILE *);

#endif
