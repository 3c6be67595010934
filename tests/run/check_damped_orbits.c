/* nevh tests: what friction does to orbits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "damped.h"
#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <stdlib.h>

/* p of a free particle, or of one without H at all, is p0 exp(-rate t).  Schemes by
   parts need H to have one. */
static void assert_decay(const nevh_integrator *scheme, bool moves, double rate,
                         double h, size_t steps) {
    nevh_system *s = nevh_system_new(1);
    const double mass = 1.3;
    if (moves || nevh_integrator_needs(scheme) & NEVH_PARTS)
        add_kinetic(s, 1, &mass);
    nevh_system_add_friction(s, "drag", &rate);
    nevh_options o = {.gradient = nevh_exact};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    double q = 0.4, p = -0.7, t = (double)steps * h;
    ck_assert_int_eq(nevh_run(m, 0, h, steps, &q, &p, NULL, 0), NEVH_OK);
    double expected = -0.7 * exp(-rate * t);
    double allowed = (2 + fabs(rate * t)) * DBL_EPSILON * fabs(expected);
    ck_assert_msg(
        fabs(p - expected) <= allowed, "%s, rate %g, h %g: relative error %.2e",
        nevh_integrator_name(scheme), rate, h, fabs(p / expected - 1));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST_EACH(decay_is_exact, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    /* Where copies of q and p are bound, rounding of q comes back to p. */
    if (!splits(scheme) || nevh_integrator_symplectic(scheme) == NEVH_EXTENDED)
        skip_test("friction is not split off, or copies are bound");
    assert_decay(scheme, true, 0.1, 0.01, 10000);
    assert_decay(scheme, false, 0.37, 0.001, 10000);
    assert_decay(scheme, true, -0.37, 0.001, 10000);
    assert_decay(scheme, false, 0.3, -0.003, 1000);
    assert_decay(scheme, true, 7.7, 0.5, 50);
    assert_decay(scheme, false, 1.3, 1, 200);
    assert_decay(scheme, false, 1e-9, 0.1, 10000);
}

/* An independent reference: GSL's Prince-Dormand with dp/dt written out. */
typedef struct {
    nevh_field *field;
    size_t n;
    const double *rates;
} slopes;

static int right_hand_side(double t, const double y[], double dydt[],
                           void *params) {
    const slopes *f = params;
    size_t n = f->n;
    if (nevh_field_gradient(f->field, 1, &t, y, y + n, dydt + n, dydt))
        return GSL_EBADFUNC;
    for (size_t i = n; i < 2 * n; i++)
        dydt[i] = -dydt[i] - f->rates[i - n] * y[i];
    return GSL_SUCCESS;
}

static state reference(const problem *b, const double rates[]) {
    nevh_system *s = b->make();
    nevh_options o = {.gradient = nevh_exact, .q = b->q, .p = b->p};
    slopes f = {nevh_field_new(s, &o), b->n, rates};
    gsl_odeiv2_system ode = {right_hand_side, NULL, 2 * b->n, &f};
    gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_y_new(
        &ode, gsl_odeiv2_step_rk8pd, 1e-3, 1e-14, 1e-14);
    double y[2 * MOST_DOF], t = b->t0;
    memcpy(y, b->q, b->n * sizeof *y);
    memcpy(y + b->n, b->p, b->n * sizeof *y);
    ck_assert_int_eq(gsl_odeiv2_driver_apply(driver, &t, b->t0 + b->span, y),
                     GSL_SUCCESS);
    state z;
    memcpy(z.q, y, b->n * sizeof *y);
    memcpy(z.p, y + b->n, b->n * sizeof *y);
    gsl_odeiv2_driver_free(driver);
    nevh_field_free(f.field);
    nevh_system_free(s);
    return z;
}

/* p^2/2.6 + 0.8 q^2, whose damped motion is known. */
static double spring(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return 0.8 * q[0] * q[0];
}

static void spring_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)c, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = 1.6 * q[i];
}

static nevh_system *make_spring(void) {
    static const double mass = 1.3;
    nevh_system *s = nevh_system_new(1);
    add_kinetic(s, 1, &mass);
    nevh_system_add(s, &(nevh_term){.effect = "spring",
                                    .nq = 1,
                                    .value = spring,
                                    .gradient = spring_gradient});
    return s;
}

static const problem oscillator = {
    .name = "oscillator",
    .n = 1,
    .separable = true,
    .quadratic = true,
    .span = 7,
    .fewest = 6,
    .q = {0.9},
    .p = {-0.3},
    .make = make_spring,
};

/* m q'' + m rate q' + 1.6 q = 0, p = m q'. */
static state oscillator_solution(double rate) {
    const double m = 1.3, t = oscillator.span, decay = exp(-rate * t / 2);
    double w = sqrt(1.6 / m - rate * rate / 4), q0 = 0.9, v0 = -0.3 / m;
    double b = (v0 + rate * q0 / 2) / w, c = cos(w * t), s = sin(w * t);
    double q = decay * (q0 * c + b * s);
    double v = decay * w * (b * c - q0 * s) - rate / 2 * q;
    return (state){.q = {q}, .p = {m * v}};
}

static void assert_order(const problem *b, const nevh_integrator *scheme,
                         const double rates[], const state *exact) {
    enum { MOST = 5 };
    double x[MOST], y[MOST];
    int count = 0;
    nevh_system *s = damped(b, rates);
    nevh_stepper *m = planned(s, b, scheme, nevh_exact);
    int order = splits(scheme) ? (int)fmin(2, order_on(b, scheme))
                               : nevh_stepper_order(m);
    bool doubled = nevh_integrator_symplectic(scheme) == NEVH_EXTENDED;
    bool keeps = nevh_integrator_preserves_energy(scheme) == NEVH_YES;
    double above = order == 1 ? (keeps ? 2e-4 : 1e-2) : doubled ? 1e-7 : 1e-5;
    for (double steps = b->fewest; steps < 4e5 && count < MOST;
         steps = ceil(steps * 1.4)) {
        state z = start(b);
        nevh_stepper_reset(m);
        int status = nevh_run(m, b->t0, b->span / steps, (size_t)steps, z.q,
                              z.p, NULL, 0);
        double error = status ? INFINITY : distance(b, &z, exact);
        if (error < 1e-12)
            break;
        if (error < above) {
            x[count] = -log(steps);
            y[count++] = log(error);
        }
    }
    double slope = slope_through(count, x, y), slack = order > 2 ? 0.15 : 0.05;
    ck_assert_msg(count >= 4 && fabs(slope - order) <= slack * order,
                  "%s on %s: order %d, measured %.3f at %d points",
                  nevh_integrator_name(scheme), b->name, order, slope, count);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST_EACH(order_of_scheme, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *const coupled[] = {&henon_heiles, &relativistic,
                                      &double_pendulum};
    if (refuses(scheme) || nevh_integrator_needs_tolerance(scheme))
        skip_test("it refuses friction, or has no fixed steps");
    state exact = oscillator_solution(unequal[0]);
    assert_order(&oscillator, scheme, unequal, &exact);
    for (size_t i = 0; i < 3; i++)
        if (fits(scheme, coupled[i])) {
            exact = reference(coupled[i], unequal);
            assert_order(coupled[i], scheme, unequal, &exact);
        }
}

TEST(independent_reference) {
    state exact = oscillator_solution(unequal[0]);
    state other = reference(&oscillator, unequal);
    ck_assert_double_lt(distance(&oscillator, &exact, &other), 1e-13);
}

/* The largest element of |M'JM - factor J|, M being the derivative of a step by
   differences of order 6. */
static double conformal_defect(nevh_stepper *m, const problem *b, double h,
                               double factor) {
    static const double weights[3] = {1.5, -0.6, 0.1};
    size_t n = b->n, size = 2 * n;
    double map[2 * MOST_DOF][2 * MOST_DOF] = {{0}}, most = 0;
    for (size_t j = 0; j < size; j++)
        for (int c = -3; c <= 3; c++) {
            double move = c * 0x1p-8;
            state z = start(b);
            if (c == 0)
                continue;
            *(j < n ? &z.q[j] : &z.p[j - n]) += move;
            nevh_stepper_reset(m);
            ck_assert_int_eq(nevh_stepper_apply(m, b->t0, h, z.q, z.p), 0);
            for (size_t i = 0; i < size; i++)
                map[i][j] += weights[abs(c) - 1] / (2 * move) *
                             (i < n ? z.q[i] : z.p[i - n]);
        }
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j < size; j++) {
            double sum = i + n == j ? -factor : j + n == i ? factor : 0;
            for (size_t k = 0; k < n; k++)
                sum += map[k][i] * map[n + k][j] - map[n + k][i] * map[k][j];
            most = fmax(most, fabs(sum));
        }
    return most;
}

TEST_EACH(the_form_shrinks, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const double level = 2e-11;
    if (refuses(scheme) || nevh_integrator_needs_tolerance(scheme))
        skip_test("it refuses friction, or has no fixed steps");
    for (const problem *const *b = problems; *b; b++) {
        if (!fits(scheme, *b))
            continue;
        nevh_claim claim = nevh_integrator_symplectic(scheme);
        double h = claim != NEVH_NO                                       ? 0.1
                   : nevh_integrator_preserves_energy(scheme) == NEVH_YES ? 0.25
                                                                          : 0.5;
        h = *b == &double_pendulum ? h / 2 : h;
        if (scheme == nevh_implicit_euler)
            h = 0.1; /* longer steps are not solved */
        if (claim == NEVH_NO && nevh_integrator_order(scheme) > 8)
            h = 2; /* for truncation to be seen */
        nevh_system *s = damped(*b, equal);
        nevh_stepper *m = planned(s, *b, scheme, nevh_exact);
        double found = conformal_defect(m, *b, h, exp(-equal[0] * h));
        if (claim == NEVH_YES)
            ck_assert_msg(found < level, "%s on %s: %.2e",
                          nevh_integrator_name(scheme), (*b)->name, found);
        if (claim == NEVH_NO)
            ck_assert_msg(found > 3 * level, "%s on %s: %.2e",
                          nevh_integrator_name(scheme), (*b)->name, found);
        nevh_stepper_free(m);
        nevh_system_free(s);
    }
}

TEST(unequal_rates_do_not) {
    nevh_system *s = damped(&henon_heiles, unequal);
    nevh_stepper *m = planned(s, &henon_heiles, nevh_verlet, nevh_exact);
    for (int i = 0; i < 2; i++)
        ck_assert_double_gt(
            conformal_defect(m, &henon_heiles, 0.1, exp(-unequal[i] * 0.1)),
            1e-3);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST_EACH(symmetric_schemes_return, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    nevh_claim claim = nevh_integrator_symmetric(scheme);
    if (!splits(scheme) || (claim != NEVH_YES && claim != NEVH_EXTENDED))
        skip_test("friction is not split off, or not symmetric");
    nevh_system *s = damped(b, unequal);
    nevh_stepper *m = planned(s, b, scheme, nevh_exact);
    double found;
    ck_assert_int_eq(
        nevh_reversal_defect(m, b->t0, 0.02, 300, b->q, b->p, NULL, &found),
        NEVH_OK);
    ck_assert_msg(found < 1e-12, "%s on %s: %.2e", nevh_integrator_name(scheme),
                  b->name, found);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Memory that friction has outdated would show: as an orbit other than that of
   a stepper that begins afresh each time.  A second copy of the state is more
   than memory; there the order shows it. */
TEST_EACH(memory_is_a_help_only, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    enum { STEPS = 200 };
    if (refuses(scheme) || nevh_integrator_symplectic(scheme) == NEVH_EXTENDED)
        skip_test("it refuses friction, or copies are bound");
    nevh_system *s = damped(b, unequal);
    nevh_stepper *kept = planned(s, b, scheme, nevh_exact);
    nevh_stepper *fresh = planned(s, b, scheme, nevh_exact);
    state x = start(b), y = x;
    for (int i = 0; i < STEPS; i++) {
        double t = b->t0 + i * 0.01;
        ck_assert_int_eq(nevh_stepper_apply(kept, t, 0.01, x.q, x.p), 0);
        nevh_stepper_reset(fresh);
        ck_assert_int_eq(nevh_stepper_apply(fresh, t, 0.01, y.q, y.p), 0);
    }
    double found = distance(b, &x, &y);
    if (scheme->multistep) /* slopes of earlier steps are part of the step */
        ck_assert_double_gt(found, 1e-8);
    else
        ck_assert_msg(found <= STEPS * 16 * DBL_EPSILON, "%s on %s: %.2e",
                      nevh_integrator_name(scheme), b->name, found);
    nevh_stepper_free(kept);
    nevh_stepper_free(fresh);
    nevh_system_free(s);
}
