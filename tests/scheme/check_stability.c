/* nevh tests: limits of stability, and how fast neighbours turn and part.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "shipped.h"
#include "support.h"
#include <float.h>
#include <math.h>
#include <nevh/extend.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Verlet's and Euler's: h omega = 2.  Runge-Kutta of order 4: R(ix) = 1 - x^2/2
   + x^4/24 + i (x - x^3/6) has modulus 1 at 2 sqrt(2).  Lobatto IIIA-IIIB of 3
   stages: 2 sqrt(2) [L. O. Jay, L. R. Petzold, Highly oscillatory systems and
   periodic stability (1995)].  Forest and Ruth: a step of Verlet's at x has the
   trace 2 - x^2; where three of them reach -2.  Kutta's of order 3: sqrt(3).
   None has an interval of which |R(ix)| is sqrt(1 + x^2), as Euler's, or sqrt(1 +
   x^4/4), as that of two stages; Adams and Bashforth of two steps: the larger root
   of z^2 - (1 + 3ix/2) z + ix/2 is 1 + x^4/4; Fehlberg's of order 5: |R|^2 - 1 is
   x^6/551 to lowest order, since 1/360 - 2/2080 is above 0.  The implicit Euler method: 1 / sqrt(1 + x^2). */
static const struct {
    const nevh_integrator *const *scheme;
    double limit, tolerance;
} published[] = {{&nevh_symplectic_euler_a, 2, 1e-7},
                 {&nevh_symplectic_euler_b, 2, 1e-7},
                 {&nevh_verlet, 2, 1e-7},
                 {&nevh_position_verlet, 2, 1e-7},
                 {&nevh_lobatto2, 2, 1e-7},
                 {&nevh_lobatto4, 2.8284271247, 1e-7},
                 {&nevh_rk4, 2.8284271247, 1e-8},
                 {&nevh_forest_ruth, 1.573401947, 1e-6},
                 {&nevh_pefrl, 2.98945, 1e-4},
                 {&nevh_midpoint, INFINITY, 0},
                 {&nevh_gauss4, INFINITY, 0},
                 {&nevh_gauss8, INFINITY, 0},
                 {&nevh_gonzalez, INFINITY, 0},
                 {&nevh_rk3, 1.7320508076, 1e-8},
                 {&nevh_explicit_midpoint, 0, 0},
                 {&nevh_heun, 0, 0},
                 {&nevh_ralston, 0, 0},
                 {&nevh_adams_bashforth2, 0, 0},
                 {&nevh_gsl_rkf45, 0, 0},
                 {&nevh_gsl_rk8pd, 0, 0},
                 {&nevh_implicit_euler, INFINITY, 0},
                 {&nevh_euler, 0, 0}};
enum { PUBLISHED = sizeof published / sizeof *published };

TEST_EACH(published_limits, PUBLISHED) {
    double limit = nevh_stability_limit(*published[_i].scheme);
    if (isinf(published[_i].limit))
        ck_assert_double_infinite(limit);
    else if (published[_i].limit == 0)
        ck_assert_double_eq(limit, 0);
    else
        ck_assert_double_eq_tol(limit, published[_i].limit,
                                published[_i].tolerance);
}

/* Its two copies of the orbit leave each other. */
TEST(limit_of_an_extended_space) {
    double limit = nevh_stability_limit(nevh_tao4);
    ck_assert_double_gt(limit, 0.3);
    ck_assert_double_lt(limit, 1);
}

static const double mass = 1.3, spring = 2.2;

static double oscillator(double t, const double q[], const double p[],
                         const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / (2 * mass) + spring * q[0] * q[0] / 2;
}

static double oscillator_term(double t, const double q[], const double p[],
                              const double c[], const void *params) {
    (void)c;
    return oscillator(t, q, p, params);
}

/* One function of all may read the time, too, and has no parts. */
static nevh_system *new_oscillator(const nevh_integrator *scheme) {
    if (!(nevh_integrator_needs(scheme) & NEVH_PARTS))
        return nevh_system_from(1, oscillator, NULL);
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(
        s, &(nevh_term){
               .effect = "H", .nq = 1, .np = 1, .value = oscillator_term});
    return s;
}

static double largest_after(const nevh_integrator *scheme, double x) {
    nevh_system *s = new_oscillator(scheme);
    nevh_options o = {.gradient_step = 0x1p-3};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    double q = 1, p = 0.3, most = 0, h = x / sqrt(spring / mass);
    for (int i = 0; i < 10000 && most < 1e3; i++) {
        ck_assert_int_eq(nevh_stepper_apply(m, i * h, h, &q, &p), NEVH_OK);
        most = fmax(most, fabs(q));
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
    return most;
}

/* Unstable windows around pi are as narrow as the error of the scheme there. */
static double largest_above(const nevh_integrator *scheme, double limit) {
    double most = 0;
    for (double part = 1e-5; part < 2e-3 && most < 5; part *= 2)
        most = fmax(most, largest_after(scheme, limit * (1 + part)));
    return most;
}

/* On another oscillator: bounded right below every limit, not right above. */
TEST_EACH(limits_are_limits, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    double limit = nevh_stability_limit(scheme);
    bool symplectic = nevh_integrator_symplectic(scheme) == NEVH_YES;
    ck_assert(isnan(limit) || limit >= 0);
    if (isnan(limit) || nevh_integrator_symplectic(scheme) == NEVH_EXTENDED)
        return;
    if (limit == 0) {
        double growth = nevh_stability_growth(scheme, 0.8);
        double after = pow(growth, 1e4 * 0.8 / (2 * pi));
        ck_assert_double_gt(growth, 1);
        ck_assert_double_ge(largest_after(scheme, 0.8), 0.5 * fmin(after, 1e3));
        return;
    }
    if (isinf(limit)) {
        ck_assert_double_le(largest_after(scheme, 9), 10);
        return;
    }
    ck_assert_double_le(largest_after(scheme, limit * (1 - 1e-4)), 1e2);
    ck_assert_double_ge(symplectic ? largest_above(scheme, limit)
                                   : largest_after(scheme, 1.3 * limit),
                        3);
}

/* |R(ix)| of two stages; of Euler's method; none of Verlet's and rk4's. */
TEST(growth_of_a_period) {
    double x = 0.3, two = sqrt(1 + x * x * x * x / 4), one = sqrt(1 + x * x);
    ck_assert_double_eq_tol(nevh_stability_growth(nevh_heun, x),
                            pow(two, 2 * pi / x), 1e-12);
    ck_assert_double_eq_tol(nevh_stability_growth(nevh_euler, x),
                            pow(one, 2 * pi / x), 1e-12);
    ck_assert_double_eq(nevh_stability_growth(nevh_verlet, x), 1);
    ck_assert_double_eq(nevh_stability_growth(nevh_rk4, x), 1);
    ck_assert_double_gt(nevh_stability_growth(nevh_verlet, 2.1), 2);
    ck_assert_double_nan(nevh_stability_growth(nevh_verlet, 0));
    ck_assert_double_nan(nevh_stability_growth(nevh_adaptive_verlet, x));
}

TEST(no_limit_is_told) {
    ck_assert_double_nan(nevh_stability_limit(NULL));
    ck_assert_double_nan(nevh_stability_limit(nevh_adaptive_verlet));
    ck_assert_double_nan(nevh_stability_limit(nevh_gsl_msadams));
}

/* Steps of no sense, for which there is an answer all the same. */
static int grow(nevh_work *w, double t, double h, double q[], double p[]) {
    (void)t;
    for (size_t k = 0; k < w->n * w->width; k++)
        q[k] *= h == 0 ? 1 : 2, p[k] *= h == 0 ? 1 : 2;
    return NEVH_OK;
}

static int stay(nevh_work *w, double t, double h, double q[], double p[]) {
    (void)w, (void)t, (void)h, (void)q, (void)p;
    return NEVH_OK;
}

static int lose(nevh_work *w, double t, double h, double q[], double p[]) {
    (void)t, (void)h;
    for (size_t k = 0; k < w->n * w->width; k++)
        q[k] = p[k] = NAN;
    return NEVH_OK;
}

static int refuse(nevh_work *w, double t, double h, double q[], double p[]) {
    (void)w, (void)t, (void)h, (void)q, (void)p;
    return NEVH_EDOM;
}

TEST_EACH(schemes_of_no_sense_have_an_answer, 8) {
    static const struct {
        int (*step)(nevh_work *, double, double, double[], double[]);
        double limit;
    } senseless[] = {{grow, 0}, {stay, INFINITY}, {lose, 0}, {refuse, 0}};
    nevh_kernel kernel = *nevh_verlet->kernel;
    nevh_integrator scheme = *nevh_verlet;
    kernel.step = senseless[_i / 2].step;
    scheme.kernel = &kernel;
    scheme.symplectic = _i % 2 ? NEVH_YES : NEVH_NO;
    double limit = nevh_stability_limit(&scheme);
    if (isinf(senseless[_i / 2].limit))
        ck_assert_double_infinite(limit);
    else
        ck_assert_double_le(limit, 1e-18);
}

static void assert_rates(const nevh_system *s, const nevh_options *o,
                         const double q[], const double p[], double frequency,
                         double growth, double tolerance) {
    nevh_rates *r = nevh_rates_new(s, o);
    double f, g;
    ck_assert_msg(!nevh_rates_status(r), "%s", nevh_rates_message(r));
    ck_assert_int_eq(nevh_rates_at(r, 0.3, q, p, &f, &g), NEVH_OK);
    ck_assert_double_eq_tol(f, frequency, tolerance * fmax(frequency, 1));
    if (isnan(growth))
        ck_assert_double_nan(g);
    else
        ck_assert_double_eq_tol(g, growth, tolerance * fmax(growth, 1));
    nevh_rates_free(r);
}

static double pendulum(double t, const double q[], const double p[],
                       const void *params) {
    (void)t;
    double unit = *(const double *)params;
    return unit * (p[0] * p[0] / (unit * unit * 2.6) - 1.7 * cos(q[0]));
}

/* omega^2 = (1.7/1.3) cos(q), whatever the units of the momentum. */
TEST_EACH(rates_of_a_pendulum, 3) {
    static const double units[] = {1, 1e30, 1e-34};
    double unit = units[_i], c = 1.7 / 1.3;
    nevh_system *s = nevh_system_from(1, pendulum, &unit);
    const double down = 0.4, up = pi - 0.1;
    double p = 0.5 * unit;
    nevh_options o = {.q = &down, .p = &p};
    assert_rates(s, &o, &down, &p, sqrt(c * cos(0.4)), 0, 1e-6);
    assert_rates(s, &o, &up, &p, 0, sqrt(c * cos(0.1)), 1e-6);
    nevh_system_free(s);
}

/* A charge in a uniform field turns with omega = B, its guiding centre does not
   move: momenta and coordinates mix. */
static double charge(double t, const double q[], const double p[],
                     const void *params) {
    (void)t, (void)params;
    double vx = p[0] + 1.5 * q[1], vy = p[1] - 1.5 * q[0];
    return (vx * vx + vy * vy) / 2;
}

TEST(rates_of_a_charge) {
    nevh_system *s = nevh_system_from(2, charge, NULL);
    static const double q[] = {0.3, 0.2}, p[] = {1, -0.5};
    nevh_options o = {.q = q, .p = p};
    assert_rates(s, &o, q, p, 3, 0, 1e-4);
    nevh_system_free(s);
}

static const double chain_springs = 2.5;
enum { CHAIN = 60 };

static double link(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return chain_springs * (q[1] - q[0]) * (q[1] - q[0]) / 2;
}

static double own_kinetic(double t, const double q[], const double p[],
                          const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return p[0] * p[0] / 2;
}

/* A ring: omega = 2 sqrt(k) |sin(pi j/N)|; dense up to 48 bodies. */
TEST_EACH(rates_of_a_ring, 2) {
    size_t n = _i ? CHAIN : 12, pairs[2 * CHAIN], own[CHAIN];
    double z[CHAIN] = {0.1, -0.2};
    for (size_t i = 0; i < n; i++) {
        own[i] = pairs[2 * i] = i;
        pairs[2 * i + 1] = (i + 1) % n;
    }
    nevh_system *s = nevh_system_new(n);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .p = own,
                                    .count = n,
                                    .value = own_kinetic});
    nevh_system_add(s, &(nevh_term){.effect = "springs",
                                    .nq = 2,
                                    .q = pairs,
                                    .count = n,
                                    .value = link});
    nevh_options o = {.q = z, .p = z};
    assert_rates(s, &o, z, z, 2 * sqrt(chain_springs), _i ? NAN : 0,
                 _i ? 1e-2 : 1e-3);
    nevh_system_free(s);
}

static double three_bodies(double gravity, const double lengths[]) {
    double q[6], p[6], frequency, growth;
    char text[40];
    nevh_scene *s = read_shipped("figure-eight.nevh");
    snprintf(text, sizeof text, "G = %g", gravity);
    ck_assert_int_eq(nevh_scene_set(s, text), NEVH_OK);
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    nevh_options o = {.q = q, .p = p, .scale = lengths};
    nevh_rates *r = nevh_rates_new(nevh_scene_system(s), &o);
    ck_assert_int_eq(nevh_rates_at(r, 0, q, p, &frequency, &growth), NEVH_OK);
    nevh_rates_free(r);
    nevh_scene_free(s);
    return frequency;
}

/* Rates go as the root of G.  Products of what the matrix is made of underflow,
   or overflow, above all where lengths are probed. */
TEST_EACH(rates_of_any_size, 5) {
    static const double gravity[] = {1e-300, 1e-200, 1e-100, 1e100, 1e200};
    double lengths[12];
    for (size_t i = 0; i < 12; i++)
        lengths[i] = 1;
    double one = three_bodies(1, lengths), any = gravity[_i];
    ck_assert_double_gt(one, 0.5);
    ck_assert_double_eq_tol(three_bodies(any, lengths) / sqrt(any) / one, 1,
                            1e-6);
    ck_assert_double_ge(three_bodies(any, NULL), 0);
}

static double rooted(double t, const double q[], const double p[],
                     const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2 - sqrt(q[0]);
}

TEST(outside_there_are_no_rates) {
    nevh_system *s = nevh_system_from(1, rooted, NULL);
    static const double q = 1, p = 0, outside = -1;
    nevh_options o = {.q = &q, .p = &p};
    nevh_rates *r = nevh_rates_new(s, &o);
    double f, g;
    ck_assert_int_eq(nevh_rates_at(r, 0, &outside, &p, &f, &g), NEVH_EDOM);
    ck_assert_int_eq(nevh_rates_at(r, 0, &q, &p, &f, &g), NEVH_OK);
    nevh_rates_free(r);
    ck_assert_int_eq(nevh_rates_status(NULL), NEVH_ENOMEM);
    nevh_rates_free(NULL);
    nevh_system_free(s);
}
