/* nevh tests: the balance of the energy, where H reads t or there is friction.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "driven.h"

/* The report on a run, and its status; with the balance where `followed`. */
static nevh_energy_report try_report(const problem *b,
                                     const nevh_integrator *scheme,
                                     bool followed, double h, size_t steps,
                                     int *status) {
    nevh_system *s = b->make();
    nevh_stepper *m = balanced(s, b, scheme);
    nevh_energy *e = nevh_energy_new(s, NULL);
    if (followed)
        ck_assert_msg(!nevh_energy_follow(e, m), "%s", nevh_energy_message(e));
    nevh_observer watch = {nevh_energy_observe, e, 1};
    state z = start(b);
    *status = nevh_run(m, b->t0, h, steps, z.q, z.p, &watch, 1);
    ck_assert_str_eq(nevh_energy_message(e), "");
    nevh_energy_report r = nevh_energy_result(e, 0);
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
    return r;
}

static nevh_energy_report report_on(const problem *b,
                                    const nevh_integrator *scheme,
                                    bool followed, double h, size_t steps) {
    int status;
    nevh_energy_report r = try_report(b, scheme, followed, h, steps, &status);
    ck_assert_msg(status == NEVH_OK, "%s on %s: status %d",
                  nevh_integrator_name(scheme), b->name, status);
    return r;
}

/* The error of the balance falls with the scheme's order.  Beyond order 8 the
   power law is hardly seen before rounding; there the error falls to it.  Of
   Runge-Kutta methods of order 2 the energy itself is wrong in order 3, with a
   sign that may differ from friction's part: only small steps show order 2. */
static void assert_order(const problem *b, const nevh_integrator *scheme) {
    enum { MOST = 5 };
    double x[MOST], y[MOST], error = INFINITY;
    int count = 0, order = nevh_integrator_order(scheme);
    bool high = order > 8;
    bool keeps_h = nevh_integrator_preserves_energy(scheme) == NEVH_YES;
    double above = order == 1   ? 3e-2
                   : order == 2 ? 2e-5
                   : order <= 4 ? 1e-3
                                : 1e-5;
    for (double steps = b->fewest; steps < 4e5 && count < MOST && error > 3e-13;
         steps = ceil(steps * 1.4)) {
        int status; /* the longest steps may be too long */
        error =
            try_report(b, scheme, true, b->span / steps, (size_t)steps, &status)
                .max;
        if (!status && error < above && error > 3e-13) {
            x[count] = -log(steps);
            y[count++] = log(error);
        }
    }
    if (count < 4) {
        ck_assert_msg(high || keeps_h, "%s on %s: only %d points",
                      nevh_integrator_name(scheme), b->name, count);
        ck_assert_double_lt(error, 3e-13);
        return;
    }
    double slope = slope_through(count, x, y);
    ck_assert_msg(slope >= (high ? 0.7 : 0.85) * order,
                  "%s on %s: order %d, measured %.3f at %d points",
                  nevh_integrator_name(scheme), b->name, order, slope, count);
}

TEST_EACH(order_of_scheme, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (!keeps_any(scheme))
        skip_test("it keeps no balance");
    for (size_t i = 0; i < PROBLEMS; i++)
        if (keeps(scheme, driven_problems[i]))
            assert_order(driven_problems[i], scheme);
}

/* The energy itself does change, however small the steps. */
TEST(energy_is_not_kept) {
    for (size_t i = 0; i < PROBLEMS; i++) {
        const problem *b = driven_problems[i];
        nevh_energy_report h =
            report_on(b, nevh_gauss8, false, b->span / 400, 400);
        nevh_energy_report balance =
            report_on(b, nevh_gauss8, true, b->span / 400, 400);
        ck_assert_double_gt(h.max, 0.05);
        ck_assert_double_lt(balance.max, 1e-12);
        ck_assert_double_eq(h.scale, balance.scale);
        ck_assert_double_eq(h.initial, balance.initial);
    }
}

/* Symplectic schemes keep the balance for long where the orbit is regular. */
static void assert_bounded(const nevh_integrator *scheme, double h,
                           size_t steps) {
    nevh_energy_report r = report_on(&driven_pendulum, scheme, true, h, steps);
    ck_assert_msg(r.verdict == NEVH_BOUNDED && r.max > 1e-7 && r.max < 0.1,
                  "%s: %s, %.2e", nevh_integrator_name(scheme),
                  nevh_verdict_name(r.verdict), r.max);
}

TEST(bounded_for_long) {
    assert_bounded(nevh_verlet, 0.1, 20000);
    assert_bounded(nevh_gauss4, 0.2, 5000);
    nevh_energy_report r =
        report_on(&driven_pendulum, nevh_rk4, true, 0.2, 5000);
    ck_assert_msg(r.verdict == NEVH_DRIFTS || r.verdict == NEVH_UNSTABLE,
                  "rk4: %s", nevh_verdict_name(r.verdict));
}

TEST_TAGGED(bounded_for_very_long, "slow", 0, 1) {
    assert_bounded(nevh_verlet, 0.1, 1000000);
    assert_bounded(nevh_position_verlet, 0.1, 1000000);
    assert_bounded(nevh_gauss4, 0.2, 300000);
}

/* A term of t alone adds f(t) - f(0) to H, and nothing to the orbit. */
TEST(time_alone) {
    nevh_system *s = henon_heiles.make();
    nevh_system_add(s, &(nevh_term){.effect = "clock",
                                    .time = true,
                                    .value = clock_term,
                                    .gradient = no_gradient});
    nevh_stepper *m = balanced(s, &henon_heiles, nevh_gauss8);
    state z = start(&henon_heiles);
    ck_assert_int_eq(nevh_run(m, 0, 0.05, 200, z.q, z.p, NULL, 0), NEVH_OK);
    ck_assert_double_eq_tol(nevh_stepper_gain(m, 0), 1.5 * (cos(23) - 1) + 1,
                            1e-12);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Sums of many steps are compensated. */
static double slowly(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)q, (void)p, (void)c, (void)params;
    return 0.7 * t;
}

TEST(many_steps) {
    nevh_system *s = henon_heiles.make();
    nevh_system_add(s, &(nevh_term){.effect = "ramp",
                                    .time = true,
                                    .value = slowly,
                                    .gradient = no_gradient});
    nevh_stepper *m = balanced(s, &henon_heiles, nevh_verlet);
    state z = start(&henon_heiles);
    nevh_run(m, 0, 0.01, 50000, z.q, z.p, NULL, 0);
    ck_assert_double_eq_tol(nevh_stepper_gain(m, 0) / 350, 1, 8e-16);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* What came in before the first observation does not count. */
TEST(observed_from_the_middle) {
    const problem *b = &driven_pendulum;
    nevh_system *s = b->make();
    nevh_stepper *m = balanced(s, b, nevh_gauss8);
    nevh_energy *e = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, e, 1};
    state z = start(b);
    ck_assert_int_eq(nevh_energy_follow(e, m), NEVH_OK);
    nevh_run(m, b->t0, 0.05, 40, z.q, z.p, NULL, 0);
    ck_assert_double_gt(fabs(nevh_stepper_gain(m, 0)), 0.01);
    nevh_run(m, b->t0 + 2, 0.05, 40, z.q, z.p, &watch, 1);
    ck_assert_double_lt(nevh_energy_result(e, 0).max, 1e-11);
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* An end between two steps is reached by a step that branches off: it counts in
   what is shown there, and leaves the account of the orbit, and what friction
   has rounded off, as they were. */
TEST_EACH(ends_between_steps, 6) {
    static const struct {
        const problem *b;
        const nevh_integrator *const *scheme;
    } all[] = {{&driven_pendulum, &nevh_verlet},
               {&driven_pendulum, &nevh_gauss4},
               {&driven_pendulum, &nevh_adaptive_verlet},
               {&damped, &nevh_verlet},
               {&driven_damped, &nevh_gauss4},
               {&driven_damped, &nevh_rk4}};
    const problem *b = all[_i].b;
    const nevh_integrator *scheme = *all[_i].scheme;
    const double h = 0.05;
    nevh_system *s = b->make();
    nevh_stepper *m = balanced(s, b, scheme), *plain = balanced(s, b, scheme);
    nevh_energy *e = nevh_energy_new(s, NULL);
    ck_assert_int_eq(nevh_energy_follow(e, m), NEVH_OK);
    nevh_observer watch = {nevh_energy_observe, e, 1};
    state x = start(b), y = x;
    nevh_run(plain, b->t0, h, 20, y.q, y.p, NULL, 0);
    double before = nevh_stepper_time(plain);
    nevh_run(plain, before, h, 1, y.q, y.p, NULL, 0);
    double t = nevh_stepper_time(plain), part = 0.4 * (t - before);
    int status = nevh_run_until(m, b->t0, h, t + part, x.q, x.p, &watch, 1);
    ck_assert_msg(status == NEVH_OK, "%s", nevh_stepper_message(m));
    ck_assert_uint_eq(nevh_stepper_taken(m), 22);
    nevh_energy_report r = nevh_energy_result(e, 0);
    ck_assert_uint_eq(r.samples, 23);
    ck_assert_msg(r.max < 2e-3, "%s on %s: %.2e", nevh_integrator_name(scheme),
                  b->name, r.max);
    ck_assert(nevh_stepper_gain(m, 0) == nevh_stepper_gain(plain, 0));
    x = y;
    nevh_run(m, t, h, 30, x.q, x.p, NULL, 0);
    nevh_run(plain, t, h, 30, y.q, y.p, NULL, 0);
    ck_assert_mem_eq(x.q, y.q, b->n * sizeof(double));
    ck_assert_mem_eq(x.p, y.p, b->n * sizeof(double));
    ck_assert(nevh_stepper_gain(m, 0) == nevh_stepper_gain(plain, 0));
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_stepper_free(plain);
    nevh_system_free(s);
}
