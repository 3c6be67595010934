/* nevh tests: steps that cannot be taken, or hardly.
   SPDX-License-Identifier: GPL-3.0-or-later

   GSL's error handler is the default one, which aborts: nothing may reach it. */
#include "support.h"
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

static double pendulum(double t, const double q[], const double p[],
                       const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2.6 - 1.7 * cos(q[0]);
}

static double quartic(double t, const double q[], const double p[],
                      const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2 + q[0] * q[0] * q[0] * q[0];
}

/* H = p^2/(2*mass) + V(q) as one function of all, or, for schemes by parts, which
   need to know the terms of H, as two terms. */
typedef struct {
    double (*value)(double, const double[], const double[], const void *);
    double mass;
    const void *params;
} hamiltonian;

static double potential(double t, const double q[], const double p[],
                        const double c[], const void *params) {
    const hamiltonian *h = params;
    const double rest = 0;
    (void)p, (void)c;
    return h->value(t, q, &rest, h->params);
}

static nevh_system *new_system(const nevh_integrator *scheme,
                               const hamiltonian *h) {
    if (!(nevh_integrator_needs(scheme) & NEVH_PARTS))
        return nevh_system_from(1, h->value, h->params);
    nevh_system *s = nevh_system_new(1);
    add_kinetic(s, 1, &h->mass);
    nevh_system_add(
        s,
        &(nevh_term){.effect = "V", .nq = 1, .value = potential, .params = h});
    return s;
}

static const hamiltonian swinging = {pendulum, 1.3, NULL},
                         bound = {quartic, 1, NULL};
static const double start_q = 0.7, start_p = 0.4;
static const double absurd[] = {1e300, -1e300,   DBL_MAX,  1e150,   1e20,
                                -1e8,  0,        1e-300,   -1e-300, DBL_MIN,
                                NAN,   INFINITY, -INFINITY};
enum { ABSURD = sizeof absurd / sizeof *absurd };

static bool finite_state(const double z[2]) {
    return isfinite(z[0]) && isfinite(z[1]);
}

/* One step of any size, and a usual one after it. */
static void try_step(const nevh_system *s, const nevh_integrator *scheme,
                     double tolerance, double h) {
    nevh_options options = {.q = &start_q,
                            .p = &start_p,
                            .tolerance =
                                fmax(tolerance, tolerance_for(scheme))};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &options);
    nevh_stepper *fresh = nevh_stepper_new(s, scheme, &options);
    const double start[] = {start_q, start_p};
    double z[] = {start_q, start_p}, y[] = {start_q, start_p};
    int status = nevh_stepper_apply(m, 0, h, z, z + 1);
    ck_assert_int_eq(nevh_stepper_status(m), status);
    ck_assert_msg(finite_state(z), "%s, h = %g", nevh_integrator_name(scheme),
                  h);
    ck_assert(isfinite(h) || status == NEVH_EINVAL);
    ck_assert(status != NEVH_EFAILED || options.tolerance > 0);
    if (fabs(h) < 1e-100) {
        ck_assert_int_eq(status, NEVH_OK);
        ck_assert_mem_eq(z, start, sizeof z);
    }
    if (status) {
        ck_assert(strlen(nevh_stepper_message(m)) > 20);
        ck_assert_mem_eq(z, start, sizeof z);
        ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z, z + 1), NEVH_OK);
        ck_assert_int_eq(nevh_stepper_apply(fresh, 0, 0.1, y, y + 1), NEVH_OK);
        ck_assert_mem_eq(z, y, sizeof z);
    }
    nevh_stepper_free(m);
    nevh_stepper_free(fresh);
}

TEST_EACH(absurd_steps, 2 * scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i / 2];
    nevh_system *s = new_system(scheme, _i % 2 ? &bound : &swinging);
    for (int i = 0; i < ABSURD; i++)
        try_step(s, scheme, 0, absurd[i]);
    nevh_system_free(s);
}

/* Under step control; 1e20 would take that many steps. */
TEST_EACH(absurd_adaptive_steps, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (!nevh_integrator_adaptive(scheme))
        skip_test("it does not adapt steps");
    nevh_system *s = nevh_system_from(1, quartic, NULL);
    for (int i = 0; i < ABSURD; i++)
        if (!(fabs(absurd[i]) > 1 && fabs(absurd[i]) < 1e200))
            try_step(s, scheme, 1e-9, absurd[i]);
    nevh_system_free(s);
}

/* There and back, however short the way. */
TEST_EACH(tiny_steps_turn_round, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    nevh_system *s = new_system(scheme, &swinging);
    for (int adaptive = 0; adaptive < 2; adaptive++) {
        nevh_options options = {.tolerance =
                                    adaptive ? 1e-9 : tolerance_for(scheme)};
        nevh_stepper *m = nevh_stepper_new(s, scheme, &options);
        double z[] = {start_q, start_p};
        ck_assert_int_eq(nevh_stepper_apply(m, 0, 1e-200, z, z + 1), NEVH_OK);
        ck_assert_int_eq(nevh_stepper_apply(m, 1e-200, -1e-200, z, z + 1),
                         NEVH_OK);
        ck_assert_double_eq(z[0], start_q);
        ck_assert_double_eq(z[1], start_p);
        nevh_stepper_free(m);
    }
    nevh_system_free(s);
}

static double stiff(double t, const double q[], const double p[],
                    const void *params) {
    double k = *(const double *)params, x = q[0] * q[0];
    (void)t;
    return p[0] * p[0] / 2 + k * (x + x * x) / 2;
}

/* What a step of the midpoint rule lacks of solving its equations. */
static double midpoint_residual(const nevh_system *s, const nevh_options *o,
                                double h, const double z[2]) {
    nevh_field *f = nevh_field_new(s, o);
    double q = (start_q + z[0]) / 2, p = (start_p + z[1]) / 2, t = 0, dq, dp;
    ck_assert_int_eq(nevh_field_gradient(f, 1, &t, &q, &p, &dq, &dp), NEVH_OK);
    nevh_field_free(f);
    double lack_q = fabs(z[0] - start_q - h * dp) / (fabs(h * dp) + start_q);
    double lack_p = fabs(z[1] - start_p + h * dq) / (fabs(h * dq) + start_p);
    return fmax(lack_q, lack_p);
}

/* Never a hang, never NaN, and what is called solved is solved. */
TEST_EACH(stiff_steps, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    for (double k = 1e2; k < 1e13; k *= 1e5) {
        const hamiltonian spring = {stiff, 1, &k};
        nevh_system *s = new_system(scheme, &spring);
        for (double h = 0.001; h < 11; h *= 10) {
            nevh_options o = {.gradient_step = 0x1p-11,
                              .q = &start_q,
                              .p = &start_p,
                              .tolerance = tolerance_for(scheme)};
            nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
            double z[] = {start_q, start_p};
            int status = nevh_stepper_apply(m, 0, h, z, z + 1);
            ck_assert(finite_state(z));
            ck_assert(status == NEVH_OK || status == NEVH_EMAXITER ||
                      status == NEVH_EDOM ||
                      (status == NEVH_EFAILED && o.tolerance > 0));
            ck_assert(!status || (z[0] == start_q && z[1] == start_p));
            if (!status && scheme == nevh_midpoint)
                ck_assert_double_le(midpoint_residual(s, &o, h, z), 1e-8);
            nevh_stepper_free(m);
        }
        nevh_system_free(s);
    }
}

/* Its values are noise: no difference quotient means anything. */
static double noisy(double t, const double q[], const double p[],
                    const void *params) {
    uint64_t bits, more;
    memcpy(&bits, q, sizeof bits);
    memcpy(&more, p, sizeof more);
    bits ^= more << 1;
    bits = (bits ^ bits >> 29) * 0x9e3779b97f4a7c15u;
    return quartic(t, q, p, params) + (double)(bits >> 40) * 0x1p-34;
}

TEST_EACH(noise_is_not_solved, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (nevh_integrator_explicit(scheme) == NEVH_YES)
        skip_test("it is explicit");
    nevh_system *s = nevh_system_from(1, noisy, NULL);
    nevh_stepper *m = nevh_stepper_new(s, scheme, NULL);
    double z[] = {start_q, start_p};
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z, z + 1), NEVH_EMAXITER);
    assert_says(nevh_stepper_message(m), nevh_integrator_name(scheme));
    assert_says(nevh_stepper_message(m), "smaller step");
    ck_assert(z[0] == start_q && z[1] == start_p);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* A spring that ends at q = 1: fixed-point iteration jumps over the end. */
static double ending(double t, const double q[], const double p[],
                     const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2 - 5 * log(1 - q[0] * q[0]);
}

/* Steps from (0.9, 0) that Newton's iteration solves, and one that takes GSL's
   solver. */
static const struct {
    const nevh_integrator *const *scheme;
    double h;
    uint64_t rescues;
} hard[] = {{&nevh_midpoint, 0.3, 0}, {&nevh_gauss4, 1.73, 1}};

/* The step is a success, and is reported as one. */
TEST_EACH(solved_after_leaving_the_domain, 2) {
    static const double q = 0.9, p = 0;
    nevh_system *s = nevh_system_from(1, ending, NULL);
    nevh_stepper *m = nevh_stepper_new(s, *hard[_i].scheme,
                                       &(nevh_options){.q = &q, .p = &p});
    double x = q, y = p;
    ck_assert_int_eq(nevh_stepper_apply(m, 0, hard[_i].h, &x, &y), NEVH_OK);
    ck_assert_uint_eq(nevh_stepper_counts(m).newtons, 1);
    ck_assert_uint_eq(nevh_stepper_counts(m).rescues, hard[_i].rescues);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_OK);
    ck_assert_str_eq(nevh_stepper_message(m), "");
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* The steepness changes too much within a step for one matrix: GSL's solver,
   and what it finds is a solution. */
static double steep(double t, const double q[], const double p[],
                    const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2 + 40 * pow(fabs(q[0]), 1.3);
}

TEST(solved_where_newton_fails) {
    nevh_system *s = nevh_system_from(1, steep, NULL);
    nevh_options o = {.gradient_step = 0x1p-10, .q = &start_q, .p = &start_p};
    uint64_t rescues = 0;
    for (double h = 0.5; h < 2; h += 0.25) {
        nevh_stepper *m = nevh_stepper_new(s, nevh_midpoint, &o);
        double z[] = {start_q, start_p};
        ck_assert_int_eq(nevh_stepper_apply(m, 0, h, z, z + 1), NEVH_OK);
        ck_assert_double_le(midpoint_residual(s, &o, h, z), 1e-8);
        rescues += nevh_stepper_counts(m).rescues;
        ck_assert_uint_eq(nevh_stepper_counts(m).newtons, 1);
        nevh_stepper_free(m);
    }
    ck_assert_uint_ge(rescues, 4);
    nevh_system_free(s);
}

static double half_square(double t, const double q[], const double p[],
                          const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return p[0] * p[0] / 2;
}

static double fourth_power(double t, const double q[], const double p[],
                           const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return 1000 * q[0] * q[0] * q[0] * q[0];
}

static double both(double t, const double q[], const double p[],
                   const void *params) {
    return half_square(t, q, p, NULL, params) +
           fourth_power(t, q, p, NULL, params);
}

/* T(p) + V(q), where slopes of momenta alone are solved for, and H as a whole:
   GSL finds the same step. */
TEST(rescue_in_both_forms) {
    nevh_options o = {.gradient_step = 0x1p-10, .q = &start_q, .p = &start_p};
    nevh_system *forms[] = {nevh_system_new(1),
                            nevh_system_from(1, both, NULL)};
    nevh_system_add(
        forms[0],
        &(nevh_term){.effect = "kinetic", .np = 1, .value = half_square});
    nevh_system_add(
        forms[0],
        &(nevh_term){.effect = "potential", .nq = 1, .value = fourth_power});
    double z[2][2];
    for (int i = 0; i < 2; i++) {
        nevh_stepper *m = nevh_stepper_new(forms[i], nevh_gauss4, &o);
        z[i][0] = start_q;
        z[i][1] = start_p;
        ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z[i], z[i] + 1),
                         NEVH_OK);
        ck_assert_uint_eq(nevh_stepper_counts(m).rescues, 1);
        nevh_stepper_free(m);
        nevh_system_free(forms[i]);
    }
    ck_assert_double_eq_tol(z[0][0], z[1][0], 1e-8);
    ck_assert_double_eq_tol(z[0][1], z[1][1], 1e-8);
}

static double steep_alone(double t, const double q[], const double p[],
                          const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return 40 * pow(fabs(q[0]), 1.3);
}

static double ending_alone(double t, const double q[], const double p[],
                           const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return -5 * log(1 - q[0] * q[0]);
}

static void half_square_gradient(size_t width, const double t[],
                                 const double q[], const double p[],
                                 const double c[], const void *params,
                                 double dq[], double dp[]) {
    (void)t, (void)q, (void)c, (void)params, (void)dq;
    for (size_t i = 0; dp && i < width; i++)
        dp[i] = p[i];
}

static void steep_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)c, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = copysign(52 * pow(fabs(q[i]), 0.3), q[i]);
}

static void ending_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)c, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = fabs(q[i]) < 1 ? 10 * q[i] / (1 - q[i] * q[i]) : NAN;
}

/* In a step that Newton's iteration (i = 0, after the first sweep has left the
   domain) or GSL solves for the slopes of momenta, those of coordinates are the
   ones that go with them: q1 - q0 = h (p0 + p1) / 2 without any loss. */
TEST_EACH(coordinates_go_along, 6) {
    const nevh_term potentials[] = {
        {.effect = "V", .nq = 1, .value = ending_alone},
        {.effect = "V", .nq = 1, .value = steep_alone}};
    nevh_term kinetic = {.effect = "T", .np = 1, .value = half_square};
    nevh_term potential = potentials[_i > 0];
    kinetic.gradient = half_square_gradient;
    potential.gradient = _i > 0 ? steep_gradient : ending_gradient;
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &kinetic);
    nevh_system_add(s, &potential);
    nevh_options o = {.gradient = nevh_exact, .q = &start_q, .p = &start_p};
    nevh_stepper *m = nevh_stepper_new(s, nevh_midpoint, &o);
    double z[] = {start_q, start_p}, h = _i > 0 ? 0.4 + 0.05 * _i : 0.6;
    ck_assert_int_eq(nevh_stepper_apply(m, 0, h, z, z + 1), NEVH_OK);
    ck_assert_uint_eq(nevh_stepper_counts(m).newtons, 1);
    ck_assert_uint_eq(nevh_stepper_counts(m).rescues, _i > 0);
    ck_assert_double_eq_tol(z[0], start_q + h * (start_p + z[1]) / 2, 5e-16);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* A lane beside one that is rescued is what it is alone. */
TEST_EACH(rescue_of_a_neighbour, 2) {
    static const double scale[] = {1, 1};
    nevh_system *s = nevh_system_from(1, ending, NULL);
    nevh_options o = {.scale = scale, .width = 2};
    nevh_stepper *both = nevh_stepper_new(s, *hard[_i].scheme, &o);
    o.width = 1;
    nevh_stepper *alone = nevh_stepper_new(s, *hard[_i].scheme, &o);
    double q[] = {0.9, 0.2}, p[] = {0, 0.1}, x = 0.2, y = 0.1, h = hard[_i].h;
    ck_assert_int_eq(nevh_stepper_apply(both, 0, h, q, p), NEVH_OK);
    ck_assert_int_eq(nevh_stepper_apply(alone, 0, h, &x, &y), NEVH_OK);
    nevh_counts a = nevh_stepper_counts(alone), b = nevh_stepper_counts(both);
    ck_assert_uint_eq(a.rescues, 0);
    ck_assert_uint_eq(b.newtons, a.newtons + 1);
    ck_assert_uint_eq(b.rescues, hard[_i].rescues);
    ck_assert_double_eq(q[1], x);
    ck_assert_double_eq(p[1], y);
    nevh_stepper_free(both);
    nevh_stepper_free(alone);
    nevh_system_free(s);
}

/* F q + p/F: values and derivatives are finite, the momentum after a step is
   not. */
static double force(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)t, (void)p, (void)params;
    return c[0] * q[0];
}

static double drift(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)t, (void)q, (void)params;
    return p[0] / c[0];
}

static void force_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    (void)t, (void)q, (void)p, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = c[i];
}

static void drift_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    (void)t, (void)q, (void)p, (void)params, (void)dq;
    for (size_t i = 0; dp && i < width; i++)
        dp[i] = 1 / c[i];
}

static nevh_system *strong(const double *strength) {
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "force",
                                    .nq = 1,
                                    .nc = 1,
                                    .c = strength,
                                    .value = force,
                                    .gradient = force_gradient});
    nevh_system_add(s, &(nevh_term){.effect = "drift",
                                    .np = 1,
                                    .nc = 1,
                                    .c = strength,
                                    .value = drift,
                                    .gradient = drift_gradient});
    return s;
}

/* The coefficients of dop853 add up to 100, and so its slopes must be that
   far from the end of the range. */
TEST_EACH(leaves_the_range_of_numbers, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const double strength = scheme == nevh_dop853 ? 1e306 : 1e308;
    const double start = scheme == nevh_dop853 ? -1.7975e308 : -1e308;
    const double back = start + strength;
    nevh_system *s = strong(&strength);
    nevh_stepper *m =
        nevh_stepper_new(s, scheme,
                         &(nevh_options){.gradient = nevh_exact,
                                         .tolerance = tolerance_for(scheme)});
    double z[] = {0, start};
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 1, z, z + 1), NEVH_EDOM);
    assert_says(nevh_stepper_message(m), "smaller");
    ck_assert(z[0] == 0 && z[1] == start);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, -1, z, z + 1), NEVH_OK);
    ck_assert(fabs(z[1] - back) <= 1e293);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST(refused_plans) {
    nevh_system *s = nevh_system_from(1, pendulum, NULL);
    const struct {
        const char *name, *word;
        double tolerance;
    } plans[] = {{"verlot", "integrator", 0},
                 {NULL, "integrator", 0},
                 {"verlet", "tolerance", -1},
                 {"gsl-rkf45", "tolerance", NAN}};
    double z[] = {start_q, start_p}, start[] = {start_q, start_p};
    ck_assert_ptr_null(nevh_integrator_named("verlot"));
    for (int i = 0; i < 4; i++) {
        nevh_options o = {.tolerance = plans[i].tolerance};
        nevh_stepper *m =
            nevh_stepper_new(s, nevh_integrator_named(plans[i].name), &o);
        ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
        assert_says(nevh_stepper_message(m), plans[i].word);
        ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z, z + 1), NEVH_EINVAL);
        ck_assert_int_eq(nevh_run(m, 0, 0.1, 2, z, z + 1, NULL, 0),
                         NEVH_EINVAL);
        ck_assert_uint_eq(nevh_stepper_taken(m), 0);
        ck_assert_mem_eq(z, start, sizeof z);
        nevh_stepper_reset(m);
        nevh_stepper_free(m);
    }
    ck_assert_ptr_null(nevh_stepper_new(NULL, nevh_verlet, NULL));
    nevh_system_free(s);
}
