/* nevh tests: the energy over long runs, and figures known from elsewhere.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <float.h>
#include <math.h>

/* Autonomous and mildly nonlinear, so that energy is to be conserved. */
static nevh_system *make_pendulum(void) {
    static const nevh_pendulum params = {1, 1, 1};
    return nevh_pendulum_model->system(&params);
}
static const problem pendulum = {
    .name = "pendulum",
    .n = 1,
    .separable = true,
    .quadratic = true,
    .span = 100,
    .q = {2},
    .make = make_pendulum,
};
static nevh_system *make_plain_double_pendulum(void) {
    return nevh_double_pendulum_model->system(
        nevh_double_pendulum_model->defaults);
}
static const problem released = {
    .name = "double pendulum",
    .n = 2,
    .span = 10,
    .q = {1.5707963267948966, 0},
    .make = make_plain_double_pendulum,
};

/* Largest energy errors, measured for this project by other programs; pendulum
   h = 0.05, t = 100; double pendulum h = 0.01, t = 10. */
typedef struct {
    const problem *problem;
    const nevh_integrator *const *scheme;
    double h, most, allowed; /* allowed: relative deviation */
} figure;

static const figure figures[] = {
    {&pendulum, &nevh_position_verlet, 0.05, 1.123e-3, 0.01},
    {&pendulum, &nevh_verlet, 0.05, 1.625e-3, 0.01},
    {&pendulum, &nevh_midpoint, 0.05, 5.02e-4, 0.01},
    {&pendulum, &nevh_gauss4, 0.05, 3.52e-8, 0.01},
    {&pendulum, &nevh_gauss6, 0.05, 3.727e-12, 0.02},
    {&pendulum, &nevh_rk4, 0.05, 8.706e-7, 0.01},
    {&released, &nevh_midpoint, 0.01, 3.333e-3, 0.01},
    {&released, &nevh_gauss4, 0.01, 2.394e-6, 0.01},
    {&released, &nevh_gauss6, 0.01, 8.369e-9, 0.01},
    {&released, &nevh_gauss8, 0.01, 1.022e-11, 0.02},
    {&released, &nevh_rk4, 0.01, 2.112e-5, 0.01},
};

TEST_EACH(known_figures, sizeof figures / sizeof *figures) {
    const figure *f = &figures[_i];
    size_t steps = (size_t)lround(f->problem->span / f->h);
    const nevh_gradient *const gradients[] = {nevh_exact, nevh_central8};
    for (int k = 0; k < 2; k++) {
        nevh_energy_report r =
            energy_of(f->problem, *f->scheme, gradients[k], f->h, steps);
        ck_assert_msg(fabs(r.max / f->most - 1) <= f->allowed,
                      "%s on %s, %s: %.4e instead of %.4e",
                      nevh_integrator_name(*f->scheme), f->problem->name,
                      nevh_gradient_name(gradients[k]), r.max, f->most);
    }
}

TEST(gauss8_at_rounding) {
    const nevh_gradient *const gradients[] = {nevh_exact, nevh_central8};
    for (int k = 0; k < 2; k++)
        ck_assert_double_lt(
            energy_of(&pendulum, nevh_gauss8, gradients[k], 0.05, 2000).max,
            2e-14);
}

/* Where truncation is seen, symplectic schemes do not lose energy in 1e5 steps
   and the others do. */
TEST_EACH(claim_over_long_runs, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    int order = nevh_integrator_order(scheme);
    if (order > 10)
        skip_test("below rounding at any step that converges");
    double h = order <= 2 ? 0.05 : order <= 4 ? 0.1 : order <= 6 ? 0.25 : 0.4;
    nevh_energy_report r = energy_of(&pendulum, scheme, NULL, h, 100000);
    nevh_claim symplectic = nevh_integrator_symplectic(scheme);
    if (symplectic == NEVH_YES || symplectic == NEVH_EXTENDED)
        ck_assert_msg(r.verdict == NEVH_BOUNDED && r.max > 1e-11 &&
                          fabs(r.drift) * 1e5 * h < 0.02 * r.max,
                      "%s: max %.2e, drift %.2e", nevh_integrator_name(scheme),
                      r.max, r.drift * 1e5 * h);
    else if (nevh_integrator_preserves_energy(scheme) == NEVH_YES)
        ck_assert_msg(r.max < 1e-13, "%s: max %.2e",
                      nevh_integrator_name(scheme), r.max);
    else if (nevh_integrator_symmetric(scheme) != NEVH_NO)
        ck_assert_msg(r.verdict == NEVH_BOUNDED, "%s: max %.2e, drift %.2e",
                      nevh_integrator_name(scheme), r.max, r.drift * 1e5 * h);
    else
        ck_assert_msg(r.verdict == NEVH_DRIFTS || r.verdict == NEVH_UNSTABLE,
                      "%s: max %.2e, drift %.2e", nevh_integrator_name(scheme),
                      r.max, r.drift * 1e5 * h);
}

/* A million steps: 50 000 seconds. */
TEST(a_million_steps) {
    const size_t steps = 1000000;
    nevh_energy_report r = energy_of(&pendulum, nevh_verlet, NULL, 0.05, steps);
    ck_assert_int_eq(r.verdict, NEVH_BOUNDED);
    ck_assert_double_eq_tol(r.max, 1.625e-3, 2e-5);
    r = energy_of(&pendulum, nevh_gauss4, NULL, 0.05, steps);
    ck_assert_int_eq(r.verdict, NEVH_BOUNDED);
    ck_assert_double_eq_tol(r.max, 3.52e-8, 1e-9);
    r = energy_of(&pendulum, nevh_rk4, NULL, 0.05, steps);
    ck_assert_int_eq(r.verdict, NEVH_DRIFTS);
    ck_assert_double_eq_tol(r.max, 3.857e-4, 1e-5);
}

/* Largest energy error of gauss8 at h = 0.02 on the double pendulum. */
static double largest_error(const double q0[], const double p0[],
                            const nevh_gradient *g, double delta,
                            size_t steps) {
    nevh_system *s = make_plain_double_pendulum();
    double q[] = {q0[0], q0[1]}, p[] = {p0[0], p0[1]};
    nevh_options options = {
        .gradient = g, .gradient_step = delta, .q = q, .p = p};
    nevh_stepper *stepper = nevh_stepper_new(s, nevh_gauss8, &options);
    nevh_energy *energy = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    ck_assert_int_eq(nevh_run(stepper, 0, 0.02, steps, q, p, &watch, 1),
                     NEVH_OK);
    double most = nevh_energy_result(energy, 0).max;
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return most;
}

static const double regular_q[] = {1.1, 0}, regular_p[] = {0, 2.7746};
static const double chaotic_q[] = {1.5707963267948966, 0}, at_rest[] = {0, 0};

/* With steps chosen by trial, orders 4 to 8 cannot be told from exact ones. */
TEST_EACH(differences_are_as_good_as_exact, 3) {
    double exact = largest_error(regular_q, regular_p, nevh_exact, 0, 5000);
    const nevh_gradient *g = nevh_gradients()[1 + _i];
    double found = largest_error(regular_q, regular_p, g, 0, 5000);
    ck_assert_msg(fabs(found / exact - 1) < 0.01, "%s: %.3e instead of %.3e",
                  nevh_gradient_name(g), found, exact);
}

/* The paper's differences are not those of any H: on a regular orbit the error
   that they bring stays, on a chaotic one it grows. */
TEST(coarse_differences) {
    const nevh_gradient *g = nevh_central2;
    double soon = largest_error(regular_q, regular_p, g, 0.01, 1000);
    double late = largest_error(regular_q, regular_p, g, 0.01, 25000);
    ck_assert_double_gt(soon, 1e-5);
    ck_assert_double_lt(late / soon, 1.02);
    double growth = 0; /* chaos: which orbit it is depends on the last bits */
    for (int i = 0; i < 4; i++) {
        const double q[] = {chaotic_q[0] + 0.1 * i, 0};
        soon = largest_error(q, at_rest, g, 0.01, 1000);
        late = largest_error(q, at_rest, g, 0.01, 25000);
        growth += late / soon / 4;
    }
    ck_assert_double_gt(growth, 1.3);
    ck_assert_double_gt(late, 500 * largest_error(chaotic_q, at_rest,
                                                  nevh_central6, 0.01, 25000));
}
