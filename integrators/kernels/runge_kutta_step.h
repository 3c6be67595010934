/* nevh: the stages of an explicit Runge-Kutta method, for any number of orbits
   side by side.
   SPDX-License-Identifier: GPL-3.0-or-later

   The text needs vector_private.h, stage_sums_private.h and one function of the
   includer; runge_kutta_kernel.c compiles it for vectors, and for rows of any
   width; lib/native hands it to the C compiler with a scene's formulas. */
#ifndef NEVH_RUNGE_KUTTA_STEP_H
#define NEVH_RUNGE_KUTTA_STEP_H

#include "stage_sums_private.h"

/* Slopes are dH/dp and dH/dq as they are written; the step
   of momenta is -h:

       Y_i = y + (s sum_j a_ij k_j + e),   k_i = (dH/dp, dH/dq)(t + c_i h, Y_i),
       y  += s sum_j b_j k_j,              s = h for q, -h for p. */

typedef struct {
    const nevh__sum *sums; /* sum_j a_ij k_j of each stage */
    size_t size;           /* numbers of a state: q, then p */
    size_t stride;         /* from the slopes of a stage to the next */
    const nevh__number *state, *compensation, *step; /* y, e, s */
    nevh__number *point;                             /* Y_i */
    nevh__number *slopes;                            /* k_i of each stage */
    const struct nevh__runge_kutta_owner *owner;     /* the includer's */
} nevh__runge_kutta_step;

/* The includer's: takes the slopes of a stage at x->point.  Returns 0, or what
   makes the step fail.  way: what the includer has handed to the functions
   below. */
NEVH__INLINE int nevh__runge_kutta_slope(const nevh__runge_kutta_step *x,
                                         int way, size_t stage);

/* `rows` (a constant) vectors of s times a sum. */
NEVH__INLINE void nevh__runge_kutta_sum(const nevh__runge_kutta_step *x,
                                        const nevh__sum *sum, size_t rows,
                                        size_t from, nevh__vector out[]) {
    nevh__add_up(sum, rows, x->slopes + from, out);
    NEVH_UNROLL
    for (size_t k = 0; k < rows; k++)
        out[k] *= NEVH__VECTOR_AT(x->step + from + k * NEVH__IN_VECTOR);
}

NEVH__INLINE void nevh__runge_kutta_place_rows(const nevh__runge_kutta_step *x,
                                               const nevh__sum *sum,
                                               size_t rows, size_t from) {
    nevh__vector change[4];
    nevh__runge_kutta_sum(x, sum, rows, from, change);
    NEVH_UNROLL
    for (size_t k = 0; k < rows; k++) {
        size_t i = from + k * NEVH__IN_VECTOR;
        NEVH__VECTOR_AT(x->point + i) =
            NEVH__VECTOR_AT(x->state + i) +
            (change[k] + NEVH__VECTOR_AT(x->compensation + i));
    }
}

NEVH__INLINE void
nevh__runge_kutta_place_number(const nevh__runge_kutta_step *x, size_t i,
                               nevh__number sum) {
    x->point[i] = x->state[i] + (sum * x->step[i] + x->compensation[i]);
}

/* The stage's state.  Sums of several rows at once keep a processor busy. */
NEVH__INLINE void nevh__runge_kutta_place(const nevh__runge_kutta_step *x,
                                          size_t stage) {
    const nevh__sum *sum = &x->sums[stage];
    size_t i = 0, one = NEVH__IN_VECTOR;
    for (; i + 4 * one <= x->size; i += 4 * one)
        nevh__runge_kutta_place_rows(x, sum, 4, i);
    for (; i + 2 * one <= x->size; i += 2 * one)
        nevh__runge_kutta_place_rows(x, sum, 2, i);
    for (; i + one <= x->size; i += one)
        nevh__runge_kutta_place_rows(x, sum, 1, i);
    for (; i + 2 <= x->size; i += 2) {
        nevh__number sums[2];
        nevh__add_up_two(sum, x->slopes + i, sums);
        nevh__runge_kutta_place_number(x, i, sums[0]);
        nevh__runge_kutta_place_number(x, i + 1, sums[1]);
    }
}

/* The stages from `first` to `until` - 1; slopes of those before are there.
   What is not finite is not looked at. */
NEVH__INLINE int nevh__runge_kutta_take(const nevh__runge_kutta_step *x,
                                        int way, size_t first, size_t until) {
    int status = 0;
    for (size_t stage = first; !status && stage < until; stage++) {
        nevh__runge_kutta_place(x, stage);
        status = nevh__runge_kutta_slope(x, way, stage);
    }
    return status;
}

#endif
