/* nevh: derivatives by eight variables at once as C text.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_VECTOR_TEXT_PRIVATE_H
#define NEVH_VECTOR_TEXT_PRIVATE_H

#include "native/slope_private.h"

/* The derivatives of a half, by vectors of variables. */
typedef struct {
    bool kick;
    bool reaches;  /* instances read variables of the vectors beside */
    bool *special; /* count: those that are left to loops */
    size_t count;
    size_t before; /* vectors that are kept for the next one */
} nevh__vectors;

/* True if vectors can be taken, and few of them are special; to be cleared in all
   cases. */
bool nevh__vectors_init(nevh__vectors *, nevh__writer *, nevh_field *,
                        bool kick);
void nevh__vectors_clear(nevh__vectors *);
/* Writes what their functions need before them. */
void nevh__write_vector_helpers(nevh__writer *);
/* After kick_slope and drift_slope, functions
       wide kick_vector(N, t, y, k, before, bad)
       wide kick_at(N, t, y, k, before, bad)
   and drift_... of vector k of the slopes, which is not special, or may be: y is
   where vector k of the points stands, between those beside if it reaches.
   before[kick_before] is what the vector before has left, which kick_vector
   leaves, too, where no vector was taken before. */
bool nevh__write_vector_slope(nevh__writer *, nevh_field *, nevh__vectors *);

#endif
