/* nevh tests: every scheme, and one under a transform of time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_SETTING_H
#define NEVH_TESTS_SETTING_H

#include "state.h"
#include <nevh/transform.h>

/* A scheme on a problem that it fits, with time in it where possible; the last
   of them is gauss4 under a transform. */
typedef struct {
    const problem *b;
    nevh_system *system, *s;
    const nevh_integrator *scheme;
    bool own_time;
} setting;

static inline setting prepare(int i) {
    setting a = {.b = &henon_heiles, .scheme = nevh_gauss4, .own_time = true};
    if (i < scheme_count()) {
        a.scheme = nevh_integrators()[i];
        a.own_time = nevh_integrator_own_time(a.scheme);
        a.b = fits(a.scheme, &double_pendulum) ? &double_pendulum
                                               : &driven_pendulum;
    } else {
        a.s = nevh_distance_power(2, 2, 0.5);
    }
    a.system = a.b->make();
    return a;
}

static inline void put_away(setting *a) {
    nevh_system_free(a->system);
    nevh_system_free(a->s);
}

static inline nevh_stepper *stepper_for(const setting *a) {
    nevh_options o = {.t = a->b->t0,
                      .q = a->b->q,
                      .p = a->b->p,
                      .tolerance = tolerance_for(a->scheme),
                      .transform = a->s};
    nevh_stepper *m = nevh_stepper_new(a->system, a->scheme, &o);
    ck_assert_msg(nevh_stepper_status(m) == NEVH_OK, "%s",
                  nevh_stepper_message(m));
    return m;
}

#endif
