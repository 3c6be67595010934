/* nevh tests: is a step a canonical map?
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>

/* The defect's own rounding and truncation, at moderate states. */
static const double level = 2e-11;

static double defect_with(const problem *b, const nevh_integrator *scheme,
                          const nevh_gradient *g, double step, double h) {
    nevh_system *s = b->make();
    /* Loose, where there are no fixed steps, so that truncation shows. */
    nevh_options options = {
        .gradient = g,
        .gradient_step = step,
        .t = b->t0,
        .q = b->q,
        .p = b->p,
        .tolerance = nevh_integrator_needs_tolerance(scheme) ? 1e-4 : 0};
    nevh_stepper *stepper = nevh_stepper_new(s, scheme, &options);
    double found = NAN;
    int status =
        nevh_symplecticity_defect(stepper, b->t0, h, b->q, b->p, NULL, &found);
    ck_assert_msg(status == NEVH_OK, "%s", nevh_stepper_message(stepper));
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return found;
}

TEST_EACH(claim_of_scheme, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (nevh_integrator_own_time(scheme))
        skip_test("a first step of own time is no other step: check_drift");
    for (const problem *const *b = problems; *b; b++) {
        if (!fits(scheme, *b))
            continue;
        /* Large for high orders, so that truncation shows where it may. */
        double h = nevh_integrator_order(scheme) > 4 ? 0.2 : 0.1;
        if (nevh_integrator_symplectic(scheme) == NEVH_NO)
            h *= nevh_integrator_order(scheme) > 8 ? 10 : 2.5;
        h = *b == &double_pendulum ? h / 2 : h;
        double found = defect_with(*b, scheme, nevh_exact, 0, h);
        if (nevh_integrator_symplectic(scheme) == NEVH_YES)
            ck_assert_msg(found < level, "%s on %s: %.2e",
                          nevh_integrator_name(scheme), (*b)->name, found);
        if (nevh_integrator_symplectic(scheme) == NEVH_NO)
            ck_assert_msg(found > 3 * level, "%s on %s: %.2e",
                          nevh_integrator_name(scheme), (*b)->name, found);
    }
}

/* Differences of a coupled V are not curl-free: a coarse one leaves a defect
   that shrinks as its order says; kicks by a V of one coordinate stay exactly
   symplectic, however coarse. */
TEST(level_of_the_gradient) {
    double coarse2 =
        defect_with(&kepler, nevh_verlet, nevh_central2, 0.02, 0.1);
    double fine2 = defect_with(&kepler, nevh_verlet, nevh_central2, 0.01, 0.1);
    double coarse4 =
        defect_with(&kepler, nevh_verlet, nevh_central4, 0.02, 0.1);
    ck_assert_double_gt(coarse2, 1e-6);
    ck_assert_double_eq_tol(coarse2 / fine2, 4, 0.2);
    ck_assert_double_lt(coarse4, coarse2 / 20);
    double one =
        defect_with(&driven_pendulum, nevh_verlet, nevh_central2, 0.05, 0.1);
    ck_assert_double_lt(one, level);
}

/* In units of scale the defect does not depend on the user's units. */
TEST(units_do_not_matter) {
    static const nevh_pendulum params = {1e-3, 1, 9.8};
    const double q[] = {1}, p[] = {2e-3}, scale[] = {1, 1e-3};
    nevh_system *s = nevh_pendulum_model->system(&params);
    nevh_options options = {.gradient = nevh_exact};
    double found = NAN;
    nevh_stepper *stepper = nevh_stepper_new(s, nevh_rk4, &options);
    ck_assert_int_eq(
        nevh_symplecticity_defect(stepper, 0, 0.1, q, p, scale, &found),
        NEVH_OK);
    ck_assert_double_gt(found, 1e-7);
    ck_assert_double_lt(found, 1e-3);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
}

TEST(refusals) {
    nevh_system *s = double_pendulum.make();
    double found = 7;
    nevh_stepper *refused = nevh_stepper_new(s, nevh_verlet, NULL);
    ck_assert_int_eq(nevh_symplecticity_defect(refused, 0, 0.1,
                                               double_pendulum.q,
                                               double_pendulum.p, NULL, &found),
                     NEVH_ESTRUCT);
    nevh_options wide = {.width = 2};
    nevh_stepper *two = nevh_stepper_new(s, nevh_midpoint, &wide);
    ck_assert_int_eq(nevh_symplecticity_defect(two, 0, 0.1, double_pendulum.q,
                                               double_pendulum.p, NULL, &found),
                     NEVH_EINVAL);
    ck_assert_int_eq(nevh_reversal_defect(two, 0, 0.1, 3, double_pendulum.q,
                                          double_pendulum.p, NULL, &found),
                     NEVH_EINVAL);
    ck_assert_double_eq(found, 7);
    nevh_stepper_free(refused);
    nevh_stepper_free(two);
    nevh_system_free(s);
}
