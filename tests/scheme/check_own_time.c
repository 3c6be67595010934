/* nevh tests: what own time asks of a plan, of memory and of failures.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "state.h"
#include <math.h>
#include <nevh/transform.h>
#include <stdlib.h>
#include <string.h>

static nevh_stepper *under(const nevh_system *h, const nevh_system *s,
                           const nevh_integrator *scheme) {
    nevh_options o = {
        .gradient = nevh_exact, .q = kepler.q, .p = kepler.p, .transform = s};
    return nevh_stepper_new(h, scheme, &o);
}

/* An s that is one function of q, with exact gradient or without. */
static nevh_system *with(nevh_term_fn value, bool time) {
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(
        s, &(nevh_term){.effect = "s", .nq = 2, .time = time, .value = value});
    return s;
}

static double one(double t, const double q[], const double p[],
                  const double c[], const void *params) {
    (void)t, (void)q, (void)p, (void)c, (void)params;
    return 1;
}

static void assert_refused(const nevh_system *h, const nevh_system *s,
                           const nevh_integrator *scheme, int status,
                           const char *word) {
    nevh_stepper *m = under(h, s, scheme);
    state z = start(&kepler), before = z;
    ck_assert_msg(nevh_stepper_status(m) == status, "%s: %d",
                  nevh_integrator_name(scheme), nevh_stepper_status(m));
    assert_says(nevh_stepper_message(m), word);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z.q, z.p), status);
    ck_assert_int_eq(nevh_run_until(m, 0, 0.1, 1, z.q, z.p, NULL, 0), status);
    ck_assert_mem_eq(&z, &before, sizeof z);
    nevh_stepper_free(m);
}

/* Each scheme either takes a transform or says why not. */
TEST_EACH(schemes_take_it_or_refuse, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    nevh_system *h = kepler.make(), *s = nevh_distance_power(2, 2, 1.5);
    if (nevh_integrator_own_time(scheme) || !nevh_integrator_needs(scheme)) {
        nevh_stepper *m = under(h, s, scheme);
        if (nevh_stepper_status(m)) {
            ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
            assert_says(nevh_stepper_message(m), "cannot take");
            ck_assert(nevh_integrator_symplectic(scheme) != NEVH_YES);
        } else {
            state z = start(&kepler);
            ck_assert_msg(nevh_stepper_apply(m, 0, 0.01, z.q, z.p) == NEVH_OK,
                          "%s", nevh_stepper_message(m));
            double t = nevh_stepper_time(m);
            ck_assert_int_eq(nevh_stepper_apply(m, t, 0.01, z.q, z.p), 0);
            ck_assert(nevh_stepper_time(m) > t);
            ck_assert(nevh_stepper_time(m) != 0.02);
        }
        nevh_stepper_free(m);
    } else
        assert_refused(h, s, scheme, NEVH_ESTRUCT, "midpoint");
    nevh_system_free(h);
    nevh_system_free(s);
}

static double whole_kepler(double t, const double q[], const double p[],
                           const void *params) {
    (void)params;
    return (p[0] * p[0] + p[1] * p[1]) / 2 - 1.3 / hypot(q[0], q[1]) +
           (q[0] > 100 ? t : 0);
}
static double shaken_kepler(double t, const double q[], const double p[],
                            const void *params) {
    return whole_kepler(t, q, p, params) + 1e-6 * q[0] * sin(t);
}

/* One function might read the time; whether it does, is found out. */
TEST(whole_functions) {
    nevh_system *h = nevh_system_from(2, whole_kepler, NULL);
    nevh_system *shaken = nevh_system_from(2, shaken_kepler, NULL);
    nevh_system *s = nevh_distance_power(2, 2, 1.5);
    nevh_options o = {.q = kepler.q, .p = kepler.p, .transform = s};
    nevh_stepper *m = nevh_stepper_new(h, nevh_gauss4, &o);
    ck_assert_str_eq(nevh_stepper_message(m), "");
    nevh_stepper_free(m);
    m = nevh_stepper_new(shaken, nevh_gauss4, &o);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
    assert_says(nevh_stepper_message(m), "depends on time");
    nevh_stepper_free(m);
    nevh_system_free(h);
    nevh_system_free(shaken);
    nevh_system_free(s);
}

TEST(refused_transforms) {
    nevh_system *h = kepler.make(), *driven = driven_pendulum.make();
    nevh_system *other = nevh_distance_power(3, 2, 1);
    nevh_system *small = nevh_distance_power(1, 1, 1);
    nevh_system *broken = nevh_distance_power(2, 3, 1);
    nevh_system *timed = with(one, true);
    const nevh_integrator *schemes[] = {nevh_gauss4, nevh_adaptive_verlet,
                                        nevh_naive_adaptive_verlet};
    for (int i = 0; i < 3; i++) {
        assert_refused(h, other, schemes[i], NEVH_EINVAL, "3 degrees");
        assert_refused(h, broken, schemes[i], NEVH_EINVAL, "3 of q");
        assert_refused(h, timed, schemes[i], NEVH_EINVAL, "time");
    }
    assert_refused(driven, small, nevh_gauss4, NEVH_ESTRUCT, "time");
    nevh_options wide = {.transform = other, .width = 2};
    nevh_stepper *m = nevh_stepper_new(h, nevh_gauss4, &wide);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
    assert_says(nevh_stepper_message(m), "one orbit");
    nevh_stepper_free(m);
    nevh_system_free(h);
    nevh_system_free(driven);
    nevh_system_free(other);
    nevh_system_free(small);
    nevh_system_free(broken);
    nevh_system_free(timed);
}

/* A wrong gradient of s is noticed as one of H is. */
static void wrong_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    (void)t, (void)q, (void)p, (void)c, (void)params, (void)dp;
    for (size_t i = 0; dq && i < 2 * width; i++)
        dq[i] = 1;
}

TEST(wrong_gradient_of_s) {
    nevh_system *h = kepler.make(), *s = nevh_system_new(2);
    nevh_system_add(s, &(nevh_term){.effect = "s",
                                    .nq = 2,
                                    .value = one,
                                    .gradient = wrong_gradient});
    assert_refused(h, s, nevh_gauss4, NEVH_ENOGRAD, "wrong");
    nevh_system_free(h);
    nevh_system_free(s);
}

/* Functions that are no s: at the start, or later. */
static double no_good(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return q[0] - 0.7;
}
static double negative_later(double t, const double q[], const double p[],
                             const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return q[0] + 0.2;
}
static double undefined_later(double t, const double q[], const double p[],
                              const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return sqrt(q[0] + 0.2) + 0.1;
}
static double infinite(double t, const double q[], const double p[],
                       const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return 1 / (q[0] - 0.7);
}
/* 1 where the orbit begins, and larger than all numbers soon after. */
static double explosive(double t, const double q[], const double p[],
                        const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return 1e-200 * pow(1e10, 4e3 * fabs(q[0] - 0.7));
}

typedef struct {
    nevh_term_fn s;
    const char *word;
    bool at_once;
} bad;
static const bad bads[] = {{no_good, "positive", true},
                           {negative_later, "", false},
                           {undefined_later, "nan", false},
                           {infinite, "inf", true},
                           {explosive, "", false}};
enum { BADS = sizeof bads / sizeof *bads };

/* The state is the last good one, and the memory goes with it. */
TEST_EACH(s_that_ends, 5 * BADS) {
    const nevh_integrator *schemes[] = {
        nevh_gauss4, nevh_rk4, nevh_adaptive_verlet, nevh_naive_adaptive_verlet,
        nevh_midpoint};
    const nevh_integrator *scheme = schemes[_i / BADS];
    const bad *b = &bads[_i % BADS];
    nevh_system *h = kepler.make(), *s = with(b->s, false);
    nevh_options o = {.gradient_step = 1e-3,
                      .q = (const double[]){0.9, 0.3},
                      .p = kepler.p,
                      .transform = s};
    nevh_stepper *m = nevh_stepper_new(h, scheme, &o);
    nevh_stepper *again = nevh_stepper_new(h, scheme, &o);
    ck_assert_msg(nevh_stepper_status(m) == NEVH_OK, "%s",
                  nevh_stepper_message(m));
    state z = start(&kepler), y = z;
    int status = nevh_run_until(m, 0, 0.02, 50, z.q, z.p, NULL, 0);
    ck_assert_msg(status == NEVH_EDOM || status == NEVH_EMAXITER, "%d", status);
    assert_says(nevh_stepper_message(m),
                status == NEVH_EDOM && _i / BADS != 2 ? b->word : "");
    ck_assert(strlen(nevh_stepper_message(m)) > 20);
    size_t taken = nevh_stepper_taken(m);
    ck_assert(b->at_once ? taken == 0 : taken > 0 || b->s == explosive);
    nevh_run(again, 0, 0.02, taken, y.q, y.p, NULL, 0);
    ck_assert_mem_eq(&z, &y, sizeof z);
    ck_assert(isfinite(nevh_stepper_time(m)));
    nevh_stepper_free(m);
    nevh_stepper_free(again);
    nevh_system_free(h);
    nevh_system_free(s);
}

/* A change of s after planning is noticed, also by a copy made later. */
TEST_EACH(stale_transforms, 2) {
    const nevh_integrator *schemes[] = {nevh_gauss4, nevh_adaptive_verlet};
    nevh_system *h = kepler.make(), *s = nevh_distance_power(2, 2, 1.5);
    nevh_stepper *m = under(h, s, schemes[_i]);
    state z = start(&kepler), before;
    nevh_run(m, 0, 0.02, 5, z.q, z.p, NULL, 0);
    before = z;
    nevh_system_add(s, &(nevh_term){.effect = "more", .nq = 2, .value = one});
    nevh_stepper *copy = nevh_stepper_copy(m);
    for (int i = 0; i < 2; i++) {
        nevh_stepper *c = i ? copy : m;
        double t = nevh_stepper_time(c);
        ck_assert_int_eq(nevh_stepper_apply(c, t, 0.02, z.q, z.p), NEVH_ESTALE);
        assert_says(nevh_stepper_message(c), "transform");
        ck_assert_mem_eq(&z, &before, sizeof z);
        nevh_stepper_free(c);
    }
    nevh_system_free(h);
    nevh_system_free(s);
}

/* Schemes of own time on Kepler's problem: under a transform, and by nature. */
enum { RUNS = 8 };
static const nevh_integrator *run_scheme(int i) {
    const nevh_integrator *schemes[] = {
        nevh_midpoint,        nevh_gauss4,
        nevh_gauss8,          nevh_rk4,
        nevh_adaptive_verlet, nevh_naive_adaptive_verlet,
        nevh_adaptive_verlet, nevh_naive_adaptive_verlet};
    return schemes[i];
}
static nevh_system *run_s(int i) {
    return i < 6 ? nevh_distance_power(2, 2, 1.5) : NULL;
}

typedef struct {
    size_t count;
    double t[200];
    state z[200];
} album;

static int record(void *data, size_t step, double t, const double q[],
                  const double p[]) {
    album *a = data;
    (void)step;
    a->t[a->count] = t;
    memcpy(a->z[a->count].q, q, sizeof a->z->q);
    memcpy(a->z[a->count++].p, p, sizeof a->z->p);
    return 0;
}

static void assert_same(const nevh_stepper *a, const nevh_stepper *b,
                        const state *x, const state *y) {
    size_t size = nevh_stepper_save_size(a);
    char *one_memory = malloc(size), *other = malloc(size);
    ck_assert_mem_eq(x, y, sizeof *x);
    ck_assert(nevh_stepper_time(a) == nevh_stepper_time(b));
    nevh_stepper_save(a, one_memory);
    nevh_stepper_save(b, other);
    ck_assert_mem_eq(one_memory, other, size);
    free(one_memory);
    free(other);
}

/* In one piece, watched; in pieces, with a copy, and from a saved memory. */
TEST_EACH(memory_can_be_kept, RUNS) {
    nevh_system *h = kepler.make(), *s = run_s(_i);
    nevh_stepper *m[3];
    state z[3];
    for (int i = 0; i < 3; i++) {
        m[i] = under(h, s, run_scheme(_i));
        z[i] = start(&kepler);
    }
    album shown = {0};
    nevh_observer watch = {record, &shown, 1};
    nevh_run(m[0], 0.1, 0.03, 100, z[0].q, z[0].p, &watch, 1);
    nevh_run(m[1], 0.1, 0.03, 100, z[1].q, z[1].p, NULL, 0);
    assert_same(m[0], m[1], &z[0], &z[1]);
    nevh_run(m[2], 0.1, 0.03, 60, z[2].q, z[2].p, NULL, 0);
    double t = nevh_stepper_time(m[2]);
    ck_assert(t == shown.t[60]);
    nevh_stepper *copy = nevh_stepper_copy(m[2]);
    size_t size = nevh_stepper_save_size(m[2]);
    void *buffer = malloc(size);
    nevh_stepper_save(m[2], buffer);
    ck_assert_int_eq(nevh_stepper_load(m[1], buffer, size), NEVH_OK);
    state x = z[2], y = z[2];
    nevh_run(m[2], t, 0.03, 40, z[2].q, z[2].p, NULL, 0);
    assert_same(m[0], m[2], &z[0], &z[2]);
    nevh_run(copy, t, 0.03, 40, x.q, x.p, NULL, 0);
    assert_same(m[0], copy, &z[0], &x);
    for (int i = 0; i < 40; i++)
        nevh_stepper_apply(m[1], nevh_stepper_time(m[1]), 0.03, y.q, y.p);
    assert_same(m[0], m[1], &z[0], &y);
    for (int i = 0; i < 3; i++)
        nevh_stepper_free(m[i]);
    nevh_stepper_free(copy);
    free(buffer);
    nevh_system_free(h);
    nevh_system_free(s);
}

/* After a jump, or a reset, H0 and s0 are those of the new start. */
TEST_EACH(a_new_start, RUNS) {
    nevh_system *h = kepler.make(), *s = run_s(_i);
    nevh_stepper *used = under(h, s, run_scheme(_i));
    nevh_stepper *fresh = under(h, s, run_scheme(_i));
    state x = start(&kepler), y;
    nevh_run(used, 0, 0.03, 30, x.q, x.p, NULL, 0);
    double t = nevh_stepper_time(used);
    x.p[1] *= 1.0625;
    y = x;
    nevh_run(used, t, 0.03, 30, x.q, x.p, NULL, 0);
    nevh_run(fresh, t, 0.03, 30, y.q, y.p, NULL, 0);
    assert_same(used, fresh, &x, &y);
    nevh_stepper_reset(used);
    t = nevh_stepper_time(used);
    nevh_run(used, t, 0.03, 30, x.q, x.p, NULL, 0);
    nevh_stepper *third = under(h, s, run_scheme(_i));
    nevh_run(third, t, 0.03, 30, y.q, y.p, NULL, 0);
    assert_same(used, third, &x, &y);
    nevh_stepper_free(used);
    nevh_stepper_free(fresh);
    nevh_stepper_free(third);
    nevh_system_free(h);
    nevh_system_free(s);
}

/* Steps of 1e-3 that start at 1e6: compensated, so that the time is the sum of
   what the steps take. */
TEST_EACH(time_adds_up, RUNS) {
    nevh_system *h = kepler.make(), *s = run_s(_i);
    nevh_stepper *near = under(h, s, run_scheme(_i));
    nevh_stepper *late = under(h, s, run_scheme(_i));
    state x = start(&kepler), y = x;
    nevh_run(near, 0, 1e-3, 2000, x.q, x.p, NULL, 0);
    nevh_run(late, 0x1p20, 1e-3, 2000, y.q, y.p, NULL, 0);
    ck_assert_mem_eq(&x, &y, sizeof x);
    ck_assert(nevh_stepper_time(late) == 0x1p20 + nevh_stepper_time(near));
    nevh_stepper_free(near);
    nevh_stepper_free(late);
    nevh_system_free(h);
    nevh_system_free(s);
}

/* |f|^(-3/4) over the scales below; |f| as if it were no less than a tenth of
   that at the start. */
static double own_s(const state *z, double unit) {
    double r = hypot(z->q[0], z->q[1]), force = 1.3 / (r * r) / 1.6;
    double speed = hypot(z->p[0] / 1.3, z->p[1] / 2.1) / 0.7;
    return pow(hypot(hypot(force, speed), unit / 10), -0.75);
}

/* Steps stay as long as s says, to a thousandth, wherever the orbit turns. */
TEST_EACH(steps_follow_s, 2) {
    static const double scale[] = {0.7, 0.1, 0.1, 1.6};
    nevh_system *h = kepler.make();
    nevh_system *s = _i ? nevh_distance_power(2, 2, 1.5) : NULL;
    nevh_options o = {.gradient = nevh_exact,
                      .q = kepler.q,
                      .p = kepler.p,
                      .scale = scale,
                      .transform = s};
    nevh_stepper *m = nevh_stepper_new(h, nevh_adaptive_verlet, &o);
    state z = start(&kepler), before;
    double unit = pow(own_s(&z, 0), -4 / 3.0), at_start = own_s(&z, unit);
    double r0 = hypot(z.q[0], z.q[1]), t = 0;
    const double step = 0.002;
    for (int i = 0; i < 4000; i++) {
        before = z;
        ck_assert_int_eq(nevh_stepper_apply(m, t, step, z.q, z.p), NEVH_OK);
        double taken = (nevh_stepper_time(m) - t) / step, expected;
        double x = (z.q[0] + before.q[0]) / 2, y = (z.q[1] + before.q[1]) / 2;
        expected = (own_s(&z, unit) + own_s(&before, unit)) / 2 / at_start;
        if (s)
            expected = pow(hypot(x, y) / r0, 1.5);
        ck_assert_double_eq_tol(taken / expected, 1, 1e-3);
        t = nevh_stepper_time(m);
    }
    nevh_stepper_free(m);
    nevh_system_free(h);
    nevh_system_free(s);
}
