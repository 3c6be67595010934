/* nevh: the energy that changes of H in time bring in, where steps do not see
   these.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ENERGY_BOOK_PRIVATE_H
#define NEVH_ENERGY_BOOK_PRIVATE_H

#include "work/ledger_private.h"
#include <nevh/gradient.h>

/* The book of one orbit. */
typedef struct {
    nevh_field *field;         /* for values */
    const nevh_timing *timing; /* NULL: nothing is booked */
    struct nevh_ledger *told;  /* by the steps; NULL: nothing */
    size_t n;
    double *state; /* 2n: between two states; friction's rates, n, follow */
    bool friction;
    double booked; /* beside what the steps told */
    double came;   /* what the steps had told before the last one */
} nevh__book;

/* A step from a state (q, p, t) to another.
   first   the step begins where the run does
   came    what the steps have told by now
   returns by how much they were wrong about a step that passes over a change */
double nevh__book_step(nevh__book *, const double from[], bool first, double t,
                       const double q[], const double p[], double came);
/* At a break itself H is neither what it was nor what it will be: *h becomes the
   value on the side where the step comes from. */
void nevh__book_value(nevh__book *, double from, double t, const double q[],
                      const double p[], double *h);

#endif
