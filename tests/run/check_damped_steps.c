/* nevh tests: all that holds of steppers holds with friction.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "damped.h"
#include <stdlib.h>

TEST_EACH(memory_can_be_kept, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    const double h = 0.0078125, t1 = 40 * h;
    if (refuses(scheme))
        skip_test("it refuses friction");
    nevh_system *s = damped(b, unequal);
    nevh_stepper *first = planned(s, b, scheme, nevh_central4);
    nevh_stepper *other = planned(s, b, scheme, nevh_central4);
    state x = start(b);
    for (int i = 0; i < 40; i++)
        nevh_stepper_apply(first, i * h, h, x.q, x.p);
    state y = x, z = x, branch = x;
    size_t size = nevh_stepper_save_size(first);
    void *buffer = malloc(size);
    nevh_stepper_save(first, buffer);
    nevh_stepper *copy = nevh_stepper_copy(first), *more;
    more = nevh_stepper_copy(first);
    nevh_run(copy, t1, h / 3, 5, branch.q, branch.p, NULL, 0);
    nevh_run(first, t1, h, 40, x.q, x.p, NULL, 0);
    ck_assert_int_eq(nevh_stepper_load(other, buffer, size), NEVH_OK);
    nevh_run(other, t1, h, 40, y.q, y.p, NULL, 0);
    ck_assert(same(b, &x, &y));
    nevh_run(more, t1, h, 40, z.q, z.p, NULL, 0);
    ck_assert(same(b, &x, &z));
    nevh_stepper_reset(other);
    z = start(b);
    nevh_run(other, 0, h, 80, z.q, z.p, NULL, 0);
    ck_assert(same(b, &x, &z));
    if (splits(scheme)) {
        nevh_system_enable(s, "drag", false);
        nevh_stepper *plain = planned(s, b, scheme, nevh_central4);
        ck_assert_int_eq(nevh_stepper_load(plain, buffer, size), NEVH_EINVAL);
        nevh_stepper_free(plain);
    }
    free(buffer);
    nevh_stepper_free(first);
    nevh_stepper_free(other);
    nevh_stepper_free(copy);
    nevh_stepper_free(more);
    nevh_system_free(s);
}

static int look(void *data, size_t step, double t, const double q[],
                const double p[]) {
    (void)data, (void)step, (void)t, (void)q, (void)p;
    return 0;
}

TEST_EACH(watching_changes_nothing, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    const double h = 0.0078125;
    if (refuses(scheme))
        skip_test("it refuses friction");
    nevh_system *s = damped(b, unequal);
    nevh_stepper *m = planned(s, b, scheme, nevh_central4);
    nevh_observer watch = {look, NULL, 1};
    state x = start(b), y = x, z = x;
    nevh_run(m, 0, h, 60, x.q, x.p, NULL, 0);
    nevh_stepper_reset(m);
    nevh_run(m, 0, h, 60, y.q, y.p, &watch, 1);
    ck_assert(same(b, &x, &y));
    nevh_stepper_reset(m);
    for (int i = 0; i < 60; i++)
        nevh_stepper_apply(m, i * h, h, z.q, z.p);
    ck_assert(same(b, &x, &z));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* H that is not finite at its k-th evaluation. */
typedef struct {
    size_t calls, fault;
} fuse;

static double fused(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    fuse *f = *(fuse *const *)params;
    (void)t, (void)p, (void)c;
    return ++f->calls == f->fault ? NAN : -1.7 * cos(q[0]);
}

enum { FUSED_STEPS = 8 };

/* Steps that fail are taken again; returns how many did. */
static int run_fused(const nevh_integrator *scheme, fuse *f,
                     double z[FUSED_STEPS + 1][2]) {
    const double mass = 1.3, rate = 0.4;
    int failures = 0;
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .nc = 1,
                                    .c = &mass,
                                    .value = mass_kinetic});
    nevh_system_add(
        s, &(nevh_term){
               .effect = "gravity", .nq = 1, .value = fused, .params = &f});
    nevh_system_add_friction(s, "drag", &rate);
    nevh_options o = {.gradient_step = 0x1p-10,
                      .tolerance = tolerance_for(scheme)};
    size_t fault = f->fault;
    f->fault = 0; /* planning may evaluate H, too */
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    *f = (fuse){0, fault};
    for (int i = 0; i < FUSED_STEPS; i++) {
        double x[2] = {z[i][0], z[i][1]};
        int status = nevh_stepper_apply(m, 0.1 * i, 0.1, x, x + 1);
        if (status) {
            failures++;
            ck_assert_mem_eq(x, z[i], sizeof x);
            status = nevh_stepper_apply(m, 0.1 * i, 0.1, x, x + 1);
        }
        ck_assert_int_eq(status, NEVH_OK);
        memcpy(z[i + 1], x, sizeof x);
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
    return failures;
}

TEST_EACH(fails_at_any_evaluation, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    double clean[FUSED_STEPS + 1][2] = {{1.7, 0.4}};
    double failed[FUSED_STEPS + 1][2] = {{1.7, 0.4}};
    fuse f = {0, 0};
    if (refuses(scheme))
        skip_test("it refuses friction");
    ck_assert_int_eq(run_fused(scheme, &f, clean), 0);
    size_t calls = f.calls, stride = calls / 40 + 1;
    for (size_t k = 1; k <= calls; k += k < 20 ? 1 : stride) {
        f = (fuse){0, k};
        ck_assert_int_eq(run_fused(scheme, &f, failed), 1);
        ck_assert_msg(memcmp(clean, failed, sizeof clean) == 0,
                      "%s, fault %zu: another orbit",
                      nevh_integrator_name(scheme), k);
    }
}

/* Backwards friction drives; beyond the range of numbers a step fails. */
TEST_EACH(overflow_is_a_failure, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    const double strong[] = {500, 500};
    if (!splits(scheme))
        skip_test("friction is not split off");
    nevh_system *s = damped(b, strong);
    nevh_stepper *m = planned(s, b, scheme, nevh_exact);
    nevh_stepper *other = planned(s, b, scheme, nevh_exact);
    state x = start(b), y;
    nevh_stepper_apply(m, b->t0, 1e-3, x.q, x.p);
    y = x;
    nevh_stepper *copy = nevh_stepper_copy(m);
    ck_assert_int_eq(nevh_stepper_apply(m, b->t0 + 1e-3, -4, y.q, y.p),
                     NEVH_EDOM);
    assert_says(nevh_stepper_message(m), "friction");
    ck_assert(same(b, &x, &y));
    nevh_stepper_apply(m, b->t0 + 1e-3, 1e-3, x.q, x.p);
    nevh_stepper_apply(copy, b->t0 + 1e-3, 1e-3, y.q, y.p);
    ck_assert(same(b, &x, &y));
    nevh_stepper_free(copy);
    nevh_stepper_free(m);
    nevh_stepper_free(other);
    nevh_system_free(s);
}
