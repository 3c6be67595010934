/* nevh: what a compiled function of steps is called with.  lib/native hands it to the
   C compiler.

   Up to `steps` steps of h, step i from t0 + i h, the first being number `from`.
   numbers  of the formulas
   weights, times  of the scheme; operations: how many it has
   q, p, memory  rows of `width`, which change
   counted  of steps that take as many as can be taken are added: of implicit ones
            sweeps of each orbit, how often noise was asked for, and sweeps evaluated,
            also of orbits that are done; of those that adapt slopes at states, and
            trials
   plan     of the scheme: of steps by parts a nevh__parts_scheme
   room     of rows, where a state is long; else where to write what is watched after
            each step, or NULL
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_STEPS_CALL_H
#define NEVH_STEPS_CALL_H

#include <stddef.h>

typedef struct {
    const double *numbers;
    double *weights, *times;
    size_t operations;
    double t0, h;
    size_t from, steps;
    double *q, *p, *memory;
    size_t *counted;
    const void *plan;
    double *room;
} nevh__steps_call;

#endif
