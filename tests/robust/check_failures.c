/* nevh tests: what fails leaves everything as it was, and says why.
   SPDX-License-Identifier: GPL-3.0-or-later

   GSL's error handler is the default one, which aborts: nothing may reach it. */
#include "support.h"
#include <math.h>
#include <stdint.h>
#include <string.h>

static const double start_q = 1.7, start_p = 0.4;

/* A value that goes wrong once, or H at its k-th evaluation. */
typedef struct {
    size_t calls, fault; /* 0: never */
    double value;
} fuse;

static double kinetic(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return p[0] * p[0] / 2.6;
}

static double gravity(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    fuse *f = *(fuse *const *)params;
    (void)t, (void)p, (void)c;
    return ++f->calls == f->fault ? f->value : -1.7 * cos(q[0]);
}

static nevh_system *system_of(nevh_term_fn potential, const void *params) {
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(
        s, &(nevh_term){.effect = "kinetic", .np = 1, .value = kinetic});
    nevh_system_add(s, &(nevh_term){.effect = "gravity",
                                    .name = "weight",
                                    .nq = 1,
                                    .value = potential,
                                    .params = params});
    return s;
}

/* With steps given, so that planning evaluates next to nothing; fuses are set
   after it. */
static nevh_stepper *stepper_of(const nevh_system *s,
                                const nevh_integrator *scheme) {
    nevh_stepper *m =
        nevh_stepper_new(s, scheme,
                         &(nevh_options){.gradient_step = 0x1p-10,
                                         .tolerance = tolerance_for(scheme),
                                         .q = &start_q,
                                         .p = &start_p});
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_OK);
    return m;
}

/* An orbit of a few steps: the states, and the evaluations it took. */
enum { STEPS = 12 };
static const double step = 0.1;
typedef struct {
    double z[STEPS + 1][2];
    size_t calls;
} orbit;

/* At which step i begins. */
static double time_of(const nevh_stepper *m, const nevh_integrator *scheme,
                      int i) {
    return i ? time_on(m, scheme, i * step) : 0;
}

static orbit clean_orbit(const nevh_integrator *scheme) {
    fuse f = {0}, *params = &f;
    nevh_system *s = system_of(gravity, &params);
    nevh_stepper *m = stepper_of(s, scheme);
    orbit o = {.z = {{start_q, start_p}}};
    f.calls = 0;
    for (int i = 0; i < STEPS; i++) {
        memcpy(o.z[i + 1], o.z[i], sizeof o.z[i]);
        ck_assert_int_eq(nevh_stepper_apply(m, time_of(m, scheme, i), step,
                                            &o.z[i + 1][0], &o.z[i + 1][1]),
                         NEVH_OK);
    }
    o.calls = f.calls;
    nevh_stepper_free(m);
    nevh_system_free(s);
    return o;
}

/* A step that fails is as if it had not been tried; tried again, it is what
   it would have been. */
static void fail_once(const nevh_integrator *scheme, const orbit *o, fuse f) {
    fuse none = {0}, *params = &none;
    nevh_system *s = system_of(gravity, &params);
    nevh_stepper *m = stepper_of(s, scheme);
    params = &f;
    double z[] = {start_q, start_p};
    int failures = 0;
    for (int i = 0; i < STEPS; i++) {
        int status =
            nevh_stepper_apply(m, time_of(m, scheme, i), step, z, z + 1);
        ck_assert_int_eq(nevh_stepper_status(m), status);
        if (status) {
            failures++;
            ck_assert_int_eq(status, NEVH_EDOM);
            assert_says(nevh_stepper_message(m), "\"weight\"");
            assert_says(nevh_stepper_message(m), "\"gravity\"");
            ck_assert_mem_eq(z, o->z[i], sizeof z);
            status =
                nevh_stepper_apply(m, time_of(m, scheme, i), step, z, z + 1);
        }
        ck_assert_int_eq(status, NEVH_OK);
        ck_assert_str_eq(nevh_stepper_message(m), "");
        ck_assert_msg(memcmp(z, o->z[i + 1], sizeof z) == 0,
                      "%s, fault %zu: step %d is another one",
                      nevh_integrator_name(scheme), f.fault, i);
    }
    ck_assert_int_eq(failures, 1);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST_EACH(fails_at_any_evaluation, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    orbit o = clean_orbit(scheme);
    size_t stride = o.calls / 50 + 1;
    for (size_t k = 1; k <= o.calls; k += k < 40 ? 1 : stride) {
        fail_once(scheme, &o, (fuse){.fault = k, .value = NAN});
        fail_once(scheme, &o, (fuse){.fault = k, .value = INFINITY});
    }
}

/* A run that fails, goes on; one that is stopped, too. */
TEST_EACH(run_keeps_the_last_good_state, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    orbit o = clean_orbit(scheme);
    fuse f = {0}, *params = &f;
    nevh_system *s = system_of(gravity, &params);
    nevh_stepper *m = stepper_of(s, scheme);
    f = (fuse){.fault = o.calls * 2 / 3, .value = NAN};
    double z[] = {start_q, start_p};
    ck_assert_int_eq(nevh_run(m, 0, step, STEPS, z, z + 1, NULL, 0), NEVH_EDOM);
    assert_says(nevh_stepper_message(m), "\"weight\"");
    size_t taken = nevh_stepper_taken(m);
    ck_assert(taken > 0 && taken < STEPS);
    ck_assert_mem_eq(z, o.z[taken], sizeof z);
    ck_assert_int_eq(nevh_run(m, time_of(m, scheme, (int)taken), step,
                              STEPS - taken, z, z + 1, NULL, 0),
                     NEVH_OK);
    ck_assert_mem_eq(z, o.z[STEPS], sizeof z);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

static int stop_at(void *data, size_t taken, double t, const double q[],
                   const double p[]) {
    (void)t, (void)q, (void)p;
    return taken == *(size_t *)data;
}

TEST_EACH(observer_stops, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    orbit o = clean_orbit(scheme);
    fuse f = {0}, *params = &f;
    nevh_system *s = system_of(gravity, &params);
    nevh_stepper *m = stepper_of(s, scheme);
    double z[] = {start_q, start_p};
    size_t never = STEPS + 1, last = 5;
    nevh_observer watch[] = {{stop_at, &never, 1}, {stop_at, &last, 1}};
    ck_assert_int_eq(nevh_run(m, 0, step, STEPS, z, z + 1, watch, 2),
                     NEVH_STOPPED);
    assert_says(nevh_stepper_message(m), "observer 1");
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_STOPPED);
    ck_assert_uint_eq(nevh_stepper_taken(m), 5);
    ck_assert_mem_eq(z, o.z[5], sizeof z);
    nevh_run(m, time_of(m, scheme, 5), step, STEPS - 5, z, z + 1, NULL, 0);
    ck_assert_mem_eq(z, o.z[STEPS], sizeof z);
    last = 0;
    ck_assert_int_eq(nevh_run(m, 0, step, 3, z, z + 1, watch, 2), NEVH_STOPPED);
    ck_assert_uint_eq(nevh_stepper_taken(m), 0);
    ck_assert_mem_eq(z, o.z[STEPS], sizeof z);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST(energy_that_fails_stops_the_run) {
    fuse f = {.fault = 1, .value = INFINITY}, *params = &f;
    nevh_system *s = system_of(gravity, &params);
    nevh_stepper *m = stepper_of(s, nevh_verlet);
    nevh_energy *e = nevh_energy_new(s, NULL);
    double z[] = {start_q, start_p};
    nevh_observer watch = {nevh_energy_observe, e, 1};
    ck_assert_int_eq(nevh_run(m, 0, step, 9, z, z + 1, &watch, 1),
                     NEVH_STOPPED);
    ck_assert_int_eq(nevh_energy_status(e), NEVH_EDOM);
    assert_says(nevh_energy_message(e), "\"weight\"");
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* A trial from another state that fails leaves the memory alone, too; so does
   a step that is none. */
TEST_EACH(failed_jump, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    orbit o = clean_orbit(scheme);
    for (int at = 1; at < STEPS; at++) {
        fuse f = {0}, *params = &f;
        nevh_system *s = system_of(gravity, &params);
        nevh_stepper *m = stepper_of(s, scheme);
        double z[] = {start_q, start_p}, other[] = {-0.3, 1.1};
        nevh_run(m, 0, step, (size_t)at, z, z + 1, NULL, 0);
        double t = time_of(m, scheme, at);
        f.fault = f.calls + 1;
        f.value = NAN;
        ck_assert_int_eq(nevh_stepper_apply(m, 9, step, other, other + 1),
                         NEVH_EDOM);
        ck_assert_int_eq(nevh_stepper_apply(m, 9, NAN, other, other + 1),
                         NEVH_EINVAL);
        ck_assert(other[0] == -0.3 && other[1] == 1.1);
        nevh_run(m, t, step, (size_t)(STEPS - at), z, z + 1, NULL, 0);
        ck_assert_msg(memcmp(z, o.z[STEPS], sizeof z) == 0,
                      "%s lost its memory at step %d",
                      nevh_integrator_name(scheme), at);
        nevh_stepper_free(m);
        nevh_system_free(s);
    }
}

static double reciprocal(double t, const double q[], const double p[],
                         const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return q[0] / q[1];
}

static void reciprocal_gradient(size_t width, const double t[],
                                const double q[], const double p[],
                                const double c[], const void *params,
                                double dq[], double dp[]) {
    (void)t, (void)p, (void)c, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++) {
        dq[i] = 1 / q[width + i];
        dq[width + i] = -q[i] / (q[width + i] * q[width + i]);
    }
}

/* The one of `width` lanes and three instances that is at fault is named. */
TEST_EACH(names_instance_and_lane, 5) {
    static const size_t q[] = {0, 1, 2, 3, 4, 5};
    enum { WIDTH = 45, BAD = 38 };
    double t[WIDTH] = {0}, x[6 * WIDTH], dq[6 * WIDTH];
    for (int i = 0; i < 6 * WIDTH; i++)
        x[i] = 1 + i;
    x[3 * WIDTH + BAD] = 0;
    nevh_system *s = nevh_system_new(6);
    nevh_system_add(s, &(nevh_term){.effect = "pairs",
                                    .nq = 2,
                                    .q = q,
                                    .count = 3,
                                    .value = reciprocal,
                                    .gradient = reciprocal_gradient});
    nevh_options o = {.gradient = _i == 4 ? nevh_exact : nevh_gradients()[_i],
                      .gradient_step = 1};
    nevh_field *f = nevh_field_new(s, &o);
    int status = _i == 4 ? nevh_field_gradient(f, WIDTH, t, x, x, dq, NULL)
                         : nevh_field_value(f, WIDTH, t, x, x, dq);
    ck_assert_int_eq(status, NEVH_EDOM);
    ck_assert_int_eq(nevh_field_status(f), NEVH_EDOM);
    assert_says(nevh_field_message(f), "\"pairs\"");
    assert_says(nevh_field_message(f), "(instance 1, lane 38)");
    assert_says(nevh_field_message(f), "q[2] = 129, q[3] = 0");
    x[3 * WIDTH + BAD] = 9;
    ck_assert_int_eq(nevh_field_value(f, WIDTH, t, x, x, dq), NEVH_OK);
    ck_assert_str_eq(nevh_field_message(f), "");
    x[3 * WIDTH + BAD] = 1;
    if (_i < 4) { /* the point on the left is the one */
        ck_assert_int_eq(nevh_field_gradient(f, WIDTH, t, x, x, dq, NULL),
                         NEVH_EDOM);
        assert_says(nevh_field_message(f), "(instance 1, lane 38)");
        assert_says(nevh_field_message(f), "q[3] = 0");
    }
    nevh_field_free(f);
    nevh_system_free(s);
}

/* Pulls the orbit over the edge of its domain, q = 2. */
static double edge(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return sqrt(2 - q[0]);
}

static double wall(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return 3 * q[0] + log(q[0]);
}

TEST_EACH(edge_of_the_domain, 2 * scheme_count()) {
    const nevh_term_fn potentials[] = {edge, wall};
    nevh_term_fn potential = potentials[_i % 2];
    const nevh_integrator *scheme = nevh_integrators()[_i / 2];
    nevh_system *s = system_of(potential, NULL);
    nevh_stepper *m = stepper_of(s, scheme), *again = stepper_of(s, scheme);
    double z[] = {start_q, start_p}, y[] = {start_q, start_p};
    int status = nevh_run(m, 0, 0.02, 1000, z, z + 1, NULL, 0);
    size_t taken = nevh_stepper_taken(m);
    ck_assert(status == NEVH_EDOM || status == NEVH_EMAXITER);
    ck_assert_int_eq(nevh_stepper_status(m), status);
    ck_assert(strlen(nevh_stepper_message(m)) > 20);
    ck_assert(taken < 1000 && isfinite(z[0]) && isfinite(z[1]));
    ck_assert_int_eq(nevh_run(again, 0, 0.02, taken, y, y + 1, NULL, 0),
                     NEVH_OK);
    ck_assert_mem_eq(z, y, sizeof z);
    nevh_stepper_free(m);
    nevh_stepper_free(again);
    nevh_system_free(s);
}
