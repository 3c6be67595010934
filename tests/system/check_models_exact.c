/* nevh tests: exact solutions of models.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "models.h"
#include <float.h>
#include <math.h>
#include <string.h>

/* Orbits with an exact solution.  SEPARATRIX: p at the bottom of `plain`. */
#define SEPARATRIX 6.2609903369994111
static const nevh_oscillator held = {1.37, 5.23}, loose = {1.37, 0},
                             repelled = {1.37, -0.2};
static const nevh_pendulum unit = {1, 1, 1}, plain = {1, 1, 9.8},
                           odd = {1.37, 0.83, 9.81}, up = {1.37, 0.83, -3.1},
                           weightless = {1.37, 0.83, 0};
static const nevh_coupled_oscillators unequal = {1.37, 0.61, 2.3, 7.1, 0.77},
                                      adrift = {1.37, 0.61, 0, 0, 0.77},
                                      pushed = {1.37, 0.61, -2.3, 7.1, 0.77};
static const struct {
    const char *model;
    const void *params;
    double q[2], p[2];
} orbits[] = {
    {"harmonic-oscillator", &held, {0.7}, {-1.9}},
    {"harmonic-oscillator", &loose, {0.7}, {-1.9}},
    {"harmonic-oscillator", &repelled, {0.7}, {-1.9}},
    {"coupled-oscillators", &unequal, {0.7, -0.4}, {0.3, 1.9}},
    {"coupled-oscillators", &adrift, {0.7, -0.4}, {0.3, 1.9}},
    {"coupled-oscillators", &pushed, {0.7, -0.4}, {0.3, 1.9}},
    /* Libration, the last two by tiny angles. */
    {"pendulum", &odd, {-0.7}, {-2.1}},
    {"pendulum", &plain, {2}, {0}},
    {"pendulum", &odd, {19.3}, {1.7}},
    {"pendulum", &odd, {1.1e-5}, {-2.3e-5}},
    {"pendulum", &odd, {0}, {0}},
    /* Rotation to either side. */
    {"pendulum", &odd, {0.7}, {7.3}},
    {"pendulum", &odd, {0.7}, {-7.3}},
    {"pendulum", &plain, {-1.25}, {-31.5}},
    /* k = 0.999, 1e-10 below and above the separatrix, on it. */
    {"pendulum", &plain, {3.0521424792523257}, {0}},
    {"pendulum", &plain, {3.1415926535}, {0}},
    {"pendulum", &plain, {0}, {SEPARATRIX * (1 - 5e-11)}},
    {"pendulum", &plain, {0}, {-SEPARATRIX * (1 + 5e-11)}},
    {"pendulum", &unit, {0}, {2}},
    /* Gravity reversed or absent. */
    {"pendulum", &up, {0.7}, {-1.3}},
    {"pendulum", &up, {0.7}, {6.3}},
    {"pendulum", &weightless, {0.7}, {-1.3}},
};
enum { ORBITS = sizeof orbits / sizeof *orbits };
static const double times[] = {-9.7, -3.31, -0.0123, 0.017, 0.59, 2.77, 8.3};
enum { TIMES = sizeof times / sizeof *times };

/* The state of an orbit at time t, coordinates first. */
static void orbit_at(int i, double t, double state[]) {
    const nevh_model *model = nevh_model_named(orbits[i].model);
    ck_assert_int_eq(model->exact(orbits[i].params, t, orbits[i].q, orbits[i].p,
                                  state, state + model->n),
                     NEVH_OK);
}

/* d/dt of that, by differences of order 8. */
static void orbit_slope(int i, double t, double slope[]) {
    static const double weights[] = {4. / 5, -1. / 5, 4. / 105, -1. / 280};
    const double step = 1. / 256;
    double after[2 * MOST_DOF] = {0}, before[2 * MOST_DOF] = {0};
    memset(slope, 0, 2 * MOST_DOF * sizeof *slope);
    for (int j = 1; j <= 4; j++) {
        orbit_at(i, t + j * step, after);
        orbit_at(i, t - j * step, before);
        for (int k = 0; k < 2 * MOST_DOF; k++)
            slope[k] += weights[j - 1] * (after[k] - before[k]) / step;
    }
}

TEST_EACH(exact_solves_hamiltons_equations, ORBITS) {
    const nevh_model *model = nevh_model_named(orbits[_i].model);
    setup s = set_up(model, orbits[_i].params, nevh_exact);
    size_t n = model->n;
    for (int j = 0; j < TIMES; j++) {
        double z[2 * MOST_DOF], slope[2 * MOST_DOF], dh[2 * MOST_DOF], t = 0;
        orbit_at(_i, times[j], z);
        orbit_slope(_i, times[j], slope);
        nevh_field_gradient(s.field, 1, &t, z, z + n, dh, dh + n);
        double tolerance = 1e-9 * (largest(dh, 2 * n) + 1e-3 * largest(z, n));
        assert_close(slope, dh + n, n, tolerance);
        for (size_t k = 0; k < n; k++)
            ck_assert_double_le(fabs(slope[n + k] + dh[k]), tolerance);
    }
    tear_down(s);
}

TEST_EACH(exact_conserves_energy, ORBITS) {
    const nevh_model *model = nevh_model_named(orbits[_i].model);
    setup s = set_up(model, orbits[_i].params, nevh_exact);
    double h0 = model->hamiltonian(0, orbits[_i].q, orbits[_i].p, s.params);
    for (int j = 0; j < TIMES; j++) {
        double z[2 * MOST_DOF];
        orbit_at(_i, times[j], z);
        double h = model->hamiltonian(0, z, z + model->n, s.params);
        double size = size_of(s.field, nevh_system_effect_count(s.system), z,
                              z + model->n);
        ck_assert_double_eq_tol(h, h0, 1e-12 * size + DBL_MIN);
    }
    tear_down(s);
}

TEST_EACH(exact_starts_at_the_start, ORBITS) {
    double z[2 * MOST_DOF];
    size_t n = nevh_model_named(orbits[_i].model)->n;
    orbit_at(_i, 0, z);
    assert_close(z, orbits[_i].q, n, 2 * DBL_EPSILON * largest(z, n));
    assert_close(z + n, orbits[_i].p, n, 2 * DBL_EPSILON * largest(z + n, n));
}

/* An angle neither jumps nor is wrapped, nor turns once too often. */
TEST_EACH(exact_angle_is_continuous, ORBITS) {
    double last[2 * MOST_DOF], z[2 * MOST_DOF];
    if (strcmp(orbits[_i].model, "pendulum") != 0)
        skip_test("its coordinate is no angle");
    orbit_at(_i, -12, last);
    for (int j = 1; j <= 2400; j++) {
        orbit_at(_i, -12 + 0.01 * j, z);
        ck_assert_double_lt(fabs(z[0] - last[0]), 0.5);
        last[0] = z[0];
    }
}

/* States in quadruple precision: the first by a Gauss method of order 16 (to
   24 digits), the others by elliptic functions of 70 digits.  At 1e-10 from
   the separatrix a rounding of p0 shows as 1e-6 in the state. */
static const struct {
    nevh_pendulum params;
    double q0, p0, t, q, p;
} references[] = {
    {{1, 1, 1}, 2, 0, 100, 1.982325653157030516, 0.1796407425909401979},
    {{1, 1, 1},
     0,
     2.00000000005,
     60,
     15.70437661663844152,
     0.003586677269138920433},
    {{1, 1, 1},
     0,
     1.99999999995,
     60,
     3.138005974393043610,
     0.003586649393180779989},
    {{1, 1, 1},
     0,
     2.00000000005,
     -1000,
     -235.6244706294582399,
     0.005021624861505312604},
    {{1, 1, 9.8},
     0,
     6.260990337155936,
     30,
     21.99116977625685673,
     0.00007978079353847956791},
    {{1, 1, 9.8},
     0,
     6.2609903368428865,
     30,
     -3.141567168241273569,
     0.00006637113949401677477},
    {{1, 1, 1},
     3.141592653589793,
     0,
     60,
     -3.141592651301718468,
     -2.288074770630849796e-9},
    {{1, 1, 1},
     3.0521424792523257,
     0,
     50,
     1.044644896729640842,
     1.731017638387517798},
    {{1, 1, 9.8},
     -1.25,
     -31.5,
     1e4,
     -313995.4353262671351,
     -31.67915838557927680},
    {{1, 1, 1}, 7.5, -0.625, 77, 6.868607322612605612, 1.168037805172984684},
    {{1, 1, 1}, 0, 2, 20, 3.141592645345178749, 8.244614489754231277e-9},
};
enum { REFERENCES = sizeof references / sizeof *references };

TEST_EACH(pendulum_reference, REFERENCES) {
    double q, p;
    ck_assert_int_eq(nevh_pendulum_model->exact(
                         &references[_i].params, references[_i].t,
                         &references[_i].q0, &references[_i].p0, &q, &p),
                     NEVH_OK);
    ck_assert_double_eq_tol(q, references[_i].q,
                            1e-12 * fmax(1, fabs(references[_i].q)));
    ck_assert_double_eq_tol(p, references[_i].p,
                            1e-12 * fmax(1, fabs(references[_i].p)));
}

/* Time in units of sqrt(l/g), momentum in units of m l sqrt(g l). */
TEST(pendulum_scales) {
    double rate = sqrt(odd.g / odd.l), action = odd.m * odd.l * odd.l * rate;
    double start[] = {2, 0}, q, p;
    nevh_pendulum_model->exact(&odd, 100 / rate, start, start + 1, &q, &p);
    ck_assert_double_eq_tol(q, 1.982325653157030516, 1e-12);
    ck_assert_double_eq_tol(p / action, 0.1796407425909401979, 1e-12);
}

/* What no answer can be given to is refused, and the state left alone. */
TEST_EACH(exact_refuses, model_count()) {
    const nevh_model *model = nevh_models()[_i];
    const double bad[] = {NAN, INFINITY, -INFINITY};
    double state[MOST_DOF] = {0.3, 0.4}, q[MOST_DOF] = {7}, p[MOST_DOF] = {8};
    if (!model->exact)
        skip_test("it has no exact solution");
    for (int i = 0; i < 3; i++) {
        double wrong[MOST_DOF] = {bad[i], 0.1};
        const void *params = model->defaults;
        ck_assert_int_eq(model->exact(params, bad[i], state, state, q, p),
                         NEVH_EDOM);
        ck_assert_int_eq(model->exact(params, 1, wrong, state, q, p),
                         NEVH_EDOM);
        ck_assert_int_eq(model->exact(params, 1, state, wrong, q, p),
                         NEVH_EDOM);
    }
    ck_assert_int_eq(model->exact(model->defaults, 1e30, state, state, q, p),
                     NEVH_EDOM);
    ck_assert_double_eq(q[0], 7);
    ck_assert_double_eq(p[0], 8);
}

/* The separatrix has a limit there, but no state. */
TEST(exact_refuses_infinite_time) {
    double q0 = 0, p0 = 2, q, p;
    ck_assert_int_eq(
        nevh_pendulum_model->exact(&unit, INFINITY, &q0, &p0, &q, &p),
        NEVH_EDOM);
}
