/* nevh tests: what a field says of its difference steps is true.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <stdint.h>
#include <string.h>

enum { STATES = 40 };

static nevh_system *make_ellipse(void) {
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 2,
                                    .value = plane_kinetic,
                                    .gradient = plane_kinetic_gradient});
    nevh_system_add(s, &(nevh_term){.effect = "potential",
                                    .nq = 2,
                                    .nc = 1,
                                    .c = (const double[]){1},
                                    .value = gravity_value,
                                    .gradient = gravity_gradient});
    return s;
}

/* Kepler orbits that stay what they are: `kepler` has two inertial masses,
   and will come close to collisions. */
static const problem ellipse = {
    .name = "ellipse",
    .n = 2,
    .separable = true,
    .quadratic = true,
    .span = 12,
    .fewest = 6,
    .q = {0.4, 0},
    .p = {0, 2},
    .make = make_ellipse,
};
static const problem comet = {
    .name = "comet",
    .n = 2,
    .separable = true,
    .quadratic = true,
    .span = 12,
    .fewest = 6,
    .q = {1.95, 0},
    .p = {0, 0.160128154},
    .make = make_ellipse,
};

/* By _i: problem and order.  The last two are only known to be smooth. */
static const problem *problem_of(int i) {
    const problem *const all[] = {&driven_pendulum, &henon_heiles,
                                  &double_pendulum, &ellipse,
                                  &comet,           &kepler};
    return all[i / 4];
}
static const nevh_gradient *method_of(int i) {
    return nevh_gradients()[i % 4];
}

static nevh_field *field_of(const nevh_system *s, const problem *b,
                            const nevh_gradient *g) {
    nevh_options o = {.gradient = g, .t = b->t0, .q = b->q, .p = b->p};
    nevh_field *f = nevh_field_new(s, &o);
    ck_assert_msg(!nevh_field_status(f), "%s", nevh_field_message(f));
    return f;
}

/* The largest error of each derivative along an orbit. */
static void measure(const problem *b, nevh_field *f, double error[]) {
    nevh_system *s = b->make();
    nevh_stepper *stepper = planned(s, b, nevh_gauss8, nevh_exact);
    nevh_field *exact = nevh_stepper_field(stepper);
    double q[MOST_DOF], p[MOST_DOF], d[2 * MOST_DOF], e[2 * MOST_DOF];
    memcpy(q, b->q, sizeof q);
    memcpy(p, b->p, sizeof p);
    memset(error, 0, 2 * b->n * sizeof *error);
    for (size_t i = 0; i < STATES; i++) {
        double t = b->t0 + (double)i * b->span / STATES;
        ck_assert(!nevh_field_gradient(f, 1, &t, q, p, d, d + b->n));
        ck_assert(!nevh_field_gradient(exact, 1, &t, q, p, e, e + b->n));
        for (size_t k = 0; k < 2 * b->n; k++)
            error[k] = fmax(error[k], fabs(d[k] - e[k]));
        nevh_run(stepper, t, b->span / STATES / 8, 8, q, p, NULL, 0);
    }
    nevh_stepper_free(stepper);
    nevh_system_free(s);
}

/* From above, and by no more than the worst case asks for. */
TEST_EACH(estimates_bound_errors, 16) {
    const problem *b = problem_of(_i);
    const nevh_gradient *g = method_of(_i);
    nevh_system *s = b->make();
    nevh_field *f = field_of(s, b, g);
    double error[2 * MOST_DOF], estimate[2 * MOST_DOF] = {0};
    measure(b, f, error);
    for (size_t i = 0; i < nevh_field_step_count(f); i++) {
        nevh_step_report r = nevh_field_step_report(f, i);
        estimate[r.index + (r.momentum ? b->n : 0)] +=
            r.truncation + r.rounding;
    }
    for (size_t k = 0; k < 2 * b->n; k++)
        ck_assert_msg(error[k] <= estimate[k] && estimate[k] <= 50 * error[k],
                      "%s, %s, variable %zu: error %.1e, estimate %.1e",
                      b->name, nevh_gradient_name(g), k, error[k], estimate[k]);
    nevh_field_free(f);
    nevh_system_free(s);
}

TEST_EACH(smooth_is_seen, 24) {
    const problem *b = problem_of(_i);
    nevh_system *s = b->make();
    nevh_field *f = field_of(s, b, method_of(_i));
    for (size_t i = 0; i < nevh_field_step_count(f); i++) {
        nevh_step_report r = nevh_field_step_report(f, i);
        ck_assert_msg(!r.given && !r.blind && !r.rough,
                      "%s, %s, %s: %c[%zu] is not smooth", b->name,
                      nevh_gradient_name(method_of(_i)), r.term,
                      r.momentum ? 'p' : 'q', r.index);
    }
    nevh_field_free(f);
    nevh_system_free(s);
}

/* All these kinetic energies are; so is Henon and Heiles' x^2 y, in x. */
TEST_EACH(quadratic_is_seen, 16) {
    const problem *b = problem_of(_i);
    const nevh_gradient *g = method_of(_i);
    nevh_system *s = b->make();
    nevh_field *f = field_of(s, b, g);
    for (size_t i = 0; i < nevh_field_step_count(f); i++) {
        nevh_step_report r = nevh_field_step_report(f, i);
        bool x = b == &henon_heiles && r.index == 0;
        ck_assert_str_eq(r.effect, r.term);
        ck_assert_int_eq(r.order, r.momentum || x ? 2 : nevh_gradient_order(g));
    }
    nevh_field_free(f);
    nevh_system_free(s);
}

/* Whole functions of one degree of freedom. */

static double smooth(double t, const double q[], const double p[],
                     const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2.6 - 2 * cos(q[0]);
}

static double kinked(double t, const double q[], const double p[],
                     const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2.6 + fabs(q[0]);
}

/* A number between 0 and 1 that looks random but is the same for equal x. */
static double hash(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits = (bits ^ bits >> 31) * 0x9e3779b97f4a7c15u;
    bits = (bits ^ bits >> 29) * 0xbf58476d1ce4e5b9u;
    return (double)(bits >> 11) * 0x1p-53;
}

static double noisy(double t, const double q[], const double p[],
                    const void *params) {
    return smooth(t, q, p, params) + 1e-6 * hash(q[0] + 1e3 * p[0]);
}

static double without_q(double t, const double q[], const double p[],
                        const void *params) {
    (void)t, (void)q, (void)params;
    return p[0] * p[0] / 2.6 + cos(p[0]);
}

/* The step of q or p, planned at (q, 0.2). */
static nevh_step_report report_of(nevh_value_fn H, const nevh_gradient *g,
                                  double q, bool momentum) {
    const double p = 0.2;
    nevh_system *s = nevh_system_from(1, H, NULL);
    nevh_field *f =
        nevh_field_new(s, &(nevh_options){.gradient = g, .q = &q, .p = &p});
    ck_assert_uint_eq(nevh_field_step_count(f), 2);
    nevh_step_report r = nevh_field_step_report(f, momentum);
    ck_assert_str_eq(r.term, "H");
    ck_assert_str_eq(r.effect, "H");
    ck_assert(r.momentum == momentum && r.index == 0 && r.instance == 0);
    nevh_field_free(f);
    nevh_system_free(s);
    return r;
}

/* The orbit from q = 0.3 crosses the kink. */
TEST_EACH(rough_is_seen, 4) {
    const nevh_gradient *g = method_of(_i);
    ck_assert(!report_of(smooth, g, 0.3, false).rough);
    ck_assert(!report_of(smooth, g, 0.3, true).rough);
    ck_assert(report_of(kinked, g, 0.3, false).rough);
    ck_assert(!report_of(kinked, g, 0.3, true).rough);
    ck_assert(report_of(noisy, g, 0.3, false).rough);
    ck_assert(report_of(noisy, g, 0.3, true).rough);
}

TEST_EACH(blind_is_said, 4) {
    nevh_step_report q = report_of(without_q, method_of(_i), 0.3, false);
    nevh_step_report p = report_of(without_q, method_of(_i), 0.3, true);
    ck_assert(q.blind && !q.rough && q.step > 0 && q.size == 0);
    ck_assert(!p.blind && !p.rough && p.size > 0);
}

/* A regular orbit of the double pendulum, on which gauss12 leaves nothing but
   rounding. */
static const double regular_q[] = {1.1, 0}, regular_p[] = {0, 2.7746};

/* The root mean square of the energy error over what is predicted for the end;
   of a random walk it is expected to be 1/sqrt(2).  The truncation of order 2
   adds nothing that grows: it is the gradient of a nearby H. */
static double wandering(const nevh_gradient *g, size_t steps) {
    const nevh_options o = {.gradient = g, .q = regular_q, .p = regular_p};
    double q[] = {1.1, 0}, p[] = {0, 2.7746}, floor;
    nevh_system *s = nevh_double_pendulum_model->system(
        nevh_double_pendulum_model->defaults);
    nevh_stepper *stepper = nevh_stepper_new(s, nevh_gauss12, &o);
    nevh_energy *energy = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 10};
    ck_assert(!nevh_run(stepper, 0, 0x1p-7, steps, q, p, &watch, 1));
    ck_assert(!nevh_field_energy_floor(nevh_stepper_field(stepper), 0,
                                       regular_q, regular_p, 0x1p-7, steps,
                                       &floor));
    nevh_energy_report r = nevh_energy_result(energy, 0);
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return r.rms * r.scale / floor;
}

static void assert_floor(const nevh_gradient *g, size_t steps) {
    double ratio = wandering(g, steps);
    ck_assert_msg(ratio > 0.1 && ratio < 5, "%s, %zu steps: %.1e times",
                  nevh_gradient_name(g), steps, ratio);
}

TEST_EACH(floor_of_short_runs, 4) {
    assert_floor(method_of(_i), 20000);
}

TEST_TAGGED(floor_of_long_runs, "slow", 0, 4) {
    assert_floor(method_of(_i), 200000);
}
