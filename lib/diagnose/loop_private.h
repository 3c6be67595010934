/* nevh: inside a loop.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_LOOP_PRIVATE_H
#define NEVH_LOOP_PRIVATE_H

#include "run/stepper_private.h"
#include <nevh/loop.h>

enum { NEVH__NODES = 16 };
/* The relative error of an area from which on it is looked for inside. */
#define NEVH__LOOP_CERTAIN 1e-3

typedef struct {
    double from, to; /* s */
    size_t parts;    /* that it is cut into */
    size_t least;    /* that an area certain to 1e-3 takes */
    double *states;  /* NEVH__NODES x n of q, then of p, for each time; NULL:
                        they are not kept */
    size_t kept;     /* times of which they are */
} nevh__panel;

/* Panels, of which those before `front` are gone. */
typedef struct {
    nevh__panel *item;
    size_t count, front, room;
} nevh__queue;

struct nevh_loop {
    nevh__report report;
    nevh_loop_options options;
    nevh_stepper *stepper;
    size_t n;
    void *memory;    /* of arrays, but for corners, steps and shape */
    double *corners; /* n_corners and 1 more: the first once again */
    size_t *steps;
    double node[NEVH__NODES]; /* in [-1, 1] */
    double legendre[NEVH__NODES]
                   [NEVH__NODES]; /* [k][j]: from value j to coefficient k */
    double *q, *p;                /* NEVH__NODES x n */
    /* Times: of the panel at hand; errors that are the series', and that are noise,
       of rounding or of differences. */
    double *taken_area, *taken_error, *taken_noise;
    double *level;      /* 2n x times: noise of coefficients of q, p of each */
    double *centre;     /* n x times: taken from q */
    double *unit;       /* times: of areas */
    double *low, *high; /* 2n x times: where the curve is */
    double *area, *error, *noise; /* times; noise: a sum of squares */
    bool *inside;                 /* times: by nevh__loop_look_inside */
    nevh__panel *shape;
    nevh__queue *rough; /* times: panels that are first too rough there */
    size_t panels;      /* that were accepted */
    size_t reach;       /* times before any step failed */
    size_t taken_times; /* of the panel at hand, that are smooth */
    bool keeps;         /* states of panels that wait */
    bool full;          /* no panel is cut any more */
    bool carried;
};

/* loop_panel.c.  Carries a panel along and calls `look` after each of the times,
   as long as it says so.  No step is taken where the states of all times are kept.
   returns  NEVH_OK, also where a step failed; a status that ends all */
typedef bool (*nevh__loop_look)(nevh_loop *, size_t time);
int nevh__loop_follow(nevh_loop *, nevh__panel *, nevh__loop_look);
/* States of the panel's nodes at the beginning. */
int nevh__loop_place(nevh_loop *, const nevh__panel *);
/* Expands values over a panel, less `from`, in a series. */
void nevh__loop_expand(const nevh_loop *, const double value[], double from,
                       double coefficient[]);
/* Functions for nevh__loop_follow: the level of noise, of a panel so short that its
   series ends halfway; the extent of the curve; areas and errors; the same up to
   the first time at which the panel must be cut. */
bool nevh__loop_listen(nevh_loop *, size_t time);
bool nevh__loop_measure(nevh_loop *, size_t time);
bool nevh__loop_integrate(nevh_loop *, size_t time);
bool nevh__loop_integrate_smooth(nevh_loop *, size_t time);
/* Into how many parts the panel at hand is to be cut, which is not smooth. */
size_t nevh__loop_parts(const nevh_loop *);
/* The fewest parts of it that can give the area to NEVH__LOOP_CERTAIN. */
size_t nevh__loop_least_parts(const nevh_loop *);

/* loop_inside.c.  Finds areas that the curve no longer tells, of one degree of
   freedom: the mean over what it enclosed at first of the determinants of all
   steps. */
int nevh__loop_look_inside(nevh_loop *);

#endif
