/* nevh tests: difference steps of sums of many terms.
   SPDX-License-Identifier: GPL-3.0-or-later

   The outer solar system mixes forces of very different sizes, which a sum of
   terms keeps apart and one function does not.  Chains have more instances,
   and one function of them more variables, than are tried. */
#include "support.h"
#include <math.h>
#include <stdlib.h>

#define EACH(lane) for (size_t lane = 0; lane < width; lane++)

static const double now = 0;

/* Sun, Jupiter, Saturn, Uranus, Neptune, Pluto in AU, days, solar masses:
   Hairer, Lubich, Wanner, "Geometric Numerical Integration", I.2.4. */
enum { BODIES = 6, PAIRS = 15, SOLAR = 3 * BODIES };
static const double G = 2.95912208286e-4;
static const double mass[] = {1.00000597682,      0.000954786104043,
                              0.000285583733151,  0.0000437273164546,
                              0.0000517759138449, 1 / 1.3e8};
static const double position[SOLAR] = {
    0,          0,           0,           -3.5023653,  -3.8169847,  -1.5507963,
    9.0755314,  -3.0458353,  -1.6483708,  8.3101420,   -16.2901086, -7.2521278,
    11.4707666, -25.7294829, -10.8169456, -15.5387357, -25.2225594, -3.1902382};
static const double velocity[SOLAR] = {
    0,          0,          0,          0.00565429, -0.00412490, -0.00190589,
    0.00168318, 0.00483525, 0.00192462, 0.00354178, 0.00137102,  0.00055029,
    0.00288930, 0.00114527, 0.00039677, 0.00276725, -0.00170702, -0.00136504};

/* q: two bodies; c: G m_i m_j. */
static double pair(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    double x = q[3] - q[0], y = q[4] - q[1], z = q[5] - q[2];
    (void)t, (void)p, (void)params;
    return -c[0] / sqrt(x * x + y * y + z * z);
}

static void pair_gradient(size_t width, const double t[], const double q[],
                          const double p[], const double c[],
                          const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)params, (void)dp;
    if (dq)
        EACH(i) {
            double d[3], r2 = 0;
            for (size_t k = 0; k < 3; k++) {
                d[k] = q[(3 + k) * width + i] - q[k * width + i];
                r2 += d[k] * d[k];
            }
            for (size_t k = 0; k < 3; k++) {
                double force = c[i] * d[k] / (r2 * sqrt(r2));
                dq[(3 + k) * width + i] = force;
                dq[k * width + i] = -force;
            }
        }
}

static nevh_system *make_solar(void) {
    nevh_system *s = nevh_system_new(SOLAR);
    size_t index[PAIRS][6], at = 0;
    double masses[SOLAR], constant[PAIRS];
    for (size_t k = 0; k < SOLAR; k++)
        masses[k] = mass[k / 3];
    for (size_t i = 0; i < BODIES; i++)
        for (size_t j = i + 1; j < BODIES; j++, at++) {
            constant[at] = G * mass[i] * mass[j];
            for (size_t k = 0; k < 6; k++)
                index[at][k] = k < 3 ? 3 * i + k : 3 * j + k - 3;
        }
    add_kinetic(s, SOLAR, masses);
    nevh_system_add(s, &(nevh_term){.effect = "gravity",
                                    .nq = 6,
                                    .nc = 1,
                                    .q = index[0],
                                    .c = constant,
                                    .count = PAIRS,
                                    .value = pair,
                                    .gradient = pair_gradient});
    return s;
}

static double whole_solar(double t, const double q[], const double p[],
                          const void *params) {
    double sum = 0;
    for (size_t i = 0; i < SOLAR; i++)
        sum += mass_kinetic(t, NULL, p + i, &mass[i / 3], params);
    for (size_t i = 0; i < BODIES; i++)
        for (size_t j = i + 1; j < BODIES; j++) {
            const double *a = q + 3 * i, *b = q + 3 * j;
            const double both[] = {a[0], a[1], a[2], b[0], b[1], b[2]};
            double constant = G * mass[i] * mass[j];
            sum += pair(t, both, NULL, &constant, params);
        }
    return sum;
}

/* The largest error of a body's force (or velocity) relative to that force:
   one norm a body, so that Pluto counts as much as the Sun. */
static double body_error(const double d[], const double exact[]) {
    double worst = 0;
    for (size_t i = 0; i < SOLAR; i += 3) {
        double error = 0, size = 0;
        for (size_t k = i; k < i + 3; k++) {
            error = fmax(error, fabs(d[k] - exact[k]));
            size = fmax(size, fabs(exact[k]));
        }
        worst = fmax(worst, error / size);
    }
    return worst;
}

/* Over 24 states of 270 years. */
static double solar_error(const nevh_system *s, const nevh_gradient *g) {
    nevh_system *terms = make_solar();
    double q[SOLAR], p[SOLAR], d[2 * SOLAR], e[2 * SOLAR], worst = 0;
    for (size_t k = 0; k < SOLAR; k++) {
        q[k] = position[k];
        p[k] = mass[k / 3] * velocity[k];
    }
    nevh_options o = {.gradient = nevh_exact, .q = q, .p = p};
    nevh_stepper *stepper = nevh_stepper_new(terms, nevh_gauss8, &o);
    o.gradient = g;
    nevh_field *f = nevh_field_new(s, &o);
    for (size_t i = 0; i < 24; i++) {
        ck_assert(!nevh_run(stepper, 0, 82, 50, q, p, NULL, 0));
        ck_assert(!nevh_field_gradient(f, 1, &now, q, p, d, d + SOLAR));
        ck_assert(!nevh_field_gradient(nevh_stepper_field(stepper), 1, &now, q,
                                       p, e, e + SOLAR));
        worst = fmax(worst, body_error(d, e));
        worst = fmax(worst, body_error(d + SOLAR, e + SOLAR));
    }
    nevh_field_free(f);
    nevh_stepper_free(stepper);
    nevh_system_free(terms);
    return worst;
}

TEST(solar_system) {
    nevh_system *terms = make_solar();
    nevh_system *whole = nevh_system_from(SOLAR, whole_solar, NULL);
    double apart = solar_error(terms, nevh_central4);
    double together = solar_error(whole, nevh_central4);
    ck_assert_double_le(apart, 1e-10);
    ck_assert_double_ge(together, 1e-8);
    nevh_system_free(whole);
    nevh_system_free(terms);
}

/* A ring of n particles with Toda's springs, exp(d) - d. */
enum { LONG_CHAIN = 2000, SHORT_CHAIN = 100 };
enum { PLAN_VALUES = 500000 };

static size_t springs_asked;

static double spring(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    springs_asked++;
    return exp(q[1] - q[0]) - (q[1] - q[0]);
}

static void spring_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)c, (void)params, (void)dp;
    if (dq)
        EACH(i) {
            dq[width + i] = exp(q[width + i] - q[i]) - 1;
            dq[i] = -dq[width + i];
        }
}

static nevh_system *make_chain(size_t n) {
    nevh_system *s = nevh_system_new(n);
    size_t *index = calloc(2 * n, sizeof *index);
    double *masses = calloc(n, sizeof *masses);
    for (size_t i = 0; i < n; i++) {
        masses[i] = 1.3;
        index[2 * i] = i;
        index[2 * i + 1] = (i + 1) % n;
    }
    add_kinetic(s, n, masses);
    nevh_system_add(s, &(nevh_term){.effect = "spring",
                                    .nq = 2,
                                    .q = index,
                                    .count = n,
                                    .value = spring,
                                    .gradient = spring_gradient});
    free(index);
    free(masses);
    return s;
}

static double whole_chain(double t, const double q[], const double p[],
                          const void *params) {
    double sum = 0, m = 1.3;
    for (size_t i = 0; i < SHORT_CHAIN; i++) {
        const double two[] = {q[i], q[(i + 1) % SHORT_CHAIN]};
        sum += mass_kinetic(t, NULL, p + i, &m, params);
        sum += spring(t, two, NULL, NULL, params);
    }
    return sum;
}

/* A state in which no two particles do the same, and its exact gradient. */
static double q0[LONG_CHAIN], p0[LONG_CHAIN], exact[2 * LONG_CHAIN];

static void set_chain(size_t n) {
    nevh_system *s = make_chain(n);
    nevh_field *f = nevh_field_new(s, &(nevh_options){.gradient = nevh_exact});
    for (size_t i = 0; i < n; i++) {
        q0[i] = sin(0.37 * (double)i) + 0.3 * sin(1.7 * (double)(i * i));
        p0[i] = cos(0.77 * (double)(i * i));
    }
    ck_assert(!nevh_field_gradient(f, 1, &now, q0, p0, exact, exact + n));
    nevh_field_free(f);
    nevh_system_free(s);
}

/* Relative to the largest component; at the state that was planned at. */
static double chain_error(const nevh_system *s, const nevh_gradient *g,
                          double step) {
    static double d[2 * LONG_CHAIN];
    size_t n = nevh_system_dof(s);
    double error = 0, size = 0;
    nevh_field *f = nevh_field_new(
        s, &(nevh_options){
               .gradient = g, .gradient_step = step, .q = q0, .p = p0});
    ck_assert(!nevh_field_gradient(f, 1, &now, q0, p0, d, d + n));
    for (size_t i = 0; i < 2 * n; i++) {
        error = fmax(error, fabs(d[i] - exact[i]));
        size = fmax(size, fabs(exact[i]));
    }
    nevh_field_free(f);
    return error / size;
}

static void assert_good(const char *name, const nevh_system *s) {
    for (int i = 0; i < 4; i++) {
        const nevh_gradient *g = nevh_gradients()[i];
        double best = INFINITY, chosen = chain_error(s, g, 0);
        for (int power = -26; power <= 0; power++)
            best = fmin(best, chain_error(s, g, ldexp(1, power)));
        ck_assert_msg(chosen <= 10 * best, "%s, %s: error %.1e, best %.1e",
                      name, nevh_gradient_name(g), chosen, best);
    }
}

static void assert_power_of_two(double step) {
    int power;
    ck_assert_double_eq(frexp(step, &power), 0.5);
}

/* One in 32 instances is tried. */
TEST(instances_between) {
    const size_t n = LONG_CHAIN;
    set_chain(n);
    nevh_system *s = make_chain(n);
    nevh_field *f = nevh_field_new(s, &(nevh_options){.q = q0, .p = p0});
    ck_assert_uint_ge(nevh_field_step_count(f), 3 * 50);
    ck_assert_uint_le(nevh_field_step_count(f), 3 * 64);
    for (size_t i = 0; i < n; i++) {
        assert_power_of_two(nevh_field_step(f, "kinetic", i, n + i));
        assert_power_of_two(nevh_field_step(f, "spring", i, i));
        assert_power_of_two(nevh_field_step(f, "spring", i, (i + 1) % n));
    }
    nevh_field_free(f);
    assert_good("chain of terms", s);
    nevh_system_free(s);
}

static size_t asked_to_plan(size_t n) {
    set_chain(n);
    nevh_system *s = make_chain(n);
    springs_asked = 0;
    nevh_field *f = nevh_field_new(s, &(nevh_options){.q = q0, .p = p0});
    ck_assert(!nevh_field_status(f));
    nevh_field_free(f);
    nevh_system_free(s);
    return springs_asked;
}

/* However long the chain, a plan has its budget of values. */
TEST(price_of_a_plan) {
    static const size_t chains[] = {8, 32, 33, 64, 100, 250, 1000, LONG_CHAIN};
    for (size_t i = 0; i < sizeof chains / sizeof *chains; i++) {
        size_t asked = asked_to_plan(chains[i]);
        ck_assert_msg(asked <= PLAN_VALUES, "%zu springs: %zu values",
                      chains[i], asked);
    }
}

/* One function of 200 variables, half of which are tried. */
TEST(variables_between) {
    const size_t n = SHORT_CHAIN;
    set_chain(n);
    nevh_system *s = nevh_system_from(n, whole_chain, NULL);
    nevh_field *f = nevh_field_new(s, &(nevh_options){.q = q0, .p = p0});
    for (size_t i = 0; i < 2 * n; i++)
        assert_power_of_two(nevh_field_step(f, "H", 0, i));
    nevh_field_free(f);
    assert_good("whole chain", s);
    nevh_system_free(s);
}

/* A step given for one mass, of those that no trial looks at, keeps that
   variable of all of them at full order. */
TEST(given_between_trials) {
    enum { N = 200, GIVEN = 3 };
    static double masses[N], steps[2 * N], p[N], dp[N], t;
    for (int i = 0; i < N; i++)
        masses[i] = p[i] = 1 + 0.01 * i;
    nevh_system *s = nevh_system_new(N);
    add_kinetic(s, N, masses);
    nevh_options o = {.gradient_steps = steps};
    for (int given = 0; given < 2; given++) {
        steps[N + GIVEN] = given ? 0.125 : 0;
        nevh_field *f = nevh_field_new(s, &o);
        ck_assert_int_eq(nevh_field_gradient(f, 1, &t, p, p, NULL, dp), 0);
        ck_assert_uint_eq(nevh_field_counts(f).values, N * (given ? 4 : 2));
        if (given)
            ck_assert(nevh_field_step(f, "kinetic", GIVEN, N + GIVEN) == 0.125);
        nevh_field_free(f);
    }
    nevh_system_free(s);
}
