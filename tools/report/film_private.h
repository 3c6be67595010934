/* nevh report: orbits as moving pictures.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FILM_PRIVATE_H
#define NEVH_FILM_PRIVATE_H

#include "experiment/plan.h"

/* An orbit, a row a step, the start included. */
typedef struct {
    const char *integrator;
    size_t frames, columns;
    double *place; /* frames*columns: x, y of ends of rods, then of bobs */
    double *error; /* of the energy, relative; frames */
} reel;

/* A symplectic scheme, and the classical Runge-Kutta method, at one step. */
typedef struct {
    plan *plan;
    size_t rods, bobs, most; /* most: frames */
    double dt;
    bool tells; /* rk4 loses or gains what the other keeps */
    reel reel[2];
} film;

/* film.c: false: there is no picture, no scheme fits, it would be too large, or
   there is friction, with which no scheme is symplectic.
   bytes  that its places may take */
bool film_make(film *, plan *, size_t bytes);
void film_free(film *);

/* film_html.c: a figure that plays where scripts run, and is still elsewhere. */
void film_html(const film *, FILE *);

#endif
