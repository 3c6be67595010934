/* nevh tests: systems with friction.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_DAMPED_H
#define NEVH_TESTS_DAMPED_H

#include "state.h"
#include <math.h>
#include <nevh/extend.h>

static inline bool same(const problem *b, const state *x, const state *y) {
    return memcmp(x->q, y->q, b->n * sizeof(double)) == 0 &&
           memcmp(x->p, y->p, b->n * sizeof(double)) == 0;
}

static const double unequal[] = {0.21, 0.08}, equal[] = {0.13, 0.13};

static inline nevh_system *damped(const problem *b, const double rates[]) {
    nevh_system *s = b->make();
    ck_assert_int_eq(nevh_system_add_friction(s, "drag", rates), NEVH_OK);
    return s;
}

static inline const problem *problem_for(const nevh_integrator *scheme) {
    return nevh_integrator_needs(scheme) ? &henon_heiles : &double_pendulum;
}

/* Whether friction is put around the scheme's steps, or refused. */
static inline bool splits(const nevh_integrator *scheme) {
    return !scheme->kernel->has_friction && !scheme->own_time;
}
static inline bool refuses(const nevh_integrator *scheme) {
    return !scheme->kernel->has_friction && scheme->own_time;
}

static inline double distance(const problem *b, const state *x,
                              const state *y) {
    double sum = 0;
    for (size_t k = 0; k < b->n; k++)
        sum += (x->q[k] - y->q[k]) * (x->q[k] - y->q[k]) +
               (x->p[k] - y->p[k]) * (x->p[k] - y->p[k]);
    return sqrt(sum);
}

#endif
