/* nevh tests: every scheme converges at its order.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>

/* Five per cent up to order 6, twelve above.  Beyond order 10 only the gentle
   Henon-Heiles problem shows the power law clear of rounding; on the others
   the last steps before it still overshoot, by up to a quarter; so with dop853,
   whose error begins with very small coefficients.  That these orders are exact
   is proved algebraically in check_coefficients and check_trees. */
static double allowance(const problem *b, const nevh_integrator *scheme) {
    int order = nevh_integrator_order(scheme);
    if ((order > 10 || scheme == nevh_dop853) && b != &henon_heiles)
        return 0.3;
    return order > 6 ? 0.12 : 0.05;
}

static void assert_order(const problem *b, const nevh_integrator *scheme) {
    int order = order_on(b, scheme);
    double slope = measured_order(b, scheme, nevh_exact);
    ck_assert_msg(fabs(slope - order) <= allowance(b, scheme) * order,
                  "%s on %s: order %d, measured %.3f",
                  nevh_integrator_name(scheme), b->name, order, slope);
}

TEST_EACH(order_of_scheme, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (nevh_integrator_needs_tolerance(scheme))
        skip_test("its error falls with the tolerance: check_adaptive");
    int measured = 0;
    for (const problem *const *b = problems; *b; b++)
        if (fits(scheme, *b)) {
            assert_order(*b, scheme);
            measured++;
        }
    ck_assert_int_ge(measured, 2);
}

/* Differences of order 8 do not cost the scheme its order. */
TEST_EACH(order_from_h_alone, 4) {
    const nevh_integrator *schemes[] = {nevh_verlet, nevh_midpoint, nevh_gauss4,
                                        nevh_rk4};
    const nevh_integrator *scheme = schemes[_i];
    double slope = measured_order(&driven_pendulum, scheme, nevh_central8);
    double order = nevh_integrator_order(scheme);
    ck_assert_msg(fabs(slope - order) <= 0.05 * order, "%s: measured %.3f",
                  nevh_integrator_name(scheme), slope);
}

/* The reference of these tests, against states computed in quadruple
   precision by other means: H = p^2/2 - cos q from q = 2 to t = 100. */
TEST(independent_reference) {
    static const nevh_pendulum params = {1, 1, 1};
    nevh_system *s = nevh_pendulum_model->system(&params);
    nevh_options options = {.gradient = nevh_exact};
    nevh_stepper *stepper = nevh_stepper_new(s, nevh_gauss16, &options);
    double q[] = {2}, p[] = {0};
    ck_assert_int_eq(nevh_run(stepper, 0, 0.05, 2000, q, p, NULL, 0), NEVH_OK);
    ck_assert_double_eq_tol(q[0], 1.982325653157030515982941, 1e-12);
    ck_assert_double_eq_tol(p[0], 0.1796407425909401978724921, 1e-12);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
}
