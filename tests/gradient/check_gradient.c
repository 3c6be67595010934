/* nevh tests: gradients from values, and how exact they are.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <float.h>
#include <math.h>
#include <string.h>

static const double now = 0.3;

/* The central methods, by _i. */
static const nevh_gradient *central(int i) {
    const nevh_gradient *const all[] = {nevh_central2, nevh_central4,
                                        nevh_central6, nevh_central8};
    return all[i];
}

/* dH/dq and dH/dp of a whole H of one degree of freedom. */
static void differentiate(nevh_value_fn H, const void *params,
                          const nevh_gradient *g, double delta, double q,
                          double p, double d[2]) {
    nevh_system *s = nevh_system_from(1, H, params);
    nevh_options o = {.gradient = g, .gradient_step = delta};
    nevh_field *f = nevh_field_new(s, &o);
    ck_assert_int_eq(nevh_field_gradient(f, 1, &now, &q, &p, d, d + 1),
                     NEVH_OK);
    nevh_field_free(f);
    nevh_system_free(s);
}

TEST(methods) {
    const char *names[] = {"central2", "central4",     "central6",
                           "central8", "complex-step", "exact"};
    const nevh_gradient *const *all = nevh_gradients();
    for (int i = 0; i < 6; i++) {
        ck_assert_str_eq(nevh_gradient_name(all[i]), names[i]);
        ck_assert_ptr_eq(nevh_gradient_named(names[i]), all[i]);
        ck_assert_int_eq(nevh_gradient_order(all[i]), i < 4 ? 2 * i + 2 : 0);
    }
    ck_assert_ptr_null(all[6]);
    ck_assert_ptr_null(nevh_gradient_named("central3"));
    ck_assert_ptr_null(nevh_gradient_named(NULL));
}

static double monomials(double t, const double q[], const double p[],
                        const void *params) {
    double k = *(const double *)params;
    (void)t;
    return pow(q[0], k) - 0.3 * pow(p[0], k);
}

/* The moments: exact for x^k up to k = order, and not beyond, where the error
   of x^(m+1) is (-1)^(m/2+1) (1 2 ... m/2)^2 delta^m, m the order. */
TEST_EACH(moments, 4) {
    const nevh_gradient *g = central(_i);
    const double q = 1.37, p = -0.83, delta = 0.25;
    double order = nevh_gradient_order(g), d[2];
    for (double k = 0; k <= order; k++) {
        differentiate(monomials, &k, g, delta, q, p, d);
        ck_assert_double_eq_tol(d[0], k * pow(q, k - 1), 1e-12);
        ck_assert_double_eq_tol(d[1], -0.3 * k * pow(p, k - 1), 1e-12);
    }
    double k = order + 1, error = _i % 2 ? -1 : 1;
    for (double j = 1; j <= order / 2; j++)
        error *= j * j * delta * delta;
    differentiate(monomials, &k, g, delta, q, p, d);
    ck_assert_double_eq_tol(d[0], k * pow(q, k - 1) + error, 1e-12);
    ck_assert_double_eq_tol(d[1], -0.3 * (k * pow(p, k - 1) + error), 1e-12);
}

static double transcendental(double t, const double q[], const double p[],
                             const void *params) {
    (void)params;
    return exp(sin(q[0]) + 0.2 * t) + sin(1.3 * p[0] + t) * cos(q[0]);
}

static double slope(const double x[], const double y[], int n) {
    double mx = 0, my = 0, xx = 0, xy = 0;
    for (int i = 0; i < n; i++) {
        mx += x[i] / n;
        my += y[i] / n;
    }
    for (int i = 0; i < n; i++) {
        xx += (x[i] - mx) * (x[i] - mx);
        xy += (x[i] - mx) * (y[i] - my);
    }
    return xy / xx;
}

TEST_EACH(order_of_the_error, 4) {
    enum { POINTS = 8 };
    const double q = 0.61, p = 0.23;
    double x[POINTS], error_q[POINTS], error_p[POINTS], d[2];
    double order = nevh_gradient_order(central(_i));
    double dq = exp(sin(q) + 0.2 * now) * cos(q) - sin(1.3 * p + now) * sin(q);
    double dp = 1.3 * cos(1.3 * p + now) * cos(q);
    for (int i = 0; i < POINTS; i++) {
        double delta = 0.2 * pow(0.87, i);
        differentiate(transcendental, NULL, central(_i), delta, q, p, d);
        x[i] = log(delta);
        error_q[i] = log(fabs(d[0] - dq));
        error_p[i] = log(fabs(d[1] - dp));
        ck_assert(fmin(error_q[i], error_p[i]) > log(1e-13));
    }
    ck_assert_double_eq_tol(slope(x, error_q, POINTS), order, 0.05 * order);
    ck_assert_double_eq_tol(slope(x, error_p, POINTS), order, 0.05 * order);
}

static double quadratic(double t, const double q[], const double p[],
                        const void *params) {
    (void)params;
    return 1.5 * q[0] * q[0] + p[0] * p[0] / 2.6 + 0.7 * q[0] * p[0] + t;
}

TEST_EACH(quadratic_is_exact, 4) {
    const double q = 0.61, p = -1.3, delta = 1024;
    double d[2];
    differentiate(quadratic, NULL, central(_i), delta, q, p, d);
    double rounding = 16 * DBL_EPSILON * 1.5 * 16 * delta;
    ck_assert_double_eq_tol(d[0], 3 * q + 0.7 * p, rounding);
    ck_assert_double_eq_tol(d[1], p / 1.3 + 0.7 * q, rounding);
}

/* A term of two degrees of freedom that reads q[1], p[1] only. */
static double second_plane(double t, const double q[], const double p[],
                           const double c[], const void *params) {
    (void)c;
    return quadratic(t, q, p, params);
}

static nevh_field *second_plane_field(nevh_system **s, const nevh_options *o) {
    static const size_t second[] = {1};
    *s = nevh_system_new(2);
    nevh_system_add(*s, &(nevh_term){.effect = "a",
                                     .nq = 1,
                                     .np = 1,
                                     .q = second,
                                     .p = second,
                                     .value = second_plane});
    nevh_field *f = nevh_field_new(*s, o);
    ck_assert_int_eq(nevh_field_status(f), NEVH_OK);
    return f;
}

/* What the user says is taken as it is, one by one, then for all. */
TEST_EACH(given_steps, 4) {
    const nevh_gradient *g = central(_i);
    const double steps[] = {7, 0.1234, 7, 0}, scale[] = {1, 1, 1, 1e5};
    const double q[] = {1, 2}, p[] = {3, 4};
    nevh_options o = {.gradient = g,
                      .gradient_step = 0.321,
                      .gradient_steps = steps,
                      .scale = scale,
                      .q = q,
                      .p = p};
    nevh_system *s;
    nevh_field *f = second_plane_field(&s, &o);
    ck_assert_double_eq(nevh_field_step(f, "a", 0, 1), 0.1234);
    ck_assert_double_eq(nevh_field_step(f, "a", 0, 3), 0.321);
    ck_assert_double_eq(nevh_field_step(f, "a", 0, 0), 0);
    ck_assert_double_eq(nevh_field_step(f, "a", 0, 2), 0);
    ck_assert_double_eq(nevh_field_step(f, "a", 0, 4), 0);
    ck_assert_double_eq(nevh_field_step(f, "a", 1, 1), 0);
    ck_assert_double_eq(nevh_field_step(f, "b", 0, 1), 0);
    nevh_field_free(f);
    nevh_system_free(s);
    o.gradient_step = 0;
    f = second_plane_field(&s, &o);
    ck_assert_double_eq(nevh_field_step(f, "a", 0, 1), 0.1234);
    ck_assert_double_gt(nevh_field_step(f, "a", 0, 3), 0.1);
    nevh_field_free(f);
    nevh_system_free(s);
}

/* The points are those that the user's step says. */
TEST(steps_are_used) {
    double d[2], exact = 3 * 0.6 * 0.6;
    const double k = 3;
    differentiate(monomials, &k, nevh_central2, 0.1, 0.6, 0, d);
    ck_assert_double_eq_tol(d[0] - exact, 0.01, 1e-14);
}

/* More lanes than any block holds, and one that is at fault near their end. */
TEST_EACH(very_many_lanes, 5) {
    enum { WIDTH = 1301, BAD = 1290 };
    const nevh_gradient *g = nevh_gradients()[_i < 4 ? _i : 5];
    const nevh_model *model = nevh_pendulum_model;
    nevh_system *s = model->system(model->defaults);
    nevh_field *f = nevh_field_new(s, &(nevh_options){.gradient = g});
    static double t[WIDTH], q[WIDTH], p[WIDTH], dq[WIDTH], dp[WIDTH], h[WIDTH];
    for (int i = 0; i < WIDTH; i++) {
        q[i] = 0.01 * i - 5;
        p[i] = 1 - 0.003 * i;
    }
    ck_assert_int_eq(nevh_field_value(f, WIDTH, t, q, p, h), NEVH_OK);
    ck_assert_int_eq(nevh_field_gradient(f, WIDTH, t, q, p, dq, dp), NEVH_OK);
    for (int i = 0; i < WIDTH; i++) {
        double one, one_q, one_p;
        nevh_field_value(f, 1, t, q + i, p + i, &one);
        nevh_field_gradient(f, 1, t, q + i, p + i, &one_q, &one_p);
        ck_assert(one == h[i] && one_q == dq[i] && one_p == dp[i]);
    }
    q[BAD] = INFINITY;
    ck_assert_int_eq(nevh_field_gradient(f, WIDTH, t, q, p, dq, dp), NEVH_EDOM);
    ck_assert_ptr_nonnull(strstr(nevh_field_message(f), "lane 1290"));
    nevh_field_free(f);
    nevh_system_free(s);
}

static const double bad[] = {-1e-3, NAN, INFINITY, -INFINITY, 0};

/* A step of 0 is the default; a scale of 0 is none. */
TEST_EACH(invalid_options, 5) {
    const bool zero = bad[_i] == 0;
    double row[] = {1, 1, bad[_i], 1};
    const nevh_options options[] = {
        {.gradient_step = bad[_i]}, {.gradient_steps = row}, {.scale = row}};
    const char *const words[] = {"gradient step", "gradient step of p[0]",
                                 "scale of p[0]"};
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(
        s,
        &(nevh_term){.effect = "a", .nq = 1, .np = 1, .value = second_plane});
    for (int i = 0; i < 3; i++) {
        nevh_field *f = nevh_field_new(s, &options[i]);
        nevh_stepper *m = nevh_stepper_new(s, nevh_rk4, &options[i]);
        int status = zero && i < 2 ? NEVH_OK : NEVH_EINVAL;
        double z[4] = {0.1, 0.2, 0.3, 0.4};
        ck_assert_int_eq(nevh_field_status(f), status);
        ck_assert_int_eq(nevh_stepper_status(m), status);
        ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z, z + 2), status);
        if (status) {
            assert_says(nevh_field_message(f), words[i]);
            assert_says(nevh_stepper_message(m), words[i]);
            ck_assert_int_eq(nevh_field_value(f, 1, &now, z, z, z),
                             NEVH_EINVAL);
        }
        nevh_stepper_free(m);
        nevh_field_free(f);
    }
    nevh_system_free(s);
}

/* A step lost in a large coordinate is an error, not a derivative of 0/0. */
TEST_EACH(step_is_lost, 4) {
    nevh_system *s;
    nevh_field *f = second_plane_field(
        &s, &(nevh_options){.gradient = central(_i), .gradient_step = 1e-3});
    const double q[] = {0, 1e20}, p[] = {0, 0};
    double d[2];
    ck_assert_int_eq(nevh_field_gradient(f, 1, &now, q, p, d, NULL), NEVH_EDOM);
    assert_says(nevh_field_message(f), "\"a\"");
    assert_says(nevh_field_message(f), "q[1]");
    assert_says(nevh_field_message(f), "gradient step");
    nevh_field_free(f);
    nevh_system_free(s);
}

static void plane_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    (void)t, (void)c, (void)params;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = 3 * q[i] + 0.7 * p[i];
    for (size_t i = 0; dp && i < width; i++)
        dp[i] = p[i] / 1.3 + 0.7 * q[i];
}

static double only_time(double t, const double q[], const double p[],
                        const double c[], const void *params) {
    (void)q, (void)p, (void)c, (void)params;
    return t * t;
}

/* What reads nothing needs no gradient. */
TEST(exact_needs_gradients) {
    nevh_system *s = nevh_system_new(2);
    const nevh_options o = {.gradient = nevh_exact};
    double q[] = {0.3, 0.5}, p[] = {0.7, 1.1}, dq[2], dp[2], h;
    nevh_term term = {.effect = "fine",
                      .nq = 1,
                      .np = 1,
                      .value = second_plane,
                      .gradient = plane_gradient};
    nevh_system_add(s, &term);
    nevh_system_add(s, &(nevh_term){.effect = "fine",
                                    .name = "none",
                                    .time = true,
                                    .value = only_time});
    nevh_system_enable(s, "fine", true);
    nevh_field *f = nevh_field_new(s, &o);
    ck_assert_int_eq(nevh_field_gradient(f, 1, &now, q, p, dq, dp), NEVH_OK);
    ck_assert_double_eq(dq[0], 3 * 0.3 + 0.7 * 0.7);
    ck_assert_double_eq(dp[0], 0.7 / 1.3 + 0.7 * 0.3);
    ck_assert(dq[1] == 0 && dp[1] == 0);
    ck_assert_uint_eq(nevh_field_counts(f).values, 0);
    ck_assert_double_eq(nevh_field_step(f, "fine", 0, 0), 0);
    nevh_field_free(f);
    term = (nevh_term){
        .effect = "e", .name = "bare", .np = 1, .value = second_plane};
    nevh_system_add(s, &term);
    f = nevh_field_new(s, &o);
    nevh_stepper *m = nevh_stepper_new(s, nevh_gauss4, &o);
    ck_assert_int_eq(nevh_field_status(f), NEVH_ENOGRAD);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_ENOGRAD);
    assert_says(nevh_field_message(f), "\"bare\"");
    assert_says(nevh_stepper_message(m), "\"bare\"");
    ck_assert_int_eq(nevh_field_gradient(f, 1, &now, q, p, dq, dp),
                     NEVH_ENOGRAD);
    ck_assert_int_eq(nevh_field_value(f, 1, &now, q, p, &h), NEVH_ENOGRAD);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, q, p), NEVH_ENOGRAD);
    nevh_stepper_free(m);
    nevh_field_free(f);
    nevh_system_free(s);
}

static double constant(double t, const double q[], const double p[],
                       const double c[], const void *params) {
    (void)t, (void)q, (void)p, (void)params;
    return c[0];
}

/* Digits that a plain sum would lose; `_i` lanes. */
TEST_RANGE(values_are_compensated, 1, 201) {
    static const double c[] = {1e16, 1, 1, -1e16, 1e-3}, z[201];
    double h[201], dq[201];
    size_t width = (size_t)_i;
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(
        s, &(nevh_term){
               .effect = "a", .nc = 1, .c = c, .count = 5, .value = constant});
    nevh_system_add(
        s, &(nevh_term){.effect = "b", .nc = 1, .c = c + 4, .value = constant});
    nevh_field *f = nevh_field_new(s, NULL);
    ck_assert_int_eq(nevh_field_value(f, width, z, z, z, h), NEVH_OK);
    ck_assert_uint_eq(nevh_field_counts(f).values, 6 * width);
    ck_assert_int_eq(nevh_field_gradient(f, width, z, z, z, dq, dq), NEVH_OK);
    for (size_t lane = 0; lane < width; lane++)
        ck_assert(h[lane] == 2.002 && dq[lane] == 0);
    nevh_field_free(f);
    nevh_system_free(s);
}
