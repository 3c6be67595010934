/* nevh: poles between two states.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PASSAGE_PRIVATE_H
#define NEVH_PASSAGE_PRIVATE_H

#include "expression/timing_parts_private.h"
#include "expression/timing_private.h"

typedef struct {
    const nevh_system *system;
    double *before, *now; /* 2n + 1 each: q, p, t of the last state */
    nevh__time_parts parts;
    size_t looks; /* so far: they are limited */
    bool found;
    double at; /* the time after the step */
    size_t effect;
} nevh__passage;

/* False when memory is out. */
bool nevh__passage_init(nevh__passage *, const nevh_system *);
void nevh__passage_clear(nevh__passage *);
void nevh__passage_keep(nevh__passage *, double t, const double q[],
                        const double p[]);
/* Tests whether the straight line from the last state to this one passes a pole of
   a term; keeps the first one. */
void nevh__passage_look(nevh__passage *, double t, const double q[],
                        const double p[]);

#endif
