/* nevh tests: schemes under a time transform.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include "run/stepper_private.h"
#include "work/transform_private.h"
#include <math.h>
#include <nevh/transform.h>
#include <stdlib.h>
#include <string.h>

/* A user's s of everything. */
static double bump(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    (void)t, (void)c, (void)params;
    return 1 / (0.4 + q[0] * q[0] + 0.5 * q[1] * q[1] +
                0.3 * (p[0] - q[1]) * (p[0] - q[1]) + 0.2 * p[1] * p[1]);
}

static void bump_gradient(size_t width, const double t[], const double q[],
                          const double p[], const double c[],
                          const void *params, double dq[], double dp[]) {
    for (size_t i = 0; i < width; i++) {
        double x = q[i], y = q[width + i], u = p[i], v = p[width + i];
        double s = bump(0, (double[]){x, y}, (double[]){u, v}, c, params);
        if (dq)
            dq[i] = -s * s * 2 * x;
        if (dq)
            dq[width + i] = -s * s * (y - 0.6 * (u - y));
        if (dp)
            dp[i] = -s * s * 0.6 * (u - y);
        if (dp)
            dp[width + i] = -s * s * 0.4 * v;
    }
    (void)t;
}

static nevh_system *with(nevh_term_fn value, nevh_block_gradient_fn gradient) {
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(s, &(nevh_term){.effect = "s",
                                    .nq = 2,
                                    .np = 2,
                                    .value = value,
                                    .gradient = gradient});
    return s;
}

/* Of q alone; of q and p, with and without exact gradient. */
enum { TRANSFORMS = 5 };
static nevh_system *transform(int i) {
    switch (i) {
    case 0:
        return nevh_distance_power(2, 2, 1.5);
    case 1:
        return nevh_distance_power(2, 2, 1);
    case 2:
        return nevh_closeness_power(2, 1, 1);
    case 3:
        return with(bump, bump_gradient);
    default:
        return with(bump, NULL);
    }
}

typedef struct {
    double q[2], p[2];
} state;

typedef struct {
    const problem *b;
    nevh_system *system, *s;
} setting;

static setting on(const problem *b, nevh_system *s) {
    return (setting){b, b->make(), s};
}

static void put_away(setting *a) {
    nevh_system_free(a->system);
    nevh_system_free(a->s);
}

static state start(const setting *a) {
    state z;
    memcpy(z.q, a->b->q, sizeof z.q);
    memcpy(z.p, a->b->p, sizeof z.p);
    return z;
}

static nevh_stepper *try_plan(const setting *a, const nevh_integrator *scheme,
                              const nevh_gradient *g) {
    nevh_options o = {
        .gradient = g, .q = a->b->q, .p = a->b->p, .transform = a->s};
    return nevh_stepper_new(a->system, scheme, &o);
}

static nevh_stepper *plan(const setting *a, const nevh_integrator *scheme,
                          const nevh_gradient *g) {
    nevh_stepper *m = try_plan(a, scheme, g);
    ck_assert_msg(nevh_stepper_status(m) == NEVH_OK, "%s",
                  nevh_stepper_message(m));
    return m;
}

/* K and its gradient, off the orbit. */
enum { POINTS = 9 };
typedef struct {
    double t[POINTS], q[2 * POINTS], p[2 * POINTS];
} points;

static points around(const setting *a) {
    points x = {{0}, {0}, {0}};
    for (size_t i = 0; i < 2 * POINTS; i++) {
        x.q[i] = a->b->q[i / POINTS] + 0.11 * sin(1 + 1.7 * (double)i);
        x.p[i] = a->b->p[i / POINTS] + 0.13 * cos(2 + 2.9 * (double)i);
    }
    return x;
}

/* By definition, at one of them. */
static double transformed(const setting *a, const points *x, size_t i) {
    nevh_field *h = nevh_field_new(a->system, NULL);
    nevh_field *s = nevh_field_new(a->s, NULL);
    double h0, h1, s0, s1, t = 0, q[] = {x->q[i], x->q[POINTS + i]},
                           p[] = {x->p[i], x->p[POINTS + i]};
    nevh_field_value(h, 1, &t, a->b->q, a->b->p, &h0);
    nevh_field_value(s, 1, &t, a->b->q, a->b->p, &s0);
    nevh_field_value(h, 1, &t, q, p, &h1);
    nevh_field_value(s, 1, &t, q, p, &s1);
    nevh_field_free(h);
    nevh_field_free(s);
    return s1 / s0 * (h1 - h0);
}

/* By differences of K's values, of order 4. */
static void differences(nevh_work *w, points *x, double *moved, double out[]) {
    const double d = 0x1p-9;
    static const double weights[] = {-1 / 12.0, 8 / 12.0, -8 / 12.0, 1 / 12.0};
    for (size_t i = 0; i < POINTS; i++)
        out[i] = 0;
    for (int j = 0; j < 4; j++) {
        double h[POINTS], move = (j < 2 ? 2 - j : 1 - j) * d;
        for (size_t i = 0; i < POINTS; i++)
            moved[i] += move;
        ck_assert_int_eq(nevh_work_value(w, POINTS, x->t, x->q, x->p, h), 0);
        for (size_t i = 0; i < POINTS; i++) {
            moved[i] -= move;
            out[i] += weights[j] * h[i] / d;
        }
    }
}

TEST_EACH(gradient_of_k, 3 * TRANSFORMS) {
    const problem *const of[] = {&kepler, &henon_heiles, &double_pendulum};
    setting a = on(of[_i / TRANSFORMS], transform(_i % TRANSFORMS));
    nevh_stepper *m = plan(&a, nevh_gauss8, nevh_exact);
    state z = start(&a);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.01, z.q, z.p), NEVH_OK);
    points x = around(&a);
    double k[POINTS], dq[2 * POINTS], dp[2 * POINTS], alone[2 * POINTS];
    nevh_work_value(&m->work, POINTS, x.t, x.q, x.p, k);
    for (size_t i = 0; i < POINTS; i++)
        ck_assert_double_eq_tol(k[i], transformed(&a, &x, i), 1e-13);
    ck_assert_double_gt(fabs(k[0]), 1e-3);
    nevh_work_gradient(&m->work, POINTS, x.t, x.q, x.p, dq, dp);
    nevh_work_gradient(&m->work, POINTS, x.t, x.q, x.p, alone, NULL);
    ck_assert_mem_eq(alone, dq, sizeof dq);
    nevh_work_gradient(&m->work, POINTS, x.t, x.q, x.p, NULL, alone);
    ck_assert_mem_eq(alone, dp, sizeof dp);
    for (size_t j = 0; j < 4; j++) {
        double found[POINTS], *exact = (j < 2 ? dq : dp) + j % 2 * POINTS;
        differences(&m->work, &x, (j < 2 ? x.q : x.p) + j % 2 * POINTS, found);
        for (size_t i = 0; i < POINTS; i++)
            ck_assert_msg(fabs(found[i] - exact[i]) <
                              1e-6 * (1 + fabs(exact[i])),
                          "variable %zu: %g, not %g", j, exact[i], found[i]);
    }
    nevh_stepper_free(m);
    put_away(&a);
}

/* More points than were planned are refused, not written. */
TEST(room_for_points) {
    setting a = on(&henon_heiles, transform(3));
    nevh_stepper *m = plan(&a, nevh_gauss8, nevh_exact);
    state z = start(&a);
    nevh_stepper_apply(m, 0, 0.01, z.q, z.p);
    double t[40] = {0}, q[80] = {0}, p[80] = {0}, h[40];
    ck_assert_int_eq(nevh_work_value(&m->work, 40, t, q, p, h), NEVH_EFAILED);
    assert_says(nevh_stepper_message(m), "points");
    nevh_stepper_free(m);
    put_away(&a);
}

static state state_at(const setting *a, const nevh_integrator *scheme, double h,
                      double t_end) {
    nevh_stepper *m = plan(a, scheme, nevh_exact);
    state z = start(a);
    if (nevh_run_until(m, 0, h, t_end, z.q, z.p, NULL, 0) != NEVH_OK)
        z.q[0] = INFINITY;
    nevh_stepper_free(m);
    return z;
}

static double distance(const state *x, const state *y) {
    double sum = 0;
    for (int k = 0; k < 2; k++)
        sum += pow(x->q[k] - y->q[k], 2) + pow(x->p[k] - y->p[k], 2);
    return sqrt(sum);
}

/* The root mean square of the state's error at a few times, none of which falls
   on a step: time and the way to it belong to what is measured. */
static double error_of(const setting *a, const state exact[],
                       const nevh_integrator *scheme, double h) {
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        state z = state_at(a, scheme, h, copysign(3.1 + 0.9 * i, h));
        sum += pow(distance(&z, &exact[i]), 2);
    }
    return sqrt(sum / 4);
}

/* Least squares through the points that are small and not yet rounding. */
static double slope_of(const setting *a, const nevh_integrator *scheme,
                       double sign) {
    enum { LEAST = 5 };
    int order = nevh_integrator_order(scheme);
    double small_error = order == 2 ? 2e-3 : order == 4 ? 2e-5 : 1e-7;
    state exact[4];
    setting plain = {a->b, a->system, NULL};
    for (int i = 0; i < 4; i++)
        exact[i] =
            state_at(&plain, nevh_gauss16, sign * 0.02, sign * (3.1 + 0.9 * i));
    double n = 0, mx = 0, my = 0, xx = 0, xy = 0;
    for (double h = 0.4; n < LEAST; h /= 1.25) {
        double error = error_of(a, exact, scheme, sign * h);
        ck_assert_double_gt(h, 1e-4);
        if (error > small_error)
            continue;
        double x = log(h), y = log(error);
        n++;
        mx += x, my += y, xx += x * x, xy += x * y;
    }
    return (xy - mx * my / n) / (xx - mx * mx / n);
}

static const nevh_integrator *scheme_at(int i) {
    const nevh_integrator *schemes[] = {nevh_midpoint, nevh_gauss4, nevh_gauss6,
                                        nevh_rk4};
    return schemes[i];
}

TEST_EACH(order_in_physical_time, 6 * 4) {
    static const struct {
        const problem *b;
        int s;
        double sign;
    } cases[] = {{&kepler, 0, 1},       {&kepler, 1, -1},
                 {&kepler, 4, 1},       {&henon_heiles, 3, -1},
                 {&henon_heiles, 4, 1}, {&double_pendulum, 3, 1}};
    const nevh_integrator *scheme = scheme_at(_i % 4);
    setting a = on(cases[_i / 4].b, transform(cases[_i / 4].s));
    double order = nevh_integrator_order(scheme);
    double slope = slope_of(&a, scheme, cases[_i / 4].sign);
    ck_assert_msg(fabs(slope - order) <= 0.05 * order,
                  "%s on %s, s %d: measured %.3f", nevh_integrator_name(scheme),
                  a.b->name, cases[_i / 4].s, slope);
    put_away(&a);
}

/* The map of K, H0 and s0 being those of one state. */
TEST_EACH(symplectic_and_symmetric, 8) {
    setting a = on(_i < 4 ? &kepler : &henon_heiles, transform(_i < 4 ? 0 : 3));
    const nevh_integrator *scheme = scheme_at(_i % 4);
    nevh_stepper *m = plan(&a, scheme, nevh_exact);
    double symplectic, back, q[] = {a.b->q[0], a.b->q[1]};
    bool claimed = nevh_integrator_symplectic(scheme) == NEVH_YES;
    ck_assert_int_eq(
        nevh_symplecticity_defect(m, 0, 0.2, q, a.b->p, NULL, &symplectic),
        NEVH_OK);
    ck_assert_msg(claimed ? symplectic < 1e-8 : symplectic > 1e-6, "%s: %g",
                  nevh_integrator_name(scheme), symplectic);
    ck_assert_int_eq(
        nevh_reversal_defect(m, 0, 0.1, 100, q, a.b->p, NULL, &back), NEVH_OK);
    ck_assert_msg(claimed ? back < 1e-12 : back > 1e-7, "%s: %g",
                  nevh_integrator_name(scheme), back);
    if (claimed)
        ck_assert_double_lt(fabs(nevh_stepper_time(m)), 1e-13);
    nevh_stepper_free(m);
    put_away(&a);
}

/* Reversible, and what the naive choice makes of it. */
TEST_EACH(own_steps_forth_and_back, 4) {
    setting a = on(&kepler, _i ? transform(_i) : NULL);
    double good, bad, t;
    nevh_stepper *m = plan(&a, nevh_adaptive_verlet, nevh_exact);
    nevh_reversal_defect(m, 0, 0.02, 200, a.b->q, a.b->p, NULL, &good);
    t = nevh_stepper_time(m);
    nevh_stepper_free(m);
    m = plan(&a, nevh_naive_adaptive_verlet, nevh_exact);
    nevh_reversal_defect(m, 0, 0.02, 200, a.b->q, a.b->p, NULL, &bad);
    ck_assert_msg(good < 1e-12 && bad > 1e-6, "%g, %g", good, bad);
    ck_assert_double_lt(fabs(t), 1e-13);
    nevh_stepper_free(m);
    put_away(&a);
}
