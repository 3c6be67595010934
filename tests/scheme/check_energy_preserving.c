/* nevh tests: schemes that keep the energy, where it is easy to lose.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "lanes.h"
#include <float.h>
#include <math.h>
#include <nevh/extend.h>
#include <string.h>

static const nevh_integrator *scheme_at(int i) {
    const nevh_integrator *const schemes[] = {
        nevh_itoh_abe, nevh_itoh_abe_symmetric, nevh_gonzalez, nevh_avf};
    return schemes[i];
}
enum { SCHEMES = 4 };

static nevh_system *make_pendulum(void) {
    static const nevh_pendulum params = {1, 1, 1};
    return nevh_pendulum_model->system(&params);
}
static const problem pendulum = {
    .name = "pendulum", .n = 1, .q = {2}, .p = {0.1}, .make = make_pendulum};

/* Kepler's ellipse of eccentricity 0.6, from its pericentre, as one function
   that may read t for all that is known. */
static double orbit_energy(double t, const double q[], const double p[],
                           const void *params) {
    (void)t, (void)params;
    return (p[0] * p[0] + p[1] * p[1]) / 2 -
           1 / sqrt(q[0] * q[0] + q[1] * q[1]);
}
static nevh_system *make_ellipse(void) {
    return nevh_system_from(2, orbit_energy, NULL);
}
static const problem ellipse = {
    .name = "ellipse", .n = 2, .q = {0.4}, .p = {0, 2}, .make = make_ellipse};

typedef struct {
    const problem *problem;
    const nevh_gradient *const *gradient;
    double h;
    double most;     /* of the energy error */
    double contrast; /* what gauss4 makes of it, at least */
} setting;

static const setting kept[] = {
    {&pendulum, &nevh_exact, 0.05, 1e-14, 3e-8},
    {&pendulum, &nevh_exact, 0.5, 5e-14, 3e-4},
    {&pendulum, &nevh_exact, 1, 1e-13, 1e-2},
    {&pendulum, &nevh_central4, 0.2, 1e-13, 8e-6},
    {&henon_heiles, &nevh_exact, 0.1, 1e-14, 1e-7},
    {&henon_heiles, &nevh_exact, 0.5, 3e-14, 5e-5},
    {&double_pendulum, &nevh_exact, 0.01, 1e-14, 8e-10},
    {&double_pendulum, &nevh_exact, 0.06, 5e-14, 1e-6},
    {&double_pendulum, &nevh_central4, 0.06, 5e-14, 1e-6},
    {&ellipse, &nevh_central8, 0.01, 1e-13, 1e-8},
    {&ellipse, &nevh_central8, 0.05, 1e-13, 5e-6},
};
enum { KEPT = sizeof kept / sizeof *kept };

/* From the problem's state, with the problem's n. */
static nevh_energy_report run(const problem *b, const nevh_integrator *scheme,
                              const nevh_options *o, double h, size_t steps) {
    nevh_system *s = b->make();
    nevh_options options = *o;
    options.q = b->q;
    options.p = b->p;
    nevh_stepper *stepper = nevh_stepper_new(s, scheme, &options);
    nevh_energy *energy = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    double q[MOST_DOF], p[MOST_DOF];
    memcpy(q, b->q, sizeof q);
    memcpy(p, b->p, sizeof p);
    int status = nevh_run(stepper, 0, h, steps, q, p, &watch, 1);
    ck_assert_msg(status == NEVH_OK, "%s on %s: %s",
                  nevh_integrator_name(scheme), b->name,
                  nevh_stepper_message(stepper));
    nevh_energy_report report = nevh_energy_result(energy, 0);
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return report;
}
static const size_t many = 10000;

/* The mean of a difference gradient has no values of H to correct it: there
   its noise makes a random walk. */
TEST_EACH(energy_is_kept, KEPT) {
    const setting *a = &kept[_i];
    const nevh_options o = {.gradient = *a->gradient};
    for (int i = 0; i < SCHEMES; i++) {
        const nevh_integrator *scheme = scheme_at(i);
        bool walks = scheme == nevh_avf && *a->gradient != nevh_exact;
        double most = run(a->problem, scheme, &o, a->h, many).max;
        ck_assert_msg(most < (walks ? 30 : 1) * a->most,
                      "%s on %s, h = %g: %.2e", nevh_integrator_name(scheme),
                      a->problem->name, a->h, most);
    }
    double contrast = run(a->problem, nevh_gauss4, &o, a->h, many).max;
    ck_assert_double_gt(contrast, a->contrast);
}

/* A million steps, and no walk where values of H balance it. */
TEST_TAGGED(energy_does_not_walk, "slow", 0, SCHEMES) {
    const nevh_integrator *scheme = scheme_at(_i);
    const nevh_options o = {.gradient = nevh_exact};
    double most = run(&henon_heiles, scheme, &o, 0.2, 1000000).max;
    ck_assert_double_lt(most, scheme == nevh_avf ? 2e-13 : 1e-14);
}

/* Each step is solved: one among these 200 000 whose sweeps ended early would
   stand out by 1e-13 and more. */
TEST(no_sweep_too_few) {
    problem high = pendulum;
    high.q[0] = 2.6;
    high.p[0] = 0;
    const nevh_options o = {.gradient = nevh_exact};
    ck_assert_double_lt(run(&high, nevh_avf, &o, 0.2, 200000).max, 8e-14);
}

/* Gonzalez' scheme keeps H however wrong the gradient is. */
TEST_EACH(wrong_gradients, 2) {
    const problem *const all[] = {&pendulum, &double_pendulum};
    const double h[] = {0.05, 0.01};
    const nevh_options o = {.gradient = nevh_central2, .gradient_step = 1e-2};
    double most = run(all[_i], nevh_gonzalez, &o, h[_i], many).max;
    ck_assert_msg(most < 1e-14, "%s: %.2e", all[_i]->name, most);
    ck_assert_double_gt(run(all[_i], nevh_midpoint, &o, h[_i], many).max, 1e-6);
}

/* Nodes too few for a cosine, and one alone is the midpoint rule. */
TEST_EACH(too_few_nodes, 3) {
    static const double least[] = {4e-4, 1e-10, 1e-14};
    static const double most[] = {6e-4, 1e-6, 1e-11};
    nevh_integrator scheme = *nevh_avf;
    const nevh_options o = {.gradient = nevh_exact};
    scheme.stages = scheme.sweep_gradients = _i + 1;
    double found = run(&pendulum, &scheme, &o, 0.05, many).max;
    ck_assert_msg(found > least[_i] && found < most[_i], "%d nodes: %.2e",
                  _i + 1, found);
    if (_i == 0) {
        double midpoint = run(&pendulum, nevh_midpoint, &o, 0.05, many).max;
        ck_assert_double_eq_tol(found, midpoint, 1e-11);
    }
}

/* One orbit of one stepper. */
typedef struct {
    nevh_system *system;
    nevh_stepper *stepper;
    double t, q[MOST_DOF], p[MOST_DOF];
} orbit;

static orbit start(nevh_system *s, const nevh_integrator *scheme,
                   const nevh_gradient *g, const double q[], const double p[]) {
    orbit z = {.system = s};
    size_t size = nevh_system_dof(s) * sizeof *q;
    nevh_options options = {.gradient = g, .q = q, .p = p};
    z.stepper = nevh_stepper_new(s, scheme, &options);
    ck_assert_msg(nevh_stepper_status(z.stepper) == NEVH_OK, "%s",
                  nevh_stepper_message(z.stepper));
    memcpy(z.q, q, size);
    memcpy(z.p, p, size);
    return z;
}

static void go(orbit *z, double h, size_t steps) {
    int status = nevh_run(z->stepper, z->t, h, steps, z->q, z->p, NULL, 0);
    z->t += (double)steps * h;
    ck_assert_msg(status == NEVH_OK, "%s", nevh_stepper_message(z->stepper));
}

static void finish(orbit *z) {
    nevh_stepper_free(z->stepper);
    nevh_system_free(z->system);
}

static double well(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    (void)t, (void)p, (void)params;
    double x = q[0] * q[0] - 1;
    return c[0] * x * x;
}

static void well_gradient(size_t width, const double t[], const double q[],
                          const double p[], const double c[],
                          const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = 4 * c[i] * q[i] * (q[i] * q[i] - 1);
}

static double constant(double t, const double q[], const double p[],
                       const double c[], const void *params) {
    (void)t, (void)q, (void)p, (void)params;
    return c[0];
}

/* p^2/2m + c (q^2 - 1)^2 for the first of n coordinates; the others move
   freely.  An offset is a term of its own. */
static nevh_system *double_well(size_t n, double mass, double c,
                                double offset) {
    const double masses[] = {mass, mass};
    nevh_system *s = nevh_system_new(n);
    add_kinetic(s, n, masses);
    nevh_system_add(s, &(nevh_term){.effect = "well",
                                    .nq = 1,
                                    .nc = 1,
                                    .c = &c,
                                    .value = well,
                                    .gradient = well_gradient});
    if (offset != 0)
        nevh_system_add(s, &(nevh_term){.effect = "offset",
                                        .nc = 1,
                                        .c = &offset,
                                        .value = constant});
    return s;
}

/* Increments of exactly 0, and H with a third derivative there.  Values of H
   alone find the bottom to the accuracy of their differences. */
TEST_EACH(equilibria, SCHEMES) {
    const nevh_integrator *scheme = scheme_at(_i);
    double slack = nevh_integrator_sweep_gradients(scheme) ? 0 : 1e-9;
    const double q[] = {1}, p[] = {0}, bottom[] = {0};
    orbit z = start(double_well(1, 1, 1, 0), scheme, nevh_exact, q, p);
    go(&z, 0.1, 1000);
    ck_assert_double_le(fabs(z.q[0] - 1), slack);
    ck_assert_double_le(fabs(z.p[0]), slack);
    finish(&z);
    z = start(make_pendulum(), scheme, nevh_central4, bottom, p);
    go(&z, 0.1, 1000);
    ck_assert(z.q[0] == 0 && z.p[0] == 0);
    finish(&z);
}

/* A small oscillation: H is dominated by what does not move. */
TEST_EACH(near_an_equilibrium, SCHEMES) {
    const nevh_integrator *scheme = scheme_at(_i);
    const double amplitude = 1e-5, h = 0.01, q[] = {amplitude}, p[] = {0};
    orbit z = start(make_pendulum(), scheme, nevh_exact, q, p);
    for (int i = 1; i <= 10; i++) {
        go(&z, h, 1000);
        double energy = (z.p[0] * z.p[0] + z.q[0] * z.q[0]) / 2;
        ck_assert_double_eq_tol(sqrt(2 * energy), amplitude, 1e-3 * amplitude);
    }
    finish(&z);
}

/* A step across a turning point, so that one increment is 0 and the state comes
   back with its momentum turned round. */
TEST_EACH(turning_points, 2 * SCHEMES) {
    const nevh_integrator *scheme = scheme_at(_i % SCHEMES);
    double h = _i / SCHEMES ? 1e-3 : 0.2;
    const double q[] = {1.3}, p[] = {h * sin(q[0]) / 2};
    orbit z = start(make_pendulum(), scheme, nevh_exact, q, p);
    go(&z, h, 1);
    double slack = scheme == nevh_itoh_abe_symmetric ? h * h * h
                   : scheme == nevh_itoh_abe         ? 1e-4 * h * h * h
                                                     : 1e-13;
    ck_assert_double_eq_tol(z.q[0], q[0], slack);
    ck_assert_double_eq_tol(z.p[0], -p[0], slack);
    ck_assert_double_eq_tol(z.p[0] * z.p[0] / 2 - cos(z.q[0]),
                            p[0] * p[0] / 2 - cos(q[0]), 1e-15);
    finish(&z);
}

/* A coordinate that H does not read stands still, or goes on by h p/m, its
   momentum the same to the last bit. */
TEST_EACH(frozen_coordinate, 2 * SCHEMES) {
    const nevh_integrator *scheme = scheme_at(_i % SCHEMES);
    double moving = _i / SCHEMES;
    const double q[] = {0.3, 5}, p[] = {0.2, moving};
    orbit z = start(double_well(2, 1, 1, 0), scheme, nevh_exact, q, p);
    go(&z, 0.125, 1000);
    ck_assert(z.p[1] == moving);
    ck_assert_double_le(fabs(z.q[1] - (5 + 125 * moving)), 1e-9 * moving);
    finish(&z);
}

/* Other units, of which the factors are powers of two, change no digit. */
TEST_EACH(units_do_not_matter, SCHEMES) {
    const nevh_integrator *scheme = scheme_at(_i);
    const double unit = 0x1p-90;
    const double q[] = {0.3}, p[] = {0.2}, small[] = {0.2 * unit};
    orbit z = start(double_well(1, 1.3, 0.7, 0), scheme, nevh_exact, q, p);
    orbit y = start(double_well(1, 1.3 * unit, 0.7 * unit, 0), scheme,
                    nevh_exact, q, small);
    go(&z, 0.1, 1000);
    go(&y, 0.1, 1000);
    ck_assert(y.q[0] == z.q[0] && y.p[0] == z.p[0] * unit);
    finish(&z);
    finish(&y);
}

/* From rest: nothing tells the units of the momentum but H. */
TEST_EACH(units_are_found, SCHEMES) {
    const nevh_integrator *scheme = scheme_at(_i);
    const double unit = 1e-27, q[] = {0.3}, p[] = {0};
    orbit z = start(double_well(1, unit, unit, 0), scheme, nevh_exact, q, p);
    for (int i = 0; i < 1000; i++) {
        go(&z, 0.1, 1);
        double v = z.p[0] / unit, x = z.q[0] * z.q[0] - 1;
        ck_assert_double_eq_tol(v * v / 2 + x * x, 0.8281, 1e-14);
    }
    finish(&z);
}

/* A term that reads nothing is not in the way of any digit. */
TEST_EACH(offset_changes_nothing, SCHEMES) {
    const nevh_integrator *scheme = scheme_at(_i);
    const double q[] = {0.3}, p[] = {0.2};
    orbit z = start(double_well(1, 1, 1, 0), scheme, nevh_central4, q, p);
    orbit y = start(double_well(1, 1, 1, 1e6), scheme, nevh_central4, q, p);
    go(&z, 0.1, 1000);
    go(&y, 0.1, 1000);
    ck_assert(y.q[0] == z.q[0] && y.p[0] == z.p[0]);
    finish(&z);
    finish(&y);
}

static double lifted(double t, const double q[], const double p[],
                     const void *params) {
    (void)t, (void)params;
    return 1e6 + (p[0] * p[0] / 2 - cos(q[0]));
}
static nevh_system *make_lifted(void) {
    return nevh_system_from(1, lifted, NULL);
}
static const problem lifted_pendulum = {
    .name = "lifted", .n = 1, .q = {2}, .p = {0.1}, .make = make_lifted};

/* In H itself, its rounding is all that is lost. */
TEST_EACH(offset_within_h, SCHEMES) {
    const nevh_options o = {.gradient = nevh_central8};
    double most = run(&lifted_pendulum, scheme_at(_i), &o, 0.1, many).max;
    ck_assert_double_lt(most * 1e6, 100 * 1e6 * DBL_EPSILON);
}

/* Increments are all short: the orbit is still the orbit. */
TEST_EACH(tiny_steps, SCHEMES) {
    const nevh_integrator *scheme = scheme_at(_i);
    const double h = 1e-8, t = 1e4 * h, q[] = {2}, p[] = {0.1};
    const nevh_options o = {.gradient = nevh_exact};
    orbit z = start(make_pendulum(), scheme, nevh_exact, q, p);
    orbit y = start(make_pendulum(), nevh_gauss8, nevh_exact, q, p);
    go(&z, h, many);
    go(&y, t, 1);
    ck_assert_double_eq_tol(z.q[0], y.q[0], 1e-13);
    ck_assert_double_eq_tol(z.p[0], y.p[0], 1e-13);
    ck_assert_double_lt(run(&pendulum, scheme, &o, h, many).max, 1e-14);
    finish(&z);
    finish(&y);
}

/* The symmetric scheme is half a step of Itoh and Abe's, and half a step that
   its own backward step undoes. */
TEST(symmetric_is_composed) {
    const problem *b = &double_pendulum;
    const double h = 0.04;
    orbit whole =
        start(b->make(), nevh_itoh_abe_symmetric, nevh_exact, b->q, b->p);
    orbit half = start(b->make(), nevh_itoh_abe, nevh_exact, b->q, b->p);
    go(&whole, h, 1);
    go(&half, h / 2, 1);
    nevh_run(half.stepper, h, -h / 2, 1, whole.q, whole.p, NULL, 0);
    for (int k = 0; k < 2; k++) {
        ck_assert_double_eq_tol(whole.q[k], half.q[k], 1e-13);
        ck_assert_double_eq_tol(whole.p[k], half.p[k], 1e-13);
    }
    finish(&whole);
    finish(&half);
}

/* Lanes at rest, slow and fast ones side by side are what they are alone. */
TEST_EACH(lanes_are_alone, SCHEMES) {
    enum { LANES = 5 };
    const double q[LANES] = {1, 0.3, 1 + 1e-9, -1.4, 0.9};
    const double p[LANES] = {0, 0.2, 0, 1, 1e-7};
    const nevh_options o = {.gradient = nevh_exact,
                            .scale = (const double[]){1, 1}};
    nevh_system *s = double_well(1, 1, 1, 0);
    assert_lanes_are_alone(&(many_orbits){s, scheme_at(_i), &o, 1, LANES, 200,
                                          0, 0.1, q, p, false, NULL});
    nevh_system_free(s);
}
