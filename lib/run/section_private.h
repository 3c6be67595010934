/* nevh: inside the search for points of sections.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SECTION_PRIVATE_H
#define NEVH_SECTION_PRIVATE_H

#include "run/stepper_private.h"
#include <gsl/gsl_min.h>
#include <gsl/gsl_roots.h>
#include <nevh/section.h>

/* A place within the step at hand. */
typedef struct {
    double s; /* part of the step's length */
    double value;
} nevh__section_node;

enum { NEVH__MOST_NODES = 4 };

/* A section along a run. */
typedef struct {
    nevh_section decl; /* the name is its own copy, or NULL */
    size_t number;
    double value, slope; /* where the step at hand begins; slopes are with t,
                            NAN where they are unknown */
    double value_after, slope_after;
    int came;      /* where the value is on a level: the side, -1 or 1, that it
                      came from; 0 where the run began there */
    double points; /* stroboscopic ones so far */

    /* The step at hand: pieces between nodes, within which the value rises or
       falls; levels are multiples of the period. */
    nevh__section_node nodes[NEVH__MOST_NODES];
    size_t n_nodes, piece;
    bool opened;        /* the next three are of that piece */
    int way;            /* 1: the value rises with s */
    double level, left; /* the next one's multiple; how many are to come */

    /* The next point, not told yet. */
    bool found;
    double s, t;
    int direction;
    double *q, *p;
} nevh__section_state;

struct nevh_sections {
    const nevh_stepper *stepper;
    nevh_stepper *branch; /* a copy */
    nevh_point_fn tell;
    void *data;
    nevh__section_state *states;
    size_t count;
    bool planned, crossings; /* crossings: not all are stroboscopic */

    /* The last state seen, where the step at hand begins. */
    bool begun, first; /* first: no step has been seen yet */
    size_t step;
    double origin; /* time at which the run began */
    double t, *q, *p, *memory;
    /* The end of the step, and its length. */
    double t_after, h;
    const double *q_after, *p_after, *memory_after;
    double tried; /* its part that the branch has taken, as a time; NAN: none */

    double *q_try, *p_try; /* of a shorter step, or near a state */
    double *dq, *dp;       /* the flow there */
    gsl_root_fsolver *root;
    gsl_min_fminimizer *least;
    nevh__report report;
};

/* section.c: tells the points within the step at hand, of which the values and
   slopes of all sections are set. */
int nevh__sections_search(nevh_sections *);
/* The part of a step by which a slope looks ahead. */
static const double nevh__section_ahead = 0x1p-20;

/* section_branch.c.  All return a status, which is recorded. */
/* The time of a stroboscopic section's next point. */
double nevh__section_due(const nevh_sections *, const nevh__section_state *);
/* The section's value at a state; of stroboscopic ones, time since that. */
int nevh__section_value(nevh_sections *, const nevh__section_state *, double t,
                        const double q[], const double p[], double *value);
/* The value after a part s of the step at hand. */
int nevh__section_sample(nevh_sections *, const nevh__section_state *, double s,
                         double *value);
/* The state after a step of h becomes the track's point. */
int nevh__section_take(nevh_sections *, nevh__section_state *, double h);
/* Finds the point between two nodes, on different sides of `level`, at which the
   value is `level`.  Finds none if the value jumps. */
int nevh__section_search(nevh_sections *, nevh__section_state *,
                         nevh__section_node a, nevh__section_node b,
                         double level);

/* section_turn.c: the nodes of the step at hand.  Where the value may turn and
   cross a level within it, nodes are put there. */
int nevh__section_nodes(nevh_sections *, nevh__section_state *);
/* False if the value cannot meet a level within the step at hand. */
bool nevh__section_near(const nevh_sections *, const nevh__section_state *);

/* section_level.c */
/* The multiple of the period at or below a value; without one, -1 below 0. */
double nevh__section_index(const nevh__section_state *, double value);
/* Finds the next point within the step at hand, if there is one. */
int nevh__section_next(nevh_sections *, nevh__section_state *);

#endif
