/* nevh tests: states of the problems.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_STATE_H
#define NEVH_TESTS_STATE_H

#include "support.h"

typedef struct {
    double q[MOST_DOF], p[MOST_DOF];
} state;

static inline state start(const problem *b) {
    state z;
    memcpy(z.q, b->q, sizeof z.q);
    memcpy(z.p, b->p, sizeof z.p);
    return z;
}

static inline void assert_same_state(const problem *b, const state *x,
                                     const state *y) {
    ck_assert_mem_eq(x->q, y->q, b->n * sizeof(double));
    ck_assert_mem_eq(x->p, y->p, b->n * sizeof(double));
}

#endif
