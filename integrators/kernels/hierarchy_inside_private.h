/* nevh: inside a hierarchy of bodies.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_HIERARCHY_INSIDE_PRIVATE_H
#define NEVH_HIERARCHY_INSIDE_PRIVATE_H

#include "hierarchy_private.h"

enum { MOST_BODIES = NEVH__MOST_BODIES, MOST_GROUPS = 2 * MOST_BODIES - 1 };

/* Bodies are the first groups; a pair of groups comes after both. */
typedef struct {
    size_t of[2];    /* the groups of a pair */
    double share[2]; /* of the mass that each of them has */
    double mass, k;  /* K of a pair */
    double mu;       /* of its motion: K by the reduced mass */
    bool inside;     /* it is part of a pair */
} group;

struct nevh__hierarchy {
    size_t space, n_bodies, n_groups;
    bool whole; /* B is 0: there are no other terms, and bodies are in twos */
    size_t place[MOST_BODIES][NEVH__SPACE]; /* of a body's coordinates */
    double inverse_mass[MOST_BODIES];
    group groups[MOST_GROUPS];
};

/* Padded with zeros to a vector. */
enum { WIDE = 4 };
typedef struct {
    double x[WIDE];
} point;

NEVH__INLINE point between(const point at[], size_t a, size_t b) {
    point r;
    for (size_t k = 0; k < WIDE; k++)
        r.x[k] = at[b].x[k] - at[a].x[k];
    return r;
}

/* Centres of mass of all groups, from those of bodies; or their velocities. */
void nevh__hierarchy_centres(const nevh__hierarchy *, point at[]);
/* Adds to the slopes of bodies those of the motion about one another, times sign. */
void nevh__hierarchy_slopes(const nevh__hierarchy *, const point at[],
                            double sign, point slope[]);

#endif
