/* nevh tests: steps that adapt to a tolerance.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "adaptive.h"
#include "lanes.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double two_pi = 6.283185307179586;

typedef struct {
    double q[2], p[2];
    uint64_t gradients;
} orbit;

/* `steps` steps over `span`. */
static orbit travel(const problem *b, const nevh_integrator *scheme,
                    double tolerance, double span, size_t steps) {
    orbit z;
    nevh_system *s = b->make();
    nevh_stepper *m = stepper_of(s, b, scheme, tolerance);
    memcpy(z.q, b->q, sizeof z.q);
    memcpy(z.p, b->p, sizeof z.p);
    int status =
        nevh_run(m, b->t0, span / (double)steps, steps, z.q, z.p, NULL, 0);
    ck_assert_msg(!status, "%s", nevh_stepper_message(m));
    z.gradients = nevh_stepper_counts(m).gradients;
    nevh_stepper_free(m);
    nevh_system_free(s);
    return z;
}

static double distance(const orbit *x, const double q[], const double p[]) {
    double sum = 0;
    for (int k = 0; k < 2; k++)
        sum += (x->q[k] - q[k]) * (x->q[k] - q[k]) +
               (x->p[k] - p[k]) * (x->p[k] - p[k]);
    return sqrt(sum);
}

/* One step over all of span: the error is in proportion to the tolerance, and
   the work grows. */
static void assert_proportion(const problem *b, const nevh_integrator *scheme,
                              double span, const orbit *end, double most) {
    double tolerance[9], error[9];
    uint64_t work = 0;
    int count = 0;
    for (double x = 1e-4; x > 0.9e-12; x /= 10, count++) {
        orbit z = travel(b, scheme, x, span, 1);
        double off = distance(&z, end->q, end->p);
        tolerance[count] = log(x);
        error[count] = log(off);
        ck_assert_msg(off < most * x || off > 0.03, "%s on %s, %.0e: %.2e",
                      nevh_integrator_name(scheme), b->name, x, off);
        /* A higher order may take fewer steps under a stricter tolerance. */
        if (!nevh_integrator_needs_tolerance(scheme))
            ck_assert_uint_gt(z.gradients, work);
        work = z.gradients;
    }
    double found = slope_through(count - 2, tolerance + 2, error + 2);
    ck_assert_msg(found > 0.7 && found < 1.3, "%s on %s: %.2f",
                  nevh_integrator_name(scheme), b->name, found);
}

TEST_EACH(error_falls_with_the_tolerance, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    orbit end;
    memcpy(end.q, ellipse.q, sizeof end.q);
    memcpy(end.p, ellipse.p, sizeof end.p);
    assert_proportion(&ellipse, scheme, 10 * two_pi, &end,
                      nevh_integrator_needs_tolerance(scheme) ? 5e6 : 2e6);
    end = travel(&henon_heiles, nevh_gauss16, 0, 100, 2000);
    assert_proportion(&henon_heiles, scheme, 100, &end, 2e3);
}

/* Time is right in every stage of every substep. */
TEST_EACH(time_goes_with_the_substeps, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    const problem *b = &driven_pendulum;
    orbit end = travel(b, nevh_gauss16, 0, 10, 500);
    orbit z = travel(b, scheme, 1e-11, 10, 3);
    ck_assert_double_eq_tol(z.q[0], end.q[0], 3e-8);
    ck_assert_double_eq_tol(z.p[0], end.p[0], 3e-8);
}

/* A control of the same kind but without memory, written separately, takes
   7009 evaluations for errors of 1e-9 (1 + |y|). */
TEST(work_is_that_of_others) {
    orbit z = travel(&ellipse, nevh_dopri5, 1e-9, 10 * two_pi, 1);
    ck_assert(z.gradients > 6500 && z.gradients < 9000);
    ck_assert_uint_eq(z.gradients % 6,
                      1); /* the last stage is the next first */
    orbit other = travel(&ellipse, nevh_gsl_rkf45, 1e-9, 10 * two_pi, 1);
    ck_assert_uint_lt(z.gradients, other.gradients);
    z = travel(&ellipse, nevh_dop853, 1e-9, 10 * two_pi, 1);
    other = travel(&ellipse, nevh_gsl_rk8pd, 1e-9, 10 * two_pi, 1);
    ck_assert_uint_lt(z.gradients, other.gradients);
}

/* Where one substep a step is enough, steps cost what they do without control:
   the slope at their end is kept. */
TEST(short_steps_cost_no_more) {
    orbit z = travel(&ellipse, nevh_dopri5, 1e-6, 1, 500);
    ck_assert_uint_eq(z.gradients, 500 * 6 + 1);
    z = travel(&ellipse, nevh_dop853, 1e-6, 1, 500);
    ck_assert_uint_eq(z.gradients, 500 * 12);
}

/* A step begins with the substep that the last one arrived at: all that it
   costs is to land at its end. */
TEST_EACH(substeps_are_remembered, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme || nevh_integrator_needs_tolerance(scheme))
        skip_test("it does not adapt steps, or begins anew with each");
    uint64_t each = (uint64_t)nevh_integrator_stages(scheme);
    orbit whole = travel(&henon_heiles, scheme, 1e-11, 300, 1);
    orbit z = travel(&henon_heiles, scheme, 1e-11, 300, 150);
    ck_assert_msg(z.gradients <= whole.gradients + 150 * each,
                  "%s: %lu instead of %lu", nevh_integrator_name(scheme),
                  (unsigned long)z.gradients, (unsigned long)whole.gradients);
}

TEST_EACH(there_and_back, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    nevh_system *s = ellipse.make();
    nevh_stepper *m = stepper_of(s, &ellipse, scheme, 1e-11);
    double q[] = {0.4, 0}, p[] = {0, 4.2};
    ck_assert_int_eq(nevh_stepper_apply(m, 3, 5, q, p), NEVH_OK);
    ck_assert_double_eq(nevh_stepper_time(m), 8);
    ck_assert_int_eq(nevh_stepper_apply(m, 8, -5, q, p), NEVH_OK);
    ck_assert_double_eq_tol(q[0], 0.4, 1e-6);
    ck_assert_double_eq_tol(q[1], 0, 1e-6);
    ck_assert_double_eq_tol(p[1], 4.2, 1e-6);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Other units, by powers of two, are the same orbit to the last bit. */
TEST_EACH(units_do_not_matter, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    const double length = 0x1p20, mass = 0x1p-30, time = 0x1p9;
    const double scale[] = {1, 1, 1, 1}, kick = mass * length / time;
    const double scaled[] = {length, length, kick, kick};
    nevh_system *plain = make_orbit(),
                *other = make_orbit_in(length, mass, time);
    nevh_options o = {
        .gradient = nevh_exact, .scale = scale, .tolerance = 1e-8};
    nevh_stepper *m = nevh_stepper_new(plain, scheme, &o);
    o.scale = scaled;
    nevh_stepper *u = nevh_stepper_new(other, scheme, &o);
    double q[] = {0.4, 0}, p[] = {0, 4.2};
    double x[] = {0.4 * length, 0}, y[] = {0, 4.2 * kick};
    ck_assert_int_eq(nevh_run(m, 0, 3, 4, q, p, NULL, 0), NEVH_OK);
    ck_assert_int_eq(nevh_run(u, 0, 3 * time, 4, x, y, NULL, 0), NEVH_OK);
    for (int k = 0; k < 2; k++) {
        ck_assert(x[k] == q[k] * length);
        ck_assert(y[k] == p[k] * kick);
    }
    nevh_stepper_free(m);
    nevh_stepper_free(u);
    nevh_system_free(plain);
    nevh_system_free(other);
}

/* Late on the clock, where t + substep is t, an H without time moves on. */
TEST_EACH(late_is_as_early, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    nevh_system *s = ellipse.make();
    double q[2][2] = {{0.4, 0}, {0.4, 0}}, p[2][2] = {{0, 4.2}, {0, 4.2}};
    for (int late = 0; late < 2; late++) {
        nevh_stepper *m = stepper_of(s, &ellipse, scheme, 1e-9);
        ck_assert_int_eq(
            nevh_stepper_apply(m, late ? 1e17 : 0, 7, q[late], p[late]),
            NEVH_OK);
        nevh_stepper_free(m);
    }
    ck_assert_mem_eq(q[0], q[1], sizeof q[0]);
    ck_assert_mem_eq(p[0], p[1], sizeof p[0]);
    nevh_system_free(s);
}

/* Lanes take substeps of their own, and none knows of the others: also where
   one runs into a wall. */
TEST_EACH(lanes_are_alone, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    enum { WIDTH = 5 };
    bool rough = scheme == nevh_dopri5 || scheme == nevh_dop853;
    nevh_system *s = rough ? cliff(walls) : nevh_system_from(1, steep, NULL);
    const nevh_options o = {.gradient_step = 0x1p-20,
                            .scale = (const double[]){1, 1},
                            .tolerance = 1e-5};
    const double q[WIDTH] = {0, 0.2, 0.4, 0.6, 0.8};
    const double p[WIDTH] = {-0.04, -0.02, 0, 0.02, 0.04};
    assert_lanes_are_alone(
        &(many_orbits){s, scheme, &o, 1, WIDTH, 6, 0, 150, q, p, false, NULL});
    nevh_system_free(s);
}

/* Also where H reads t: each lane has its own. */
TEST_EACH(lanes_have_their_own_time, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    nevh_system *s = driven_pendulum.make();
    const nevh_options o = {.gradient = nevh_exact,
                            .scale = (const double[]){1, 1},
                            .tolerance = 1e-8};
    const double q[] = {0.9, 0.1, 2.8}, p[] = {0.3, 0, 0.1};
    assert_lanes_are_alone(
        &(many_orbits){s, scheme, &o, 1, 3, 6, 0.3, 5, q, p, false, NULL});
    nevh_system_free(s);
}

/* What a substep loses to rounding is added to the next one: a hundred
   thousand of them, whose truncation is nothing, leave the last digit. */
TEST_EACH(rounding_is_carried_on, 2) {
    const nevh_integrator *scheme = _i ? nevh_dop853 : nevh_dopri5;
    nevh_system *s = henon_heiles.make();
    nevh_stepper *m = stepper_of(s, &henon_heiles, scheme, 1e-9);
    nevh_energy *e = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, e, 1000};
    double q[2], p[2];
    memcpy(q, henon_heiles.q, sizeof q);
    memcpy(p, henon_heiles.p, sizeof p);
    ck_assert_int_eq(nevh_run(m, 0, 0x1p-10, 100000, q, p, &watch, 1), NEVH_OK);
    double rms = nevh_energy_result(e, 0).rms;
    ck_assert_msg(rms < 1e-15, "%s: %.2e", nevh_integrator_name(scheme), rms);
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

static int look(void *data, size_t step, double t, const double q[],
                const double p[]) {
    (void)step, (void)t, (void)q, (void)p;
    ++*(int *)data;
    return 0;
}

/* Watched, in pieces, from a copy, from what was saved, and after a trial
   elsewhere that failed: the same orbit to the last bit. */
TEST_EACH(memory_is_all, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme)
        skip_test("it does not adapt steps");
    const double h = 0.375;
    nevh_system *s = ellipse.make();
    nevh_stepper *m = stepper_of(s, &ellipse, scheme, 1e-7);
    nevh_stepper *other = stepper_of(s, &ellipse, scheme, 1e-7);
    orbit whole = travel(&ellipse, scheme, 1e-7, 30 * h, 30), z[3];
    double q[] = {0.4, 0}, p[] = {0, 4.2}, far[] = {0, 0}, fast[] = {1, 1};
    int looks = 0;
    nevh_observer watch = {look, &looks, 1};
    ck_assert_int_eq(nevh_run(m, 0, h, 11, q, p, &watch, 1), NEVH_OK);
    void *buffer = malloc(nevh_stepper_save_size(m));
    nevh_stepper_save(m, buffer);
    nevh_stepper *copy = nevh_stepper_copy(m);
    nevh_stepper_load(other, buffer, nevh_stepper_save_size(m));
    ck_assert_int_eq(nevh_stepper_apply(m, 0, h, far, fast), NEVH_EDOM);
    nevh_stepper *const each[] = {m, copy, other};
    for (int i = 0; i < 3; i++) {
        memcpy(z[i].q, q, sizeof q);
        memcpy(z[i].p, p, sizeof p);
        nevh_run(each[i], 11 * h, h, 19, z[i].q, z[i].p, NULL, 0);
        ck_assert_mem_eq(z[i].q, whole.q, sizeof q);
        ck_assert_mem_eq(z[i].p, whole.p, sizeof p);
        nevh_stepper_free(each[i]);
    }
    ck_assert_int_eq(looks, 12);
    free(buffer);
    nevh_system_free(s);
}

/* GSL would take errors that are 0/0 for good ones. */
TEST_EACH(a_tolerance_of_nothing, scheme_count()) {
    const nevh_integrator *scheme = adaptive(_i);
    if (!scheme || strncmp(nevh_integrator_name(scheme), "gsl-", 4) != 0)
        skip_test("not one of GSL's");
    const double scale[] = {0.01, 0.01, 0.01, 0.01};
    nevh_system *s = ellipse.make();
    nevh_options o = {
        .gradient = nevh_exact, .scale = scale, .tolerance = 0x1p-1074};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
    assert_says(nevh_stepper_message(m), "tolerance");
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST(a_tolerance_is_needed) {
    nevh_system *s = ellipse.make();
    nevh_stepper *m = nevh_stepper_new(s, nevh_gsl_msadams, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
    assert_says(nevh_stepper_message(m), "gsl-msadams");
    assert_says(nevh_stepper_message(m), "tolerance");
    nevh_stepper_free(m);
    nevh_system_free(s);
    for (int i = 0; i < scheme_count(); i++)
        ck_assert(!nevh_integrator_needs_tolerance(nevh_integrators()[i]) ||
                  adaptive(i));
}
