/* nevh tests: forth and back.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <float.h>
#include <math.h>

/* Steps of own time may be long: fewer of them keep a chaotic orbit from
   forgetting where it began. */
enum { STEPS = 500, OWN_STEPS = 60 };

static double defect(const problem *b, const nevh_integrator *scheme,
                     const nevh_gradient *g, double h) {
    nevh_system *s = b->make();
    nevh_stepper *stepper = planned(s, b, scheme, g);
    double found = NAN;
    size_t steps = nevh_integrator_own_time(scheme) ? OWN_STEPS : STEPS;
    int status = nevh_reversal_defect(stepper, b->t0, h, steps, b->q, b->p,
                                      NULL, &found);
    ck_assert_msg(status == NEVH_OK, "%s", nevh_stepper_message(stepper));
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return found;
}

/* Rounding grows with the root of the steps, and on an orbit with shear with
   another factor; a thousandth of what is no return at all. */
TEST_EACH(symmetric_schemes_return, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (nevh_integrator_symmetric(scheme) != NEVH_YES &&
        nevh_integrator_symmetric(scheme) != NEVH_EXTENDED)
        skip_test("it is not symmetric");
    for (const problem *const *b = problems; *b; b++) {
        if (!fits(scheme, *b))
            continue;
        double found = defect(*b, scheme, nevh_exact, 0.02);
        bool returns = found <= 300 * DBL_EPSILON * sqrt(STEPS);
        ck_assert_msg(returns, "%s on %s: %.2e", nevh_integrator_name(scheme),
                      (*b)->name, found);
    }
}

/* Those that are not symmetric must be caught, at a step large enough for
   their truncation to be seen. */
TEST_EACH(others_do_not_return, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (nevh_integrator_symmetric(scheme) != NEVH_NO ||
        nevh_integrator_needs_tolerance(scheme))
        skip_test("it is symmetric, or returns as its tolerance says");
    int order = nevh_integrator_order(scheme);
    double h = order > 8 ? 2 : order > 4 ? 0.4 : order > 1 ? 0.1 : 0.02;
    double found = defect(&henon_heiles, scheme, nevh_exact, h);
    ck_assert_msg(found > 1e-9, "%s: %.2e", nevh_integrator_name(scheme),
                  found);
}

/* A fixed difference step keeps the symmetry, however wrong the gradient. */
TEST(differences_return) {
    const nevh_gradient *const *g = nevh_gradients();
    for (; nevh_gradient_order(*g) > 0; g++) {
        double found = defect(&henon_heiles, nevh_verlet, *g, 0.05);
        ck_assert_msg(found < 1e-10, "%s: %.2e", nevh_gradient_name(*g), found);
    }
}
