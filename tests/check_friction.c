/* nevh tests: friction.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
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

static bool same(const problem *b, const state *x, const state *y) {
    return memcmp(x->q, y->q, b->n * sizeof(double)) == 0 &&
           memcmp(x->p, y->p, b->n * sizeof(double)) == 0;
}

static const double unequal[] = {0.21, 0.08}, equal[] = {0.13, 0.13};

static nevh_system *damped(const problem *b, const double rates[]) {
    nevh_system *s = b->make();
    ck_assert_int_eq(nevh_system_add_friction(s, "drag", rates), NEVH_OK);
    return s;
}

static const problem *problem_for(const nevh_integrator *scheme) {
    return nevh_integrator_needs(scheme) ? &henon_heiles : &double_pendulum;
}

/* Whether friction is put around the scheme's steps, or refused. */
static bool splits(const nevh_integrator *scheme) {
    return !scheme->kernel->damps && !scheme->own_time;
}
static bool refuses(const nevh_integrator *scheme) {
    return !scheme->kernel->damps && scheme->own_time;
}

/* What a system says. */

START_TEST(rates_add_up) {
    const double a[] = {0.5, 0.25}, b[] = {1, -0.125};
    double sum[2];
    nevh_system *s = henon_heiles.make();
    ck_assert(!nevh_system_friction(s, sum));
    ck_assert(sum[0] == 0 && sum[1] == 0);
    size_t effects = nevh_system_effect_count(s);
    nevh_system_add_friction(s, "air", a);
    nevh_system_add_friction(s, "water", b);
    nevh_system_add_friction(s, "air", a);
    ck_assert_uint_eq(nevh_system_effect_count(s), effects + 2);
    ck_assert_str_eq(nevh_system_effect_name(s, effects), "air");
    ck_assert_str_eq(nevh_system_effect_name(s, effects + 1), "water");
    ck_assert(nevh_system_friction(s, sum));
    ck_assert(sum[0] == 2 && sum[1] == 0.375);
    ck_assert_int_eq(nevh_system_enable(s, "air", false), NEVH_OK);
    ck_assert(nevh_system_friction(s, sum));
    ck_assert(sum[0] == 1 && sum[1] == -0.125);
    nevh_system_enable(s, "water", false);
    ck_assert(!nevh_system_friction(s, NULL));
    ck_assert(!nevh_system_effect_on(s, "water"));
    nevh_system_free(s);
}
END_TEST

/* Terms and friction of one name are one effect. */
START_TEST(an_effect_of_both_kinds) {
    double values[4], sum[2];
    nevh_system *s = henon_heiles.make();
    nevh_system_add_friction(s, "potential", unequal);
    nevh_system_add_friction(s, "drag", equal);
    ck_assert_uint_eq(nevh_system_effect_count(s), 3);
    nevh_field *f = nevh_field_new(s, NULL);
    nevh_field_effects(f, 0, henon_heiles.q, henon_heiles.p, values);
    ck_assert(values[0] != 0 && values[1] != 0 && values[2] == 0);
    ck_assert_uint_eq(nevh_field_effect_values(f, "drag"), 0);
    nevh_field_free(f);
    nevh_system_enable(s, "potential", false);
    nevh_system_friction(s, sum);
    ck_assert(sum[0] == equal[0] && sum[1] == equal[1]);
    ck_assert_uint_eq(nevh_system_traits(s), NEVH_SEPARABLE | NEVH_AUTONOMOUS);
    nevh_system_free(s);
}
END_TEST

static void assert_bad(const char *effect, const double rates[],
                       const char *word) {
    nevh_system *s = henon_heiles.make();
    size_t effects = nevh_system_effect_count(s);
    ck_assert_int_eq(nevh_system_add_friction(s, effect, rates), NEVH_EINVAL);
    ck_assert_int_eq(nevh_system_status(s), NEVH_EINVAL);
    assert_says(nevh_system_message(s), word);
    ck_assert_uint_eq(nevh_system_effect_count(s), effects);
    ck_assert(!nevh_system_friction(s, NULL));
    ck_assert_int_eq(nevh_system_add_friction(s, "drag", equal), NEVH_EINVAL);
    nevh_stepper *m = nevh_stepper_new(s, nevh_verlet, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

START_TEST(bad_rates) {
    assert_bad("drag", (double[]){0.1, NAN}, "nan");
    assert_bad("drag", (double[]){INFINITY, 0.1}, "momentum 0");
    assert_bad("drag", (double[]){0, -INFINITY}, "-inf");
    assert_bad("drag", NULL, "NULL");
    assert_bad("", equal, "name");
    assert_bad(NULL, equal, "name");
    nevh_system *s = henon_heiles.make();
    const double huge[] = {0, DBL_MAX};
    nevh_system_add_friction(s, "a", huge);
    nevh_system_add_friction(s, "b", huge);
    nevh_stepper *m = nevh_stepper_new(s, nevh_verlet, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
    assert_says(nevh_stepper_message(m), "momentum 1");
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

/* Adding or switching it makes steppers stale; copies of these stay so. */
START_TEST(changes_are_noticed) {
    nevh_system *s = damped(&henon_heiles, equal);
    nevh_stepper *m = planned(s, &henon_heiles, nevh_verlet, nevh_exact);
    state z = start(&henon_heiles);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z.q, z.p), NEVH_OK);
    nevh_system_enable(s, "drag", false);
    ck_assert_int_eq(nevh_stepper_apply(m, 0.1, 0.1, z.q, z.p), NEVH_ESTALE);
    nevh_stepper *copy = nevh_stepper_copy(m);
    ck_assert_int_eq(nevh_stepper_apply(copy, 0.1, 0.1, z.q, z.p), NEVH_ESTALE);
    nevh_stepper_free(copy);
    nevh_stepper_free(m);
    m = planned(s, &henon_heiles, nevh_verlet, nevh_exact);
    nevh_system_add_friction(s, "more", equal);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z.q, z.p), NEVH_ESTALE);
    copy = nevh_stepper_copy(m);
    ck_assert_int_eq(nevh_stepper_apply(copy, 0, 0.1, z.q, z.p), NEVH_ESTALE);
    nevh_stepper_free(copy);
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

/* What a stepper says. */

START_TEST(order_to_expect) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    nevh_system *s = damped(b, unequal);
    nevh_stepper *m = nevh_stepper_new(s, scheme, NULL);
    int order = nevh_integrator_order(scheme);
    if (refuses(scheme))
        ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
    ck_assert_int_eq(nevh_stepper_order(m),
                     splits(scheme) && order > 2 ? 2 : order);
    nevh_stepper_free(m);
    nevh_system_enable(s, "drag", false);
    m = nevh_stepper_new(s, scheme, NULL);
    ck_assert_int_eq(nevh_stepper_order(m), order);
    nevh_stepper_free(m);
    m = nevh_stepper_new(s, NULL, NULL);
    ck_assert_int_eq(nevh_stepper_order(m), 0);
    ck_assert_int_eq(nevh_stepper_order(NULL), 0);
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

START_TEST(own_times_are_refused) {
    nevh_integrator varies = **&nevh_verlet;
    varies.name = "varies";
    varies.own_time = true;
    nevh_system *s = damped(&henon_heiles, equal);
    nevh_stepper *m = nevh_stepper_new(s, &varies, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
    assert_says(nevh_stepper_message(m), "varies");
    assert_says(nevh_stepper_message(m), "friction");
    nevh_stepper_free(m);
    nevh_system_enable(s, "drag", false);
    m = nevh_stepper_new(s, &varies, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_OK);
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

/* A scheme of its own: q and p stay as they are, memory holds p. */
static int hold_plan(nevh_work *w) {
    w->memory_rows = w->n + 1;
    return NEVH_OK;
}

static int hold(nevh_work *w, double t, double h, double q[], double p[]) {
    (void)t, (void)h, (void)q;
    double *begun = w->memory + w->size;
    for (size_t i = 0; i < w->size; i++) {
        if (begun[i % w->width] != 0)
            ck_assert_double_eq_tol(w->memory[i], p[i], 1e-15 * fabs(p[i]));
        w->memory[i] = p[i];
    }
    for (size_t lane = 0; lane < w->width; lane++)
        begun[lane] = 1;
    if (w->friction)
        for (size_t i = 0; i < w->size; i++)
            p[i] -= h * w->friction[i / w->width] * p[i];
    return NEVH_OK;
}

static void hold_damp(nevh_work *w, const double factor[]) {
    for (size_t i = 0; i < w->size; i++)
        w->memory[i] *= factor[i / w->width];
}

static nevh_integrator holding(const nevh_kernel *kernel) {
    return (nevh_integrator){
        .name = "hold", .source = "here", .order = 4, .kernel = kernel};
}

/* The kernel is told of each factor between its steps, also of lanes that
   jump and of steps that change. */
START_TEST(memory_is_damped_with_p) {
    const nevh_kernel kernel = {
        .plan = hold_plan, .step = hold, .damp = hold_damp};
    nevh_integrator scheme = holding(&kernel);
    nevh_system *s = damped(&henon_heiles, unequal);
    nevh_stepper *m = nevh_stepper_new(s, &scheme, &(nevh_options){.width = 2});
    double q[4] = {0}, p[4] = {1, -2, 3, -4}, t = 0;
    for (int i = 0; i < 40; i++) {
        double h = i % 7 == 3 ? -0.3 : 0.2;
        ck_assert_int_eq(nevh_stepper_apply(m, t, h, q, p), NEVH_OK);
        t += h;
        p[i % 4] += i % 11 == 5;
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

/* One that damps itself is given the rates, and left alone. */
START_TEST(a_kernel_takes_the_rates) {
    const nevh_kernel kernel = {.plan = hold_plan, .step = hold, .damps = true};
    nevh_integrator scheme = holding(&kernel);
    nevh_system *s = damped(&henon_heiles, unequal);
    nevh_stepper *m = nevh_stepper_new(s, &scheme, NULL);
    ck_assert_int_eq(nevh_stepper_order(m), 4);
    double q[2] = {0}, p[2] = {1, -2};
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.5, q, p), NEVH_OK);
    ck_assert(p[0] == 1 - 0.5 * 0.21 && p[1] == -2 + 0.5 * 0.08 * 2);
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

/* What it does to orbits. */

static state orbit_on(nevh_system *s, const problem *b,
                      const nevh_integrator *scheme, nevh_counts *counts) {
    nevh_stepper *m = planned(s, b, scheme, nevh_central4);
    state z = start(b);
    ck_assert_int_eq(nevh_run(m, b->t0, 0.02, 60, z.q, z.p, NULL, 0), 0);
    *counts = nevh_stepper_counts(m);
    nevh_stepper_free(m);
    return z;
}

START_TEST(none_leaves_no_trace) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    const double zeros[] = {0, -0.}, opposite[] = {-0.21, -0.08};
    nevh_counts without, with;
    nevh_system *s = b->make();
    state plain = orbit_on(s, b, scheme, &without);
    nevh_system_add_friction(s, "nothing", zeros);
    state x = orbit_on(s, b, scheme, &with);
    ck_assert(same(b, &plain, &x));
    nevh_system_add_friction(s, "drag", unequal);
    nevh_system_enable(s, "drag", false);
    x = orbit_on(s, b, scheme, &with);
    ck_assert(same(b, &plain, &x));
    nevh_system_enable(s, "drag", true);
    nevh_system_add_friction(s, "drive", opposite);
    x = orbit_on(s, b, scheme, &with);
    ck_assert(same(b, &plain, &x));
    ck_assert_mem_eq(&without, &with, sizeof with);
    nevh_system_enable(s, "drive", false);
    if (!refuses(scheme)) {
        x = orbit_on(s, b, scheme, &with);
        ck_assert(!same(b, &plain, &x));
    }
    nevh_system_free(s);
}
END_TEST

/* p of a free particle, or of one without H at all, is p0 exp(-rate t). */
static void assert_decay(const nevh_integrator *scheme, bool moves, double rate,
                         double h, size_t steps) {
    nevh_system *s = nevh_system_new(1);
    const double mass = 1.3;
    if (moves)
        nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                        .np = 1,
                                        .nc = 1,
                                        .c = &mass,
                                        .value = mass_kinetic,
                                        .gradient = mass_kinetic_gradient});
    nevh_system_add_friction(s, "drag", &rate);
    nevh_options o = {.gradient = nevh_exact};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    double q = 0.4, p = -0.7, t = (double)steps * h;
    ck_assert_int_eq(nevh_run(m, 0, h, steps, &q, &p, NULL, 0), NEVH_OK);
    double expected = -0.7 * exp(-rate * t);
    double allowed = (2 + fabs(rate * t)) * DBL_EPSILON * fabs(expected);
    ck_assert_msg(
        fabs(p - expected) <= allowed, "%s, rate %g, h %g: relative error %.2e",
        nevh_integrator_name(scheme), rate, h, fabs(p / expected - 1));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

START_TEST(decay_is_exact) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (!splits(scheme))
        return;
    assert_decay(scheme, true, 0.1, 0.01, 10000);
    assert_decay(scheme, false, 0.37, 0.001, 10000);
    assert_decay(scheme, true, -0.37, 0.001, 10000);
    assert_decay(scheme, false, 0.3, -0.003, 1000);
    assert_decay(scheme, true, 7.7, 0.5, 50);
    assert_decay(scheme, false, 1.3, 1, 200);
    assert_decay(scheme, false, 1e-9, 0.1, 10000);
}
END_TEST

/* An independent reference: GSL's Prince-Dormand with dp/dt written out. */
typedef struct {
    nevh_field *field;
    size_t n;
    const double *rates;
} slopes;

static int right_hand_side(double t, const double y[], double dydt[],
                           void *params) {
    const slopes *f = params;
    size_t n = f->n;
    if (nevh_field_gradient(f->field, 1, &t, y, y + n, dydt + n, dydt))
        return GSL_EBADFUNC;
    for (size_t i = n; i < 2 * n; i++)
        dydt[i] = -dydt[i] - f->rates[i - n] * y[i];
    return GSL_SUCCESS;
}

static state reference(const problem *b, const double rates[]) {
    nevh_system *s = b->make();
    nevh_options o = {.gradient = nevh_exact, .q = b->q, .p = b->p};
    slopes f = {nevh_field_new(s, &o), b->n, rates};
    gsl_odeiv2_system ode = {right_hand_side, NULL, 2 * b->n, &f};
    gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_y_new(
        &ode, gsl_odeiv2_step_rk8pd, 1e-3, 1e-14, 1e-14);
    double y[2 * MOST_DOF], t = b->t0;
    memcpy(y, b->q, b->n * sizeof *y);
    memcpy(y + b->n, b->p, b->n * sizeof *y);
    ck_assert_int_eq(gsl_odeiv2_driver_apply(driver, &t, b->t0 + b->span, y),
                     GSL_SUCCESS);
    state z;
    memcpy(z.q, y, b->n * sizeof *y);
    memcpy(z.p, y + b->n, b->n * sizeof *y);
    gsl_odeiv2_driver_free(driver);
    nevh_field_free(f.field);
    nevh_system_free(s);
    return z;
}

/* p^2/2.6 + 0.8 q^2, whose damped motion is known. */
static double spring(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return 0.8 * q[0] * q[0];
}

static void spring_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)c, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = 1.6 * q[i];
}

static nevh_system *make_spring(void) {
    static const double mass = 1.3;
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .nc = 1,
                                    .c = &mass,
                                    .value = mass_kinetic,
                                    .gradient = mass_kinetic_gradient});
    nevh_system_add(s, &(nevh_term){.effect = "spring",
                                    .nq = 1,
                                    .value = spring,
                                    .gradient = spring_gradient});
    return s;
}

static const problem oscillator = {
    .name = "oscillator",
    .n = 1,
    .separable = true,
    .quadratic = true,
    .span = 7,
    .fewest = 6,
    .q = {0.9},
    .p = {-0.3},
    .make = make_spring,
};

/* m q'' + m rate q' + 1.6 q = 0, p = m q'. */
static state oscillator_solution(double rate) {
    const double m = 1.3, t = oscillator.span, decay = exp(-rate * t / 2);
    double w = sqrt(1.6 / m - rate * rate / 4), q0 = 0.9, v0 = -0.3 / m;
    double b = (v0 + rate * q0 / 2) / w, c = cos(w * t), s = sin(w * t);
    double q = decay * (q0 * c + b * s);
    double v = decay * w * (b * c - q0 * s) - rate / 2 * q;
    return (state){.q = {q}, .p = {m * v}};
}

static double distance(const problem *b, const state *x, const state *y) {
    double sum = 0;
    for (size_t k = 0; k < b->n; k++)
        sum += (x->q[k] - y->q[k]) * (x->q[k] - y->q[k]) +
               (x->p[k] - y->p[k]) * (x->p[k] - y->p[k]);
    return sqrt(sum);
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

static void assert_order(const problem *b, const nevh_integrator *scheme,
                         const double rates[], const state *exact) {
    enum { MOST = 5 };
    double x[MOST], y[MOST];
    int count = 0;
    nevh_system *s = damped(b, rates);
    nevh_stepper *m = planned(s, b, scheme, nevh_exact);
    int order = nevh_stepper_order(m);
    double above = order == 1 ? 1e-2 : 1e-5;
    for (double steps = b->fewest; steps < 4e5 && count < MOST;
         steps = ceil(steps * 1.4)) {
        state z = start(b);
        nevh_stepper_reset(m);
        int status = nevh_run(m, b->t0, b->span / steps, (size_t)steps, z.q,
                              z.p, NULL, 0);
        double error = status ? INFINITY : distance(b, &z, exact);
        if (error < 1e-12)
            break;
        if (error < above) {
            x[count] = -log(steps);
            y[count++] = log(error);
        }
    }
    double slope = slope_of(count, x, y), slack = order > 2 ? 0.15 : 0.05;
    ck_assert_msg(count >= 4 && fabs(slope - order) <= slack * order,
                  "%s on %s: order %d, measured %.3f at %d points",
                  nevh_integrator_name(scheme), b->name, order, slope, count);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

START_TEST(order_of_scheme) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *const coupled[] = {&henon_heiles, &relativistic,
                                      &double_pendulum};
    if (refuses(scheme))
        return;
    state exact = oscillator_solution(unequal[0]);
    assert_order(&oscillator, scheme, unequal, &exact);
    for (size_t i = 0; i < 3; i++)
        if (fits(scheme, coupled[i])) {
            exact = reference(coupled[i], unequal);
            assert_order(coupled[i], scheme, unequal, &exact);
        }
}
END_TEST

START_TEST(independent_reference) {
    state exact = oscillator_solution(unequal[0]);
    state other = reference(&oscillator, unequal);
    ck_assert_double_lt(distance(&oscillator, &exact, &other), 1e-13);
}
END_TEST

/* The largest element of |M'JM - factor J|, M being the derivative of a step by
   differences of order 6. */
static double conformal_defect(nevh_stepper *m, const problem *b, double h,
                               double factor) {
    static const double weights[3] = {1.5, -0.6, 0.1};
    size_t n = b->n, size = 2 * n;
    double map[2 * MOST_DOF][2 * MOST_DOF] = {{0}}, most = 0;
    for (size_t j = 0; j < size; j++)
        for (int c = -3; c <= 3; c++) {
            double move = c * 0x1p-8;
            state z = start(b);
            if (c == 0)
                continue;
            *(j < n ? &z.q[j] : &z.p[j - n]) += move;
            nevh_stepper_reset(m);
            ck_assert_int_eq(nevh_stepper_apply(m, b->t0, h, z.q, z.p), 0);
            for (size_t i = 0; i < size; i++)
                map[i][j] += weights[abs(c) - 1] / (2 * move) *
                             (i < n ? z.q[i] : z.p[i - n]);
        }
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j < size; j++) {
            double sum = i + n == j ? -factor : j + n == i ? factor : 0;
            for (size_t k = 0; k < n; k++)
                sum += map[k][i] * map[n + k][j] - map[n + k][i] * map[k][j];
            most = fmax(most, fabs(sum));
        }
    return most;
}

START_TEST(the_form_shrinks) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const double level = 2e-11;
    if (refuses(scheme))
        return;
    for (const problem *const *b = problems; *b; b++) {
        if (!fits(scheme, *b))
            continue;
        nevh_claim claim = nevh_integrator_symplectic(scheme);
        double h = claim == NEVH_NO ? 0.5 : 0.1;
        h = *b == &double_pendulum ? h / 2 : h;
        nevh_system *s = damped(*b, equal);
        nevh_stepper *m = planned(s, *b, scheme, nevh_exact);
        double found = conformal_defect(m, *b, h, exp(-equal[0] * h));
        if (claim == NEVH_YES)
            ck_assert_msg(found < level, "%s on %s: %.2e",
                          nevh_integrator_name(scheme), (*b)->name, found);
        if (claim == NEVH_NO)
            ck_assert_msg(found > 3 * level, "%s on %s: %.2e",
                          nevh_integrator_name(scheme), (*b)->name, found);
        nevh_stepper_free(m);
        nevh_system_free(s);
    }
}
END_TEST

START_TEST(unequal_rates_do_not) {
    nevh_system *s = damped(&henon_heiles, unequal);
    nevh_stepper *m = planned(s, &henon_heiles, nevh_verlet, nevh_exact);
    for (int i = 0; i < 2; i++)
        ck_assert_double_gt(
            conformal_defect(m, &henon_heiles, 0.1, exp(-unequal[i] * 0.1)),
            1e-3);
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

START_TEST(symmetric_schemes_return) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    nevh_claim claim = nevh_integrator_symmetric(scheme);
    if (!splits(scheme) || (claim != NEVH_YES && claim != NEVH_DOUBLED))
        return;
    nevh_system *s = damped(b, unequal);
    nevh_stepper *m = planned(s, b, scheme, nevh_exact);
    double found;
    ck_assert_int_eq(
        nevh_reversal_defect(m, b->t0, 0.02, 300, b->q, b->p, NULL, &found),
        NEVH_OK);
    ck_assert_msg(found < 1e-12, "%s on %s: %.2e", nevh_integrator_name(scheme),
                  b->name, found);
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

/* Memory that friction has outdated would show: as an orbit other than that of
   a stepper that begins afresh each time.  A second copy of the state is more
   than memory; there the order shows it. */
START_TEST(memory_is_a_help_only) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    enum { STEPS = 200 };
    if (refuses(scheme) || nevh_integrator_symplectic(scheme) == NEVH_DOUBLED)
        return;
    nevh_system *s = damped(b, unequal);
    nevh_stepper *kept = planned(s, b, scheme, nevh_exact);
    nevh_stepper *fresh = planned(s, b, scheme, nevh_exact);
    state x = start(b), y = x;
    for (int i = 0; i < STEPS; i++) {
        double t = b->t0 + i * 0.01;
        ck_assert_int_eq(nevh_stepper_apply(kept, t, 0.01, x.q, x.p), 0);
        nevh_stepper_reset(fresh);
        ck_assert_int_eq(nevh_stepper_apply(fresh, t, 0.01, y.q, y.p), 0);
    }
    double found = distance(b, &x, &y);
    ck_assert_msg(found <= STEPS * 16 * DBL_EPSILON, "%s on %s: %.2e",
                  nevh_integrator_name(scheme), b->name, found);
    nevh_stepper_free(kept);
    nevh_stepper_free(fresh);
    nevh_system_free(s);
}
END_TEST

/* All that holds of steppers holds with friction. */

START_TEST(memory_can_be_kept) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    const double h = 0.0078125, t1 = 40 * h;
    if (refuses(scheme))
        return;
    nevh_system *s = damped(b, unequal);
    nevh_stepper *first = planned(s, b, scheme, nevh_central4);
    nevh_stepper *other = planned(s, b, scheme, nevh_central4);
    state x = start(b);
    for (int i = 0; i < 40; i++)
        nevh_stepper_apply(first, i * h, h, x.q, x.p);
    state y = x, z = x, branch = x;
    size_t size = nevh_stepper_save_size(first);
    void *buffer = malloc(size);
    nevh_stepper_save(first, buffer);
    nevh_stepper *copy = nevh_stepper_copy(first), *more;
    more = nevh_stepper_copy(first);
    nevh_run(copy, t1, h / 3, 5, branch.q, branch.p, NULL, 0);
    nevh_run(first, t1, h, 40, x.q, x.p, NULL, 0);
    ck_assert_int_eq(nevh_stepper_load(other, buffer, size), NEVH_OK);
    nevh_run(other, t1, h, 40, y.q, y.p, NULL, 0);
    ck_assert(same(b, &x, &y));
    nevh_run(more, t1, h, 40, z.q, z.p, NULL, 0);
    ck_assert(same(b, &x, &z));
    nevh_stepper_reset(other);
    z = start(b);
    nevh_run(other, 0, h, 80, z.q, z.p, NULL, 0);
    ck_assert(same(b, &x, &z));
    if (splits(scheme)) {
        nevh_system_enable(s, "drag", false);
        nevh_stepper *plain = planned(s, b, scheme, nevh_central4);
        ck_assert_int_eq(nevh_stepper_load(plain, buffer, size), NEVH_EINVAL);
        nevh_stepper_free(plain);
    }
    free(buffer);
    nevh_stepper_free(first);
    nevh_stepper_free(other);
    nevh_stepper_free(copy);
    nevh_stepper_free(more);
    nevh_system_free(s);
}
END_TEST

/* Lane 1 of three is the orbit that runs alone, also beside one that jumps. */
START_TEST(lanes_are_alone) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    enum { WIDTH = 3 };
    if (refuses(scheme))
        return;
    nevh_system *s = damped(b, unequal);
    nevh_options o = {.gradient_step = 0x1p-9, .width = WIDTH};
    nevh_stepper *three = nevh_stepper_new(s, scheme, &o);
    o.width = 1;
    nevh_stepper *one = nevh_stepper_new(s, scheme, &o);
    double q[MOST_DOF * WIDTH], p[MOST_DOF * WIDTH];
    for (size_t i = 0; i < b->n * WIDTH; i++) {
        q[i] = b->q[i / WIDTH] * (1 + 0.3 * ((double)(i % WIDTH) - 1));
        p[i] = b->p[i / WIDTH] * (1 - 0.4 * ((double)(i % WIDTH) - 1));
    }
    state x = start(b);
    for (int i = 0; i < 40; i++) {
        double t = b->t0 + 0.02 * i;
        q[2] += i == 20 ? 0.125 : 0;
        ck_assert_int_eq(nevh_stepper_apply(three, t, 0.02, q, p), NEVH_OK);
        ck_assert_int_eq(nevh_stepper_apply(one, t, 0.02, x.q, x.p), NEVH_OK);
    }
    for (size_t k = 0; k < b->n; k++) {
        ck_assert(q[k * WIDTH + 1] == x.q[k]);
        ck_assert(p[k * WIDTH + 1] == x.p[k]);
    }
    nevh_stepper_free(three);
    nevh_stepper_free(one);
    nevh_system_free(s);
}
END_TEST

static int look(void *data, size_t step, double t, const double q[],
                const double p[]) {
    (void)data, (void)step, (void)t, (void)q, (void)p;
    return 0;
}

START_TEST(watching_changes_nothing) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    const double h = 0.0078125;
    if (refuses(scheme))
        return;
    nevh_system *s = damped(b, unequal);
    nevh_stepper *m = planned(s, b, scheme, nevh_central4);
    nevh_observer watch = {look, NULL, 1};
    state x = start(b), y = x, z = x;
    nevh_run(m, 0, h, 60, x.q, x.p, NULL, 0);
    nevh_stepper_reset(m);
    nevh_run(m, 0, h, 60, y.q, y.p, &watch, 1);
    ck_assert(same(b, &x, &y));
    nevh_stepper_reset(m);
    for (int i = 0; i < 60; i++)
        nevh_stepper_apply(m, i * h, h, z.q, z.p);
    ck_assert(same(b, &x, &z));
    nevh_stepper_free(m);
    nevh_system_free(s);
}
END_TEST

/* H that is not finite at its k-th evaluation. */
typedef struct {
    size_t calls, fault;
} fuse;

static double fused(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    fuse *f = *(fuse *const *)params;
    (void)t, (void)p, (void)c;
    return ++f->calls == f->fault ? NAN : -1.7 * cos(q[0]);
}

enum { FUSED_STEPS = 8 };

/* Steps that fail are taken again; returns how many did. */
static int run_fused(const nevh_integrator *scheme, fuse *f,
                     double z[FUSED_STEPS + 1][2]) {
    const double mass = 1.3, rate = 0.4;
    int failures = 0;
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .nc = 1,
                                    .c = &mass,
                                    .value = mass_kinetic});
    nevh_system_add(
        s, &(nevh_term){
               .effect = "gravity", .nq = 1, .value = fused, .params = &f});
    nevh_system_add_friction(s, "drag", &rate);
    nevh_options o = {.gradient_step = 0x1p-10};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    for (int i = 0; i < FUSED_STEPS; i++) {
        double x[2] = {z[i][0], z[i][1]};
        int status = nevh_stepper_apply(m, 0.1 * i, 0.1, x, x + 1);
        if (status) {
            failures++;
            ck_assert_mem_eq(x, z[i], sizeof x);
            status = nevh_stepper_apply(m, 0.1 * i, 0.1, x, x + 1);
        }
        ck_assert_int_eq(status, NEVH_OK);
        memcpy(z[i + 1], x, sizeof x);
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
    return failures;
}

START_TEST(fails_at_any_evaluation) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    double clean[FUSED_STEPS + 1][2] = {{1.7, 0.4}};
    double failed[FUSED_STEPS + 1][2] = {{1.7, 0.4}};
    fuse f = {0, 0};
    if (refuses(scheme))
        return;
    ck_assert_int_eq(run_fused(scheme, &f, clean), 0);
    size_t calls = f.calls, stride = calls / 40 + 1;
    for (size_t k = 1; k <= calls; k += k < 20 ? 1 : stride) {
        f = (fuse){0, k};
        ck_assert_int_eq(run_fused(scheme, &f, failed), 1);
        ck_assert_msg(memcmp(clean, failed, sizeof clean) == 0,
                      "%s, fault %zu: another orbit",
                      nevh_integrator_name(scheme), k);
    }
}
END_TEST

/* Backwards friction drives; beyond the range of numbers a step fails. */
START_TEST(overflow_is_a_failure) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    const double strong[] = {500, 500};
    if (!splits(scheme))
        return;
    nevh_system *s = damped(b, strong);
    nevh_stepper *m = planned(s, b, scheme, nevh_exact);
    nevh_stepper *other = planned(s, b, scheme, nevh_exact);
    state x = start(b), y;
    nevh_stepper_apply(m, b->t0, 1e-3, x.q, x.p);
    y = x;
    nevh_stepper *copy = nevh_stepper_copy(m);
    ck_assert_int_eq(nevh_stepper_apply(m, b->t0 + 1e-3, -4, y.q, y.p),
                     NEVH_EDOM);
    assert_says(nevh_stepper_message(m), "friction");
    ck_assert(same(b, &x, &y));
    nevh_stepper_apply(m, b->t0 + 1e-3, 1e-3, x.q, x.p);
    nevh_stepper_apply(copy, b->t0 + 1e-3, 1e-3, y.q, y.p);
    ck_assert(same(b, &x, &y));
    nevh_stepper_free(copy);
    nevh_stepper_free(m);
    nevh_stepper_free(other);
    nevh_system_free(s);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("friction");
    TCase *cases = tcase_create("friction");
    int count = scheme_count();
    tcase_add_test(cases, rates_add_up);
    tcase_add_test(cases, an_effect_of_both_kinds);
    tcase_add_test(cases, bad_rates);
    tcase_add_test(cases, changes_are_noticed);
    tcase_add_loop_test(cases, order_to_expect, 0, count);
    tcase_add_test(cases, own_times_are_refused);
    tcase_add_test(cases, memory_is_damped_with_p);
    tcase_add_test(cases, a_kernel_takes_the_rates);
    tcase_add_loop_test(cases, none_leaves_no_trace, 0, count);
    tcase_add_loop_test(cases, decay_is_exact, 0, count);
    tcase_add_loop_test(cases, order_of_scheme, 0, count);
    tcase_add_test(cases, independent_reference);
    tcase_add_loop_test(cases, the_form_shrinks, 0, count);
    tcase_add_test(cases, unequal_rates_do_not);
    tcase_add_loop_test(cases, symmetric_schemes_return, 0, count);
    tcase_add_loop_test(cases, memory_is_a_help_only, 0, count);
    tcase_add_loop_test(cases, memory_can_be_kept, 0, count);
    tcase_add_loop_test(cases, lanes_are_alone, 0, count);
    tcase_add_loop_test(cases, watching_changes_nothing, 0, count);
    tcase_add_loop_test(cases, fails_at_any_evaluation, 0, count);
    tcase_add_loop_test(cases, overflow_is_a_failure, 0, count);
    suite_add_tcase(suite, cases);
    return run_suite(suite);
}
