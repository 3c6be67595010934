/* nevh tests: friction as an effect, and steppers that are told of it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "damped.h"
#include <float.h>

/* What a system says. */

TEST(rates_add_up) {
    const double a[] = {0.5, 0.25}, b[] = {1, -0.125};
    double sum[2];
    nevh_system *s = henon_heiles.make();
    ck_assert(!nevh_system_friction(s, sum));
    ck_assert(sum[0] == 0 && sum[1] == 0);
    size_t effects = nevh_system_effect_count(s);
    nevh_system_add_friction(s, "air", a);
    nevh_system_add_friction(s, "water", b);
    nevh_system_add_friction(s, "air", a);
    ck_assert_uint_eq(nevh_system_effect_count(s), effects + 2);
    ck_assert_str_eq(nevh_system_effect_name(s, effects), "air");
    ck_assert_str_eq(nevh_system_effect_name(s, effects + 1), "water");
    ck_assert(nevh_system_friction(s, sum));
    ck_assert(sum[0] == 2 && sum[1] == 0.375);
    ck_assert_int_eq(nevh_system_enable(s, "air", false), NEVH_OK);
    ck_assert(nevh_system_friction(s, sum));
    ck_assert(sum[0] == 1 && sum[1] == -0.125);
    nevh_system_enable(s, "water", false);
    ck_assert(!nevh_system_friction(s, NULL));
    ck_assert(!nevh_system_effect_on(s, "water"));
    nevh_system_free(s);
}

/* Terms and friction of one name are one effect. */
TEST(an_effect_of_both_kinds) {
    double values[4], sum[2];
    nevh_system *s = henon_heiles.make();
    nevh_system_add_friction(s, "potential", unequal);
    nevh_system_add_friction(s, "drag", equal);
    ck_assert_uint_eq(nevh_system_effect_count(s), 3);
    nevh_field *f = nevh_field_new(s, NULL);
    nevh_field_effects(f, 0, henon_heiles.q, henon_heiles.p, values);
    ck_assert(values[0] != 0 && values[1] != 0 && values[2] == 0);
    ck_assert_uint_eq(nevh_field_effect_values(f, "drag"), 0);
    nevh_field_free(f);
    nevh_system_enable(s, "potential", false);
    nevh_system_friction(s, sum);
    ck_assert(sum[0] == equal[0] && sum[1] == equal[1]);
    ck_assert_uint_eq(nevh_system_traits(s), NEVH_SEPARABLE | NEVH_AUTONOMOUS);
    nevh_system_free(s);
}

static void assert_bad(const char *effect, const double rates[],
                       const char *word) {
    nevh_system *s = henon_heiles.make();
    size_t effects = nevh_system_effect_count(s);
    ck_assert_int_eq(nevh_system_add_friction(s, effect, rates), NEVH_EINVAL);
    ck_assert_int_eq(nevh_system_status(s), NEVH_EINVAL);
    assert_says(nevh_system_message(s), word);
    ck_assert_uint_eq(nevh_system_effect_count(s), effects);
    ck_assert(!nevh_system_friction(s, NULL));
    ck_assert_int_eq(nevh_system_add_friction(s, "drag", equal), NEVH_EINVAL);
    nevh_stepper *m = nevh_stepper_new(s, nevh_verlet, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST(bad_rates) {
    assert_bad("drag", (double[]){0.1, NAN}, "nan");
    assert_bad("drag", (double[]){INFINITY, 0.1}, "p[0]");
    assert_bad("drag", (double[]){0, -INFINITY}, "-inf");
    assert_bad("drag", NULL, "NULL");
    assert_bad("", equal, "name");
    assert_bad(NULL, equal, "name");
    nevh_system *s = henon_heiles.make();
    const double huge[] = {0, DBL_MAX};
    nevh_system_add_friction(s, "a", huge);
    nevh_system_add_friction(s, "b", huge);
    nevh_stepper *m = nevh_stepper_new(s, nevh_verlet, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
    assert_says(nevh_stepper_message(m), "p[1]");
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Adding or switching it makes steppers stale; copies of these stay so. */
TEST(changes_are_noticed) {
    nevh_system *s = damped(&henon_heiles, equal);
    nevh_stepper *m = planned(s, &henon_heiles, nevh_verlet, nevh_exact);
    state z = start(&henon_heiles);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z.q, z.p), NEVH_OK);
    nevh_system_enable(s, "drag", false);
    ck_assert_int_eq(nevh_stepper_apply(m, 0.1, 0.1, z.q, z.p), NEVH_ESTALE);
    nevh_stepper *copy = nevh_stepper_copy(m);
    ck_assert_int_eq(nevh_stepper_apply(copy, 0.1, 0.1, z.q, z.p), NEVH_ESTALE);
    nevh_stepper_free(copy);
    nevh_stepper_free(m);
    m = planned(s, &henon_heiles, nevh_verlet, nevh_exact);
    nevh_system_add_friction(s, "more", equal);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z.q, z.p), NEVH_ESTALE);
    copy = nevh_stepper_copy(m);
    ck_assert_int_eq(nevh_stepper_apply(copy, 0, 0.1, z.q, z.p), NEVH_ESTALE);
    nevh_stepper_free(copy);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* What a stepper says. */

TEST_EACH(order_to_expect, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    nevh_system *s = damped(b, unequal);
    nevh_stepper *m = nevh_stepper_new(s, scheme, NULL);
    int order = nevh_integrator_order(scheme);
    if (refuses(scheme))
        ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
    ck_assert_int_eq(nevh_stepper_order(m),
                     splits(scheme) && order > 2 ? 2 : order);
    nevh_stepper_free(m);
    nevh_system_enable(s, "drag", false);
    m = nevh_stepper_new(s, scheme, NULL);
    ck_assert_int_eq(nevh_stepper_order(m), order);
    nevh_stepper_free(m);
    m = nevh_stepper_new(s, NULL, NULL);
    ck_assert_int_eq(nevh_stepper_order(m), 0);
    ck_assert_int_eq(nevh_stepper_order(NULL), 0);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST(own_times_are_refused) {
    nevh_integrator varies = **&nevh_verlet;
    varies.name = "varies";
    varies.own_time = true;
    nevh_system *s = damped(&henon_heiles, equal);
    nevh_stepper *m = nevh_stepper_new(s, &varies, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_ESTRUCT);
    assert_says(nevh_stepper_message(m), "varies");
    assert_says(nevh_stepper_message(m), "friction");
    nevh_stepper_free(m);
    nevh_system_enable(s, "drag", false);
    m = nevh_stepper_new(s, &varies, NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_OK);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* A scheme of its own: q and p stay as they are, memory holds p. */
static int hold_plan(nevh_work *w) {
    w->memory_rows = w->n + 1;
    return NEVH_OK;
}

static int hold(nevh_work *w, double t, double h, double q[], double p[]) {
    (void)t, (void)h, (void)q;
    double *begun = w->memory + w->size;
    for (size_t i = 0; i < w->size; i++) {
        if (begun[i % w->width] != 0)
            ck_assert_double_eq_tol(w->memory[i], p[i], 1e-15 * fabs(p[i]));
        w->memory[i] = p[i];
    }
    for (size_t lane = 0; lane < w->width; lane++)
        begun[lane] = 1;
    if (w->friction)
        for (size_t i = 0; i < w->size; i++)
            p[i] -= h * w->friction[i / w->width] * p[i];
    return NEVH_OK;
}

static void hold_friction(nevh_work *w, const double factor[]) {
    for (size_t i = 0; i < w->size; i++)
        w->memory[i] *= factor[i / w->width];
}

static nevh_integrator holding(const nevh_kernel *kernel) {
    return (nevh_integrator){
        .name = "hold", .source = "here", .order = 4, .kernel = kernel};
}

/* The kernel is told of each factor between its steps, also of lanes that
   jump and of steps that change. */
TEST(memory_is_damped_with_p) {
    const nevh_kernel kernel = {
        .plan = hold_plan, .step = hold, .apply_friction = hold_friction};
    nevh_integrator scheme = holding(&kernel);
    nevh_system *s = damped(&henon_heiles, unequal);
    nevh_stepper *m = nevh_stepper_new(s, &scheme, &(nevh_options){.width = 2});
    double q[4] = {0}, p[4] = {1, -2, 3, -4}, t = 0;
    for (int i = 0; i < 40; i++) {
        double h = i % 7 == 3 ? -0.3 : 0.2;
        ck_assert_int_eq(nevh_stepper_apply(m, t, h, q, p), NEVH_OK);
        t += h;
        p[i % 4] += i % 11 == 5;
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* One that has friction itself is given the rates, and left alone. */
TEST(a_kernel_takes_the_rates) {
    const nevh_kernel kernel = {
        .plan = hold_plan, .step = hold, .has_friction = true};
    nevh_integrator scheme = holding(&kernel);
    nevh_system *s = damped(&henon_heiles, unequal);
    nevh_stepper *m = nevh_stepper_new(s, &scheme, NULL);
    ck_assert_int_eq(nevh_stepper_order(m), 4);
    double q[2] = {0}, p[2] = {1, -2};
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.5, q, p), NEVH_OK);
    ck_assert(p[0] == 1 - 0.5 * 0.21 && p[1] == -2 + 0.5 * 0.08 * 2);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* What it does to orbits. */

static state orbit_on(nevh_system *s, const problem *b,
                      const nevh_integrator *scheme, nevh_counts *counts) {
    nevh_stepper *m = planned(s, b, scheme, nevh_central4);
    state z = start(b);
    ck_assert_int_eq(nevh_run(m, b->t0, 0.02, 60, z.q, z.p, NULL, 0), 0);
    *counts = nevh_stepper_counts(m);
    nevh_stepper_free(m);
    return z;
}

TEST_EACH(none_leaves_no_trace, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    const double zeros[] = {0, -0.}, opposite[] = {-0.21, -0.08};
    nevh_counts without, with;
    nevh_system *s = b->make();
    state plain = orbit_on(s, b, scheme, &without);
    nevh_system_add_friction(s, "nothing", zeros);
    state x = orbit_on(s, b, scheme, &with);
    ck_assert(same(b, &plain, &x));
    nevh_system_add_friction(s, "drag", unequal);
    nevh_system_enable(s, "drag", false);
    x = orbit_on(s, b, scheme, &with);
    ck_assert(same(b, &plain, &x));
    nevh_system_enable(s, "drag", true);
    nevh_system_add_friction(s, "drive", opposite);
    x = orbit_on(s, b, scheme, &with);
    ck_assert(same(b, &plain, &x));
    ck_assert_mem_eq(&without, &with, sizeof with);
    nevh_system_enable(s, "drive", false);
    if (!refuses(scheme)) {
        x = orbit_on(s, b, scheme, &with);
        ck_assert(!same(b, &plain, &x));
    }
    nevh_system_free(s);
}
