/* nevh tests: GSL's solvers on nevh's gradients, and the other way round.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <gsl/gsl_errno.h>
#include <math.h>
#include <nevh/gsl.h>
#include <string.h>

/* What the paper does with SciPy: only H, and an existing solver. */
static double oscillator(double t, const double q[], const double p[],
                         const void *params) {
    double k = *(const double *)params;
    (void)t;
    return k * q[0] * q[0] / 2 + p[0] * p[0] / 2;
}

TEST(h_into_an_existing_solver) {
    const double pi = acos(-1), k = 4 * pi * pi;
    nevh_system *s = nevh_system_from(1, oscillator, &k);
    nevh_field *field = nevh_field_new(s, NULL);
    gsl_odeiv2_system ode = nevh_gsl_system(field);
    gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_y_new(
        &ode, gsl_odeiv2_step_rk8pd, 1e-3, 1e-12, 1e-12);
    double t = 0, y[] = {1, 0};
    for (int i = 1; i <= 30; i++) {
        ck_assert_int_eq(gsl_odeiv2_driver_apply(driver, &t, 0.1 * i, y),
                         GSL_SUCCESS);
        ck_assert_double_eq_tol(y[0], cos(2 * pi * t), 1e-9);
        ck_assert_double_eq_tol(y[1], -2 * pi * sin(2 * pi * t), 1e-8);
    }
    ck_assert_uint_gt(nevh_field_counts(field).values, 1000);
    gsl_odeiv2_driver_free(driver);
    nevh_field_free(field);
    nevh_system_free(s);
}

/* Against the field with another gradient method: dq/dt = dH/dp first. */
TEST(right_hand_side) {
    const problem *b = &double_pendulum;
    nevh_system *s = b->make();
    nevh_options options = {.gradient = nevh_exact};
    nevh_field *field = nevh_field_new(s, &options);
    gsl_odeiv2_system ode = nevh_gsl_system(field);
    double y[4] = {b->q[0], b->q[1], b->p[0], b->p[1]}, dydt[4], t = 0;
    double dq[2], dp[2];
    ck_assert_uint_eq(ode.dimension, 4);
    ck_assert_int_eq(ode.function(0, y, dydt, ode.params), GSL_SUCCESS);
    ck_assert_int_eq(nevh_field_gradient(field, 1, &t, b->q, b->p, dq, dp), 0);
    for (int k = 0; k < 2; k++) {
        ck_assert_double_eq(dydt[k], dp[k]);
        ck_assert_double_eq(dydt[2 + k], -dq[k]);
    }
    nevh_field_free(field);
    nevh_system_free(s);
}

/* Pendulum driven in time: d(-V')/dq, and the derivative in t. */
TEST(jacobian) {
    const problem *b = &driven_pendulum;
    nevh_system *s = b->make();
    nevh_options options = {.gradient = nevh_exact};
    nevh_field *field = nevh_field_new(s, &options);
    gsl_odeiv2_system ode = nevh_gsl_system(field);
    double y[] = {1.1, 0.4}, m[4], dt[2], t = 0.6;
    ck_assert_int_eq(ode.jacobian(t, y, m, dt, ode.params), GSL_SUCCESS);
    double strength = 2 + 0.7 * sin(1.9 * t);
    ck_assert_double_eq_tol(m[0], 0, 1e-9);
    ck_assert_double_eq_tol(m[1], 1 / 1.3, 1e-9);
    ck_assert_double_eq_tol(m[2], -strength * cos(1.1), 1e-9);
    ck_assert_double_eq_tol(m[3], 0, 1e-9);
    ck_assert_double_eq_tol(dt[0], 0, 1e-9);
    ck_assert_double_eq_tol(dt[1], -0.7 * 1.9 * cos(1.9 * t) * sin(1.1), 1e-9);
    nevh_field_free(field);
    nevh_system_free(s);
}

/* An implicit solver of GSL's needs it. */
TEST(solver_with_jacobian) {
    nevh_system *s = double_pendulum.make();
    nevh_field *field = nevh_field_new(s, NULL);
    gsl_odeiv2_system ode = nevh_gsl_system(field);
    gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_y_new(
        &ode, gsl_odeiv2_step_rk4imp, 1e-3, 1e-9, 1e-9);
    double t = 0, h0, h1, y[4];
    memcpy(y, double_pendulum.q, 2 * sizeof *y);
    memcpy(y + 2, double_pendulum.p, 2 * sizeof *y);
    nevh_field_value(field, 1, &t, y, y + 2, &h0);
    ck_assert_int_eq(gsl_odeiv2_driver_apply(driver, &t, 0.5, y), GSL_SUCCESS);
    nevh_field_value(field, 1, &t, y, y + 2, &h1);
    ck_assert_double_eq_tol(h1, h0, 1e-6);
    gsl_odeiv2_driver_free(driver);
    nevh_field_free(field);
    nevh_system_free(s);
}

static double undefined(double t, const double q[], const double p[],
                        const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2 - log(q[0]);
}

TEST(failure_reaches_gsl) {
    nevh_system *s = nevh_system_from(1, undefined, NULL);
    nevh_field *field = nevh_field_new(s, NULL);
    gsl_odeiv2_system ode = nevh_gsl_system(field);
    double y[] = {-1, 0}, dydt[2];
    ck_assert_int_eq(ode.function(0, y, dydt, ode.params), GSL_EBADFUNC);
    ck_assert_int_eq(nevh_field_status(field), NEVH_EDOM);
    nevh_field_free(field);
    nevh_system_free(s);
}

/* With a tolerance the step is GSL's, whatever h is; tighter is better. */
TEST_EACH(tighter_is_better, 2) {
    const nevh_integrator *scheme = _i ? nevh_gsl_rk8pd : nevh_gsl_rkf45;
    const problem *b = &kepler;
    nevh_system *s = b->make();
    double before = 1;
    uint64_t work = 0;
    for (double tolerance = 1e-4; tolerance > 1e-11; tolerance /= 100) {
        nevh_options options = {.gradient = nevh_exact, .tolerance = tolerance};
        nevh_stepper *stepper = nevh_stepper_new(s, scheme, &options);
        nevh_energy *energy = nevh_energy_new(s, NULL);
        nevh_observer watch = {nevh_energy_observe, energy, 1};
        double q[2], p[2];
        memcpy(q, b->q, sizeof q);
        memcpy(p, b->p, sizeof p);
        ck_assert_int_eq(nevh_run(stepper, 0, 5, 4, q, p, &watch, 1), NEVH_OK);
        double error = nevh_energy_result(energy, 0).max;
        nevh_counts counts = nevh_stepper_counts(stepper);
        ck_assert_double_lt(error, before / 5);
        ck_assert_double_lt(error, 3000 * tolerance);
        ck_assert_uint_gt(counts.gradients, work);
        before = error;
        work = counts.gradients;
        nevh_energy_free(energy);
        nevh_stepper_free(stepper);
    }
    nevh_system_free(s);
}

TEST(bad_tolerance) {
    const double bad[] = {-1, NAN, INFINITY};
    nevh_system *s = kepler.make();
    for (int i = 0; i < 3; i++) {
        nevh_options options = {.tolerance = bad[i]};
        nevh_stepper *stepper = nevh_stepper_new(s, nevh_gsl_rkf45, &options);
        ck_assert_int_eq(nevh_stepper_status(stepper), NEVH_EINVAL);
        nevh_stepper_free(stepper);
    }
    nevh_system_free(s);
}
