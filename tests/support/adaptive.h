/* nevh tests: a problem for steps that adapt to a tolerance.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_ADAPTIVE_H
#define NEVH_TESTS_ADAPTIVE_H

#include "support.h"
#include <math.h>

/* A body of mass 2.1 around one at rest, G M = 1, in other units. */
static inline nevh_system *make_orbit_in(double length, double mass,
                                         double time) {
    const double masses[] = {2.1 * mass, 2.1 * mass};
    double rate = length / time;
    return gravity_system(masses, 2.1 * mass * length * rate * rate);
}

static inline nevh_system *make_orbit(void) {
    return make_orbit_in(1, 1, 1);
}

/* From the perihelion, eccentricity 0.6; closed after every 2 pi. */
static const problem ellipse = {
    .name = "ellipse",
    .n = 2,
    .separable = true,
    .quadratic = true,
    .q = {0.4, 0},
    .p = {0, 4.2},
    .make = make_orbit,
};

/* The scheme with this index, or NULL where it does not adapt. */
static const nevh_integrator *adaptive(int i) {
    const nevh_integrator *scheme = nevh_integrators()[i];
    return nevh_integrator_adaptive(scheme) ? scheme : NULL;
}

static inline nevh_stepper *stepper_of(const nevh_system *s, const problem *b,
                                       const nevh_integrator *scheme,
                                       double tolerance) {
    nevh_options o = {.gradient = nevh_exact,
                      .t = b->t0,
                      .q = b->q,
                      .p = b->p,
                      .tolerance = tolerance};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    ck_assert_msg(!nevh_stepper_status(m), "%s", nevh_stepper_message(m));
    return m;
}

/* Falls towards the left, slowly, up a wall that overflows. */
static double steep(double t, const double q[], const double p[],
                    const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2.6 + exp(q[0]) + exp(-2 * q[0]);
}

static inline nevh_system *cliff(nevh_term_fn potential) {
    static const double one = 1;
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .nc = 1,
                                    .c = &one,
                                    .value = mass_kinetic});
    nevh_system_add(
        s, &(nevh_term){.effect = "cliff", .nq = 1, .value = potential});
    return s;
}

/* Ends at q = -1 and 1, but throws back. */
static double walls(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return -1e-4 * log(1 - q[0] * q[0]);
}

#endif
