/* nevh tests: the models are what they are said to be.
   SPDX-License-Identifier: GPL-3.0-or-later

   Parameters and states are of high entropy: where m = l = 1 nobody would see
   that m l stands for m l^2. */
#include "support.h"
#include "models/models_private.h"
#include <float.h>
#include <math.h>
#include <string.h>

enum { STATES = 24 };

/* What is known of each model, and parameters to test it with. */
static const struct {
    const char *name, *effects;
    bool separable;
    double energy; /* of the start, with the default parameters */
    const void *params;
} known[] = {
    {"harmonic-oscillator", "kinetic spring ", true, 19.739208802178717,
     &(const nevh_oscillator){1.37, 5.23}},
    {"pendulum", "kinetic gravity ", true, 4.0782389981619955,
     &(const nevh_pendulum){1.37, 0.83, 9.81}},
    {"double-pendulum", "kinetic gravity ", false, -9.8,
     &(const nevh_double_pendulum){1.37, 0.83, 9.81}},
    {"double-pendulum-as-printed", "kinetic gravity ", false, -9.8,
     &(const nevh_double_pendulum){1.37, 0.83, 9.81}},
    {"elastic-pendulum", "kinetic spring gravity ", false, -2.942443896261655,
     &(const nevh_elastic_pendulum){1.37, 31.3, 0.83, 9.81}},
    {"coupled-oscillators", "kinetic springs coupling ", true, 0.55,
     &(const nevh_coupled_oscillators){1.37, 0.61, 2.3, 7.1, 0.77}},
};
enum { MODELS = sizeof known / sizeof *known };

typedef struct {
    const nevh_model *model;
    const void *params;
    nevh_system *system;
    nevh_field *field;
} setup;

static setup set_up(const nevh_model *model, const void *params,
                    const nevh_gradient *gradient) {
    nevh_options options = {.gradient = gradient, .gradient_step = 1. / 256};
    setup s = {.model = model, .params = params};
    s.system = model->system(params);
    ck_assert_str_eq(nevh_system_message(s.system), "");
    s.field = nevh_field_new(s.system, &options);
    ck_assert_str_eq(nevh_field_message(s.field), "");
    return s;
}

static void tear_down(setup s) {
    nevh_field_free(s.field);
    nevh_system_free(s.system);
}

/* In [-1, 1). */
static double uniform(void) {
    static unsigned long long seed = 20240229;
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(seed >> 11) / 4503599627370496.0 - 1;
}

/* Around the start, lanes innermost. */
static void make_states(const nevh_model *model, double q[], double p[]) {
    for (size_t k = 0; k < model->n; k++)
        for (size_t i = 0; i < STATES; i++) {
            q[k * STATES + i] = model->q[k] + 0.9 * uniform();
            p[k * STATES + i] = model->p[k] + 5 * uniform();
        }
}

static void take_lane(size_t n, size_t lane, const double from[], double to[]) {
    for (size_t k = 0; k < n; k++)
        to[k] = from[k * STATES + lane];
}

/* The size of H at a state: the sum of what its effects amount to. */
static double size_of(nevh_field *field, size_t effects, const double q[],
                      const double p[]) {
    double h[8], size = 0;
    ck_assert_uint_le(effects, 8);
    ck_assert_int_eq(nevh_field_effects(field, 0, q, p, h), NEVH_OK);
    for (size_t i = 0; i < effects; i++)
        size += fabs(h[i]);
    return size;
}

TEST(list_is_complete) {
#define EXPORTED(id) nevh_##id##_model,
    const nevh_model *const exported[] = {NEVH__MODELS(EXPORTED)};
    ck_assert_uint_eq(sizeof exported / sizeof *exported, MODELS);
    for (size_t i = 0; i < MODELS; i++) {
        ck_assert_ptr_eq(nevh_models()[i], exported[i]);
        ck_assert_ptr_eq(nevh_model_named(known[i].name), exported[i]);
    }
    ck_assert_ptr_null(nevh_models()[MODELS]);
    ck_assert_ptr_null(nevh_model_named("pendulums"));
    ck_assert_ptr_null(nevh_model_named(NULL));
}

TEST_EACH(structure, MODELS) {
    const nevh_model *model = nevh_models()[_i];
    char effects[80] = "";
    setup s = set_up(model, model->defaults, nevh_exact);
    for (size_t i = 0; i < nevh_system_effect_count(s.system); i++) {
        strcat(effects, nevh_system_effect_name(s.system, i));
        strcat(effects, " ");
    }
    ck_assert_str_eq(effects, known[_i].effects);
    ck_assert_int_eq((nevh_system_traits(s.system) & NEVH_SEPARABLE) != 0,
                     known[_i].separable);
    ck_assert_double_eq_tol(
        model->hamiltonian(0, model->q, model->p, model->defaults),
        known[_i].energy, 1e-13);
    for (size_t k = 0; k < model->n; k++)
        ck_assert_str_ne(model->coords[k], "");
    tear_down(s);
}

/* Vector cosines are within 4 ulp, and those of one effect may cancel. */
TEST_EACH(terms_sum_to_the_hamiltonian, MODELS) {
    const nevh_model *model = nevh_models()[_i];
    setup s = set_up(model, known[_i].params, nevh_exact);
    double t[STATES] = {0}, h[STATES], q[MOST_DOF], p[MOST_DOF];
    double many_q[MOST_DOF * STATES], many_p[MOST_DOF * STATES];
    make_states(model, many_q, many_p);
    ck_assert_int_eq(nevh_field_value(s.field, STATES, t, many_q, many_p, h),
                     NEVH_OK);
    double size = 0, error = 0;
    for (size_t i = 0; i < STATES; i++) {
        take_lane(model->n, i, many_q, q);
        take_lane(model->n, i, many_p, p);
        size = fmax(size,
                    size_of(s.field, nevh_system_effect_count(s.system), q, p));
        error = fmax(error, fabs(h[i] - model->hamiltonian(0, q, p, s.params)));
    }
    ck_assert_double_le(error, 4 * DBL_EPSILON * size);
    tear_down(s);
}

/* One state alone gives what it gives among others, to the last bit. */
TEST_EACH(lanes_are_independent, MODELS) {
    const nevh_model *model = nevh_models()[_i];
    setup s = set_up(model, known[_i].params, nevh_exact);
    double t[STATES] = {0}, h[STATES], alone, q[MOST_DOF], p[MOST_DOF];
    double many_q[MOST_DOF * STATES], many_p[MOST_DOF * STATES];
    double many_dq[MOST_DOF * STATES], many_dp[MOST_DOF * STATES];
    double dq[MOST_DOF], dp[MOST_DOF];
    make_states(model, many_q, many_p);
    nevh_field_value(s.field, STATES, t, many_q, many_p, h);
    nevh_field_gradient(s.field, STATES, t, many_q, many_p, many_dq, many_dp);
    for (size_t i = 0; i < STATES; i++) {
        take_lane(model->n, i, many_q, q);
        take_lane(model->n, i, many_p, p);
        nevh_field_value(s.field, 1, t, q, p, &alone);
        ck_assert_double_eq(alone, h[i]);
        nevh_field_gradient(s.field, 1, t, q, p, dq, NULL);
        nevh_field_gradient(s.field, 1, t, q, p, NULL, dp);
        for (size_t k = 0; k < model->n; k++) {
            ck_assert_double_eq(dq[k], many_dq[k * STATES + i]);
            ck_assert_double_eq(dp[k], many_dp[k * STATES + i]);
        }
    }
    tear_down(s);
}

static double largest(const double x[], size_t count) {
    double most = 0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

static void assert_close(const double a[], const double b[], size_t count,
                         double tolerance) {
    for (size_t i = 0; i < count; i++)
        ck_assert_double_le(fabs(a[i] - b[i]), tolerance);
}

TEST_EACH(gradient_is_the_derivative, MODELS) {
    const nevh_model *model = nevh_models()[_i];
    setup exact = set_up(model, known[_i].params, nevh_exact);
    setup central = set_up(model, known[_i].params, nevh_central8);
    enum { SIZE = MOST_DOF * STATES };
    double t[STATES] = {0}, q[SIZE], p[SIZE];
    double dq[SIZE], dp[SIZE], near_dq[SIZE], near_dp[SIZE];
    size_t count = model->n * STATES;
    make_states(model, q, p);
    nevh_field_gradient(exact.field, STATES, t, q, p, dq, dp);
    nevh_field_gradient(central.field, STATES, t, q, p, near_dq, near_dp);
    ck_assert_int_eq(nevh_field_status(central.field), NEVH_OK);
    assert_close(dq, near_dq, count, 1e-10 * largest(dq, count));
    assert_close(dp, near_dp, count, 1e-10 * largest(dp, count));
    tear_down(exact);
    tear_down(central);
}

/* The double pendulum once more, from where its bobs are. */

static void bobs(const nevh_double_pendulum *a, const double q[],
                 double xy[4]) {
    xy[0] = a->l * sin(q[0]);
    xy[1] = -a->l * cos(q[0]);
    xy[2] = xy[0] + a->l * sin(q[1]);
    xy[3] = xy[1] - a->l * cos(q[1]);
}

/* T - V; velocities are sixth-order differences of positions. */
static double lagrangian(const nevh_double_pendulum *a, const double q[],
                         const double v[]) {
    static const double weights[] = {45. / 60, -9. / 60, 1. / 60};
    const double step = 2e-3;
    double here[4], there[4], velocity[4] = {0}, sum = 0;
    for (int j = 1; j <= 3; j++)
        for (int sign = -1; sign <= 1; sign += 2) {
            bobs(a,
                 (double[]){q[0] + sign * j * step * v[0],
                            q[1] + sign * j * step * v[1]},
                 there);
            for (int i = 0; i < 4; i++)
                velocity[i] += sign * weights[j - 1] * there[i] / step;
        }
    for (int i = 0; i < 4; i++)
        sum += a->m / 2 * (velocity[i] * velocity[i]);
    bobs(a, q, here);
    return sum - a->m * a->g * (here[1] + here[3]);
}

/* p = dL/dv; L is quadratic in v. */
static void momenta(const nevh_double_pendulum *a, const double q[],
                    const double v[], double p[]) {
    for (int i = 0; i < 2; i++) {
        double up[] = {v[0], v[1]}, down[] = {v[0], v[1]};
        up[i] += 1;
        down[i] -= 1;
        p[i] = (lagrangian(a, q, up) - lagrangian(a, q, down)) / 2;
    }
}

/* H = p v - L at the v that has the momenta p. */
static double legendre(const nevh_double_pendulum *a, const double q[],
                       const double p[]) {
    double c[2], d[2], v[2];
    momenta(a, q, (double[]){1, 0}, c);
    momenta(a, q, (double[]){0, 1}, d);
    double det = c[0] * d[1] - c[1] * d[0];
    v[0] = (p[0] * d[1] - p[1] * d[0]) / det;
    v[1] = (p[1] * c[0] - p[0] * c[1]) / det;
    return p[0] * v[0] + p[1] * v[1] - lagrangian(a, q, v);
}

/* How far H is from the Legendre transform, of its size. */
static double legendre_error(const nevh_model *model) {
    static const nevh_double_pendulum a = {1.37, 0.83, 9.81};
    double worst = 0;
    for (int i = 0; i < 200; i++) {
        double q[] = {4 * uniform(), 4 * uniform()};
        double p[] = {5 * uniform(), 5 * uniform()};
        double h = legendre(&a, q, p);
        double error = fabs(model->hamiltonian(0, q, p, &a) - h);
        worst = fmax(worst, error / (3 * a.m * a.g * a.l + fabs(h)));
    }
    return worst;
}

TEST(double_pendulum_follows_from_its_lagrangian) {
    ck_assert_double_lt(legendre_error(nevh_double_pendulum_model), 1e-9);
}

TEST(as_printed_is_no_double_pendulum) {
    ck_assert_double_gt(legendre_error(nevh_double_pendulum_as_printed_model),
                        0.1);
}

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
TEST_EACH(exact_refuses, MODELS) {
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
