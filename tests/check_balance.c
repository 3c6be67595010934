/* nevh tests: the balance of the energy, where H reads t or there is friction.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include "gradient/field_private.h"
#include <math.h>
#include <nevh/extend.h>
#include <stdlib.h>
#include <string.h>

#define assert_says(message, word)                                             \
    ck_assert_msg(strstr(message, word), "no \"%s\" in: %s", word, message)

typedef struct {
    double q[MOST_DOF], p[MOST_DOF];
} state;

static state start(const problem *b) {
    state z;
    memcpy(z.q, b->q, sizeof z.q);
    memcpy(z.p, b->p, sizeof z.p);
    return z;
}

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

static double driven(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)p, (void)c, (void)params;
    return -(2 + 0.7 * sin(1.9 * t)) * cos(q[0]);
}

static void driven_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    (void)p, (void)c, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = (2 + 0.7 * sin(1.9 * t[i])) * sin(q[i]);
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
                                    .value = driven,
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
    return breathing(t, q, p, c, params) + driven(t, q, p, c, params) +
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

static bool has_friction(const problem *b) {
    return b == &damped || b == &driven_damped;
}

/* Whether the balance can be kept of that problem. */
static bool keeps(const nevh_integrator *scheme, const problem *b) {
    const nevh_kernel *kernel = scheme->kernel;
    if (has_friction(b) && scheme->own_time && !kernel->damps)
        return false;
    return fits(scheme, b) &&
           !(kernel->opaque && (b != &damped || kernel->damps));
}

static nevh_stepper *balanced(nevh_system *s, const problem *b,
                              const nevh_integrator *scheme) {
    nevh_options o = {.gradient = nevh_exact,
                      .t = b->t0,
                      .q = b->q,
                      .p = b->p,
                      .balance = true};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    ck_assert_msg(nevh_stepper_status(m) == NEVH_OK, "%s on %s: %s",
                  nevh_integrator_name(scheme), b->name,
                  nevh_stepper_message(m));
    return m;
}

/* The report on a run; with the balance where `followed`. */
static nevh_energy_report report_on(const problem *b,
                                    const nevh_integrator *scheme,
                                    bool followed, double h, size_t steps) {
    nevh_system *s = b->make();
    nevh_stepper *m = balanced(s, b, scheme);
    nevh_energy *e = nevh_energy_new(s, NULL);
    if (followed)
        ck_assert_msg(!nevh_energy_follow(e, m), "%s", nevh_energy_message(e));
    nevh_observer watch = {nevh_energy_observe, e, 1};
    state z = start(b);
    int status = nevh_run(m, b->t0, h, steps, z.q, z.p, &watch, 1);
    ck_assert_msg(status == NEVH_OK, "%s on %s: %s, %s",
                  nevh_integrator_name(scheme), b->name,
                  nevh_stepper_message(m), nevh_energy_message(e));
    nevh_energy_report r = nevh_energy_result(e, 0);
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
    return r;
}

/* The slope of a straight line through log-log points. */
static double slope_of(int count, const double x[], const double y[]) {
    double mx = 0, my = 0, xx = 0, xy = 0;
    for (int i = 0; i < count; i++) {
        mx += x[i] / count;
        my += y[i] / count;
    }
    for (int i = 0; i < count; i++) {
        xx += (x[i] - mx) * (x[i] - mx);
        xy += (x[i] - mx) * (y[i] - my);
    }
    return xy / xx;
}

/* The error of the balance falls with the scheme's order.  Beyond order 8 the
   power law is hardly seen before rounding; there the error falls to it. */
static void assert_order(const problem *b, const nevh_integrator *scheme) {
    enum { MOST = 5 };
    double x[MOST], y[MOST], error = INFINITY;
    int count = 0, order = nevh_integrator_order(scheme);
    bool high = order > 8;
    bool keeps_h = nevh_integrator_preserves_energy(scheme) == NEVH_YES;
    double above = order == 1 ? 3e-2 : order <= 4 ? 1e-3 : 1e-5;
    for (double steps = b->fewest; steps < 4e5 && count < MOST && error > 3e-13;
         steps = ceil(steps * 1.4)) {
        error = report_on(b, scheme, true, b->span / steps, (size_t)steps).max;
        if (error < above && error > 3e-13) {
            x[count] = -log(steps);
            y[count++] = log(error);
        }
    }
    if (count < 4) {
        ck_assert_msg(high || keeps_h, "%s on %s: only %d points",
                      nevh_integrator_name(scheme), b->name, count);
        ck_assert_double_lt(error, 3e-13);
        return;
    }
    double slope = slope_of(count, x, y);
    ck_assert_msg(slope >= (high ? 0.7 : 0.85) * order,
                  "%s on %s: order %d, measured %.3f at %d points",
                  nevh_integrator_name(scheme), b->name, order, slope, count);
}

static const problem *const driven_problems[] = {
    &driven_pendulum, &breathing_pendulum, &mixed_pendulum, &turning_frame,
    &damped,          &driven_damped};
enum { PROBLEMS = sizeof driven_problems / sizeof *driven_problems };

START_TEST(order_of_scheme) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    for (size_t i = 0; i < PROBLEMS; i++)
        if (keeps(scheme, driven_problems[i]))
            assert_order(driven_problems[i], scheme);
}
END_TEST

/* The energy itself does change, however small the steps. */
START_TEST(energy_is_not_kept) {
    for (size_t i = 0; i < PROBLEMS; i++) {
        const problem *b = driven_problems[i];
        nevh_energy_report h =
            report_on(b, nevh_gauss8, false, b->span / 400, 400);
        nevh_energy_report balance =
            report_on(b, nevh_gauss8, true, b->span / 400, 400);
        ck_assert_double_gt(h.max, 0.05);
        ck_assert_double_lt(balance.max, 1e-12);
        ck_assert_double_eq(h.scale, balance.scale);
        ck_assert_double_eq(h.initial, balance.initial);
    }
}
END_TEST

/* What is asked for changes no bit of the orbit, and no count. */
START_TEST(asking_changes_nothing) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    for (size_t i = 0; i < PROBLEMS; i++) {
        const problem *b = driven_problems[i];
        if (!keeps(scheme, b))
            continue;
        nevh_counts counts[2];
        state z[2];
        nevh_system *s = b->make();
        for (int asked = 0; asked < 2; asked++) {
            nevh_options o = {.gradient = nevh_central4,
                              .t = b->t0,
                              .q = b->q,
                              .p = b->p,
                              .balance = asked};
            nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
            z[asked] = start(b);
            nevh_run(m, b->t0, 0.02, 40, z[asked].q, z[asked].p, NULL, 0);
            counts[asked] = nevh_stepper_counts(m);
            ck_assert((nevh_stepper_gain(m, 0) != 0) == asked);
            nevh_stepper_free(m);
        }
        ck_assert_mem_eq(z[0].q, z[1].q, b->n * sizeof(double));
        ck_assert_mem_eq(z[0].p, z[1].p, b->n * sizeof(double));
        ck_assert_mem_eq(&counts[0], &counts[1], sizeof counts[0]);
        nevh_system_free(s);
    }
}
END_TEST

/* Nothing comes in where nothing can. */
START_TEST(closed_systems) {
    nevh_system *s = henon_heiles.make();
    nevh_stepper *m = balanced(s, &henon_heiles, nevh_gsl_rkf45);
    nevh_stepper *unasked = planned(s, &henon_heiles, nevh_verlet, nevh_exact);
    nevh_energy *e = nevh_energy_new(s, NULL);
    ck_assert_int_eq(nevh_energy_follow(e, unasked), NEVH_OK);
    nevh_observer watch = {nevh_energy_observe, e, 1};
    state z = start(&henon_heiles);
    nevh_run(m, 0, 0.1, 10, z.q, z.p, NULL, 0);
    ck_assert(nevh_stepper_gain(m, 0) == 0);
    z = start(&henon_heiles);
    ck_assert_int_eq(nevh_run(unasked, 0, 0.1, 10, z.q, z.p, &watch, 1), 0);
    ck_assert(nevh_energy_result(e, 0).max > 0);
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_stepper_free(unasked);
    nevh_system_free(s);
}
END_TEST

/* The sum goes with the memory; a reset begins it, a jump does not. */
START_TEST(gain_can_be_kept) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    for (size_t i = 0; i < PROBLEMS; i++) {
        const problem *b = driven_problems[i];
        const double h = 0.0078125, t1 = 0.25 + 30 * h;
        if (!keeps(scheme, b))
            continue;
        nevh_system *s = b->make();
        nevh_stepper *m = balanced(s, b, scheme),
                     *other = balanced(s, b, scheme);
        state x = start(b);
        nevh_run(m, 0.25, h, 30, x.q, x.p, NULL, 0);
        state y = x, z = x;
        size_t size = nevh_stepper_save_size(m);
        void *buffer = malloc(size);
        nevh_stepper_save(m, buffer);
        nevh_stepper *copy = nevh_stepper_copy(m);
        ck_assert_int_eq(nevh_stepper_load(other, buffer, size), NEVH_OK);
        ck_assert(nevh_stepper_gain(other, 0) == nevh_stepper_gain(m, 0));
        nevh_run(m, t1, h, 30, x.q, x.p, NULL, 0);
        nevh_run(other, t1, h, 30, y.q, y.p, NULL, 0);
        nevh_run(copy, t1, h, 30, z.q, z.p, NULL, 0);
        double gain = nevh_stepper_gain(m, 0);
        ck_assert(gain != 0 && gain == nevh_stepper_gain(other, 0));
        ck_assert(gain == nevh_stepper_gain(copy, 0));
        z.q[0] += 0.01;
        nevh_run(copy, t1 + 30 * h, h, 1, z.q, z.p, NULL, 0);
        ck_assert_double_eq_tol(nevh_stepper_gain(copy, 0), gain, 0.05);
        ck_assert(nevh_stepper_gain(copy, 0) != gain);
        nevh_stepper_reset(copy);
        ck_assert(nevh_stepper_gain(copy, 0) == 0);
        ck_assert(nevh_stepper_gain(m, 1) == 0);
        free(buffer);
        nevh_stepper_free(m);
        nevh_stepper_free(other);
        nevh_stepper_free(copy);
        nevh_system_free(s);
    }
}
END_TEST

/* A lane's gain is that of the orbit that runs alone. */
START_TEST(lanes_are_alone) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    enum { WIDTH = 5 };
    for (size_t i = 0; i < PROBLEMS; i++) {
        const problem *b = driven_problems[i];
        if (!keeps(scheme, b) || scheme->own_time)
            continue;
        double q[MOST_DOF * WIDTH], p[MOST_DOF * WIDTH];
        for (size_t k = 0; k < b->n * WIDTH; k++) {
            q[k] = b->q[k / WIDTH] * (1 + 0.1 * ((double)(k % WIDTH) - 3));
            p[k] = b->p[k / WIDTH] * (1 - 0.1 * ((double)(k % WIDTH) - 3));
        }
        nevh_system *s = b->make();
        nevh_options o = {
            .gradient = nevh_exact, .width = WIDTH, .balance = true};
        nevh_stepper *five = nevh_stepper_new(s, scheme, &o);
        o.width = 1;
        nevh_stepper *one = nevh_stepper_new(s, scheme, &o);
        state x;
        for (size_t k = 0; k < b->n; k++) {
            x.q[k] = q[k * WIDTH + 3];
            x.p[k] = p[k * WIDTH + 3];
        }
        ck_assert_int_eq(nevh_run(five, b->t0, 0.02, 30, q, p, NULL, 0), 0);
        ck_assert_int_eq(nevh_run(one, b->t0, 0.02, 30, x.q, x.p, NULL, 0), 0);
        ck_assert(nevh_stepper_gain(five, 3) == nevh_stepper_gain(one, 0));
        ck_assert(nevh_stepper_gain(five, 2) != nevh_stepper_gain(one, 0));
        nevh_stepper_free(five);
        nevh_stepper_free(one);
        nevh_system_free(s);
    }
}
END_TEST

/* Symplectic schemes keep the balance for long where the orbit is regular. */
static void assert_bounded(const nevh_integrator *scheme, double h,
                           size_t steps) {
    nevh_energy_report r = report_on(&driven_pendulum, scheme, true, h, steps);
    ck_assert_msg(r.verdict == NEVH_BOUNDED && r.max > 1e-7 && r.max < 0.1,
                  "%s: %s, %.2e", nevh_integrator_name(scheme),
                  nevh_verdict_name(r.verdict), r.max);
}

START_TEST(bounded_for_long) {
    assert_bounded(nevh_verlet, 0.1, 20000);
    assert_bounded(nevh_gauss4, 0.2, 5000);
    nevh_energy_report r =
        report_on(&driven_pendulum, nevh_rk4, true, 0.2, 5000);
    ck_assert_msg(r.verdict == NEVH_DRIFTS || r.verdict == NEVH_UNSTABLE,
                  "rk4: %s", nevh_verdict_name(r.verdict));
}
END_TEST

START_TEST(bounded_for_very_long) {
    assert_bounded(nevh_verlet, 0.1, 1000000);
    assert_bounded(nevh_position_verlet, 0.1, 1000000);
    assert_bounded(nevh_gauss4, 0.2, 300000);
}
END_TEST

/* A term of t alone adds f(t) - f(0) to H, and nothing to the orbit. */
START_TEST(time_alone) {
    nevh_system *s = henon_heiles.make();
    nevh_system_add(s, &(nevh_term){.effect = "clock",
                                    .time = true,
                                    .value = clock_term,
                                    .gradient = no_gradient});
    nevh_stepper *m = balanced(s, &henon_heiles, nevh_gauss8);
    state z = start(&henon_heiles);
    ck_assert_int_eq(nevh_run(m, 0, 0.05, 200, z.q, z.p, NULL, 0), NEVH_OK);
    ck_assert_double_eq_tol(nevh_stepper_gain(m, 0), 1.5 * (cos(23) - 1) + 1,
                            1e-12);
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

/* Sums of many steps are compensated. */
static double slowly(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)q, (void)p, (void)c, (void)params;
    return 0.7 * t;
}

START_TEST(many_steps) {
    nevh_system *s = henon_heiles.make();
    nevh_system_add(s, &(nevh_term){.effect = "ramp",
                                    .time = true,
                                    .value = slowly,
                                    .gradient = no_gradient});
    nevh_stepper *m = balanced(s, &henon_heiles, nevh_verlet);
    state z = start(&henon_heiles);
    nevh_run(m, 0, 0.01, 50000, z.q, z.p, NULL, 0);
    ck_assert_double_eq_tol(nevh_stepper_gain(m, 0) / 350, 1, 8e-16);
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

/* What came in before the first observation does not count. */
START_TEST(observed_from_the_middle) {
    const problem *b = &driven_pendulum;
    nevh_system *s = b->make();
    nevh_stepper *m = balanced(s, b, nevh_gauss8);
    nevh_energy *e = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, e, 1};
    state z = start(b);
    ck_assert_int_eq(nevh_energy_follow(e, m), NEVH_OK);
    nevh_run(m, b->t0, 0.05, 40, z.q, z.p, NULL, 0);
    ck_assert_double_gt(fabs(nevh_stepper_gain(m, 0)), 0.01);
    nevh_run(m, b->t0 + 2, 0.05, 40, z.q, z.p, &watch, 1);
    ck_assert_double_lt(nevh_energy_result(e, 0).max, 1e-11);
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

/* Steps that fail leave the sum alone: H is not finite at its k-th value. */
typedef struct {
    size_t calls, fault;
} fuse;

static double fused(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    fuse *f = *(fuse *const *)params;
    return ++f->calls == f->fault ? NAN : driven(t, q, p, c, NULL);
}

enum { FUSED_STEPS = 6 };

/* Returns how many steps failed, and were taken again. */
static int run_fused(const nevh_integrator *scheme, fuse *f, size_t fault,
                     double gain[FUSED_STEPS]) {
    const double mass = 1.3, rate = 0.4, q0 = 1.7, p0 = 0.4;
    double q = q0, p = p0;
    int failures = 0;
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .nc = 1,
                                    .c = &mass,
                                    .value = mass_kinetic});
    nevh_system_add(s, &(nevh_term){.effect = "gravity",
                                    .nq = 1,
                                    .time = true,
                                    .value = fused,
                                    .params = &f});
    if (!scheme->own_time)
        nevh_system_add_friction(s, "drag", &rate);
    nevh_options o = {
        .gradient_step = 0x1p-10, .q = &q0, .p = &p0, .balance = true};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_OK);
    f->calls = 0;
    f->fault = fault;
    for (int i = 0; i < FUSED_STEPS; i++) {
        double before = nevh_stepper_gain(m, 0);
        int status = nevh_stepper_apply(m, 0.1 * i, 0.1, &q, &p);
        if (status) {
            failures++;
            ck_assert(nevh_stepper_gain(m, 0) == before);
            assert_says(nevh_stepper_message(m), "gravity");
            status = nevh_stepper_apply(m, 0.1 * i, 0.1, &q, &p);
        }
        ck_assert_int_eq(status, NEVH_OK);
        gain[i] = nevh_stepper_gain(m, 0);
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
    return failures;
}

START_TEST(fails_at_any_evaluation) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    double clean[FUSED_STEPS], failed[FUSED_STEPS];
    fuse f = {0, 0};
    if (scheme->kernel->opaque)
        return;
    ck_assert_int_eq(run_fused(scheme, &f, 0, clean), 0);
    size_t calls = f.calls, stride = calls / 40 + 1;
    for (size_t k = 1; k <= calls; k += stride) {
        ck_assert_int_eq(run_fused(scheme, &f, k, failed), 1);
        ck_assert_mem_eq(clean, failed, sizeof clean);
    }
}
END_TEST

/* Refusals. */

START_TEST(out_of_reach) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (!scheme->kernel->opaque)
        return;
    nevh_system *s = driven_pendulum.make();
    nevh_options o = {.balance = true};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
    assert_says(nevh_stepper_message(m), "balance");
    assert_says(nevh_stepper_message(m), nevh_integrator_name(scheme));
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

/* A kernel that forgets a part is found out. */
static int no_plan(nevh_work *w) {
    (void)w;
    return NEVH_OK;
}

static int forgetful(nevh_work *w, double t, double h, double q[], double p[]) {
    return nevh_work_account(w, NEVH_OF_Q, h, &t, q, p);
}

START_TEST(incomplete_accounts) {
    const nevh_kernel kernel = {.plan = no_plan, .step = forgetful};
    const nevh_integrator scheme = {
        .name = "forgetful", .source = "here", .order = 1, .kernel = &kernel};
    nevh_system *s = driven_pendulum.make();
    nevh_stepper *m = balanced(s, &driven_pendulum, &scheme);
    nevh_energy *e = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, e, 1};
    state z = start(&driven_pendulum);
    ck_assert_int_eq(nevh_energy_follow(e, m), NEVH_OK);
    ck_assert_int_eq(nevh_run(m, 0, 0.1, 9, z.q, z.p, &watch, 1), NEVH_STOPPED);
    ck_assert_uint_eq(nevh_stepper_taken(m), 1);
    ck_assert(isnan(nevh_stepper_gain(m, 0)));
    ck_assert_int_eq(nevh_energy_status(e), NEVH_EDOM);
    assert_says(nevh_energy_message(e), "forgetful");
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

static void assert_not_followed(const nevh_system *s, const nevh_stepper *m,
                                size_t width, const char *word) {
    nevh_energy *e = nevh_energy_new(s, &(nevh_options){.width = width});
    ck_assert_int_eq(nevh_energy_follow(e, m), NEVH_EINVAL);
    ck_assert_int_eq(nevh_energy_status(e), NEVH_EINVAL);
    assert_says(nevh_energy_message(e), word);
    double x[4] = {0};
    ck_assert_int_eq(nevh_energy_observe(e, 0, 0, x, x), NEVH_EINVAL);
    nevh_energy_free(e);
}

START_TEST(not_followed) {
    const problem *b = &driven_pendulum;
    nevh_system *s = b->make(), *other = b->make();
    nevh_stepper *asked = balanced(s, b, nevh_verlet);
    nevh_stepper *plain = planned(s, b, nevh_verlet, nevh_exact);
    nevh_stepper *refused = nevh_stepper_new(s, NULL, NULL);
    assert_not_followed(s, plain, 1, "balance");
    assert_not_followed(s, asked, 2, "2");
    assert_not_followed(other, asked, 1, "another system");
    assert_not_followed(s, refused, 1, "refused");
    assert_not_followed(s, NULL, 1, "memory");
    nevh_energy *e = nevh_energy_new(s, NULL);
    nevh_energy_observe(e, 0, b->t0, b->q, b->p);
    ck_assert_int_eq(nevh_energy_follow(e, asked), NEVH_EINVAL);
    assert_says(nevh_energy_message(e), "first");
    nevh_energy_free(e);
    nevh_stepper_free(asked);
    nevh_stepper_free(plain);
    nevh_stepper_free(refused);
    nevh_system_free(s);
    nevh_system_free(other);
}
END_TEST

/* dH/dt itself, in any unit of time; u is the unit, the numbers are those of a
   pendulum of frequency about 1. */
typedef struct {
    double u;
    double (*f)(double x); /* of t/u */
} clockwork;

static double wave(double x) {
    return cos(1.7 * x);
}
static double wave_slope(double x) {
    return -1.7 * sin(1.7 * x);
}
static double ramp(double x) {
    return 3 - 0.2 * x;
}
static double ramp_slope(double x) {
    (void)x;
    return -0.2;
}
static double parabola(double x) {
    return 0.3 * x * x - x;
}
static double parabola_slope(double x) {
    return 0.6 * x - 1;
}
static double pulse(double x) {
    return exp(-(x - 3) * (x - 3));
}
static double pulse_slope(double x) {
    return -2 * (x - 3) * pulse(x);
}
static double overtone(double x) {
    return sin(x) + 0.1 * sin(37 * x);
}
static double overtone_slope(double x) {
    return cos(x) + 3.7 * cos(37 * x);
}
static double fixed(double x) {
    (void)x;
    return 5;
}
static double zero(double x) {
    (void)x;
    return 0;
}
static const struct {
    double (*f)(double), (*slope)(double);
} clocks[] = {{wave, wave_slope},         {ramp, ramp_slope},
              {parabola, parabola_slope}, {pulse, pulse_slope},
              {overtone, overtone_slope}, {fixed, zero}};
enum { CLOCKS = sizeof clocks / sizeof *clocks };

static double by_clock(double t, const double q[], const double p[],
                       const double c[], const void *params) {
    const clockwork *w = params;
    (void)p;
    return c[0] * w->f(t / w->u) * q[0] / (w->u * w->u);
}

static double still(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    const clockwork *w = params;
    (void)t, (void)p, (void)c;
    return -cos(q[0]) / (w->u * w->u);
}

static double half_square(double t, const double q[], const double p[],
                          const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return p[0] * p[0] / 2;
}

static void assert_slope(size_t kind, double u, double from) {
    const clockwork w = {u, clocks[kind].f};
    const double constants[] = {1, 0.5, -0.25};
    const size_t one[] = {0, 0, 0};
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(
        s, &(nevh_term){.effect = "kinetic", .np = 1, .value = half_square});
    nevh_system_add(
        s, &(nevh_term){
               .effect = "gravity", .nq = 1, .value = still, .params = &w});
    nevh_system_add(s, &(nevh_term){.effect = "clock",
                                    .nq = 1,
                                    .nc = 1,
                                    .q = one,
                                    .c = constants,
                                    .count = 3,
                                    .time = true,
                                    .value = by_clock,
                                    .params = &w});
    double q = 0.9, p = 0.3 / u, worst = 0, size = 0;
    nevh_options o = {.t = from * u, .q = &q, .p = &p};
    nevh_field *f = nevh_field_new(s, &o);
    nevh__time_step steps[3];
    memset(steps, 0, sizeof steps);
    ck_assert_int_eq(nevh__field_plan_time(f, &o, steps), NEVH_OK);
    ck_assert(!steps[0].method && !steps[1].method && steps[2].method);
    for (int i = 0; i < 200; i++) {
        double x = from + 0.0713 * i, t = x * u, slope = 0;
        double exact = 1.25 * clocks[kind].slope(x) * q / u / u / u;
        ck_assert_int_eq(
            nevh__field_time_slope(f, 2, &steps[2], 1, &t, &q, &p, &slope),
            NEVH_OK);
        worst = fmax(worst, fabs(slope - exact));
        size = fmax(size, fabs(exact));
    }
    ck_assert_msg(worst <= 1e-11 * size, "clock %zu, unit %g, from %g: %.1e",
                  kind, u, from, worst / size);
    nevh_field_free(f);
    nevh_system_free(s);
}

START_TEST(time_derivative) {
    const double units[] = {1, 1e-15, 1e12};
    for (size_t kind = 0; kind < CLOCKS; kind++) {
        assert_slope(kind, units[_i], 0);
        assert_slope(kind, units[_i], 2.3);
        assert_slope(kind, units[_i], -0.7);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("balance");
    TCase *cases = tcase_create("balance"), *slow = tcase_create("slow");
    int count = scheme_count();
    tcase_add_loop_test(cases, order_of_scheme, 0, count);
    tcase_add_test(cases, energy_is_not_kept);
    tcase_add_loop_test(cases, asking_changes_nothing, 0, count);
    tcase_add_test(cases, closed_systems);
    tcase_add_loop_test(cases, gain_can_be_kept, 0, count);
    tcase_add_loop_test(cases, lanes_are_alone, 0, count);
    tcase_add_test(cases, bounded_for_long);
    tcase_add_test(cases, time_alone);
    tcase_add_test(cases, many_steps);
    tcase_add_test(cases, observed_from_the_middle);
    tcase_add_loop_test(cases, fails_at_any_evaluation, 0, count);
    tcase_add_loop_test(cases, out_of_reach, 0, count);
    tcase_add_test(cases, incomplete_accounts);
    tcase_add_test(cases, not_followed);
    tcase_add_loop_test(cases, time_derivative, 0, 3);
    suite_add_tcase(suite, cases);
    tcase_set_tags(slow, "slow");
    tcase_add_test(slow, bounded_for_very_long);
    suite_add_tcase(suite, slow);
    return run_suite(suite);
}
