/* nevh tests: the account of the energy is a part of the stepper.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "driven.h"
#include <stdlib.h>

/* What is asked for changes no bit of the orbit, and no count. */
TEST_EACH(asking_changes_nothing, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (!keeps_any(scheme))
        skip_test("it keeps no balance");
    for (size_t i = 0; i < PROBLEMS; i++) {
        const problem *b = driven_problems[i];
        if (!keeps(scheme, b))
            continue;
        nevh_counts counts[2];
        state z[2];
        nevh_system *s = b->make();
        for (int asked = 0; asked < 2; asked++) {
            nevh_options o = {.gradient = nevh_central4,
                              .t = b->t0,
                              .q = b->q,
                              .p = b->p,
                              .balance = asked};
            nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
            z[asked] = start(b);
            nevh_run(m, b->t0, 0.02, 40, z[asked].q, z[asked].p, NULL, 0);
            counts[asked] = nevh_stepper_counts(m);
            ck_assert((nevh_stepper_gain(m, 0) != 0) == asked);
            nevh_stepper_free(m);
        }
        ck_assert_mem_eq(z[0].q, z[1].q, b->n * sizeof(double));
        ck_assert_mem_eq(z[0].p, z[1].p, b->n * sizeof(double));
        ck_assert_mem_eq(&counts[0], &counts[1], sizeof counts[0]);
        nevh_system_free(s);
    }
}

/* Nothing comes in where nothing can. */
TEST(closed_systems) {
    nevh_system *s = henon_heiles.make();
    nevh_stepper *m = balanced(s, &henon_heiles, nevh_gsl_rkf45);
    nevh_stepper *unasked = planned(s, &henon_heiles, nevh_verlet, nevh_exact);
    nevh_energy *e = nevh_energy_new(s, NULL);
    ck_assert_int_eq(nevh_energy_follow(e, unasked), NEVH_OK);
    nevh_observer watch = {nevh_energy_observe, e, 1};
    state z = start(&henon_heiles);
    nevh_run(m, 0, 0.1, 10, z.q, z.p, NULL, 0);
    ck_assert(nevh_stepper_gain(m, 0) == 0);
    z = start(&henon_heiles);
    ck_assert_int_eq(nevh_run(unasked, 0, 0.1, 10, z.q, z.p, &watch, 1), 0);
    ck_assert(nevh_energy_result(e, 0).max > 0);
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_stepper_free(unasked);
    nevh_system_free(s);
}

/* The sum goes with the memory; a reset begins it, a jump does not. */
TEST_EACH(gain_can_be_kept, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (!keeps_any(scheme))
        skip_test("it keeps no balance");
    for (size_t i = 0; i < PROBLEMS; i++) {
        const problem *b = driven_problems[i];
        const double h = 0.0078125, t1 = 0.25 + 30 * h;
        if (!keeps(scheme, b))
            continue;
        nevh_system *s = b->make();
        nevh_stepper *m = balanced(s, b, scheme),
                     *other = balanced(s, b, scheme);
        state x = start(b);
        nevh_run(m, 0.25, h, 30, x.q, x.p, NULL, 0);
        state y = x, z = x;
        size_t size = nevh_stepper_save_size(m);
        void *buffer = malloc(size);
        nevh_stepper_save(m, buffer);
        nevh_stepper *copy = nevh_stepper_copy(m);
        ck_assert_int_eq(nevh_stepper_load(other, buffer, size), NEVH_OK);
        ck_assert(nevh_stepper_gain(other, 0) == nevh_stepper_gain(m, 0));
        nevh_run(m, t1, h, 30, x.q, x.p, NULL, 0);
        nevh_run(other, t1, h, 30, y.q, y.p, NULL, 0);
        nevh_run(copy, t1, h, 30, z.q, z.p, NULL, 0);
        double gain = nevh_stepper_gain(m, 0);
        ck_assert(gain != 0 && gain == nevh_stepper_gain(other, 0));
        ck_assert(gain == nevh_stepper_gain(copy, 0));
        z.q[0] += 0.01;
        nevh_run(copy, t1 + 30 * h, h, 1, z.q, z.p, NULL, 0);
        ck_assert_double_eq_tol(nevh_stepper_gain(copy, 0), gain, 0.05);
        ck_assert(nevh_stepper_gain(copy, 0) != gain);
        nevh_stepper_reset(copy);
        ck_assert(nevh_stepper_gain(copy, 0) == 0);
        ck_assert(nevh_stepper_gain(m, 1) == 0);
        free(buffer);
        nevh_stepper_free(m);
        nevh_stepper_free(other);
        nevh_stepper_free(copy);
        nevh_system_free(s);
    }
}

/* A lane's gain is that of the orbit that runs alone; also where a neighbour, or
   the lane itself, is put elsewhere. */
TEST_EACH(lanes_are_alone, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    enum { WIDTH = 5 };
    if (!keeps_any(scheme) || scheme->own_time)
        skip_test("it keeps no balance, or takes one orbit at a time");
    for (size_t i = 0; i < PROBLEMS; i++) {
        const problem *b = driven_problems[i];
        if (!keeps(scheme, b) || scheme->own_time)
            continue;
        double q[MOST_DOF * WIDTH], p[MOST_DOF * WIDTH];
        for (size_t k = 0; k < b->n * WIDTH; k++) {
            q[k] = b->q[k / WIDTH] * (1 + 0.1 * ((double)(k % WIDTH) - 3));
            p[k] = b->p[k / WIDTH] * (1 - 0.1 * ((double)(k % WIDTH) - 3));
        }
        nevh_system *s = b->make();
        nevh_options o = {
            .gradient = nevh_exact, .width = WIDTH, .balance = true};
        nevh_stepper *five = nevh_stepper_new(s, scheme, &o);
        o.width = 1;
        nevh_stepper *one = nevh_stepper_new(s, scheme, &o);
        state x;
        for (size_t k = 0; k < b->n; k++) {
            x.q[k] = q[k * WIDTH + 3];
            x.p[k] = p[k * WIDTH + 3];
        }
        ck_assert_int_eq(nevh_run(five, b->t0, 0.02, 30, q, p, NULL, 0), 0);
        ck_assert_int_eq(nevh_run(one, b->t0, 0.02, 30, x.q, x.p, NULL, 0), 0);
        ck_assert(nevh_stepper_gain(five, 3) == nevh_stepper_gain(one, 0));
        ck_assert(nevh_stepper_gain(five, 2) != nevh_stepper_gain(one, 0));
        for (size_t lane = 0; lane <= 3; lane += 3) {
            double t = b->t0 + 0.02 * (30 + (double)lane);
            q[lane] *= 1.1;
            x.q[0] = q[3];
            ck_assert_int_eq(nevh_run(five, t, 0.02, 3, q, p, NULL, 0), 0);
            ck_assert_int_eq(nevh_run(one, t, 0.02, 3, x.q, x.p, NULL, 0), 0);
            ck_assert(nevh_stepper_gain(five, 3) == nevh_stepper_gain(one, 0));
        }
        nevh_stepper_free(five);
        nevh_stepper_free(one);
        nevh_system_free(s);
    }
}

/* Steps that fail leave the sum alone: H is not finite at its k-th value. */
typedef struct {
    size_t calls, fault;
} fuse;

static double fused(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    fuse *f = *(fuse *const *)params;
    return ++f->calls == f->fault ? NAN : driven_value(t, q, p, c, NULL);
}

enum { FUSED_STEPS = 6 };

/* Returns how many steps failed, and were taken again. */
static int run_fused(const nevh_integrator *scheme, fuse *f, size_t fault,
                     double gain[FUSED_STEPS]) {
    const double mass = 1.3, rate = 0.4, q0 = 1.7, p0 = 0.4;
    double q = q0, p = p0;
    int failures = 0;
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .nc = 1,
                                    .c = &mass,
                                    .value = mass_kinetic});
    nevh_system_add(s, &(nevh_term){.effect = "gravity",
                                    .nq = 1,
                                    .time = true,
                                    .value = fused,
                                    .params = &f});
    if (!scheme->own_time)
        nevh_system_add_friction(s, "drag", &rate);
    nevh_options o = {
        .gradient_step = 0x1p-10, .q = &q0, .p = &p0, .balance = true};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_OK);
    f->calls = 0;
    f->fault = fault;
    for (int i = 0; i < FUSED_STEPS; i++) {
        double before = nevh_stepper_gain(m, 0);
        int status = nevh_stepper_apply(m, 0.1 * i, 0.1, &q, &p);
        if (status) {
            failures++;
            ck_assert(nevh_stepper_gain(m, 0) == before);
            assert_says(nevh_stepper_message(m), "gravity");
            status = nevh_stepper_apply(m, 0.1 * i, 0.1, &q, &p);
        }
        ck_assert_int_eq(status, NEVH_OK);
        gain[i] = nevh_stepper_gain(m, 0);
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
    return failures;
}

TEST_EACH(fails_at_any_evaluation, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    double clean[FUSED_STEPS], failed[FUSED_STEPS];
    fuse f = {0, 0};
    if (scheme->kernel->opaque)
        skip_test("it keeps no balance");
    ck_assert_int_eq(run_fused(scheme, &f, 0, clean), 0);
    size_t calls = f.calls, stride = calls / 40 + 1;
    for (size_t k = 1; k <= calls; k += stride) {
        ck_assert_int_eq(run_fused(scheme, &f, k, failed), 1);
        ck_assert_mem_eq(clean, failed, sizeof clean);
    }
}

/* Refusals. */

TEST_EACH(out_of_reach, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (!scheme->kernel->opaque)
        skip_test("it keeps a balance");
    nevh_system *s = driven_pendulum.make();
    nevh_options o = {.tolerance = tolerance_for(scheme), .balance = true};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
    assert_says(nevh_stepper_message(m), "balance");
    assert_says(nevh_stepper_message(m), nevh_integrator_name(scheme));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* A kernel that forgets a part is found out. */
static int no_plan(nevh_work *w) {
    (void)w;
    return NEVH_OK;
}

static int forgetful(nevh_work *w, double t, double h, double q[], double p[]) {
    return nevh_work_account(w, NEVH_OF_Q, h, &t, q, p);
}

TEST(incomplete_accounts) {
    const nevh_kernel kernel = {.plan = no_plan, .step = forgetful};
    const nevh_integrator scheme = {
        .name = "forgetful", .source = "here", .order = 1, .kernel = &kernel};
    nevh_system *s = driven_pendulum.make();
    nevh_stepper *m = balanced(s, &driven_pendulum, &scheme);
    nevh_energy *e = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, e, 1};
    state z = start(&driven_pendulum);
    ck_assert_int_eq(nevh_energy_follow(e, m), NEVH_OK);
    ck_assert_int_eq(nevh_run(m, 0, 0.1, 9, z.q, z.p, &watch, 1), NEVH_STOPPED);
    ck_assert_uint_eq(nevh_stepper_taken(m), 1);
    ck_assert(isnan(nevh_stepper_gain(m, 0)));
    ck_assert_int_eq(nevh_energy_status(e), NEVH_EDOM);
    assert_says(nevh_energy_message(e), "forgetful");
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

static void assert_not_followed(const nevh_system *s, const nevh_stepper *m,
                                size_t width, const char *word) {
    nevh_energy *e = nevh_energy_new(s, &(nevh_options){.width = width});
    ck_assert_int_eq(nevh_energy_follow(e, m), NEVH_EINVAL);
    ck_assert_int_eq(nevh_energy_status(e), NEVH_EINVAL);
    assert_says(nevh_energy_message(e), word);
    double x[4] = {0};
    ck_assert_int_eq(nevh_energy_observe(e, 0, 0, x, x), NEVH_EINVAL);
    nevh_energy_free(e);
}

TEST(not_followed) {
    const problem *b = &driven_pendulum;
    nevh_system *s = b->make(), *other = b->make();
    nevh_stepper *asked = balanced(s, b, nevh_verlet);
    nevh_stepper *plain = planned(s, b, nevh_verlet, nevh_exact);
    nevh_stepper *refused = nevh_stepper_new(s, NULL, NULL);
    assert_not_followed(s, plain, 1, "balance");
    assert_not_followed(s, asked, 2, "2");
    assert_not_followed(other, asked, 1, "another system");
    assert_not_followed(s, refused, 1, "refused");
    assert_not_followed(s, NULL, 1, "memory");
    nevh_energy *e = nevh_energy_new(s, NULL);
    nevh_energy_observe(e, 0, b->t0, b->q, b->p);
    ck_assert_int_eq(nevh_energy_follow(e, asked), NEVH_EINVAL);
    assert_says(nevh_energy_message(e), "first");
    nevh_energy_free(e);
    nevh_stepper_free(asked);
    nevh_stepper_free(plain);
    nevh_stepper_free(refused);
    nevh_system_free(s);
    nevh_system_free(other);
}
