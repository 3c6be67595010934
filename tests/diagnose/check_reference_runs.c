/* nevh tests: errors of runs, by references.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "reference.h"
#include <math.h>
#include <string.h>

static const orbit circle = {"x = 1", "T = p_x^2/2\nV = x^2/2", 0, 100};

/* State error of a run with so many steps. */
static double error_of_run(const setup *s, const nevh_integrator *scheme,
                           double t0, double t1, double steps) {
    double q[MOST], p[MOST];
    nevh_options o = {.gradient = nevh_exact, .q = s->q, .p = s->p};
    nevh_stepper *stepper = nevh_stepper_new(s->system, scheme, &o);
    nevh_state_error *error = nevh_state_error_new(s->reference);
    memcpy(q, s->q, sizeof q);
    memcpy(p, s->p, sizeof p);
    ck_assert_int_eq(
        nevh_run_until(stepper, t0, (t1 - t0) / steps, t1, q, p,
                       &(nevh_observer){nevh_state_error_observe, error, 1}, 1),
        NEVH_OK);
    double result = nevh_state_error_result(error);
    nevh_state_error_free(error);
    nevh_stepper_free(stepper);
    return result;
}

/* Its slope is the order, with exact references, runs, and friction. */
static const struct {
    orbit orbit;
    const char *scheme;
    double steps, order;
} slopes[] = {
    {{"q = 2", "T = p_q^2/2\nV = -cos(q)", 0, 30}, "verlet", 3000, 2},
    {{"q = 2", "T = p_q^2/2\nV = -cos(q)", 0, 30}, "gauss6", 150, 6},
    {{"x = 0.4\ny = 0\np_y = 2", "T = (p_x^2 + p_y^2)/2\nV = -1/hypot(x, y)", 0,
      20},
     "blanes-moan4",
     2000,
     4},
    {{"x = 0\ny = 0.1\np_x = 0.49057789051960615",
      "T = (p_x^2 + p_y^2)/2\nV = (x^2 + y^2)/2 + x^2*y - y^3/3", 0, 30},
     "kahan-li6",
     100,
     6},
    {{"q = 2",
      "T = p_q^2/2\nV = -cos(q)*(1 + 0.3*cos(2*t))\n"
      "[friction]\ndrag = all: 0.1",
      1, 21},
     "rk4",
     400,
     4},
    {{"q = 2",
      "T = p_q^2/2\nV = -cos(q)*(1 + 0.3*cos(2*t))\n"
      "[friction]\ndrag = all: 0.1",
      1, 21},
     "verlet",
     1000,
     2},
};
enum { SLOPES = sizeof slopes / sizeof *slopes };

TEST_EACH(slope_of_the_state_error_is_the_order, SLOPES) {
    const orbit *o = &slopes[_i].orbit;
    const nevh_integrator *scheme = nevh_integrator_named(slopes[_i].scheme);
    setup s = refer_to(o, NULL);
    double n = slopes[_i].steps;
    double a = error_of_run(&s, scheme, o->t0, o->t1, n);
    double b = error_of_run(&s, scheme, o->t0, o->t1, 2 * n);
    ck_assert_double_lt(a, 0.1);
    ck_assert_double_gt(b, 10 * nevh_reference_error(s.reference));
    ck_assert_double_eq_tol(log2(a / b), slopes[_i].order, 0.15);
    tear_down(&s);
}

/* The state, and nothing but it, over the range of each variable. */
TEST(state_error_is_that_of_the_worst_variable) {
    setup s = refer_to(&circle, NULL);
    nevh_state_error *e = nevh_state_error_new(s.reference);
    ck_assert(isnan(nevh_state_error_result(e)));
    for (size_t i = 0; i <= 100; i++) {
        double t = (double)i, q = cos(t), p = -sin(t) + (i == 60 ? 3e-3 : 0);
        ck_assert_int_eq(nevh_state_error_observe(e, i, t, &q, &p), NEVH_OK);
    }
    ck_assert_double_eq_tol(nevh_state_error_result(e), 1.5e-3, 1e-8);
    double last = 1;
    nevh_state_error_free(e);
    e = nevh_state_error_new(s.reference);
    nevh_state_error_observe(e, 0, 0, &last, &(double){NAN});
    ck_assert_double_eq(nevh_state_error_result(e), INFINITY);
    nevh_state_error_free(e);
    ck_assert(isnan(nevh_state_error_result(NULL)));
    ck_assert_ptr_null(nevh_state_error_new(NULL));
    tear_down(&s);
}

/* Of a million observations no more than 1025 ask the reference; the last one
   always does. */
TEST(observations_are_spread_over_the_run) {
    setup s = refer_to(&circle, NULL);
    nevh_state_error *e = nevh_state_error_new(s.reference);
    size_t count = 0, most = 1000000;
    for (size_t i = 0; i <= most; i++) {
        double t = 100 * ((double)i / (double)most), q = cos(t), p = -sin(t);
        double before = nevh_state_error_result(e);
        q += 1e-3 * (double)(count + 1);
        nevh_state_error_observe(e, i, t, &q, &p);
        count += nevh_state_error_result(e) != before;
    }
    ck_assert_uint_eq(count, 1025);
    ck_assert_double_eq_tol(nevh_state_error_result(e), 1e-3 * 1025 / 2, 1e-6);
    nevh_state_error_free(e);
    tear_down(&s);
}

TEST(runs_beyond_the_horizon_have_no_state_error) {
    const orbit chaos = {"a = 3\nb = 3", RODS, 0, 60};
    setup s = refer_to(&chaos, NULL);
    ck_assert(isnan(error_of_run(&s, nevh_gauss8, 0, 60, 6000)));
    ck_assert_double_lt(error_of_run(&s, nevh_gauss8, 0, 8, 800), 1e-3);
    tear_down(&s);
}
