/* nevh tests: values without SIMD.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <string.h>

/* Which of a term's functions were called, and how often.  The two differ by
   a constant, so that values show it, too. */
static size_t scalar_calls, block_calls;

static double value(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)c, (void)params;
    scalar_calls++;
    return p[0] * p[0] / 2 - (1 + 0.1 * sin(t)) * cos(q[0]);
}

static void block(size_t width, const double t[], const double q[],
                  const double p[], const double c[], const void *params,
                  double h[]) {
    (void)c, (void)params;
    block_calls++;
    for (size_t i = 0; i < width; i++)
        h[i] = p[i] * p[i] / 2 - (1 + 0.1 * sin(t[i])) * cos(q[i]) + 1;
}

static nevh_system *make(nevh_term_fn scalar, nevh_block_fn simd) {
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "H",
                                    .nq = 1,
                                    .np = 1,
                                    .time = true,
                                    .value = scalar,
                                    .block = simd});
    return s;
}

/* By _i: what the term has, and whether it is asked to be portable. */
typedef enum { BOTH, ONLY_VALUE, ONLY_BLOCK } forms;

static nevh_system *system_of(int i) {
    forms has = i / 2;
    return make(has == ONLY_BLOCK ? NULL : value,
                has == ONLY_VALUE ? NULL : block);
}

static bool scalar_wanted(int i) {
    return i / 2 == ONLY_VALUE || (i / 2 == BOTH && i % 2);
}

static void assert_only(bool scalar) {
    ck_assert((scalar_calls > 0) == scalar && (block_calls > 0) == !scalar);
    scalar_calls = block_calls = 0;
}

enum { WIDTH = 11 };

/* Planning, values, effects and gradients. */
TEST_EACH(fields, 6) {
    nevh_system *s = system_of(_i);
    bool scalar = scalar_wanted(_i);
    double t[WIDTH], q[WIDTH], p[WIDTH], dq[WIDTH], dp[WIDTH], h[WIDTH];
    for (size_t i = 0; i < WIDTH; i++) {
        t[i] = 0.3 * (double)i;
        q[i] = 1.2 - 0.2 * (double)i;
        p[i] = 0.7;
    }
    nevh_field *f =
        nevh_field_new(s, &(nevh_options){.q = q, .p = p, .portable = _i % 2});
    ck_assert_int_eq(nevh_field_status(f), NEVH_OK);
    assert_only(scalar);
    ck_assert(!nevh_field_gradient(f, WIDTH, t, q, p, dq, dp));
    if (scalar)
        ck_assert_uint_eq(scalar_calls, nevh_field_counts(f).values);
    assert_only(scalar);
    ck_assert(!nevh_field_value(f, WIDTH, t, q, p, h));
    if (scalar)
        ck_assert_uint_eq(scalar_calls, WIDTH);
    assert_only(scalar);
    for (size_t i = 0; i < WIDTH; i++) {
        double weight = 1 + 0.1 * sin(t[i]);
        ck_assert_double_eq_tol(dq[i], weight * sin(q[i]), 1e-11);
        ck_assert_double_eq_tol(dp[i], p[i], 1e-11);
        ck_assert_double_eq_tol(
            h[i], p[i] * p[i] / 2 - weight * cos(q[i]) + !scalar, 1e-14);
    }
    ck_assert(!nevh_field_effects(f, t[1], q + 1, p + 1, h));
    assert_only(scalar);
    nevh_field_free(f);
    nevh_system_free(s);
}

TEST_EACH(energies, 6) {
    nevh_system *s = system_of(_i);
    double q = 0.4, p = 0.1;
    nevh_energy *e = nevh_energy_new(s, &(nevh_options){.portable = _i % 2});
    ck_assert(!nevh_energy_observe(e, 0, 0, &q, &p));
    ck_assert(!nevh_energy_observe(e, 1, 0.1, &q, &p));
    ck_assert_double_eq_tol(nevh_energy_result(e, 0).initial,
                            0.005 - cos(0.4) + !scalar_wanted(_i), 1e-14);
    assert_only(scalar_wanted(_i));
    nevh_energy_free(e);
    nevh_system_free(s);
}

/* Energies without options are as they always were: in blocks. */
TEST(energies_without_options) {
    nevh_system *s = system_of(2 * BOTH);
    double q = 0.4, p = 0.1;
    nevh_energy *e = nevh_energy_new(s, NULL);
    ck_assert(!nevh_energy_observe(e, 0, 0, &q, &p));
    assert_only(false);
    nevh_energy_free(e);
    nevh_system_free(s);
}

/* An orbit of the double pendulum, from planning on. */
static void run(const nevh_integrator *scheme, const nevh_gradient *g,
                double z[4]) {
    const problem *b = &double_pendulum;
    nevh_system *s = b->make();
    nevh_stepper *stepper = nevh_stepper_new(
        s, scheme,
        &(nevh_options){.gradient = g, .q = b->q, .p = b->p, .portable = true});
    memcpy(z, b->q, 2 * sizeof *z);
    memcpy(z + 2, b->p, 2 * sizeof *z);
    ck_assert(!nevh_run(stepper, 0, 0.01, 500, z, z + 2, NULL, 0));
    nevh_stepper_free(stepper);
    nevh_system_free(s);
}

TEST_EACH(orbits_repeat, 4) {
    const nevh_integrator *const schemes[] = {nevh_gauss8, nevh_rk4,
                                              nevh_gsl_rk8pd};
    for (int i = 0; i < 3; i++) {
        double first[4], again[4], start[2];
        memcpy(start, double_pendulum.q, sizeof start);
        run(schemes[i], nevh_gradients()[_i], first);
        run(schemes[i], nevh_gradients()[_i], again);
        ck_assert_mem_eq(first, again, sizeof first);
        ck_assert_mem_ne(first, start, sizeof start);
    }
}

/* Planned and run without a block. */
TEST(orbits_are_scalar) {
    nevh_system *s = system_of(2 * BOTH + 1);
    double q = 0.4, p = 0.1;
    nevh_stepper *stepper = nevh_stepper_new(
        s, nevh_gauss4, &(nevh_options){.q = &q, .p = &p, .portable = true});
    ck_assert(!nevh_run(stepper, 0, 0.1, 20, &q, &p, NULL, 0));
    assert_only(true);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
}
