/* nevh tests: Runge-Kutta-Nystroem methods.
   SPDX-License-Identifier: GPL-3.0-or-later

   The order on the problems of all schemes is measured in check_order, and
   that lanes and one orbit give the same bits in check_lanes and
   check_same_bits.  Here: the coefficients, and what the equations of second
   order ask of T. */
#include "lanes.h"
#include <float.h>
#include <math.h>
#include <nevh/extend.h>
#include <string.h>

#define EACH(lane) for (size_t lane = 0; lane < width; lane++)

static const nevh_nystrom *table(void) {
    return nevh_dprkn12->table;
}

/* sum_i b_i c_i^k. */
static double moment(const double b[], int k) {
    const nevh_nystrom *t = table();
    long double sum = 0;
    for (size_t i = 0; i < t->stages; i++)
        sum += b[i] * powl(t->c[i], k);
    return (double)sum;
}

/* Quadratures of order 12 for momenta and coordinates; the embedded one is of
   order 10, and of no higher. */
TEST(quadratures) {
    const nevh_nystrom *t = table();
    for (int k = 0; k < 12; k++)
        ck_assert_double_eq_tol(moment(t->bp, k), 1. / (k + 1), 1e-15);
    for (int k = 0; k < 11; k++)
        ck_assert_double_eq_tol(moment(t->bq, k), 1. / ((k + 1) * (k + 2)),
                                1e-15);
    for (int k = 0; k < 10; k++)
        ck_assert_double_eq_tol(moment(t->error_p, k), 0, 1e-15);
    for (int k = 0; k < 9; k++)
        ck_assert_double_eq_tol(moment(t->error_q, k), 0, 1e-15);
    ck_assert_double_gt(fabs(moment(t->bp, 12) - 1. / 13), 1e-9);
    ck_assert_double_gt(fabs(moment(t->error_p, 10)), 1e-8);
    ck_assert_double_gt(fabs(moment(t->error_q, 9)), 1e-8);
}

/* sum_j a_ij c_j^k = c_i^(k+2) / ((k+1)(k+2)), as far as the stages have it. */
TEST(stages) {
    const nevh_nystrom *t = table();
    for (size_t i = 1; i < t->stages; i++) {
        const double *a = t->a + i * t->stages;
        for (int k = 0; k < (i < 2 ? 1 : 3); k++) {
            double wanted = pow(t->c[i], k + 2) / ((k + 1) * (k + 2));
            ck_assert_double_eq_tol(moment(a, k), wanted, 2e-14);
        }
        for (size_t j = i; j < t->stages; j++)
            ck_assert(a[j] == 0);
    }
    ck_assert(t->c[0] == 0);
}

/* bq = bp (1 - c), by which coordinates are of the order of momenta. */
TEST(weights_agree) {
    const nevh_nystrom *t = table();
    for (size_t i = 0; i < t->stages; i++)
        ck_assert_double_eq_tol(t->bq[i], t->bp[i] * (1 - t->c[i]), 1e-16);
}

/* T = p0^2 + p0 p1 + 0.7 p1^2 + 0.3 p0 - 0.2 p1, of which no W is declared to
   be diagonal, and T_p(0) is not 0. */
static double coupled(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return p[0] * p[0] + p[0] * p[1] + 0.7 * p[1] * p[1] + 0.3 * p[0] -
           0.2 * p[1];
}

static void coupled_gradient(size_t width, const double t[], const double q[],
                             const double p[], const double c[],
                             const void *params, double dq[], double dp[]) {
    (void)t, (void)q, (void)c, (void)params, (void)dq;
    if (dp)
        EACH(i) {
            dp[i] = 2 * p[i] + p[width + i] + 0.3;
            dp[width + i] = p[i] + 1.4 * p[width + i] - 0.2;
        }
}

/* p^2/3 + 0.1 p, in terms of one momentum each. */
static double single(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return p[0] * p[0] / 3 + 0.1 * p[0];
}

static void single_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    (void)t, (void)q, (void)c, (void)params, (void)dq;
    if (dp)
        EACH(i) {
            dp[i] = 2 * p[i] / 3 + 0.1;
        }
}

/* Driven, and of both coordinates. */
static double wells(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)p, (void)c, (void)params;
    return -cos(q[0]) - 0.6 * cos(q[1] - 0.5 * q[0]) + 0.1 * q[1] * sin(t);
}

static void wells_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    (void)p, (void)c, (void)params, (void)dp;
    if (dq)
        EACH(i) {
            double slope = 0.6 * sin(q[width + i] - 0.5 * q[i]);
            dq[i] = sin(q[i]) - 0.5 * slope;
            dq[width + i] = slope + 0.1 * sin(t[i]);
        }
}

static nevh_system *make(nevh_term kinetic) {
    nevh_system *s = nevh_system_new(2);
    kinetic.effect = "kinetic";
    nevh_system_add(s, &kinetic);
    nevh_system_add(s, &(nevh_term){.effect = "wells",
                                    .nq = 2,
                                    .time = true,
                                    .value = wells,
                                    .gradient = wells_gradient});
    ck_assert(!nevh_system_status(s));
    return s;
}

static nevh_system *make_coupled(void) {
    return make(
        (nevh_term){.np = 2, .value = coupled, .gradient = coupled_gradient});
}

static nevh_system *make_single(void) {
    static const size_t each[] = {0, 1};
    return make((nevh_term){.np = 1,
                            .p = each,
                            .count = 2,
                            .value = single,
                            .gradient = single_gradient});
}

/* H as one function, of which nothing is declared. */
static double whole(double t, const double q[], const double p[],
                    const void *params) {
    return single(t, q, p, NULL, params) + single(t, q, p + 1, NULL, params) +
           wells(t, q, p, NULL, params);
}

typedef struct {
    double z[4];
} state;

static size_t slopes; /* that the last travel took */

/* From t = 0.2 to 10.2. */
static state travel(const nevh_system *s, const nevh_integrator *scheme,
                    const nevh_gradient *g, size_t steps, double tolerance) {
    state x = {{0.4, -0.7, 0.9, 0.3}};
    nevh_options o = {.gradient = g,
                      .t = 0.2,
                      .q = (const double[]){0.4, -0.7},
                      .p = (const double[]){0.9, 0.3},
                      .tolerance = tolerance};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    int status =
        nevh_run(m, 0.2, 10. / (double)steps, steps, x.z, x.z + 2, NULL, 0);
    ck_assert_msg(!status, "%s", nevh_stepper_message(m));
    slopes = nevh_stepper_counts(m).gradients;
    nevh_stepper_free(m);
    return x;
}

static double apart(state a, state b) {
    double most = 0;
    for (int i = 0; i < 4; i++)
        most = fmax(most, fabs(a.z[i] - b.z[i]));
    return most;
}

static void assert_order(nevh_system *s, size_t few, size_t many) {
    state exact = travel(s, nevh_gauss16, nevh_exact, 100, 0);
    double far = apart(travel(s, nevh_dprkn12, nevh_exact, few, 0), exact);
    double near = apart(travel(s, nevh_dprkn12, nevh_exact, many, 0), exact);
    double slope = log(far / near) / log((double)many / (double)few);
    ck_assert_double_ge(near, 1e-12);
    ck_assert_double_eq_tol(slope, 12, 1);
    ck_assert_double_le(
        apart(travel(s, nevh_dprkn12, nevh_exact, 50, 0), exact), 2e-14);
    ck_assert_double_le(
        apart(travel(s, nevh_dprkn12, nevh_central8, 50, 0), exact), 1e-9);
    nevh_system_free(s);
}

TEST(momenta_that_mix) {
    assert_order(make_coupled(), 8, 24);
}

TEST(momenta_apart) {
    assert_order(make_single(), 5, 9);
}

/* The same orbit where W is known and where T_p is asked for. */
TEST(undeclared) {
    nevh_system *one = nevh_system_from(2, whole, NULL), *s = make_single();
    state a = travel(one, nevh_dprkn12, nevh_central8, 20, 0);
    state b = travel(s, nevh_dprkn12, nevh_exact, 20, 0);
    ck_assert_double_le(apart(a, b), 1e-10);
    nevh_system_free(one);
    nevh_system_free(s);
}

/* What one function of everything rounds does not come from other lanes, nor
   from other steps. */
TEST(undeclared_in_lanes) {
    enum { WIDTH = 3 };
    nevh_system *one = nevh_system_from(2, whole, NULL);
    for (int adaptive = 0; adaptive < 2; adaptive++) {
        const nevh_options o = {.scale = (const double[]){1, 1, 1, 1},
                                .gradient_step = 0x1p-12,
                                .tolerance = adaptive ? 1e-9 : 0};
        double z[4 * WIDTH];
        for (size_t i = 0; i < 4 * WIDTH; i++)
            z[i] = 0.4 - 0.1 * (double)(i % 5);
        assert_lanes_are_alone(&(many_orbits){one, nevh_dprkn12, &o, 2, WIDTH,
                                              14, 0.2, adaptive ? 40 : 0.5, z,
                                              z + 2 * WIDTH, false, NULL});
    }
    nevh_system_free(one);
}

/* Errors follow the tolerance, with fewer slopes than dop853 needs. */
TEST(follows_the_tolerance) {
    nevh_system *s = make_coupled();
    state exact = travel(s, nevh_gauss16, nevh_exact, 100, 0);
    for (double tolerance = 1e-5; tolerance > 1e-13; tolerance /= 100) {
        double error =
            apart(travel(s, nevh_dprkn12, nevh_exact, 1, tolerance), exact);
        ck_assert_msg(error <= 30 * tolerance + 1e-14, "%.0e: %.2e", tolerance,
                      error);
        ck_assert_double_ge(error, 1e-4 * tolerance);
    }
    travel(s, nevh_dprkn12, nevh_exact, 1, 1e-11);
    size_t own = slopes;
    travel(s, nevh_dop853, nevh_exact, 1, 1e-11);
    ck_assert_uint_le(3 * own, 2 * slopes);
    nevh_system_free(s);
}

static double growing_mass(double t, const double q[], const double p[],
                           const double c[], const void *params) {
    (void)q, (void)c, (void)params;
    return (p[0] * p[0] + p[1] * p[1]) / (2 + 0.1 * sin(t));
}

static double growing_whole(double t, const double q[], const double p[],
                            const void *params) {
    return growing_mass(t, q, p, NULL, params) + wells(t, q, p, NULL, params);
}

static void assert_refused(nevh_system *s, const nevh_options *o, int status,
                           const char *word) {
    nevh_stepper *m = nevh_stepper_new(s, nevh_dprkn12, o);
    ck_assert_int_eq(nevh_stepper_status(m), status);
    ck_assert_msg(strstr(nevh_stepper_message(m), word) != NULL, "%s",
                  nevh_stepper_message(m));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* That is no equation of second order; splittings can take it. */
TEST(refuses_a_mass_that_grows) {
    const nevh_options o = {.gradient = nevh_central4};
    nevh_term term = {.np = 2, .time = true, .value = growing_mass};
    assert_refused(make(term), &o, NEVH_ESTRUCT, "\"kinetic\"");
    assert_refused(nevh_system_from(2, growing_whole, NULL), &o, NEVH_ESTRUCT,
                   "\"H\"");
    nevh_system *s = make(term);
    nevh_stepper *m = nevh_stepper_new(s, nevh_rkn11b, &o);
    ck_assert(!nevh_stepper_status(m));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST(refuses_other_kinetic_energies) {
    const nevh_options o = {.gradient = nevh_exact};
    assert_refused(relativistic.make(), &o, NEVH_ESTRUCT, "quadratic");
}

/* Friction goes around steps of a given length. */
TEST(refuses_friction_under_a_tolerance) {
    nevh_options o = {.gradient = nevh_exact, .tolerance = 1e-6};
    nevh_system *s = make_single();
    nevh_system_add_friction(s, "air", (const double[]){0.1, 0.1});
    assert_refused(s, &o, NEVH_ESTRUCT, "friction");
    s = make_single();
    nevh_system_add_friction(s, "air", (const double[]){0.1, 0.1});
    o.tolerance = 0;
    nevh_stepper *m = nevh_stepper_new(s, nevh_dprkn12, &o);
    ck_assert(!nevh_stepper_status(m));
    ck_assert_int_eq(nevh_stepper_order(m), 2);
    nevh_stepper_free(m);
    nevh_system_free(s);
}
