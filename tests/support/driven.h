/* nevh tests: systems into which energy comes from outside.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_DRIVEN_H
#define NEVH_TESTS_DRIVEN_H

#include "state.h"
#include <math.h>
#include <nevh/extend.h>

/* A pendulum whose mass and gravity vary, and a term of t alone. */
static double breathing(double t, const double q[], const double p[],
                        const double c[], const void *params) {
    (void)q, (void)c, (void)params;
    return p[0] * p[0] / (2.6 + 0.8 * sin(1.3 * t)) + 0.01 * pow(p[0], 4);
}

static void breathing_gradient(size_t width, const double t[], const double q[],
                               const double p[], const double c[],
                               const void *params, double dq[], double dp[]) {
    (void)q, (void)c, (void)params, (void)dq;
    for (size_t i = 0; dp && i < width; i++)
        dp[i] = 2 * p[i] / (2.6 + 0.8 * sin(1.3 * t[i])) + 0.04 * pow(p[i], 3);
}

static double clock_term(double t, const double q[], const double p[],
                         const double c[], const void *params) {
    (void)q, (void)p, (void)c, (void)params;
    return 1.5 * cos(2.3 * t) + 0.1 * t;
}

static void no_gradient(size_t width, const double t[], const double q[],
                        const double p[], const double c[], const void *params,
                        double dq[], double dp[]) {
    (void)width, (void)t, (void)q, (void)p, (void)c, (void)params;
    (void)dq, (void)dp;
}

static nevh_system *make_breathing(void) {
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .time = true,
                                    .value = breathing,
                                    .gradient = breathing_gradient});
    nevh_system_add(s, &(nevh_term){.effect = "potential",
                                    .nq = 1,
                                    .time = true,
                                    .value = driven_value,
                                    .gradient = driven_gradient});
    nevh_system_add(s, &(nevh_term){.effect = "clock",
                                    .time = true,
                                    .value = clock_term,
                                    .gradient = no_gradient});
    return s;
}

/* The same as one function, whose parts are not declared. */
static double mixed(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    return breathing(t, q, p, c, params) + driven_value(t, q, p, c, params) +
           clock_term(t, q, p, c, params);
}

static void mixed_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    driven_gradient(width, t, q, p, c, params, dq, dp);
    breathing_gradient(width, t, q, p, c, params, dq, dp);
}

static nevh_system *make_mixed(void) {
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "H",
                                    .nq = 1,
                                    .np = 1,
                                    .time = true,
                                    .value = mixed,
                                    .gradient = mixed_gradient});
    return s;
}

/* Not separable: a rotating frame that speeds up and down. */
static double turning(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)c, (void)params;
    return (0.4 + 0.3 * sin(1.1 * t)) * (q[0] * p[1] - q[1] * p[0]);
}

static void turning_gradient(size_t width, const double t[], const double q[],
                             const double p[], const double c[],
                             const void *params, double dq[], double dp[]) {
    (void)c, (void)params;
    for (size_t i = 0; i < width; i++) {
        double rate = 0.4 + 0.3 * sin(1.1 * t[i]);
        if (dq) {
            dq[i] = rate * p[width + i];
            dq[width + i] = -rate * p[i];
        }
        if (dp) {
            dp[i] = -rate * q[width + i];
            dp[width + i] = rate * q[i];
        }
    }
}

static nevh_system *make_turning(void) {
    nevh_system *s = henon_heiles.make();
    nevh_system_add(s, &(nevh_term){.effect = "turning",
                                    .nq = 2,
                                    .np = 2,
                                    .time = true,
                                    .value = turning,
                                    .gradient = turning_gradient});
    return s;
}

static nevh_system *make_damped(void) {
    static const double rates[] = {0.11, 0.04};
    nevh_system *s = henon_heiles.make();
    nevh_system_add_friction(s, "drag", rates);
    return s;
}

static nevh_system *make_driven_damped(void) {
    static const double rate = 0.07;
    nevh_system *s = make_breathing();
    nevh_system_add_friction(s, "drag", &rate);
    return s;
}

#define ONE_PENDULUM                                                           \
    .n = 1, .separable = true, .t0 = 0.3, .span = 6, .fewest = 5, .q = {0.9},  \
    .p = {0.3}
static const problem breathing_pendulum = {
    .name = "breathing pendulum", ONE_PENDULUM, .make = make_breathing};
static const problem mixed_pendulum = {
    .name = "mixed pendulum", ONE_PENDULUM, .make = make_mixed};
static const problem driven_damped = {
    .name = "driven and damped", ONE_PENDULUM, .make = make_driven_damped};
static const problem turning_frame = {.name = "turning frame",
                                      .n = 2,
                                      .span = 8,
                                      .fewest = 6,
                                      .q = {0.11, -0.12},
                                      .p = {0.17, 0.13},
                                      .make = make_turning};
static const problem damped = {.name = "damped Henon-Heiles",
                               .n = 2,
                               .separable = true,
                               .quadratic = true,
                               .span = 12,
                               .fewest = 6,
                               .q = {0.31, -0.22},
                               .p = {0.27, 0.33},
                               .make = make_damped};

static inline bool has_friction(const problem *b) {
    return b == &damped || b == &driven_damped;
}

/* Whether the balance can be kept of that problem. */
static inline bool keeps(const nevh_integrator *scheme, const problem *b) {
    const nevh_kernel *kernel = scheme->kernel;
    if (has_friction(b) && scheme->own_time && !kernel->has_friction)
        return false;
    return fits(scheme, b) &&
           !(kernel->opaque && (b != &damped || kernel->has_friction));
}

static inline nevh_stepper *balanced(nevh_system *s, const problem *b,
                                     const nevh_integrator *scheme) {
    nevh_options o = {.gradient = nevh_exact,
                      .t = b->t0,
                      .q = b->q,
                      .p = b->p,
                      .tolerance = tolerance_for(scheme),
                      .balance = true};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    ck_assert_msg(nevh_stepper_status(m) == NEVH_OK, "%s on %s: %s",
                  nevh_integrator_name(scheme), b->name,
                  nevh_stepper_message(m));
    return m;
}

static const problem *const driven_problems[] = {
    &driven_pendulum, &breathing_pendulum, &mixed_pendulum, &turning_frame,
    &damped,          &driven_damped};
enum { PROBLEMS = sizeof driven_problems / sizeof *driven_problems };

/* Whether the balance can be kept of any of them. */
static inline bool keeps_any(const nevh_integrator *scheme) {
    for (size_t i = 0; i < PROBLEMS; i++)
        if (keeps(scheme, driven_problems[i]))
            return true;
    return false;
}

#endif
