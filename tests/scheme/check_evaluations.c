/* nevh tests: every evaluation is counted, and none is wasted.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <nevh/extend.h>
#include <stdint.h>

enum { STEPS = 50, LATER = 80 };
static const double h = 0.03;

static nevh_counts counts_after(size_t steps, const problem *b,
                                const nevh_integrator *scheme,
                                const nevh_gradient *g, size_t width,
                                const nevh_observer *watch, size_t watchers) {
    nevh_system *s = b->make();
    nevh_options options = {
        .gradient = g, .width = width, .tolerance = tolerance_for(scheme)};
    nevh_stepper *stepper = nevh_stepper_new(s, scheme, &options);
    double q[MOST_DOF * 4], p[MOST_DOF * 4];
    for (size_t i = 0; i < b->n * width; i++) {
        q[i] = b->q[i / width];
        p[i] = b->p[i / width];
    }
    ck_assert_int_eq(nevh_run(stepper, b->t0, h, steps, q, p, watch, watchers),
                     NEVH_OK);
    nevh_counts counts = nevh_stepper_counts(stepper);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return counts;
}

static nevh_counts counts_of(const problem *b, const nevh_integrator *scheme,
                             const nevh_gradient *g, size_t width,
                             const nevh_observer *watch, size_t watchers) {
    return counts_after(STEPS, b, scheme, g, width, watch, watchers);
}

/* To the last one between step STEPS and step LATER; the first step may take
   more. */
TEST_EACH(gradients_of_a_step, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = &henon_heiles;
    uint64_t each = (uint64_t)nevh_integrator_gradients(scheme);
    nevh_counts c = counts_of(b, scheme, nevh_central2, 1, NULL, 0);
    nevh_counts late =
        counts_after(LATER, b, scheme, nevh_central2, 1, NULL, 0);
    if (each) {
        ck_assert_uint_eq(late.gradients - c.gradients, each * (LATER - STEPS));
        ck_assert_uint_ge(c.gradients, each * STEPS);
        ck_assert_uint_le(c.gradients, each * (STEPS + 1));
    } else if (!nevh_integrator_needs_tolerance(scheme)) {
        ck_assert_uint_eq(
            c.gradients,
            c.sweeps * (uint64_t)nevh_integrator_sweep_gradients(scheme));
    }
    ck_assert_uint_eq(c.newtons, 0);
    ck_assert_uint_eq(c.rescues, 0);
}

/* One more where a step's last kick is the next one's first. */
TEST(kept_gradients) {
    ck_assert_uint_eq(
        counts_of(&henon_heiles, nevh_verlet, nevh_exact, 1, NULL, 0).gradients,
        STEPS + 1);
    ck_assert_uint_eq(
        counts_of(&henon_heiles, nevh_position_verlet, nevh_exact, 1, NULL, 0)
            .gradients,
        STEPS);
}

/* Henon-Heiles: 2 instances of p^2/2m, one of V(x, y).  Order 2 takes 2 values
   for each variable read, order 2m m times as many, except that x and the
   momenta, in which H is found to be quadratic, take 2; exact takes none. */
TEST_EACH(values_of_a_gradient, 5) {
    const nevh_gradient *g = _i < 4 ? nevh_gradients()[_i] : nevh_exact;
    uint64_t order = (uint64_t)nevh_gradient_order(g);
    uint64_t quadratic = order ? 2 : 0;
    nevh_counts c = counts_of(&henon_heiles, nevh_rk4, g, 1, NULL, 0);
    ck_assert_uint_eq(c.gradients, 4 * STEPS);
    ck_assert_uint_eq(c.values, 4 * STEPS * (order + 3 * quadratic));
    ck_assert_double_eq(c.hamiltonians, (double)c.values / 3);
}

/* One step of the schemes that take values of H beside, or instead of, its
   gradient, from a state where no increment is short.  The first sweep of a
   part knows no slopes, so all increments are. */
TEST_EACH(values_of_a_sweep, 4) {
    static const struct {
        const nevh_integrator *const *scheme;
        uint64_t start, first, sweep;
    } costs[] = {{&nevh_itoh_abe, 1, 8, 4},
                 {&nevh_itoh_abe_symmetric, 2, 16, 4},
                 {&nevh_gonzalez, 1, 0, 1},
                 {&nevh_avf, 0, 0, 0}};
    const problem *b = &henon_heiles;
    nevh_system *s = b->make();
    nevh_stepper *m = planned(s, b, *costs[_i].scheme, nevh_exact);
    double q[] = {b->q[0], b->q[1]}, p[] = {b->p[0], b->p[1]};
    ck_assert_int_eq(nevh_stepper_apply(m, 0, h, q, p), NEVH_OK);
    nevh_counts c = nevh_stepper_counts(m);
    ck_assert_uint_gt(c.sweeps, 4);
    ck_assert_uint_eq(c.values, 3 * (costs[_i].start + costs[_i].first +
                                     costs[_i].sweep * c.sweeps));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Kicks ask for dH/dq alone, drifts for dH/dp alone. */
TEST(kicks_and_drifts_ask_for_half) {
    nevh_counts c =
        counts_of(&henon_heiles, nevh_verlet, nevh_central2, 1, NULL, 0);
    ck_assert_uint_eq(c.values, (STEPS + 1) * 4 + STEPS * 4);
    c = counts_of(&henon_heiles, nevh_position_verlet, nevh_central2, 1, NULL,
                  0);
    ck_assert_uint_eq(c.values, STEPS * 4 + (STEPS + 1) * 4);
}

/* Noise is not iterated on: with differences a step takes hardly more sweeps
   than with exact gradients. */
TEST_EACH(noise_costs_no_sweeps, 4) {
    const nevh_integrator *const schemes[] = {nevh_midpoint, nevh_gauss4,
                                              nevh_gauss8, nevh_gauss16};
    uint64_t exact =
        counts_of(&double_pendulum, schemes[_i], nevh_exact, 1, NULL, 0).sweeps;
    for (int k = 0; k < 4; k++) {
        uint64_t sweeps = counts_of(&double_pendulum, schemes[_i],
                                    nevh_gradients()[k], 1, NULL, 0)
                              .sweeps;
        ck_assert_msg(sweeps <= exact + exact / 4, "%s, %s: %lu of %lu",
                      nevh_integrator_name(schemes[_i]),
                      nevh_gradient_name(nevh_gradients()[k]),
                      (unsigned long)sweeps, (unsigned long)exact);
    }
}

TEST_EACH(runs_count_alike, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    nevh_system *s = henon_heiles.make();
    nevh_energy *energy = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 3};
    nevh_counts a = counts_of(&henon_heiles, scheme, nevh_central4, 1, NULL, 0);
    nevh_counts b =
        counts_of(&henon_heiles, scheme, nevh_central4, 1, &watch, 1);
    ck_assert_uint_eq(a.values, b.values);
    ck_assert_uint_eq(a.gradients, b.gradients);
    ck_assert_uint_eq(a.sweeps, b.sweeps);
    nevh_energy_free(energy);
    nevh_system_free(s);
}

TEST_EACH(lanes_count_alike, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (nevh_integrator_own_time(scheme))
        skip_test("it takes one orbit at a time");
    nevh_counts a = counts_of(&henon_heiles, scheme, nevh_central4, 1, NULL, 0);
    nevh_counts four =
        counts_of(&henon_heiles, scheme, nevh_central4, 4, NULL, 0);
    ck_assert_uint_eq(4 * a.values, four.values);
    ck_assert_uint_eq(4 * a.gradients, four.gradients);
    ck_assert_uint_eq(4 * a.sweeps, four.sweeps);
}
