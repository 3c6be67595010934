/* nevh tests: scenes in two texts, and references of their orbits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_REFERENCE_H
#define NEVH_TESTS_REFERENCE_H

#include "support.h"
#include <math.h>

enum { MOST = 4 };

/* H as text, from (q, p) at time t0 to t1. */
typedef struct {
    const char *coordinates, *effects;
    double t0, t1;
} orbit;

typedef struct {
    nevh_scene *scene;
    const nevh_system *system;
    size_t n;
    double q[MOST], p[MOST];
    nevh_reference *reference;
} setup;

static inline setup set_up(const char *coordinates, const char *effects) {
    setup s = {.scene = scene_with(coordinates, effects)};
    s.system = nevh_scene_system(s.scene);
    s.n = nevh_scene_dof(s.scene);
    ck_assert_uint_le(s.n, MOST);
    ck_assert_int_eq(nevh_scene_start(s.scene, s.q, s.p), NEVH_OK);
    return s;
}

static inline void refer(setup *s, const nevh_integrator *integrator, double t0,
                         double t1) {
    s->reference =
        nevh_reference_new(s->system, integrator, t0, t1, s->q, s->p);
    ck_assert_str_eq(nevh_reference_message(s->reference), "");
    ck_assert_int_eq(nevh_reference_status(s->reference), NEVH_OK);
}

static inline setup refer_to(const orbit *o,
                             const nevh_integrator *integrator) {
    setup s = set_up(o->coordinates, o->effects);
    refer(&s, integrator, o->t0, o->t1);
    return s;
}

static inline void tear_down(setup *s) {
    nevh_reference_free(s->reference);
    nevh_scene_free(s->scene);
}

#define RODS                                                                   \
    "T = (p_a^2 + 2*p_b^2 - 2*p_a*p_b*cos(a - b))/(2*(1 + sin(a - b)^2))\n"    \
    "V = -9.8*(2*cos(a) + cos(b))"

#endif
