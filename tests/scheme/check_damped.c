/* nevh tests: friction inside the right-hand side.

   Kernels that take it so are stepped directly, with rates of the test's own.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"
#include "support.h"
#include <math.h>
#include <string.h>

/* q'' + rate q' + w^2 q = 0 twice, with masses that are not 1. */
static const double masses[] = {1.3, 2.1}, frequency[] = {1.1, 1.7};
static const double rates[] = {0.4, 0.15};
static const size_t both[] = {0, 1};

static double spring(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)p, (void)params;
    return c[0] * q[0] * q[0] / 2;
}

static void spring_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = c[i] * q[i];
}

static nevh_system *make_springs(void) {
    double stiffness[2];
    for (int k = 0; k < 2; k++)
        stiffness[k] = masses[k] * frequency[k] * frequency[k];
    nevh_system *s = nevh_system_new(2);
    add_kinetic(s, 2, masses);
    nevh_system_add(s, &(nevh_term){.effect = "springs",
                                    .nq = 1,
                                    .nc = 1,
                                    .q = both,
                                    .c = stiffness,
                                    .count = 2,
                                    .value = spring,
                                    .gradient = spring_gradient});
    return s;
}

/* The exact state at time t from q = 1, p = 0. */
static void solve(double t, size_t k, double *q, double *p) {
    double half = rates[k] / 2,
           w = sqrt(frequency[k] * frequency[k] - half * half);
    *q = exp(-half * t) * (cos(w * t) + half / w * sin(w * t));
    *p = -masses[k] * exp(-half * t) * (w + half * half / w) * sin(w * t);
}

/* The kernel's steps from (1, 0) twice, in both of two lanes; the error. */
static double error_of(const nevh_integrator *scheme, double tolerance,
                       const double friction[], double span, size_t steps) {
    nevh_system *s = make_springs();
    nevh_options o = {
        .gradient = nevh_exact, .width = 2, .tolerance = tolerance};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    double q[] = {1, 1, 1, 1}, p[] = {0, 0, 0, 0}, h = span / (double)steps;
    double error = 0, x, y;
    ck_assert_msg(!nevh_stepper_status(m), "%s", nevh_stepper_message(m));
    m->work.friction = friction;
    for (size_t i = 0; i < steps; i++)
        ck_assert(!scheme->kernel->step(&m->work, (double)i * h, h, q, p));
    for (size_t k = 0; k < 2; k++) {
        solve(span, k, &x, &y);
        ck_assert(q[2 * k] == q[2 * k + 1] && p[2 * k] == p[2 * k + 1]);
        error = fmax(error, fmax(fabs(q[2 * k] - x), fabs(p[2 * k] - y)));
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
    return error;
}

/* The scheme with this index, or NULL where friction goes around it. */
static const nevh_integrator *damped(int i) {
    const nevh_integrator *scheme = nevh_integrators()[i];
    return scheme->kernel->has_friction ? scheme : NULL;
}

TEST_EACH(keeps_the_order, scheme_count()) {
    const nevh_integrator *scheme = damped(_i);
    if (!scheme || nevh_integrator_needs_tolerance(scheme))
        skip_test("it takes no friction into its slopes, or no fixed steps");
    int order = nevh_integrator_order(scheme);
    size_t steps = order == 1 ? 3000 : order <= 5 ? 100 : 12;
    double coarse = error_of(scheme, 0, rates, 3, steps);
    double fine = error_of(scheme, 0, rates, 3, 2 * steps);
    double slope = log2(coarse / fine);
    ck_assert_msg(fabs(slope - order) < (order > 6 ? 0.12 : 0.05) * order,
                  "%s: %.2f, errors %.2e and %.2e",
                  nevh_integrator_name(scheme), slope, coarse, fine);
    ck_assert(error_of(scheme, 0, NULL, 3, steps) > 0.1);
}

TEST_EACH(meets_the_tolerance, scheme_count()) {
    const nevh_integrator *scheme = damped(_i);
    if (!scheme || !nevh_integrator_adaptive(scheme))
        skip_test("it takes no friction into its slopes, or does not adapt");
    double error = error_of(scheme, 1e-11, rates, 20, 3);
    ck_assert_msg(error < 2e-8, "%s: %.2e", nevh_integrator_name(scheme),
                  error);
}

/* Rates of 0 are no friction, to the last bit. */
TEST_EACH(none_is_none, scheme_count()) {
    static const double zeros[] = {0, 0};
    const nevh_integrator *scheme = damped(_i);
    if (!scheme)
        skip_test("it takes no friction into its slopes");
    double tolerance = tolerance_for(scheme);
    ck_assert(error_of(scheme, tolerance, zeros, 3, 20) ==
              error_of(scheme, tolerance, NULL, 3, 20));
}

TEST(runge_kutta_and_gsl_take_it) {
    const nevh_integrator *const schemes[] = {
        nevh_euler,     nevh_rk4,       nevh_dopri5,     nevh_dop853,
        nevh_gsl_rkf45, nevh_gsl_rk8pd, nevh_gsl_msadams};
    for (size_t i = 0; i < sizeof schemes / sizeof *schemes; i++)
        ck_assert(schemes[i]->kernel->has_friction);
}
