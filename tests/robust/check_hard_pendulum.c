/* nevh tests: hard cases of the pendulum: many turns, the separatrix, and noise
   in its gradient, each with a contrast that fails.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "hard.h"
#include <gsl/gsl_sf_ellint.h>
#include <math.h>
#include <string.h>

/* Radians by which a pendulum of modulus 2 that goes round has turned. */
static double turned(const nevh_integrator *scheme, double h, size_t steps,
                     double *energy) {
    nevh_scene *scene = read_scene("scenes/hard", "pendulum-modulus");
    ck_assert_int_eq(nevh_scene_set(scene, "k = 2"), NEVH_OK);
    orbit o = begin(scene, scheme);
    ck_assert_int_eq(nevh_run(o.stepper, 0, h, steps, o.q, o.p, NULL, 0),
                     NEVH_OK);
    *energy = fabs(o.p[0] * o.p[0] / 2 - cos(o.q[0]) - 7);
    end(&o);
    return o.q[0];
}

/* A turn takes 2 K(1/k)/k, by K(1/2) in GSL's own definition.  The state is not
   wrapped, so that in the end angles are rounded to 1e-9: errors p dF h of
   4.5e-11 a step add up to 2e-7 of energy in 1.6e7 steps, as a random walk. */
TEST_TAGGED(a_million_turns, "slow", 0, 1) {
    double period = 2 * gsl_sf_ellint_Kcomp(0.5, GSL_PREC_DOUBLE) / 2;
    double h = period / 16, energy;
    double angle = turned(nevh_blanes_moan4, h, 16000000, &energy);
    ck_assert_double_eq_tol(angle / (2 * pi), 1e6, 0.5);
    ck_assert_double_le(energy, 1e-6);
    turned(nevh_rk4, h, 160000, &energy);
    ck_assert_double_ge(energy, 1e-2);
}

/* The pendulum of modulus 2 after half a turn or so. */
static orbit go_round(const nevh_integrator *scheme, const char *turns) {
    nevh_scene *scene = read_scene("scenes/hard", "pendulum-modulus");
    ck_assert_int_eq(nevh_scene_set(scene, "k = 2"), NEVH_OK);
    ck_assert_int_eq(nevh_scene_set(scene, turns), NEVH_OK);
    orbit o = begin(scene, scheme);
    ck_assert_int_eq(nevh_run(o.stepper, 0, 0.025, 40, o.q, o.p, NULL, 0),
                     NEVH_OK);
    end(&o);
    return o;
}

/* Where angles are counted from changes nothing but their rounding, which is
   4.7e-10 after a million turns. */
TEST_EACH(turns_do_not_matter, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (nevh_integrator_needs_tolerance(scheme))
        skip_test("its tolerance is relative to the angle");
    orbit here = go_round(scheme, "turns = 0");
    for (int far = 0; far < 2; far++) {
        double turns = far ? 1e9 : 1e6, rounding = turns * 0x1p-50;
        orbit there = go_round(scheme, far ? "turns = 1e9" : "turns = 1e6");
        double turned = there.q[0] - 2 * pi * turns;
        ck_assert_msg(fabs(turned - here.q[0]) <= 200 * rounding &&
                          fabs(there.p[0] - here.p[0]) <= 200 * rounding,
                      "%s: after %g turns q is off by %.2g, p by %.2g",
                      nevh_integrator_name(scheme), turns, turned - here.q[0],
                      there.p[0] - here.p[0]);
    }
}

/* Steps of a turn need Newton's iteration, whose differences of angles must not
   be as large as these are. */
TEST_EACH(newton_after_many_turns, 2) {
    const nevh_integrator *schemes[] = {nevh_gauss4, nevh_lobatto4};
    nevh_scene *scene = read_scene("scenes/hard", "pendulum-modulus");
    ck_assert_int_eq(nevh_scene_set(scene, "k = 2"), NEVH_OK);
    ck_assert_int_eq(nevh_scene_set(scene, "turns = 1e6"), NEVH_OK);
    orbit o = begin(scene, schemes[_i]);
    ck_assert_msg(!nevh_run(o.stepper, 0, 2, 200, o.q, o.p, NULL, 0), "%s",
                  nevh_stepper_message(o.stepper));
    ck_assert_uint_gt(nevh_stepper_counts(o.stepper).newtons, 0);
    end(&o);
}

/* The largest error of a state over four turns of a pendulum that comes
   within 1e-10 of standing upright, against Jacobi's functions. */
static double beside_separatrix(const nevh_integrator *scheme,
                                const char *modulus) {
    nevh_scene *scene = read_scene("scenes/hard", "pendulum-modulus");
    ck_assert_int_eq(nevh_scene_set(scene, modulus), NEVH_OK);
    orbit o = begin(scene, scheme);
    nevh_reference *exact =
        nevh_reference_new(nevh_scene_system(scene), NULL, 0, 40, o.q, o.p);
    ck_assert_msg(!nevh_reference_status(exact), "%s",
                  nevh_reference_message(exact));
    ck_assert(strncmp(nevh_reference_text(exact), "exact", 5) == 0);
    nevh_state_error *error = nevh_state_error_new(exact);
    nevh_observer watch = {nevh_state_error_observe, error, 1};
    ck_assert_int_eq(nevh_run(o.stepper, 0, 0.05, 800, o.q, o.p, &watch, 1),
                     NEVH_OK);
    double most = nevh_state_error_result(error);
    nevh_state_error_free(error);
    nevh_reference_free(exact);
    end(&o);
    return most;
}

/* Each passage takes log(1/d) at a distance d in energy: energies that walk
   by the rounding of 800 steps, 30 epsilon, put it off by 30 epsilon/1e-10,
   which is 7e-5 in each of two. */
TEST_EACH(both_sides_of_the_separatrix, 2) {
    static const char *const moduli[] = {"k = 1 - 1e-10", "k = 1 + 1e-10"};
    ck_assert_double_le(beside_separatrix(nevh_gauss12, moduli[_i]), 1.4e-4);
    ck_assert_double_ge(beside_separatrix(nevh_rk4, moduli[_i]), 0.1);
}

enum { PENDULUMS = 8 };

/* Energy errors of gauss8 on pendulums over so many steps, a root of their
   mean square over what planning predicts for that gradient. */
static double walked(const nevh_gradient *gradient, size_t steps,
                     double *error) {
    nevh_scene *scene = read_scene("scenes", "pendulum");
    const nevh_system *system = nevh_scene_system(scene);
    double q[PENDULUMS], p[PENDULUMS], h = 0.02, floor, sum = 0;
    for (size_t i = 0; i < PENDULUMS; i++)
        q[i] = 2 - 0.01 * (double)i, p[i] = 0;
    nevh_options options = {
        .gradient = gradient, .q = q, .p = p, .width = PENDULUMS};
    nevh_stepper *m = nevh_stepper_new(system, nevh_gauss8, &options);
    nevh_energy *e = nevh_energy_new(system, &options);
    nevh_observer watch = {nevh_energy_observe, e, steps};
    /* half-way down: where it is at rest noise in forces does no work */
    ck_assert_int_eq(
        nevh_field_energy_floor(nevh_stepper_field(m), 0, (double[]){1},
                                (double[]){sqrt(2 * 9.8 * (cos(1) - cos(2)))},
                                h, steps, &floor),
        NEVH_OK);
    ck_assert_int_eq(nevh_run(m, 0, h, steps, q, p, &watch, 1), NEVH_OK);
    for (size_t i = 0; i < PENDULUMS; i++) {
        nevh_energy_report r = nevh_energy_result(e, i);
        sum += r.final * r.final * r.scale * r.scale / PENDULUMS;
    }
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_scene_free(scene);
    *error = sqrt(sum);
    return *error / floor;
}

TEST_TAGGED(gradients_bring_their_noise, "slow", 0, 1) {
    static const nevh_gradient *const *const gradients[] = {
        &nevh_central4, &nevh_central6, &nevh_central8};
    double error, exact;
    walked(nevh_exact, 1000000, &exact);
    for (int i = 0; i < 3; i++) {
        double ratio = walked(*gradients[i], 1000000, &error);
        ck_assert_double_le(ratio, 4);
        ck_assert_double_ge(ratio, 0.25);
        ck_assert_double_ge(error, exact);
    }
}
