/* nevh tests: the models are what they are said to be.
   SPDX-License-Identifier: GPL-3.0-or-later

   Parameters and states are of high entropy: where m = l = 1 nobody would see
   that m l stands for m l^2. */
#include "models.h"
#include "models/models_private.h"
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
