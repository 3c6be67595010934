/* nevh tests: the forms in which implicit stages are solved.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "implicit/implicit_private.h"
#include "support.h"
#include <float.h>
#include <math.h>
#include <nevh/extend.h>
#include <string.h>

enum { STEPS = 200 };
static const nevh_integrator *const *const schemes[] = {
    &nevh_midpoint, &nevh_gauss4,   &nevh_gauss8,  &nevh_gauss16,
    &nevh_lobatto2, &nevh_lobatto4, &nevh_lobatto6};
enum { SCHEMES = sizeof schemes / sizeof *schemes };

/* 0 q p: with it T(p) + V(q) is not what is declared, and stages are solved
   for the slopes of coordinates as well. */
static double nothing(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)c, (void)params;
    return 0 * q[0] * p[0];
}

static void nothing_gradient(size_t width, const double t[], const double q[],
                             const double p[], const double c[],
                             const void *params, double dq[], double dp[]) {
    (void)t, (void)q, (void)p, (void)c, (void)params;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = 0;
    for (size_t i = 0; dp && i < width; i++)
        dp[i] = 0;
}

typedef struct {
    double q[2 * MOST_DOF], p[2 * MOST_DOF];
    nevh_counts counts;
} result;

/* Two orbits side by side, in steps of h that change now and then. */
static result solve(const problem *b, const nevh_integrator *scheme,
                    const nevh_gradient *g, bool mixed) {
    result z = {0};
    nevh_system *s = b->make();
    if (mixed)
        nevh_system_add(s, &(nevh_term){.effect = "nothing",
                                        .nq = 1,
                                        .np = 1,
                                        .value = nothing,
                                        .gradient = nothing_gradient});
    ck_assert(!(nevh_system_traits(s) & NEVH_SEPARABLE) == mixed);
    for (size_t k = 0; k < b->n; k++)
        for (size_t lane = 0; lane < 2; lane++) {
            z.q[2 * k + lane] = b->q[k] * (1 + 0.1 * (double)lane);
            z.p[2 * k + lane] = b->p[k];
        }
    nevh_options options = {.gradient = g, .t = b->t0, .width = 2};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &options);
    double t = b->t0;
    for (size_t i = 0; i < STEPS; i++) {
        double h = i / 20 % 2 ? 0.03 : 0.02;
        ck_assert_int_eq(nevh_stepper_apply(m, t, h, z.q, z.p), NEVH_OK);
        t = nevh_stepper_time(m);
    }
    z.counts = nevh_stepper_counts(m);
    nevh_stepper_free(m);
    nevh_system_free(s);
    return z;
}

static double difference(const result *a, const result *b) {
    double most = 0;
    for (size_t i = 0; i < 2 * MOST_DOF; i++)
        most =
            fmax(most, fmax(fabs(a->q[i] - b->q[i]), fabs(a->p[i] - b->p[i])));
    return most;
}

static const problem *const separable[] = {&driven_pendulum, &henon_heiles,
                                           &relativistic};

/* The partitioned form is the same scheme, in little more than half the
   sweeps. */
TEST_EACH(partitioned_form_is_the_scheme, 3 * SCHEMES) {
    const problem *b = separable[_i % 3];
    const nevh_integrator *scheme = *schemes[_i / 3];
    result part = solve(b, scheme, nevh_exact, false);
    result full = solve(b, scheme, nevh_exact, true);
    ck_assert_double_le(difference(&part, &full), 1e-13);
    ck_assert_msg(part.counts.sweeps <= 0.7 * (double)full.counts.sweeps,
                  "%s on %s: %lu of %lu", nevh_integrator_name(scheme), b->name,
                  (unsigned long)part.counts.sweeps,
                  (unsigned long)full.counts.sweeps);
    ck_assert_uint_eq(part.counts.gradients,
                      part.counts.sweeps *
                          (uint64_t)nevh_integrator_sweep_gradients(scheme));
}

/* Sweeps of every second step; `fresh`: a guess knows the step before alone. */
static size_t count_sweeps(const problem *b, const nevh_integrator *scheme,
                           double h, bool fresh) {
    nevh_system *s = b->make();
    double q[MOST_DOF], p[MOST_DOF];
    size_t counted = 0;
    for (size_t k = 0; k < b->n; k++) {
        q[k] = b->q[k];
        p[k] = b->p[k];
    }
    nevh_options options = {.gradient = nevh_exact, .t = b->t0};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &options);
    for (size_t i = 0; i < 2 * STEPS; i++) {
        size_t before = nevh_stepper_counts(m).sweeps;
        double t = b->t0 + (double)i * h;
        if (fresh && i % 2 == 0)
            nevh_stepper_reset(m);
        ck_assert_int_eq(nevh_stepper_apply(m, t, h, q, p), NEVH_OK);
        counted += i % 2 * (nevh_stepper_counts(m).sweeps - before);
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
    return counted;
}

/* A guess from several steps saves sweeps, the more of them the fewer stages
   there are; of eight there is none. */
TEST_EACH(several_steps_lead_closer, SCHEMES) {
    static const problem *const subjects[] = {&driven_pendulum, &henon_heiles,
                                              &double_pendulum, &kepler};
    static const double part[SCHEMES] = {0.7,  0.83, 0.9, 1.01,
                                         0.93, 0.89, 0.92};
    const nevh_integrator *scheme = *schemes[_i];
    double h = fmin(0.01 * nevh_integrator_order(scheme), 0.05);
    size_t all = 0, one = 0;
    for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++) {
        all += count_sweeps(subjects[i], scheme, h, false);
        one += count_sweeps(subjects[i], scheme, h, true);
    }
    ck_assert_msg((double)all <= part[_i] * (double)one, "%s: %zu, not %zu",
                  nevh_integrator_name(scheme), all, one);
}

/* lobatto2 is the general Stoermer-Verlet method: on T(p) + V(q), verlet. */
TEST_EACH(lobatto2_is_verlet, 3) {
    const problem *b = separable[_i];
    result lobatto = solve(b, nevh_lobatto2, nevh_exact, false);
    result verlet = solve(b, nevh_verlet, nevh_exact, false);
    ck_assert_double_le(difference(&lobatto, &verlet), 1e-13);
    ck_assert_uint_le(lobatto.counts.sweeps, 2 * 3 * STEPS);
}

/* Its general form, by hand: p1 = p - h/2 H_q(q, p1),
   q1 = q + h/2 (H_p(q, p1) + H_p(q1, p1)), p2 = p1 - h/2 H_q(q1, p1). */
TEST(lobatto2_is_the_generalized_leapfrog) {
    const problem *b = &double_pendulum;
    const double h = 0.01, t[] = {0, 0};
    nevh_system *s = b->make();
    nevh_stepper *m = planned(s, b, nevh_lobatto2, nevh_exact);
    nevh_field *f = nevh_stepper_field(m);
    double q[2], p[2], q1[2], p1[2], dq[2], v[2], v1[2];
    memcpy(q, b->q, sizeof q);
    memcpy(p, b->p, sizeof p);
    memcpy(q1, q, sizeof q);
    memcpy(p1, p, sizeof p);
    for (int i = 0; i < 60; i++) {
        nevh_field_gradient(f, 1, t, q, p1, dq, v);
        nevh_field_gradient(f, 1, t, q1, p1, NULL, v1);
        for (int k = 0; k < 2; k++) {
            p1[k] = p[k] - h / 2 * dq[k];
            q1[k] = q[k] + h / 2 * (v[k] + v1[k]);
        }
    }
    nevh_field_gradient(f, 1, t, q1, p1, dq, NULL);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, h, q, p), NEVH_OK);
    for (int k = 0; k < 2; k++) {
        ck_assert_double_eq_tol(q[k], q1[k], 1e-15);
        ck_assert_double_eq_tol(p[k], p1[k] - h / 2 * dq[k], 1e-14);
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* A descriptor of one's own: more stages than any that is listed, and fewer
   than the family has. */
TEST_EACH(stages_of_ones_own, 2) {
    nevh_integrator own = *nevh_gauss4;
    const nevh_kernel *kernels[] = {&nevh_gauss_kernel, &nevh_lobatto_kernel};
    own.kernel = kernels[_i];
    own.stages = 12;
    result many = solve(&henon_heiles, &own, nevh_exact, false);
    result due = solve(&henon_heiles, nevh_gauss20, nevh_exact, false);
    ck_assert_double_le(difference(&many, &due), 1e-13);
    own.stages = _i;
    nevh_system *s = henon_heiles.make();
    nevh_stepper *m = nevh_stepper_new(s, &own, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
    ck_assert_ptr_nonnull(strstr(nevh_stepper_message(m), "stages"));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST(implicit_euler_has_one_stage) {
    nevh_integrator own = *nevh_implicit_euler;
    own.stages = 2;
    nevh_system *s = henon_heiles.make();
    nevh_stepper *m = nevh_stepper_new(s, &own, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
    ck_assert_ptr_nonnull(strstr(nevh_stepper_message(m), "1 to 1"));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

static double oscillator(double t, const double q[], const double p[],
                         const void *params) {
    (void)t, (void)params;
    return (p[0] * p[0] + q[0] * q[0]) / 2;
}

/* (q, p) at the end of the step is the solution of q - h p = q0, p + h q = p0:
   the energy is divided by 1 + h^2. */
TEST(implicit_euler_is_the_end_of_the_step) {
    const double h = 0.3, q0 = 0.7, p0 = -0.4;
    nevh_options options = {.gradient_step = 0x1p-3};
    nevh_system *s = nevh_system_from(1, oscillator, NULL);
    nevh_stepper *m = nevh_stepper_new(s, nevh_implicit_euler, &options);
    double q = q0, p = p0;
    ck_assert_int_eq(nevh_stepper_apply(m, 0, h, &q, &p), NEVH_OK);
    ck_assert_double_eq_tol(q, (q0 + h * p0) / (1 + h * h), 1e-15);
    ck_assert_double_eq_tol(p, (p0 - h * q0) / (1 + h * h), 1e-15);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Motion without forces is exact: the weights of a step add up to h, but for
   the last bit where they are many. */
TEST_EACH(free_motion, SCHEMES) {
    static const double mass[] = {1};
    static const double steps[] = {0.1, 0.3, 1 / 3., 0.7, 1e-3, 123.4};
    nevh_system *s = nevh_system_new(1);
    add_kinetic(s, 1, mass);
    nevh_options options = {.gradient = nevh_exact};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        nevh_stepper *m = nevh_stepper_new(s, *schemes[_i], &options);
        double q = 0, p = 1;
        ck_assert_int_eq(nevh_stepper_apply(m, 0, steps[i], &q, &p), NEVH_OK);
        double slack =
            nevh_integrator_stages(*schemes[_i]) > 4 ? DBL_EPSILON * q : 0;
        ck_assert(fabs(q - steps[i]) <= slack && p == 1);
        nevh_stepper_free(m);
    }
    nevh_system_free(s);
}

/* Newton's linear equations. */
TEST(factors) {
    double matrix[] = {0, 1, 2, 1, 0, 3, 4, -3, 8};
    double singular[] = {1, 2, 3, 2, 4, 6, 1, 0, 1};
    double x[] = {1 * 2 + 2 * 5, 3 + 3 * 5, 4 * 3 - 3 * 2 + 8 * 5};
    double wrong[] = {1, 2, NAN, 4};
    size_t pivot[3];
    ck_assert(nevh__factor(3, matrix, pivot));
    nevh__solve(3, matrix, pivot, x);
    ck_assert_double_eq_tol(x[0], 3, 1e-14);
    ck_assert_double_eq_tol(x[1], 2, 1e-14);
    ck_assert_double_eq_tol(x[2], 5, 1e-14);
    ck_assert(!nevh__factor(3, singular, pivot));
    ck_assert(!nevh__factor(2, wrong, pivot));
}
