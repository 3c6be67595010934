/* nevh tests: steps that adapt to a tolerance, where one step is a long way or the
   orbit ends.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "adaptive.h"
#include <math.h>
#include <string.h>

/* A first substep of all h would be far beyond numbers. */
TEST_EACH(h_is_not_the_first_substep, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    nevh_system *s = nevh_system_from(1, steep, NULL);
    nevh_options o = {.tolerance = 1e-9};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    double q[] = {0.3}, p[] = {1.2}, t = 0, before, after;
    nevh_field *f = nevh_stepper_field(m);
    ck_assert_int_eq(nevh_field_value(f, 1, &t, q, p, &before), NEVH_OK);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 1000, q, p), NEVH_OK);
    ck_assert_int_eq(nevh_field_value(f, 1, &t, q, p, &after), NEVH_OK);
    ck_assert_double_eq_tol(after, before, 1e-4);
    ck_assert(q[0] != 0.3);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* A million time units are no many substeps where nothing happens fast. */
TEST_EACH(a_long_way, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    nevh_system *s = make_orbit_in(1, 1, 0x1p15);
    nevh_options o = {.gradient = nevh_exact, .tolerance = 1e-7};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    double q[] = {0.4, 0}, p[] = {0, 4.2 * 0x1p-15};
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 1e6, q, p), NEVH_OK);
    ck_assert_uint_lt(nevh_stepper_counts(m).gradients, 5000);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

static void assert_usual_step(nevh_stepper *used, const nevh_system *s,
                              const nevh_integrator *scheme, double tolerance) {
    nevh_stepper *fresh = stepper_of(s, &ellipse, scheme, tolerance);
    double q[] = {0.4, 0}, p[] = {0, 4.2}, x[] = {0.4, 0}, y[] = {0, 4.2};
    ck_assert_int_eq(nevh_stepper_apply(used, 0, 2, q, p), NEVH_OK);
    ck_assert_int_eq(nevh_stepper_apply(fresh, 0, 2, x, y), NEVH_OK);
    ck_assert_mem_eq(q, x, sizeof q);
    ck_assert_mem_eq(p, y, sizeof p);
    nevh_stepper_free(fresh);
}

static void go_too_far(const nevh_integrator *scheme, double h,
                       const char *word) {
    nevh_system *s = ellipse.make();
    nevh_stepper *m = stepper_of(s, &ellipse, scheme, 1e-7);
    double q[] = {0.4, 0}, p[] = {0, 4.2};
    ck_assert_int_eq(nevh_stepper_apply(m, 0, h, q, p), NEVH_EFAILED);
    assert_says(nevh_stepper_message(m), nevh_integrator_name(scheme));
    assert_says(nevh_stepper_message(m), word);
    ck_assert(q[0] == 0.4 && q[1] == 0 && p[0] == 0 && p[1] == 4.2);
    assert_usual_step(m, s, scheme, 1e-7);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST_EACH(a_way_too_long, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    go_too_far(scheme, 1e30, "gave up");
}

TEST_TAGGED(too_many_substeps, "slow", 0, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    go_too_far(scheme, -1e8, "gave up");
}

TEST(the_budget_is_named) {
    go_too_far(nevh_dopri5, 1e30, "too short");
    go_too_far(nevh_dopri5, 1e8, "million");
}

/* Ends at q = 2, where the orbit goes. */
static double edge(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return sqrt(2 - q[0]);
}

TEST_EACH(an_end_of_the_domain, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    nevh_system *s = cliff(edge);
    nevh_options o = {.gradient_step = 0x1p-14, .tolerance = 1e-6};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    double q = 1, p = 0.5, x = 1, y = 0.5;
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.5, &q, &p), NEVH_OK);
    double before[] = {q, p};
    ck_assert_int_eq(nevh_stepper_apply(m, 0.5, 5, &q, &p), NEVH_EDOM);
    assert_says(nevh_stepper_message(m), "cliff");
    ck_assert(q == before[0] && p == before[1]);
    ck_assert_int_eq(nevh_stepper_apply(m, 0.5, 0.25, &q, &p), NEVH_OK);
    nevh_stepper_reset(m);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.5, &x, &y), NEVH_OK);
    ck_assert_int_eq(nevh_stepper_apply(m, 0.5, 0.25, &x, &y), NEVH_OK);
    ck_assert(x == q && y == p);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Trials that leave the domain are taken back. */
TEST_EACH(walls_are_not_run_through, 2) {
    const nevh_integrator *scheme = _i ? nevh_dop853 : nevh_dopri5;
    nevh_system *s = cliff(walls);
    nevh_options o = {.gradient_step = 0x1p-20, .tolerance = 1e-5};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    double q = 0.2, p = 0.03, t = 0, before, after;
    nevh_field *f = nevh_stepper_field(m);
    ck_assert_int_eq(nevh_field_value(f, 1, &t, &q, &p, &before), NEVH_OK);
    ck_assert_msg(!nevh_stepper_apply(m, 0, 2000, &q, &p), "%s",
                  nevh_stepper_message(m));
    ck_assert_int_eq(nevh_field_value(f, 1, &t, &q, &p, &after), NEVH_OK);
    ck_assert_double_eq_tol(after, before, 1e-5);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* x'' = 6 x^2, x = 1/(1 - t)^2: gone at t = 1, up to which the substeps shrink
   as long as times tell them apart. */
static double fleeing(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)c, (void)params;
    return p[0] * p[0] / 2 - 2 * q[0] * q[0] * q[0];
}

static void fleeing_gradient(size_t width, const double t[], const double q[],
                             const double p[], const double c[],
                             const void *params, double dq[], double dp[]) {
    (void)t, (void)c, (void)params;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = -6 * q[i] * q[i];
    for (size_t i = 0; dp && i < width; i++)
        dp[i] = p[i];
}

TEST_EACH(orbits_that_end_in_time, 20) {
    const nevh_integrator *scheme = _i % 2 ? nevh_dop853 : nevh_dopri5;
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "H",
                                    .nq = 1,
                                    .np = 1,
                                    .value = fleeing,
                                    .gradient = fleeing_gradient});
    double x = 1, y = 2, h = 1.05 + 0.1 * (_i / 2);
    nevh_options o = {
        .gradient = nevh_exact, .q = &x, .p = &y, .tolerance = 1e-9};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    int status = nevh_stepper_apply(m, 0, h, &x, &y);
    ck_assert(status == NEVH_EFAILED || status == NEVH_EDOM);
    ck_assert(x == 1 && y == 2);
    ck_assert_uint_le(nevh_stepper_counts(m).gradients, 30000);
    nevh_stepper_free(m);
    nevh_system_free(s);
}
